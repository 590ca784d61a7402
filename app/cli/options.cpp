#include <cmath>

#include "app/cli/commands.h"
#include "app/platform/output_files.h"
#include "base/input_error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "render/scene/io/mesh_files.h"

namespace foci {
namespace {

glm::vec3 vectorOf(const std::vector<double>& xyz) {
  return {static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])};
}

}  // namespace

double vergenceOf_D(const std::string& option, const std::string& text) {
  constexpr double kNearestFocus_m = 0.01;  // nearer than any eye accommodates
  const auto distance_m = text == "inf" ? std::optional(HUGE_VAL) : parseNumber(text);
  if (!distance_m || !(*distance_m >= kNearestFocus_m)) {
    throw InputError(option + " " + text, "expected metres, 0.01 or more, or inf");
  }
  return 1.0 / *distance_m;
}

void onceParsed(CLI::App& command, const std::function<void()>& run) {
  command.callback([&command, run] {
    for (const CLI::Option* option : command.get_options()) {
      if (option->get_type_size() == 0) continue;  // a flag
      if (std::ranges::find(option->results(), "") != option->results().end()) {
        throw InputError(option->get_name(), "expected a value that is not empty");
      }
    }
    run();
  });
}

void addOverwriteFlag(CLI::App& command, bool& overwrite) {
  command.add_flag("--overwrite", overwrite, "also replace files that foci did not make");
}

unsigned threadsOf(const std::string& threads) {
  constexpr unsigned kMaxThreads = 1024;  // chosen by eye: far above the cores of a workstation
  if (threads.empty()) return maxThreads();
  const auto count = parseNumber(threads);
  if (!count || *count < 1 || *count > kMaxThreads || *count != std::floor(*count)) {
    throw InputError("--threads " + threads,
                     "expected an integer, 1 to " + std::to_string(kMaxThreads));
  }
  return static_cast<unsigned>(*count);
}

void addStudyOptions(CLI::App& command, StudyRequest& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    return addOption(command, name, value, type, help);
  };
  add("STUDY", options.study, "FILE",
      "study (TOML), or a scene: points, mesh, Gaussians or prepared scene, which foci then frames")
      ->required();
  add("--scene", options.scene, "FILE",
      "points, mesh, Gaussians or prepared scene instead of the study's scene");
  add("--look", options.look, "FROM", "for a scene: look from front, left, above or outside");
  add("--up", options.up, "AXIS", "for a scene: its upward axis, x, y or z, or -x, -y or -z");
  add("--write-study", options.write_study, "FILE.toml",
      "save the study with these options, to edit and use again");
  add("--screen", options.screen, "FILE",
      "calibrated screen: a TOML file of foci or a PsychoPy monitor");
  add("--gaze-map", options.gaze_map, "FILE",
      "gaze map of `foci calibrate gaze`, for the recording or the webcam");
  add("--camera", options.camera, "FILE", "camera of `foci calibrate camera`");
  add("--size", options.size, "WxH", "size of the frames, px, e.g. 1280x720");
  add("--pupil", options.pupil, "MM",
      "pupil diameter in millimetres, or its source: recording or luminance");
  add("--method", options.method, "NAME", "depth-of-field method; `foci methods` lists them");
  add("--device", options.device, "auto|gpu|cpu", "render on a GPU or the CPU");
  add("--view", options.view, "mono|side-by-side|top-bottom|anaglyph|left|right",
      "one eye in the middle, both eyes, or one of them");
  addOption(command, "--set", options.set, "KEY=VALUE",
            "set any key of the study, e.g. --set focus.fixed_D=2; may be repeated")
      ->allow_extra_args(false);
  addOption(command, "--threads", options.threads, "N",
            "max number of threads; the frames do not depend on it");
  command.add_flag("--no-cache", options.no_cache,
                   "sample meshes and scans anew; the frames are the same");
  command.add_flag("--json", options.json, "print the summary as JSON");
}

void addMarkerOptions(CLI::App& command, StudyRequest& options) {
  command.add_flag("--marker", options.marker, "mark where the observer looks");
  command.add_flag("--split", options.split, "left half sharp, right half as the eye sees it");
}

void saveStudy(const StudyRequest& options, const StudyAsked& asked, const OutputGuard& guard) {
  if (options.write_study.empty()) return;
  writeOutput(options.write_study, writtenStudy(options.write_study, asked.study, asked.framing),
              guard);
}

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
