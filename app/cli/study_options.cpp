#include "app/cli/study_options.h"

#include "app/cli/option_values.h"
#include "app/platform/output_files.h"

namespace foci {

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

}  // namespace foci
