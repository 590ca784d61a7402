#include "app/reproduce_scenes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "app/base/input_error.h"
#include "app/tables.h"
#include "render/optics/defocus.h"
#include "render/scene/open_scene.h"
#include "render/scene/surface_query.h"

namespace foci {
namespace {

constexpr glm::ivec2 kSize_px{512, 512};

// The plane: found by a search over tilts of 45 to 60 degrees and distances of 1.5 and 2 sides.
// Its corners stay inside the picture, so that all of its surfels are drawn, and it is as large as
// makes the paper's own two apertures draw the paper's fragments (5.05, 17.1 and 197 million
// against 5.69, 17.6 and 197).
constexpr float kPlaneSide_m = 3.833f;
constexpr EyePose kPlanePose{{0.0f, 4.711f, 3.299f}, {0.0f, 0.0f, 0.341f}};
constexpr double kPlaneFov_rad = 0.782;
constexpr double kPlaneFocus_m = 5.742;  // its middle, along the axis
constexpr std::array<double, kApertures> kPlaneApertures_m{0.0, 0.5, 2.0};

constexpr double kStatueFov_rad = 0.56;
constexpr double kScanFov_rad = 0.6;
constexpr std::size_t kFewestInView = 1000;
constexpr double kFocusCone_rad = 0.00873;  // half a degree, as the eye's

constexpr double kFirstBlur_px =
    3.5;  // root mean square: what the paper's counts mean (formulas.md, 7)
constexpr double kFragmentsWithin = 0.005;
constexpr int kMostSteps = 12;

constexpr std::array<PaperRow, 5> kPaperPlane{{{0, "0", false, 5685, 262144, 0.76},
                                               {1, "0.5", true, 8521, 178696, 0.97},
                                               {2, "2", true, 7246, 54385, 0.75},
                                               {1, "0.5", false, 17630, 262144, 1.79},
                                               {2, "2", false, 196752, 262144, 20.2}}};
constexpr std::array<PaperRow, 5> kPaperLion{{{0, "0", false, 2266, 81458, 0.43},
                                              {1, "0.01", true, 4036, 53629, 0.56},
                                              {2, "0.04", true, 5318, 17271, 0.56},
                                              {1, "0.01", false, 7771, 81458, 0.91},
                                              {2, "0.04", false, 90219, 81458, 8.93}}};

View viewFrom(const EyePose& pose, double fov_rad) {
  return viewOfCamera(eyeFromWorld(pose.position_m, pose.target_m, pose.up), kSize_px, fov_rad);
}

RenderSettings settingsFor(double focus_m, const glm::vec3& background) {
  RenderSettings settings;
  settings.defocus.focus_D = static_cast<float>(1.0 / focus_m);
  settings.defocus.along = DistanceAlong::axis;  // a camera, as the paper's
  settings.background = background;
  return settings;
}

/// Distances along the axis of the surfels whose centres are on the picture.
std::vector<float> depthsInView(const SurfelCloud& cloud, const View& view) {
  std::vector<float> depths_m;
  for (const glm::vec3& p_world : cloud.position_m) {
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

/// What the middle of the view shows, else the point looked at. Along the sight and the axis, which
/// are one there.
double focusAt_m(const SurfelCloud& cloud, const EyePose& pose) {
  const glm::dvec3 sight = glm::dvec3(pose.target_m) - glm::dvec3(pose.position_m);
  const double to_target_m = glm::length(sight);
  return SurfaceQuery(cloud)
      .distance(glm::dvec3(pose.position_m), sight / to_target_m, kFocusCone_rad, 0.5)
      .value_or(to_target_m);
}

ReproduceScene lionScene(std::string name, SurfelCloud cloud, const EyePose& pose, double fov_rad) {
  const double focus_m = focusAt_m(cloud, pose);
  return {.name = std::move(name),
          .cloud = std::move(cloud),
          .view = viewFrom(pose, fov_rad),
          .settings = settingsFor(focus_m, {0.03f, 0.035f, 0.045f}),
          .apertures_m = {},
          .paper = kPaperLion,
          .paper_reference_s = 83.0};
}

}  // namespace

Defocus ReproduceScene::defocus(std::size_t aperture) const {
  return defocusOfLens(apertures_m[aperture], view.focal_px, settings.defocus.focus_D,
                       settings.defocus.along);
}

RenderSettings ReproduceScene::settingsAt(std::size_t aperture) const {
  RenderSettings all = settings;
  all.defocus = defocus(aperture);
  return all;
}

double ReproduceScene::largestBlur_px(std::size_t aperture) const {
  float most_px = 0.0f;
  const Defocus lens = defocus(aperture);
  for (const float depth_m : depthsInView(cloud, view)) {
    most_px = std::max(most_px, blurRadius_px(lens, 1.0f / depth_m).x);
  }
  return most_px;
}

ReproduceScene planeScene(int samples) {
  return {.name = "plane",
          .cloud = makePlane(samples, kPlaneSide_m),
          .view = viewFrom(kPlanePose, kPlaneFov_rad),
          .settings = settingsFor(kPlaneFocus_m, glm::vec3(0.2f)),
          .apertures_m = kPlaneApertures_m,
          .paper = kPaperPlane,
          .paper_reference_s = 147.0};
}

ReproduceScene statueScene() {
  return lionScene("statue", makeStatue(), statueEyePose(), kStatueFov_rad);
}

ReproduceScene scanScene(const ScanView& scan) {
  OpenedScene opened = openScene(scan.file, 1.0, scan.pose.position_m);
  ReproduceScene scene =
      lionScene(scan.file.stem().string(), std::move(opened.cloud), scan.pose, kScanFov_rad);
  if (scene.name == "plane") scene.name = "scanned plane";  // not the other one
  const std::size_t in_view = depthsInView(scene.cloud, scene.view).size();
  if (in_view < kFewestInView) {
    throw InputError(scan.file.string(),
                     std::to_string(in_view) + " points in view, expected at least " +
                         std::to_string(kFewestInView) + " (--eye, --look-at, --up)");
  }
  return scene;
}

void chooseApertures(ReproduceScene& scene, const std::function<void()>& on_frame) {
  const auto paper = makeMethod("paper", scene.cloud);
  Frame frame;
  const auto fragmentsAt = [&](std::size_t aperture) {
    const auto stats = paper->render(scene.view, scene.settingsAt(aperture), frame);
    on_frame();
    return static_cast<double>(stats.fragments);
  };
  const auto counted = [&](std::size_t aperture) {
    const auto row = std::find_if(scene.paper.begin(), scene.paper.end(), [&](const PaperRow& one) {
      return one.aperture == aperture && !one.lod;
    });
    return row->kfragments;
  };

  // The aperture that blurs the picture as the paper's small one did, as a start.
  double sum_D2 = 0.0;
  const std::vector<float> depths_m = depthsInView(scene.cloud, scene.view);
  for (const float depth_m : depths_m) {
    const double defocus_D = 1.0 / depth_m - scene.settings.defocus.focus_D;
    sum_D2 += defocus_D * defocus_D / static_cast<double>(depths_m.size());
  }
  double aperture_m = 2.0 * kFirstBlur_px / (scene.view.focal_px.x * std::sqrt(sum_D2));

  scene.apertures_m = {};
  const double sharp = fragmentsAt(0);
  for (const std::size_t aperture : {std::size_t{1}, std::size_t{2}}) {
    const double wanted = sharp * counted(aperture) / counted(0);
    for (int step = 0;; ++step) {
      scene.apertures_m[aperture] = aperture_m;
      const double fragments = std::isfinite(aperture_m) ? fragmentsAt(aperture) : 0.0;
      if (std::abs(fragments / wanted - 1.0) < kFragmentsWithin) break;
      if (step == kMostSteps || !(fragments > sharp)) {
        throw InputError(scene.name, "no aperture blurs it so that fragments grow " +
                                         decimal(counted(aperture) / counted(0), 1) + " times");
      }
      aperture_m *= std::sqrt((wanted - sharp) / (fragments - sharp));
    }
    aperture_m *= 4.0;  // as the paper's two
  }
}

}  // namespace foci
