#include "app/study/scene_study.h"

#include "app/platform/shell.h"
#include "app/study/study_text.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/scene_formats.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {
namespace {

/// Whether the file gives no more than a colour for each material. Textures and scans contain the
/// light of the place; such a colour does not.
bool isPlain(const SceneFacts& facts) { return !facts.has_colors; }

}  // namespace

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

std::string frameScene(Study& study, const SceneFacts& facts, const std::optional<Look>& look,
                       const std::optional<UpAxis>& up) {
  const Framing framing =
      framingOf(facts, {.screen = study.screenInForce(), .look = look, .up = up});
  frameScene(study, facts, framing);
  if (!isPlain(facts)) return framingText(framing);
  return framingText(framing) + (facts.material_colors ? "; plain colours" : "; one colour") +
         ": shaded by render.shading = " + exactText(kPlainShading);
}

void shadePlainScene(Study& study, const SceneFacts& facts) {
  if (isPlain(facts)) study.lighting.shading = static_cast<float>(kPlainShading);
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
