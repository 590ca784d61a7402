#include <tbb/global_control.h>

#include <cstdio>
#include <memory>
#include <utility>

#include "app/cli/commands.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "app/replay/replay.h"
#include "app/study/inputs.h"
#include "app/study/study_request.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

struct RenderOptions : StudyRequest {
  std::string out{}, focus{}, gaze{}, depth{}, defocus{};
  bool overwrite = false;
};

glm::dvec2 gazeOf_px(const std::string& gaze, const Screen& screen) {
  const glm::dvec2 point_px = pairOf("--gaze", gaze, ',', "X,Y in px of the study's screen");
  if (point_px.x < 0 || point_px.y < 0 || point_px.x > screen.size_px.x ||
      point_px.y > screen.size_px.y) {
    throw InputError("--gaze " + gaze, "expected a point on the study's screen, 0,0 to " +
                                           std::to_string(screen.size_px.x) + "," +
                                           std::to_string(screen.size_px.y));
  }
  return point_px;
}

std::string summaryJsonOf(const RenderOptions& options, const Study& study,
                          const ImageSummary& summary) {
  nlohmann::ordered_json json = {{"out", options.out},
                                 {"focus_D", summary.focus_D},
                                 {"surface_distance_m", summary.surface_distance_m},
                                 {"pupil_mm", summary.pupil_mm},
                                 {"method", study.render.method},
                                 {"device", summary.device},
                                 {"splats", summary.stats.splats},
                                 {"fragments", summary.stats.fragments},
                                 {"render_ms", summary.stats.ms},
                                 {"quality_level", nullptr},
                                 {"tolerance_error", summary.stats.tolerance_error},
                                 {"tolerance_met", summary.stats.tolerance_met},
                                 {"warnings", summary.warnings}};
  if (const auto& level = summary.stats.quality_level) json["quality_level"] = textOf(*level);
  return jsonText(json);
}

void runRender(const RenderOptions& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  threadsOf(options.threads));
  StudyAsked asked = studyOf(options);
  const Study& study = asked.study;
  const OutputGuard guard({options.out, options.depth, options.defocus, options.write_study},
                          inputFiles(study), options.overwrite);
  ImageRequest request{.out = options.out, .focus_D = {}, .gaze_px = {}, .guard = guard};
  if (!options.depth.empty()) request.depth = options.depth;
  if (!options.defocus.empty()) request.defocus = options.defocus;
  if (!options.focus.empty()) request.focus_D = vergenceOf_D("--focus", options.focus);
  if (!options.gaze.empty()) request.gaze_px = gazeOf_px(options.gaze, study.screenInForce());
  const ImageSummary summary = renderImage(study, request, std::move(asked.scene));
  saveStudy(options, asked, guard);
  if (options.json) {
    std::puts(summaryJsonOf(options, study, summary).c_str());
    return;
  }
  const auto& surface_m = summary.surface_distance_m;
  const std::string surface = request.focus_D ? ""
                              : surface_m ? ", on the surface " + decimal(*surface_m, 3) + " m away"
                                          : ", at rest: no surface under the gaze";
  std::printf("%s: focus %.3f D%s; pupil %.2f mm; %.1f ms\n", visible(options.out).c_str(),
              summary.focus_D, surface.c_str(), summary.pupil_mm, summary.stats.ms);
}

}  // namespace

void addRenderCommand(CLI::App& app) {
  const auto options = std::make_shared<RenderOptions>();
  CLI::App* command =
      app.add_subcommand("render",
                         "Render one image of a study or of any scene, at a given focus or gaze.\n"
                         "Example: foci render cow.obj --out cow.png");
  addStudyOptions(*command, *options);
  addOption(*command, "--out", options->out, "FILE", "image: .png (sRGB), .pfm or .exr (linear)")
      ->required();
  auto* focus =
      addOption(*command, "--focus", options->focus, "METRES", "focal distance, metres, or inf");
  addOption(*command, "--gaze", options->gaze, "X,Y",
            "point on the study's screen, px; the eye focuses on the surface there")
      ->excludes(focus);
  addOption(*command, "--depth", options->depth, "FILE",
            "also write the distance of each pixel, metres, as .pfm or .exr");
  addOption(*command, "--defocus", options->defocus, "FILE",
            "also write how much nearer than the focus each pixel is, D, as .pfm or .exr");
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [options] { runRender(*options); });
}

}  // namespace foci
