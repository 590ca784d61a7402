#include "app/render_picture.h"

#include "app/base/input_error.h"
#include "app/inputs.h"
#include "app/observer_pupil.h"
#include "gaze/focus/line_of_sight.h"
#include "render/image/image_file.h"
#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/surface_query.h"

namespace foci {

PictureSummary renderPicture(const Study& study, const PictureRequest& request) {
  checkImageExtension(request.out);
  if (request.depth && request.depth->extension() != ".pfm") {
    throw InputError("--depth " + request.depth->string(), "expected a name that ends in .pfm");
  }
  const SurfelCloud cloud = loadScene(study);
  const Screen screen = study.screenInForce();
  const glm::mat4 eye_from_world = EyePath(study).eyeFromWorldAt(0.0);
  const View view =
      viewThroughScreen(eye_from_world, study.pictureSize_px(), screen.size_m, screen.distance_m);

  PictureSummary summary;
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

  Frame frame;
  const auto method = makeMethod(study.render.method, cloud);
  RenderSettings settings{.defocus = {},
                          .background = glm::vec3(study.scene.background),
                          .shading = static_cast<float>(study.render.shading)};
  ObserverPupil pupil(study);
  if (pupil.needsPicture()) {
    method->render(view, settings, frame);
    pupil.show(0.0, frame);
  }
  summary.pupil_mm = pupil.at_mm(0.0);
  settings.defocus = defocusOfLens(summary.pupil_mm / 1000.0, view.focal_px, summary.focus_D,
                                   DistanceAlong::sight);
  settings.depth = request.depth.has_value();
  summary.stats = method->render(view, settings, frame);
  writeImage(request.out, frame, study.screen.gamma);
  if (request.depth) writeDepthPfm(*request.depth, frame);
  return summary;
}

}  // namespace foci
