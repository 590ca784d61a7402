#include "render/gl/frame_block.h"

#include <cmath>

#include "render/splat/bin.h"

namespace foci {

bool blurs(const GpuRequest& request) {
  const glm::vec2 radius = request.defocus.radius_px_per_D * request.aperture;
  return radius.x > 0.0f && radius.y > 0.0f;
}

bool mayBeCoarse(const GpuRequest& request) {
  return request.cut && (blurs(request) || request.cut->acuity.base_px > 1.0f ||
                         request.cut->acuity.per_px > 0.0f);
}

GpuFrameBlock viewBlockOf(const View& view, const Defocus& defocus, const Acuity& acuity) {
  const glm::mat3 rows = glm::transpose(glm::mat3(view.eye_from_world));
  const glm::vec3 eye = -rows * glm::vec3(view.eye_from_world[3]);
  const glm::vec2 j = defocus.astigmatism_D;
  GpuFrameBlock block;
  block.right = {rows[0], eye.x};
  block.up = {rows[1], eye.y};
  block.back = {rows[2], eye.z};
  block.focal_principal_px = {view.focal_px, view.principal_px};
  block.view_px = {view.principal_px, defocus.radius_px_per_D};
  block.focus = {defocus.focus_D, j, glm::length(j)};
  block.acuity = {acuity.gaze_px, acuity.base_px, acuity.per_px};
  block.cut.w = view.near_m;
  block.size = {view.size_px, 0, 0};
  block.cells = {(view.size_px + kTile - 1) / kTile, 0, 0};
  block.scene.z = defocus.along == DistanceAlong::axis;
  return block;
}

GpuFrameBlock frameBlockOf(const GpuRequest& request, const GpuScene& scene) {
  const View& view = request.view;
  const Defocus& defocus = request.defocus;
  const glm::vec2 radius = defocus.radius_px_per_D, j = defocus.astigmatism_D, lens = request.lens;
  // Astigmatism displaces all points alike, whatever their distance, for a given lens point.
  const glm::vec2 aside_px =
      radius * glm::vec2(j.x * lens.x + j.y * lens.y, j.y * lens.x - j.x * lens.y);
  const bool blurred = blurs(request), coarse = mayBeCoarse(request);
  const float oblong = radius.x > 0.0f && radius.y > 0.0f ? std::sqrt(radius.y / radius.x) : 1.0f;
  const CutSettings cut = request.cut.value_or(kFaithfulCut);
  const std::size_t number = request.sub_aperture_centres.size();

  GpuFrameBlock block =
      viewBlockOf(view, defocus, request.cut ? request.cut->acuity : request.acuity);
  block.focal_principal_px = {view.focal_px, view.principal_px + aside_px};
  block.blur_lens = {radius * request.aperture, radius * lens};
  if (!blurred) block.focus.w = 0.0f;
  block.cut = {cut.per_blur2, cut.per_pixel2, cut.per_acuity2, view.near_m};
  block.background_low_pass = {request.background, request.low_pass_px};
  block.meridian_oblong = {nearestMeridian(defocus), oblong, 1.0f / oblong};
  block.sub_aperture_shading = {number > 1 ? 1.0f / std::sqrt(static_cast<float>(number)) : 0.0f,
                                request.shading, static_cast<float>(number),
                                lensRadius_m(view, defocus)};
  block.size.z = coarse ? kApron * kMaxStep_px : 0;
  block.size.w = coarse;
  block.cells.z = blurred;
  block.cells.w = scene.isOriented();
  block.scene = {static_cast<int>(scene.surfelCount()), scene.levels(), block.scene.z,
                 scene.isTransparent()};
  block.cut_switches.x = cut.foreshortened;
  return block;
}

}  // namespace foci
