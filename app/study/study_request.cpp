#include "app/study/study_request.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "app/platform/shell.h"
#include "app/platform/warnings.h"
#include "app/study/study_text.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
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

/// Reads a file that is no scene. A recording in the study's place would read as broken TOML, so
/// its name decides. If the name does not say that the file is a study, the message covers both.
Study readStudyFile(const std::filesystem::path& file) {
  const std::string extension = lowerExtension(file);
  for (const char* of_recordings : {".csv", ".tsv", ".asc", ".xdf", ".gz", ".txt"}) {
    if (extension != of_recordings) continue;
    throw InputError(file.string(),
                     "is not a study: expected a study (TOML) or a scene; foci replay takes a "
                     "recording with --trace FILE, foci live with --source trace:FILE");
  }
  std::error_code ignored;
  if (extension == ".toml" || !std::filesystem::is_regular_file(file, ignored)) {
    return readStudy(file);
  }
  try {
    Study study = readStudy(file);
    std::ifstream in(file, std::ios::binary);
    const bool has_keys =
        std::find(std::istreambuf_iterator<char>(in), {}, '=') != std::istreambuf_iterator<char>();
    if (has_keys) return study;
  } catch (const InputError& error) {
    throw InputError(
        file.string(),
        std::string("is no scene that foci reads; as a study (TOML): ") + error.what());
  }
  throw InputError(file.string(),
                   "is no scene that foci reads, and a study (TOML) without a key: docs/scenes.md "
                   "lists the formats of scenes");
}

/// A scene of one colour, or of one for each material, is shaded, so that its shape shows. Textures
/// and scans contain the light of the place; such a colour does not.
void shadePlainScene(Study& study, const SceneFacts& facts) {
  if (!facts.has_colors) study.lighting.shading = static_cast<float>(kPlainShading);
}

/// For the study's screen.
/// @return what was chosen
std::string frameScene(Study& study, const SceneFacts& facts, const std::optional<Look>& look,
                       const std::optional<UpAxis>& up) {
  const Framing framing =
      framingOf(facts, {.screen = study.screenInForce(), .look = look, .up = up});
  frameScene(study, facts, framing);
  if (facts.has_colors) return framingText(framing);
  return framingText(framing) + (facts.material_colors ? "; plain colours" : "; one colour") +
         ": shaded by render.shading = " + exactText(kPlainShading);
}

/// The recording's head moves the eye, so there is nothing to frame.
std::string placeHead(Study& study, const SceneFacts& facts, const SpacePreview& head,
                      const StudyRequest& options) {
  if (!options.look.empty() || !options.up.empty()) {
    throw InputError(options.look.empty() ? "--up" : "--look",
                     "expected a recording without a head: this recording's head moves the eye");
  }
  shadePlainScene(study, facts);
  if (head.scene_scale_m) study.scene.scale_m = *head.scene_scale_m;
  return "the recording's head moves the eye; a unit of the scene is " +
         significant(study.scene.scale_m) + " m" +
         (head.scene_scale_m ? ", as the recording says" : " (scene.scale_m)");
}

}  // namespace

glm::dvec2 pairOf(const std::string& option, const std::string& text, char between,
                  const std::string& expected) {
  const std::size_t at = text.find(between);
  const auto first = parseNumber(std::string_view(text).substr(0, at));
  const auto second =
      at == std::string::npos ? std::nullopt : parseNumber(std::string_view(text).substr(at + 1));
  if (!first || !second) throw InputError(option + " " + text, "expected " + expected);
  return {*first, *second};
}

std::optional<Look> lookOf(const std::string& look) {
  constexpr std::array<std::pair<std::string_view, Look>, 4> kLooks = {
      {{"front", Look::front},
       {"left", Look::left},
       {"above", Look::above},
       {"outside", Look::outside}}};
  if (look.empty()) return std::nullopt;
  for (const auto& [name, value] : kLooks) {
    if (name == look) return value;
  }
  throw InputError("--look " + look, "expected front, left, above or outside");
}

std::optional<UpAxis> upOf(const std::string& up) {
  if (up.empty()) return std::nullopt;
  auto axis = upAxisNamed(up);
  if (!axis) throw InputError("--up " + up, "expected x, y or z, or -x, -y or -z");
  return axis;
}

StudyAsked studyOf(const StudyRequest& options) {
  const bool is_scene = isScene(options.study);
  const std::optional<Look> look = lookOf(options.look);
  const std::optional<UpAxis> up = upOf(options.up);
  if (!is_scene && !(options.look.empty() && options.up.empty())) {
    throw InputError(options.look.empty() ? "--up" : "--look",
                     "expected a scene instead of a study, which has eye.position_m");
  }
  if (is_scene && !options.scene.empty()) {
    throw InputError("--scene " + options.scene,
                     "expected a study, not the scene " + options.study + ", before it");
  }
  Study study = is_scene ? studyOfScene(options.study) : readStudyFile(options.study);
  const auto override = [&](const char* key, const std::string& value, const std::string& where) {
    if (!value.empty()) overrideKey(study, key, value, where);
  };
  override("scene.file", options.scene, "--scene");
  override("gaze.source", options.trace, "--trace");
  override("screen.monitor", options.screen, "--screen");
  override("gaze.map", options.gaze_map, "--gaze-map");
  override("gaze.camera", options.camera, "--camera");
  override("render.method", options.method, "--method " + options.method);
  override("render.device", options.device, "--device");
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
  if (options.no_cache) study.scene.cache = false;
  for (const std::string& assignment : options.set) setKeyByOption(study, assignment);
  std::string framing;
  std::optional<SceneFile> scene;
  if (is_scene) {
    scene = readScene(options.study);
    const SpacePreview head = study.gazeIsSimulated()
                                  ? SpacePreview{}
                                  : previewSpace(study.gaze.source, study.gaze.columns);
    framing = head.has_head ? placeHead(study, factsOf(*scene), head, options)
                            : frameScene(study, factsOf(*scene), look, up);
    say(options.study + ": " + framing +
        (options.write_study.empty() ? "; --write-study FILE saves this" : ""));
    // The place of the eye that the user sets replaces the chosen one.
    for (const std::string& assignment : options.set) setKeyByOption(study, assignment);
  }
  checkStudy(study);
  if (!options.write_study.empty())
    writtenStudy(options.write_study, study, framing);  // or refuses
  return {std::move(study), std::move(framing), std::move(scene)};
}

Study studyOfScene(const std::filesystem::path& scene) {
  if (const auto kind = recordingKindOf(scene)) {
    throw InputError(scene.string(), "is a recording (" + *kind +
                                         "): expected a scene or a study, and --trace " +
                                         shellWord(scene.string()));
  }
  Study study;
  study.file = sceneFileIn(scene);
  study.scene.file = study.file;
  return study;
}

void frameScene(Study& study, const SceneFacts& facts, const Framing& framing) {
  shadePlainScene(study, facts);
  study.scene.scale_m = framing.scale_m;
  study.eye.position_m = framing.position_m;
  study.eye.look_at_m = framing.look_at_m;
  study.eye.up = framing.up;
}

std::string writtenStudy(const std::filesystem::path& file, const Study& study,
                         const std::string& about) {
  const std::string scene =
      study.scene.file ? shown(study.scene.file->filename().string()) : "the built-in scene";
  const std::string comment = "A study of " + scene + ", written by foci.\n" + about +
                              (about.empty() ? "" : "\n") +
                              "Keys that are not here have their defaults: `foci keys` lists them.";
  return annotatedStudyToml(study, file.parent_path(), comment);
}

}  // namespace foci
