#include "app/evaluation/scene_in_view.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "app/platform/sha256.h"
#include "app/platform/warnings.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/lod/surface_query.h"
#include "render/scene/io/open_scene.h"

namespace foci {
namespace {

// The plane: chosen by a search over tilts of 45 to 60 degrees and distances of 1.5 and 2 sides.
// The corners stay inside the image, so the renderer meets all surfels. The size is such that
// method `paper` renders the fragments of Table 1 of the paper at the paper's own apertures (tests:
// PlaneScene).
constexpr float kPlaneSide_m = 3.833f;
constexpr EyePose kPlanePose{{0.0f, 4.711f, 3.299f}, {0.0f, 0.0f, 0.341f}};
constexpr double kPlaneFov_rad = 0.782;
constexpr double kPlaneFocus_m = 5.742;  // the middle of the plane, along the axis

// Names that no scan may take.
constexpr const char* kBuiltIn[] = {"plane",  "gallery", "mask",  "fence",
                                    "garden", "ball",    "statue"};

// Fields of view, chosen by eye unless a comment says otherwise.
constexpr double kStatueFov_rad = 0.56;
constexpr double kScanFov_rad = 0.6;
constexpr double kGalleryFov_rad = 0.46;  // the gallery is sampled for this image height
constexpr double kFenceFov_rad = 0.5;
constexpr double kMaskFov_rad = 0.44;
constexpr double kGardenFov_rad = 0.5;
constexpr double kGardenFocus_m = 0.95;

constexpr std::size_t kMinInView = 1000;    // points; with fewer, no surface can be told
constexpr double kFocusCone_rad = 0.00873;  // half a degree, as for a gaze in app/study

View viewFrom(const EyePose& pose, const glm::ivec2& size_px, double fov_rad) {
  return viewOfCamera(eyeFromWorld(pose.position_m, pose.target_m, pose.up), size_px, fov_rad);
}

RenderSettings settingsFor(double focus_m, const glm::vec3& background) {
  RenderSettings settings;
  settings.defocus.focus_D = static_cast<float>(1.0 / focus_m);
  settings.defocus.along = DistanceAlong::axis;  // a camera, as in the paper
  settings.lighting.background = background;
  return settings;
}

/// Distance of the surface in the middle of the view, else of the point looked at. The line of
/// sight is the camera's axis there.
double focusAt_m(const Scene& scene, const EyePose& pose) {
  const glm::dvec3 sight = glm::dvec3(pose.target_m) - glm::dvec3(pose.position_m);
  const double to_target_m = glm::length(sight);
  return SurfaceQuery(scene)
      .distance(glm::dvec3(pose.position_m), sight / to_target_m, kFocusCone_rad, 0.5)
      .value_or(to_target_m);
}

SceneInView lionInView(std::string name, Scene scene, const EyePose& pose, int size_px,
                       double fov_rad) {
  const double focus_m = focusAt_m(scene, pose);
  return {.name = std::move(name),
          .scene = std::move(scene),
          .view = viewFrom(pose, glm::ivec2(size_px), fov_rad),
          .settings = settingsFor(focus_m, {0.03f, 0.035f, 0.045f})};
}

std::string poseText(const EyePose& pose) {
  std::string text;
  for (const glm::vec3& v : {pose.position_m, pose.target_m, pose.up}) {
    for (int i = 0; i < 3; ++i) text += decimal(v[i], 6) + " ";
  }
  return text;
}

}  // namespace

std::string scanKey(const ScanView& scan) {
  return sha256OfFile(scan.file) + " " + poseText(scan.pose);
}

Defocus SceneInView::defocusThrough(double aperture_m) const {
  return defocusOfLens(aperture_m, view.focal_px, settings.defocus.focus_D, settings.defocus.along);
}

RenderSettings SceneInView::settingsThrough(double aperture_m) const {
  RenderSettings all = settings;
  all.defocus = defocusThrough(aperture_m);
  return all;
}

std::vector<float> SceneInView::depthsInView_m() const {
  std::vector<float> depths_m;
  for (const glm::vec3& p_world : scene.position_m()) {
    const glm::vec3 p(view.eye_from_world * glm::vec4(p_world, 1.0f));
    if (!(-p.z >= view.near_m)) continue;
    const glm::vec2 at = project(view, p);
    if (at.x >= 0.0f && at.y >= 0.0f && at.x < static_cast<float>(view.size_px.x) &&
        at.y < static_cast<float>(view.size_px.y)) {
      depths_m.push_back(-p.z);
    }
  }
  return depths_m;
}

double SceneInView::largestBlurThrough_px(double aperture_m) const {
  float max_px = 0.0f;
  const Defocus lens = defocusThrough(aperture_m);
  for (const float depth_m : depthsInView_m()) {
    max_px = std::max(max_px, blurRadius_px(lens, 1.0f / depth_m).x);
  }
  return max_px;
}

SceneInView planeInView(int samples, int size_px) {
  return {.name = "plane",
          .scene = {makePlane(samples, kPlaneSide_m)},
          .view = viewFrom(kPlanePose, glm::ivec2(size_px), kPlaneFov_rad),
          .settings = settingsFor(kPlaneFocus_m, glm::vec3(0.2f))};
}

SceneInView statueInView(int size_px) {
  return lionInView("statue", {makeStatue()}, statueEyePose(), size_px, kStatueFov_rad);
}

bool holdsGaussians(const std::filesystem::path& file) {
  const SceneFile scene = readScene(file);
  const auto* const prepared = std::get_if<PreparedScene>(&scene.content);
  return std::holds_alternative<GaussianFile>(scene.content) ||
         (prepared != nullptr && prepared->scene.gaussians() != nullptr);
}

SceneInView surfacesInView(const ScanView& scan, int size_px) {
  SceneInView seen = scanInView(scan, size_px);
  if (!seen.scene.surfels()) {
    throw InputError(
        scan.file.string(),
        "holds Gaussians, and these measurements are of surfaces: expected points or a "
        "mesh (--scan)");
  }
  return seen;
}

SceneInView scanInView(const ScanView& scan, int size_px) {
  OpenedScene opened = openScene(scan.file, 1.0, scan.pose.position_m);
  Warnings warnings;
  warnings.addAll(scan.file.string(), opened.remarks);
  std::string name = scan.file.stem().string();
  if (std::find(std::begin(kBuiltIn), std::end(kBuiltIn), name) != std::end(kBuiltIn)) {
    name = "scanned " + name;
  }
  SceneInView scene =
      lionInView(std::move(name), std::move(opened.scene), scan.pose, size_px, kScanFov_rad);
  scene.warnings = warnings.all();
  const std::size_t in_view = scene.depthsInView_m().size();
  if (in_view < kMinInView) {
    throw InputError(scan.file.string(),
                     std::to_string(in_view) + " points in view, expected at least " +
                         std::to_string(kMinInView) + " (--eye, --look-at, --up)");
  }
  const double focus_m = 1.0 / double{scene.settings.defocus.focus_D};
  if (!(scene.largestBlurThrough_px(focus_m) > 1.0)) {
    throw InputError(scan.file.string(),
                     "all its points in view are in focus, so there is no blur to measure: look at "
                     "it from the side (--eye, --look-at)");
  }
  return scene;
}

SceneInView galleryInView(int width_px, float step_px) {
  const View view = viewFrom(galleryEyePose(), {width_px, width_px * 9 / 16}, kGalleryFov_rad);
  return {.name = "gallery",
          .scene = {makeGallery(step_px)},
          .view = view,
          .settings = settingsFor(galleryDepth_m(view, "knot"), {0.012f, 0.013f, 0.016f})};
}

View maskView(int size_px) {
  // A step nearer than the gallery's own eye pose, past the foreground.
  return viewFrom({{-0.02f, 1.35f, -0.38f}, {0.177f, 1.462f, -1.55f}}, glm::ivec2(size_px),
                  kMaskFov_rad);
}

SceneInView maskInView(int size_px, float step_px) {
  const View view = maskView(size_px);
  return {.name = "mask",
          .scene = {makeGallery(step_px)},
          .view = view,
          .settings = settingsFor(galleryDepth_m(view, "bust"), glm::vec3(0.0f))};
}

SceneInView fenceInView(int size_px) {
  const EyePose pose = fenceEyePose();
  return {.name = "fence",
          .scene = {makeFence()},
          .view = viewFrom(pose, glm::ivec2(size_px), kFenceFov_rad),
          .settings = settingsFor(glm::distance(pose.position_m, pose.target_m), glm::vec3(0.05f))};
}

SceneInView gardenInView(int width_px) {
  return {.name = "garden",
          .scene = {makeGarden()},
          .view = viewFrom(gardenEyePose(), {width_px, width_px * 9 / 16}, kGardenFov_rad),
          .settings = settingsFor(kGardenFocus_m, glm::vec3(0.05f))};
}

double galleryDepth_m(const View& view, const std::string& place) {
  const auto places = galleryPointsOfInterest();
  const auto found = std::ranges::find(places, place, &PointOfInterest::name);
  assert(found != places.end());
  return -(view.eye_from_world * glm::vec4(found->p_world, 1.0f)).z;
}

}  // namespace foci
