#include "app/evaluation/scan_options.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "base/input_error.h"

namespace foci {
namespace {

constexpr int kMaxThreads = 1024;

glm::vec3 vectorOf(const std::vector<double>& xyz) {
  return {static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])};
}

}  // namespace

void addScanOptions(CLI::App& command, ScanOptions& options) {
  command.add_option("--scan", options.scan, "points, mesh or scene instead of the statue")
      ->type_name("FILE");
  const auto pose = [&](const char* name, std::vector<double>& xyz, const char* help) {
    command.add_option(name, xyz, help)->type_name("X,Y,Z")->delimiter(',')->expected(3);
  };
  pose("--eye", options.eye, "from where the scan is seen, metres; default: as configs/lion.toml");
  pose("--look-at", options.look_at, "what of it is in the middle and in focus, metres");
  pose("--up", options.up, "which way is up");
  command.add_option("--threads", options.threads, "at most; measured at 1 and at this")
      ->type_name("N");
}

std::optional<ScanView> scanViewOf(const ScanOptions& options) {
  if (options.scan.empty()) return std::nullopt;
  const EyePose pose{vectorOf(options.eye), vectorOf(options.look_at), vectorOf(options.up)};
  const glm::vec3 side = glm::cross(pose.target_m - pose.position_m, pose.up);
  if (!(glm::length(side) > 0.0f && std::isfinite(glm::length(side)))) {
    throw InputError("--eye, --look-at, --up", "the line of sight is none, or along up");
  }
  return ScanView{options.scan, pose};
}

std::unique_ptr<tbb::global_control> threadLimit(const ScanOptions& options) {
  if (!options.threads) return nullptr;
  if (*options.threads < 1 || *options.threads > kMaxThreads) {
    throw InputError("--threads " + std::to_string(*options.threads),
                     "expected an integer, 1 to " + std::to_string(kMaxThreads));
  }
  return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(*options.threads));
}

}  // namespace foci
