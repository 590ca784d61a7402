#include "app/replay/render_image.h"

#include <cstdio>

#include "app/session/observer_eye.h"
#include "app/session/observer_pupil.h"
#include "app/session/session.h"
#include "app/session/stereo.h"
#include "app/study/inputs.h"
#include "base/input_error.h"
#include "gaze/geometry/line_of_sight.h"
#include "render/image/image_file.h"
#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/surface_query.h"

namespace foci {

ImageSummary renderImage(const Study& study, const ImageRequest& request) {
  checkImageExtension(request.out);
  if (request.depth && request.depth->extension() != ".pfm") {
    throw InputError("--depth " + request.depth->string(), "expected a name that ends in .pfm");
  }
  if (request.depth && study.output.view != "mono") {
    throw InputError("--depth", "expected output.view = \"mono\": one eye has one distance");
  }
  const SurfelCloud cloud = loadScene(study);
  const Screen screen = study.screenInForce();
  const glm::mat4 eye_from_world = EyePath(study).eyeFromWorldAt(0.0);
  const View view =
      viewThroughScreen(eye_from_world, study.imageSize_px(), screen.size_m, screen.distance_m);

  ImageSummary summary;
  if (request.focus_D) {
    summary.focus_D = *request.focus_D;
  } else {
    const glm::dvec2 gaze_px = request.gaze_px.value_or(0.5 * glm::dvec2(screen.size_px));
    const glm::dmat4 world_from_eye = glm::inverse(glm::dmat4(eye_from_world));
    const glm::dvec3 direction = glm::dmat3(world_from_eye) * lineOfSight(screen, gaze_px);
    summary.surface_distance_m =
        SurfaceQuery(cloud).distance(glm::dvec3(world_from_eye[3]), glm::normalize(direction),
                                     glm::radians(study.focus.cone_deg), study.focus.coverage);
    summary.focus_D = summary.surface_distance_m ? 1.0 / *summary.surface_distance_m
                                                 : study.focus.accommodation.resting_D;
  }
  summary.focus_D = reachableFocus_D(accommodationOf(study), summary.focus_D);

  if (const std::string remark = ellipseText(study); !remark.empty()) {
    std::fprintf(stderr, "foci: %s\n", remark.c_str());
  }
  const StereoView stereo = stereoViewNamed(study.output.view);
  const auto method = makeMethod(study.render.method, cloud);
  Frame frame{.size_px = view.size_px, .rgba = {}, .depth_m = {}}, eye_frame;
  RenderSettings settings{.defocus = {},
                          .background = glm::vec3(study.scene.background),
                          .shading = static_cast<float>(study.render.shading),
                          .quality = requestedQuality(study)};
  settings.quality.frame_ms.reset();  // a still image has time
  ObserverPupil pupil(study);
  if (pupil.needsImage()) {
    method->render(view, settings, frame);
    pupil.show(0.0, frame);
  }
  summary.pupil_mm = pupil.at_mm(0.0);
  settings.depth = request.depth.has_value();
  frame.rgba.resize(static_cast<std::size_t>(view.size_px.x) * view.size_px.y);
  for (const EyeView& eye :
       eyeViews(stereo, view, study.observer.ipd_mm / 1000.0, screen.distance_m)) {
    settings.defocus = defocusOfEye(study, summary.pupil_mm, eye.view.focal_px, summary.focus_D);
    const bool mono = stereo == StereoView::mono;
    const RenderStats stats = method->render(eye.view, settings, mono ? frame : eye_frame);
    addView(stats, summary.stats);
    if (!mono) putEye(stereo, eye, eye_frame, frame);
  }
  writeImage(request.out, frame, study.screen.gamma);
  if (request.depth) writeDepthPfm(*request.depth, frame);
  return summary;
}

}  // namespace foci
