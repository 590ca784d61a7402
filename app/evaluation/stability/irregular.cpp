// Scenes with irregular samples: uneven density, holes, copies, wrong normals, few points.
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "app/evaluation/stability/setups.h"
#include "render/scene/builtin/pattern.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/surfel_cloud.h"

namespace foci {
namespace stability {
namespace {

constexpr float kSpacing_m = 1.0f / kFocal_px;  // a pixel wide at 1 m

SurfelCloud estimated(PointCloud&& points) {
  return surfelsFromPoints(std::move(points), {.viewpoint_m = glm::vec3(0.0f)});
}

/// A white wall 1 m away, out of focus. Its points should cover it.
StabilitySetup wallOf(PointCloud&& points) {
  return {.view = view(),
          .cloud = estimated(std::move(points)),
          .settings = lens(6.0f, 0.0f),
          .truth =
              [](const View& seen, const RenderSettings&, int) {
                Frame frame{.size_px = seen.size_px, .rgba = {}, .depth_m = {}};
                frame.rgba.assign(static_cast<std::size_t>(seen.size_px.x) * seen.size_px.y,
                                  glm::vec4(1.0f));
                return frame;
              },
          .score = [](const Frame& frame) { return coverageErrorFrom(frame, 1.0f, 8); }};
}

/// The half-plane of `edgeSheets`, blurred, before a sheet in focus.
/// @param addNear  adds the surfels of the half-plane
template <class AddNear>
StabilitySetup edgeWith(const AddNear& addNear) {
  constexpr float kRadius_px = 8.0f;
  const std::vector<Sheet> sheets = edgeSheets(1.0f, 2.0f);
  StabilitySetup setup = sceneOf({sheets[0]}, lens(2.0f * kRadius_px, 0.5f));
  addNear(setup.cloud, sheets[1]);
  setup.truth = [sheets](const View& seen, const RenderSettings& settings, int samples) {
    return exactFrame(sheets, seen, settings, samples);
  };
  setup.score = [](const Frame& frame) { return edgeError(frame, kRadius_px, kRadius_px + 4.0); };
  return setup;
}

}  // namespace

StabilitySetup density(float ratio) {
  // Points per area fall by the factor `ratio` from the left to the right of the image.
  constexpr float kSide_m = 0.6f, kFinest_m = kSpacing_m;
  std::mt19937 random(5);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) / float{1 << 24}; };
  PointCloud points;
  for (float x = -0.5f * kSide_m; x < 0.5f * kSide_m;) {
    const float along = std::clamp(x / (kSize_px * kFinest_m) + 0.5f, 0.0f, 1.0f);
    const float step_m = kFinest_m * std::pow(ratio, 0.5f * along);
    for (float y = -0.5f * kSide_m; y < 0.5f * kSide_m; y += step_m) {
      const glm::vec2 jitter = 0.5f * step_m * glm::vec2(uniform() - 0.5f, uniform() - 0.5f);
      points.position_m.emplace_back(x + jitter.x, y + jitter.y, -1.0f);
      points.color.emplace_back(1.0f);
    }
    x += step_m;
  }
  return wallOf(std::move(points));
}

StabilitySetup patches(float width_px) {
  // Holes on a grid of 24 samples: at most a fifth of the wall is missing.
  constexpr int kSide = 180, kApart = 24;
  PointCloud points;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const glm::vec2 off(x % kApart - kApart / 2, y % kApart - kApart / 2);
      if (2.0f * glm::length(off) < width_px) continue;
      const glm::vec2 jitter(hash01(x, y, 1), hash01(x, y, 2));
      const glm::vec2 at = glm::vec2(x, y) - 0.5f * kSide + 0.25f * jitter;
      points.position_m.emplace_back(kSpacing_m * at.x, kSpacing_m * at.y, -1.0f);
      points.color.emplace_back(1.0f);
    }
  }
  return wallOf(std::move(points));
}

StabilitySetup duplicates(float copies) {
  return edgeWith([=](SurfelCloud& cloud, const Sheet& sheet) {
    SurfelCloud regular;
    addSurfels(regular, sheet);
    PointCloud points;
    for (std::size_t i = 0; i < regular.size(); ++i) {
      // Every third point has copies.
      const int times = i % 3 == 0 ? static_cast<int>(copies) : 1;
      points.position_m.insert(points.position_m.end(), static_cast<std::size_t>(times),
                               regular.position_m[i]);
    }
    points.color.assign(points.size(), glm::vec3(1.0f, 0.0f, 0.0f));
    const SurfelCloud near = estimated(std::move(points));
    for (std::size_t i = 0; i < near.size(); ++i) {
      cloud.position_m.push_back(near.position_m[i]);
      cloud.axis_u_m.push_back(near.axis_u_m[i]);
      cloud.axis_v_m.push_back(near.axis_v_m[i]);
      cloud.color.push_back(near.color[i]);
      cloud.area_m2.push_back(near.area_m2[i]);
    }
  });
}

StabilitySetup misledNormals(float angle_deg) {
  return edgeWith(
      [=](SurfelCloud& cloud, const Sheet& sheet) { addSurfels(cloud, sheet, angle_deg); });
}

}  // namespace stability

namespace {

/// The scan with a share of its points, chosen by a hash of their index.
SurfelCloud thinned(const SurfelCloud& cloud, float share) {
  PointCloud points;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (hash01(static_cast<int>(i), 0, 5) >= share) continue;
    points.position_m.push_back(cloud.position_m[i]);
    points.color.push_back(cloud.color[i]);
  }
  return stability::estimated(std::move(points));
}

StabilitySetup thinnedSetup(const std::shared_ptr<const SceneInView>& seen, float share) {
  constexpr double kBlur_px = 8.0;
  const double aperture_m = kBlur_px / seen->largestBlurThrough_px(1.0);
  const SurfelCloud& scan = *seen->scene.surfels();
  StabilitySetup setup{.view = seen->view,
                       .cloud = share < 1.0f ? thinned(scan, share) : scan,
                       .settings = seen->settingsThrough(aperture_m)};
  setup.truth = [seen](const View& view, const RenderSettings& settings, int samples) {
    Frame frame;
    makeMethod("accumulate:" + std::to_string(samples), seen->scene)->render(view, settings, frame);
    return frame;
  };
  return setup;
}

}  // namespace

StabilityScene thinnedScan(const ScanView& scan) {
  constexpr int kImage_px = 256;
  // Read now, so that a bad scan is reported at once.
  const auto seen = std::make_shared<const SceneInView>(surfacesInView(scan, kImage_px));
  return {.name = "thinned",
          .what = "a scan with a part of its points, blur radius up to 8 px",
          .dial = "share of the points",
          .score = "PSNR against the whole scan, dB",
          .high_is_good = true,
          .good = 30.0,
          .values = {1.0f, 0.5f, 0.25f, 0.1f},
          .setup = [seen](float share) { return thinnedSetup(seen, share); },
          .input = scanKey(scan),
          .warnings = seen->warnings};
}

}  // namespace foci
