#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "app/cli/commands.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "app/replay/replay.h"
#include "app/study/framing.h"
#include "app/study/inputs.h"
#include "app/study/study_request.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr glm::ivec2 kThumbnail_px(480, 270);

struct InfoOptions {
  std::string scene{}, thumbnail{}, look{}, up{};
  bool overwrite = false;
  bool json = false;
};

void runInfo(const InfoOptions& options) {
  Study study = studyOfScene(options.scene);
  const std::optional<Look> look = lookOf(options.look);
  const std::optional<UpAxis> up = upOf(options.up);
  if (!options.thumbnail.empty() && !options.thumbnail.ends_with(".png")) {
    throw InputError("--thumbnail " + options.thumbnail, "expected a name that ends in .png");
  }
  const OutputGuard guard({options.thumbnail}, inputFiles(study), options.overwrite);
  SceneFile scene = readScene(options.scene, kCheckAll_B);
  const SceneFacts facts = factsOf(scene);
  const Framing framing =
      framingOf(facts, {.screen = study.screenInForce(), .look = look, .up = up});
  if (!options.thumbnail.empty()) {
    frameScene(study, facts, framing);
    study.output.size_px = kThumbnail_px;
    renderImage(
        study,
        {.out = options.thumbnail, .depth = {}, .focus_D = {}, .gaze_px = {}, .guard = guard},
        std::move(scene));
  }
  if (options.json) {
    nlohmann::ordered_json json = sceneJson(facts, framing);
    if (!options.thumbnail.empty()) json["thumbnail"] = options.thumbnail;
    std::puts(jsonText(json).c_str());
    return;
  }
  std::fputs(sceneText(facts, framing).c_str(), stdout);
  if (!options.thumbnail.empty()) std::printf("thumbnail %s\n", visible(options.thumbnail).c_str());
}

}  // namespace

void addInfoCommand(CLI::App& app) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand("info",
                                         "Describe a scene file: bounds, units, counts and "
                                         "materials, and with --thumbnail an image.\n"
                                         "Example: foci info cow.obj --thumbnail cow.png");
  addOption(*command, "SCENE", options->scene, "FILE", "points, mesh, Gaussians or prepared scene")
      ->required();
  addOption(*command, "--thumbnail", options->thumbnail, "FILE.png",
            "also render the scene, 480x270 px");
  addOption(*command, "--look", options->look, "FROM", "look from front, left, above or outside");
  addOption(*command, "--up", options->up, "AXIS", "upward axis, x, y or z, or -x, -y or -z");
  command->add_flag("--json", options->json, "print the facts as JSON");
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [options] { runInfo(*options); });
}

}  // namespace foci
