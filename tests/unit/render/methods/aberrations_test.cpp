// A point of light through an eye with aberrations: what the parts of the lens render, against the
// rays of thousands of lens points, and its signs.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "app/evaluation/chart/chart.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"
#include "render/optics/colours.h"
#include "tests/unit/render/gaussian_scenes.h"
#include "tests/unit/render/method_scenes.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kFocal_px = 3438.0f;  // 60 px for each degree
constexpr int kSize_px = 129;

SurfelCloud light() {
  SurfelCloud cloud;
  appendSurfel(cloud, {0.0f, 0.0f, -1.0f}, {0.0f, 0.0f, 1.0f}, 3e-5f, 4e-9f, glm::vec3(1.0f));
  return cloud;
}

/// The typical eye, or one with a single term, focused `focus_D` nearer than the light.
RenderSettings eye(double pupil_m, double focus_D, std::vector<double> zernike_um) {
  RenderSettings settings;
  settings.defocus =
      defocusOfLens(pupil_m, glm::vec2(kFocal_px), 1.0 + focus_D, DistanceAlong::axis);
  settings.pupil.diameter_m = pupil_m;
  settings.pupil.wavefront =
      withoutRefraction(rescaled({.zernike_um = std::move(zernike_um), .pupil_m = 6e-3}, pupil_m));
  return settings;
}

const std::vector<double> kTypical{0, 0, 0, 0, 0, 0, -0.11, 0.14, 0.02, 0.01, 0, 0, 0.13, -0.03};

Frame seen(std::string_view method, const RenderSettings& settings) {
  return render(method, light(), squareView(kSize_px, kFocal_px), settings);
}

glm::dvec2 centreOf(const Frame& frame, int channel = 0) {
  glm::dvec2 sum(0.0);
  double mass = 0.0;
  for (int y = 0; y < frame.size_px.y; ++y) {
    for (int x = 0; x < frame.size_px.x; ++x) {
      const double at = frame.at(x, y)[channel];
      mass += at;
      sum += at * (glm::dvec2(x, y) + 0.5 - 0.5 * kSize_px);
    }
  }
  return sum / mass;
}

/// Root mean square of the difference over the peak, of the pixels that hold 1 % of it in either.
double rmsOfPeak(const Frame& a, const Frame& b) {
  double peak = 0.0, squares = 0.0;
  for (const glm::vec4& p : b.rgba) peak = std::max(peak, double{p.r});
  int count = 0;
  for (std::size_t p = 0; p < a.rgba.size(); ++p) {
    if (std::max(a.rgba[p].r, b.rgba[p].r) < 0.01 * peak) continue;
    const double off = (a.rgba[p].r - b.rgba[p].r) / peak;
    squares += off * off;
    ++count;
  }
  return std::sqrt(squares / count);
}

class Aberrations : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ByParts, Aberrations, testing::Values("sweep:19", "sweep-lod:19"),
                         [](const auto& spec) {
                           std::string name = spec.param;
                           std::erase_if(name, [](char c) { return c == ':' || c == '-'; });
                           return name;
                         });

TEST_P(Aberrations, SpreadLightAsTheRaysDo) {
  double light = 0.0;
  for (const double pupil_m : {3e-3, 6e-3}) {
    for (const double focus_D : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const RenderSettings settings = eye(pupil_m, focus_D, kTypical);
      const Frame rays = seen("accumulate:2000", settings), parts = seen(GetParam(), settings);
      const Moments expected = momentsOf(rays), got = momentsOf(parts);
      light += got.mass / expected.mass;
      const std::string where = std::to_string(pupil_m) + " m, " + std::to_string(focus_D) + " D";
      EXPECT_NEAR(got.mass / expected.mass, 1.0, 2e-3) << where;
      EXPECT_NEAR(got.variance_x_px2 / expected.variance_x_px2, 1.0, 0.03) << where;
      EXPECT_NEAR(got.variance_y_px2 / expected.variance_y_px2, 1.0, 0.03) << where;
      EXPECT_LT(rmsOfPeak(parts, rays), 0.04) << where;
    }
  }
  EXPECT_NEAR(light / 10.0, 1.0, 1e-3);  // single sums depend on where the pixels sample
}

