#include <algorithm>
#include <utility>

#include "app/platform/output_files.h"
#include "app/replay/replay.h"
#include "app/replay/run_writer.h"
#include "app/session/session.h"
#include "app/study/load_scene.h"
#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/image/image_file.h"
#include "render/methods/quality_level.h"

namespace foci {
namespace {

void checkRequest(const Study& study, const ImageRequest& request) {
  checkImageExtension(request.out);
  for (const auto& [option, map] :
       {std::pair("--depth ", &request.depth), std::pair("--defocus ", &request.defocus)}) {
    if (*map && (*map)->extension() != ".pfm" && (*map)->extension() != ".exr") {
      throw InputError(option + (*map)->string(), "expected a name that ends in .pfm or .exr");
    }
  }
  const StereoView view = study.output.view;
  const bool both =
      view != StereoView::mono && view != StereoView::left && view != StereoView::right;
  if ((request.depth || request.defocus) && both) {
    throw InputError(request.depth ? "--depth" : "--defocus",
                     "expected output.view = \"mono\", \"left\" or \"right\": one eye has one "
                     "distance");
  }
}

}  // namespace

ImageSummary renderImage(const Study& study, const ImageRequest& request,
                         std::optional<SceneFile> file) {
  checkRequest(study, request);
  Warnings warnings;
  const Scene scene = loadScene(study, warnings, std::move(file));
  SessionSettings settings = sessionSettingsOf(study);
  settings.quality.frame_ms.reset();
  if (request.focus_D) settings.focus.fixed_D = request.focus_D;
  constexpr double kRate_Hz = 1000.0;  // of no samples
  Session session(settings, scene, settings.screen, kRate_Hz, 0.0);
  addScreenDoubts(study, warnings);
  warnings.add(eyeRemark(study));
  if (const std::string device = session.deviceOf(settings.method);
      settings.device == RenderDevice::gpu || !device.starts_with("the CPU")) {
    say("renders on " + device);
  }
  const glm::dvec2 middle_px = 0.5 * glm::dvec2(settings.screen.size_px);
  std::optional<glm::dvec2> gaze_px = request.gaze_px;
  if (!gaze_px && !settings.focus.fixed_D) gaze_px = session.middleSurface_px(0.0);
  // Sparse points and faint Gaussians fill the cone nowhere: less of a wider one is enough.
  constexpr double kLeastCoverage = 0.002, kWide_deg = 2.0;
  const bool sparse = !gaze_px;
  while (!gaze_px && !settings.focus.fixed_D && settings.focus.coverage > kLeastCoverage) {
    settings.focus.coverage *= 0.25;
    settings.focus.cone_deg = std::max(settings.focus.cone_deg, kWide_deg);
    session.changeSettings(settings);
    gaze_px = session.middleSurface_px(0.0);
  }
  if (sparse && gaze_px) {  // the front of what is there
    settings.focus.coverage *= 0.25;
    session.changeSettings(settings);
  }
  if (!request.gaze_px && gaze_px && *gaze_px != middle_px) {
    say("nothing is in the middle: the eye looks at the nearest surface around it, at " +
        decimal(gaze_px->x, 0) + "," + decimal(gaze_px->y, 0) + " px");
  }
  FrameRecord record = session.lookSettled(0.0, gaze_px.value_or(middle_px));
  RenderRequest render_request = session.requestOf(settings.method, record);
  for (RenderRequest::Eye& eye : render_request.eyes) {
    eye.settings.depth = request.depth || request.defocus;
    eye.settings.quality.check = ErrorCheck::of_still;
  }
  // Before the time of the frame counts.
  if (choosesQuality(settings.method)) session.renderer().pass(render_request);
  const Frame& frame = session.render(render_request, record);
  if (record.stats.tolerance_met == false) {
    warnings.add("5 % of the pixels may err by more than quality.tolerance = " +
                 significant(settings.quality.tolerance, 2) +
                 " just-noticeable differences, by up to " +
                 decimal(*record.stats.tolerance_error, 1) +
                 ": method auto has no better quality level (docs/methods.md)");
  }
  warnings.add(session.deviceRemark());
  OutputFiles files(request.guard);
  using Path = std::filesystem::path;
  files.write(request.out, [&](const Path& to) { writeImage(to, frame, study.screen.gamma); });
  if (request.depth) {
    files.write(*request.depth,
                [&](const Path& to) { writeMap(to, frame.size_px, frame.depth_m); });
  }
  if (request.defocus) {
    files.write(*request.defocus, [&](const Path& to) {
      writeMap(to, frame.size_px, defocusMap_D(frame, record.eye.focus_D));
    });
  }
  files.commit();
  return {.focus_D = record.eye.focus_D,
          .surface_distance_m = record.eye.surface_distance_m,
          .pupil_mm = record.pupil_mm,
          .device = session.devices(),
          .stats = record.stats,
          .warnings = warnings.all()};
}

}  // namespace foci
