#include "app/cli/scan_options.h"

#include <cmath>

#include "app/cli/option_values.h"
#include "base/input_error.h"
#include "render/scene/io/mesh_files.h"

namespace foci {
namespace {

glm::vec3 vectorOf(const std::vector<double>& xyz) {
  return {static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])};
}

}  // namespace

void addScanOptions(CLI::App& command, ScanOptions& options) {
  addOption(command, "--scan", options.scan, "FILE",
            "points, mesh or prepared scene instead of the statue");
  const auto pose = [&](const char* name, std::vector<double>& xyz, const char* help) {
    addOption(command, name, xyz, "X,Y,Z", help)->delimiter(',')->expected(3);
  };
  pose("--eye", options.eye, "where the eye is, metres; default: as in configs/lion.toml");
  pose("--look-at", options.look_at, "point in the middle of the image and in focus, metres");
  pose("--up", options.up, "upward direction of the image");
  addOption(command, "--threads", options.threads, "N",
            "max number of threads; times are measured with 1 and with N");
}

std::vector<std::filesystem::path> scanFiles(const ScanOptions& options) {
  if (options.scan.empty()) return {};
  std::vector<std::filesystem::path> files = meshCompanions(options.scan);
  files.emplace_back(options.scan);
  return files;
}

std::optional<ScanView> scanViewOf(const ScanOptions& options) {
  if (options.scan.empty()) return std::nullopt;
  const EyePose pose{vectorOf(options.eye), vectorOf(options.look_at), vectorOf(options.up)};
  const glm::vec3 side = glm::cross(pose.target_m - pose.position_m, pose.up);
  if (!(glm::length(side) > 0.0f && std::isfinite(glm::length(side)))) {
    throw InputError("--eye, --look-at, --up",
                     "expected --look-at away from --eye, and not along --up");
  }
  return ScanView{options.scan, pose};
}

}  // namespace foci