TEST_P(Aberrations, ComaPointsWhereTheRimsRaysGo) {
  // Z_8 = sqrt(8) (3 r^2 - 2) x for somebody who faces the eye. Its slope has the mean sqrt(8) c /
  // R over the pupil: towards -x of the image where c is above 0;
  // Z_7 the same along y. Both axes of the image are opposite to those of somebody who faces the
  // eye.
  const double c_um = 0.3, mean_px = std::sqrt(8.0) * c_um * 1e-6 / 3e-3 * kFocal_px;
  std::vector<double> coma(9);
  coma[8] = c_um;
  EXPECT_NEAR(centreOf(seen(GetParam(), eye(6e-3, 0.0, coma))).x, -mean_px, 0.1);
  coma[8] = 0.0;
  coma[7] = c_um;
  EXPECT_NEAR(centreOf(seen(GetParam(), eye(6e-3, 0.0, coma))).y, -mean_px, 0.1);
}

TEST_P(Aberrations, TheBlurOfSphericalAberrationDependsOnTheSignOfDefocus) {
  std::vector<double> spherical(13);
  spherical[12] = 0.3;
  const Moments near = momentsOf(seen(GetParam(), eye(6e-3, 0.5, spherical)));
  const Moments far = momentsOf(seen(GetParam(), eye(6e-3, -0.5, spherical)));
  EXPECT_GT(near.variance_x_px2, 1.3 * far.variance_x_px2);
}

TEST(Pupil, ColoursShiftWithThePupilBesideTheAxis) {
  RenderSettings settings = eye(2e-3, 0.0, {});
  settings.colours = coloursOfPrimaries();
  settings.pupil.offset_m = {0.5e-3, -0.25e-3};
  const Frame frame = seen("sweep", settings);
  const glm::dvec2 apart = centreOf(frame, 2) - centreOf(frame, 1);
  const double difference_D = settings.colours[2].nearer_D - settings.colours[1].nearer_D;
  EXPECT_NEAR(apart.x, kFocal_px * difference_D * 0.5e-3, 0.02);
  EXPECT_NEAR(apart.y, -kFocal_px * difference_D * 0.25e-3, 0.02);
}

TEST(Pupil, DiffractionAddsItsVariance) {
  constexpr float kDiffraction_px = 0.8f;
  const float one_px = diffractionThroughPixel_px(kDiffraction_px);
  const DiffractionHalo halo = diffractionHalo(kDiffraction_px);
  double both_px2 = (1.0 - halo.inHalos()) * halo.core_px * halo.core_px;
  for (std::size_t i = 0; i < 2; ++i) {
    // Lines in all directions: half of their variance is along each axis.
    both_px2 += 0.5 * halo.halo_share[i] * halo.halo_px[i] * halo.halo_px[i];
  }
  for (const std::string method : {"sweep", "sweep:7", "sweep-lod", "accumulate:7", "auto"}) {
    RenderSettings settings = eye(2e-3, 0.0, {});
    const double without = momentsOf(seen(method, settings)).variance_x_px2;
    settings.pupil.diffraction_px = kDiffraction_px;
    const double expected = method == "sweep:7" ? both_px2 : one_px * one_px;
    EXPECT_NEAR(momentsOf(seen(method, settings)).variance_x_px2 - without, expected,
                0.05 * expected)
        << method;
  }
}

