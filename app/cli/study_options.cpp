#include "app/cli/study_options.h"

#include <CLI/CLI.hpp>
#include <vector>

#include "app/cli/option_values.h"
#include "app/study/inputs.h"
#include "base/input_error.h"
#include "gaze/sources/line_reader.h"

namespace foci {
namespace {

std::vector<double> listOf(const glm::dvec2& pair) { return {pair.x, pair.y}; }

/// --pupil takes a diameter, or the name of the pupil's source.
void overridePupil(Study& study, const std::string& pupil) {
  if (pupil.empty()) return;
  const auto pupil_mm = parseNumber(pupil);
  const bool named = pupil == "recording" || pupil == "luminance";
  if (!pupil_mm && !named) {
    throw InputError("--pupil " + pupil, "expected millimetres, e.g. 4, or recording or luminance");
  }
  overrideKey(study, "observer.pupil", named ? pupil : "fixed", "--pupil");
  if (pupil_mm) overrideKey(study, "observer.pupil_mm", *pupil_mm, "--pupil " + pupil);
}

}  // namespace

void addStudyOptions(CLI::App& command, StudyOptions& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    return command.add_option(name, value, help)->type_name(type);
  };
  add("STUDY", options.study, "FILE", "study file (TOML)")->required();
  add("--scene", options.scene, "FILE",
      "points (PLY), mesh or prepared scene instead of the study's scene");
  add("--screen", options.screen, "FILE",
      "calibrated screen: a TOML file of foci or a PsychoPy monitor");
  add("--gaze-map", options.gaze_map, "FILE",
      "gaze map of `foci calibrate gaze`, for the recording or the webcam");
  add("--camera", options.camera, "FILE", "camera of `foci calibrate camera`");
  add("--size", options.size, "WxH", "size of the frames, px, e.g. 1280x720");
  add("--pupil", options.pupil, "MM",
      "pupil diameter in millimetres, or its source: recording or luminance");
  add("--method", options.method, "NAME", "depth-of-field method; `foci methods` lists them");
  add("--view", options.view, "NAME", "mono, side-by-side, top-bottom or anaglyph");
  addThreadsOption(command, options.threads,
                   "max number of threads; the frames do not depend on it");
  command.add_flag("--json", options.json, "print the summary as JSON");
}

void addMarkerOptions(CLI::App& command, StudyOptions& options) {
  command.add_flag("--marker", options.marker, "mark where the observer looks");
  command.add_flag("--split", options.split, "left half sharp, right half as the eye sees it");
}

Study studyOf(const StudyOptions& options) {
  Study study = readStudy(options.study);
  const auto override = [&](const char* key, const std::string& value, const std::string& where) {
    if (!value.empty()) overrideKey(study, key, value, where);
  };
  override("scene.file", options.scene, "--scene");
  override("gaze.source", options.trace, "--trace");
  override("screen.monitor", options.screen, "--screen");
  override("gaze.map", options.gaze_map, "--gaze-map");
  override("gaze.camera", options.camera, "--camera");
  override("render.method", options.method, "--method " + options.method);
  if (!options.size.empty()) {
    overrideKey(study, "output.size_px",
                listOf(pairOf("--size", options.size, 'x', "WIDTHxHEIGHT, e.g. 1280x720")),
                "--size " + options.size);
  }
  if (!options.seconds.empty()) {
    overrideKey(study, "output.seconds",
                listOf(pairOf("--seconds", options.seconds, ':', "FROM:TO in seconds, e.g. 2:8.5")),
                "--seconds " + options.seconds);
  }
  overridePupil(study, options.pupil);
  override("output.view", options.view, "--view");
  if (options.marker) study.output.marker = true;
  if (options.split) study.output.split = true;
  checkStudy(study);
  return study;
}

}  // namespace foci