TEST(AberrationsOfGaussians, PartsShowWhatTheRaysShow) {
  GaussianCloud cloud;
  addWall(cloud, 2.0f, 0.06f, 40, 0.95f, {0.2f, 0.5f, 0.3f});
  addWall(cloud, 1.0f, 0.008f, 16, 0.95f, {0.9f, 0.8f, 0.3f});
  const GaussianCloud& scene = cloud;
  std::vector<double> strong = kTypical;
  for (double& um : strong) um *= 3.0;
  const RenderSettings settings = eye(6e-3, 0.5, strong);
  RenderSettings plain = settings;
  plain.pupil = {};
  const View view = squareView(kSize_px, kFocal_px);
  const Frame rays = render("accumulate:300", scene, view, settings);
  for (const char* method : {"sweep:19", "sweep-lod:19", "auto"}) {
    const double with_dB = psnr_dB(rays, render(method, scene, view, settings));
    EXPECT_GT(with_dB, 36.0) << method;
    EXPECT_GT(with_dB, 6.0 + psnr_dB(rays, render(method, scene, view, plain))) << method;
  }
}

TEST(AberrationsOfGaussians, DiffractionSpreadsTheImage) {
  GaussianCloud cloud;
  addWall(cloud, 1.0f, 0.0004f, 1, 0.9f, {0.9f, 0.8f, 0.3f});
  const GaussianCloud& scene = cloud;
  const View view = squareView(kSize_px, kFocal_px);
  for (const char* method : {"sweep", "sweep:7", "sweep-lod", "accumulate:7", "auto"}) {
    RenderSettings settings = eye(2e-3, 0.0, {});
    const Moments without = momentsOf(render(method, scene, view, settings));
    for (const float sigma_px : {0.4f, 2.0f}) {
      settings.pupil.diffraction_px = sigma_px;
      const double expected_px2 = std::pow(diffractionThroughPixel_px(sigma_px), 2);
      const Moments with = momentsOf(render(method, scene, view, settings));
      EXPECT_NEAR((with.variance_x_px2 - without.variance_x_px2) / expected_px2, 1.0, 0.01)
          << method;
      EXPECT_NEAR(with.mass / without.mass, 1.0, 1e-4) << method;
    }
  }
}

TEST(AberrationsOfGaussians, MethodsWithoutThemLeaveThemOut) {
  GaussianCloud cloud;
  addWall(cloud, 1.0f, 0.008f, 16, 0.95f, {0.9f, 0.8f, 0.3f});
  const GaussianCloud& scene = cloud;
  const View view = squareView(kSize_px, kFocal_px);
  RenderSettings settings = eye(6e-3, 0.5, kTypical);
  settings.pupil.diffraction_px = 1.0f;
  RenderSettings plain = settings;
  plain.pupil = {};
  for (const char* method : {"pinhole", "inflate"}) {
    EXPECT_EQ(render(method, scene, view, settings).rgba, render(method, scene, view, plain).rgba)
        << method;
  }
}

TEST(AutoOfAnEye, StaysWithinItsPrediction) {
  for (const ChartScene& scene : planChart({.size_px = 96}).scenes) {
    if (scene.id != "fence") continue;  // a small one
    const SceneInView in_view = scene.make();
    RenderSettings settings = in_view.settingsThrough(6e-3);
    settings.quality.check = ErrorCheck::of_still;  // else a table predicts the first frame
    const double focal_px = settings.defocus.radius_px_per_D.x / 3e-3;
    settings.pupil = eye(6e-3, 0.0, kTypical).pupil;
    // A blur of as many pixels as on a fine screen.
    for (double& um : settings.pupil.wavefront.zernike_um) um *= kFocal_px / focal_px;
    Frame frame, reference;
    const RenderStats stats =
        makeMethod("auto", in_view.scene)->render(in_view.view, settings, frame);
    makeMethod("accumulate:256", in_view.scene)->render(in_view.view, settings, reference);
    EXPECT_LE(visibleErrorOf(frame, reference), *stats.tolerance_error) << scene.id;
    EXPECT_NE(*stats.quality_level, QualityLevel::sharp) << scene.id;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
