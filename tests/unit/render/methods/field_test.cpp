// A point of light beside the line of sight: its rendered image against rays through the wavefront
// of its direction. Rays have the second moments of Fourier optics, but for diffraction.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "render/methods/method.h"
#include "render/optics/lens_field.h"
#include "tests/unit/render/gaussian_scenes.h"
#include "tests/unit/render/method_scenes.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kPupil_m = 4e-3;
constexpr float kFocal_px = 2000.0f;
constexpr int kSize_px = 129;
constexpr double kVarianceTolerance = 0.05;  // the goal of docs/results.md

/// A direction in image axes (x right, y down, z forward).
glm::dvec3 directionAt(const glm::dvec2& deg) {
  const double angle_rad = glm::radians(glm::length(deg));
  const glm::dvec2 along = angle_rad > 0.0 ? glm::normalize(deg) : glm::dvec2(1.0, 0.0);
  return {std::sin(angle_rad) * along, std::cos(angle_rad)};
}

/// A view about the direction, as a part of a large image that the eye faces.
/// @param shift_px  of the point from the middle
View viewAround(const glm::dvec3& to, const glm::vec2& shift_px) {
  const glm::vec2 at_px = kFocal_px * glm::vec2(to) / static_cast<float>(to.z);
  return {.size_px = {kSize_px, kSize_px},
          .focal_px = glm::vec2(kFocal_px),
          .principal_px = glm::vec2(0.5f * kSize_px) + shift_px - at_px};
}

/// A tiny surfel that faces the eye, 1 / `point_D` metres away.
SurfelCloud lightAt(const glm::dvec3& to, double point_D) {
  const glm::vec3 p_eye = glm::vec3(to.x, -to.y, -to.z) / static_cast<float>(point_D);
  SurfelCloud cloud;
  appendSurfel(cloud, p_eye, -glm::normalize(p_eye), 3e-5f, 4e-9f, glm::vec3(1.0f));
  return cloud;
}

RenderSettings eyeFor(const View& view, double focus_D) {
  RenderSettings settings;
  settings.defocus = defocusOfLens(kPupil_m, view.focal_px, focus_D, DistanceAlong::sight);
  settings.defocus.field = std::make_shared<const LensField>(typicalField(), false, view,
                                                             view.principal_px, settings.defocus);
  settings.pupil.diameter_m = kPupil_m;
  return settings;
}

/// Variance on the image of the rays through the pupil, by the Zernike coefficients of the
/// direction (`PupilWavefront`) and exact projection of turned rays.
Moments raysOf(const glm::dvec2& deg, double off_D) {
  const LocalAberration local = typicalField().at(deg, false);
  Wavefront w{.zernike_um = std::vector<double>(9), .pupil_m = kPupil_m};
  w.zernike_um[7] = -local.coma_um.y;
  w.zernike_um[8] = -local.coma_um.x;
  const PupilWavefront wavefront(withPower(w, local.power_D));
  const glm::dmat2 shape = pupilShape(deg, false);
  // The gaze's right and down, turned with the eye's view to the direction.
  const glm::dvec3 to = directionAt(deg);
  glm::dvec3 right(1.0, 0.0, 0.0), down(0.0, 1.0, 0.0);
  if (to.z < 1.0) {
    const glm::dvec3 axis = glm::normalize(glm::cross(glm::dvec3(0.0, 0.0, 1.0), to));
    const double angle_rad = std::acos(to.z);
    const auto turned = [&](const glm::dvec3& v) {  // Rodrigues
      return v * std::cos(angle_rad) + glm::cross(axis, v) * std::sin(angle_rad) +
             axis * glm::dot(axis, v) * (1.0 - std::cos(angle_rad));
    };
    right = turned(right);
    down = turned(down);
  }
  Moments moments;
  glm::dvec2 sum(0.0), squares(0.0);
  constexpr int kRays = 4000;
  for (int i = 0; i < kRays; ++i) {
    const double radius = std::sqrt((i + 0.5) / kRays), turn = i * 2.399963229728653;
    const glm::dvec2 p = shape * (radius * glm::dvec2(std::cos(turn), std::sin(turn)));
    const glm::dvec2 slope = 0.5 * kPupil_m * off_D * p + wavefront.at(p).slope;
    const glm::dvec3 ray = to + slope.x * right + slope.y * down;
    const glm::dvec2 at_px = double{kFocal_px} * glm::dvec2(ray) / ray.z;
    sum += at_px / double{kRays};
    squares += (at_px - double{kFocal_px} * glm::dvec2(to) / to.z) *
               (at_px - double{kFocal_px} * glm::dvec2(to) / to.z) / double{kRays};
  }
  const glm::dvec2 mean = sum - double{kFocal_px} * glm::dvec2(to) / to.z;
  return {1.0, squares.x - mean.x * mean.x, squares.y - mean.y * mean.y};
}

/// Mean over places of the point among the samples, which are up to 8 px apart.
Moments seenAt(const std::string& method, const glm::dvec3& to, const auto& light, double focus_D) {
  Moments mean;
  for (const glm::vec2& shift_px : {glm::vec2(0.0f), {2.3f, 5.1f}, {5.1f, 0.7f}, {3.7f, 3.4f}}) {
    const View view = viewAround(to, shift_px);
    const Moments m = momentsOf(render(method, light, view, eyeFor(view, focus_D)));
    mean.variance_x_px2 += 0.25 * m.variance_x_px2;
    mean.variance_y_px2 += 0.25 * m.variance_y_px2;
  }
  return mean;
}

/// `got` is the image of a point in that direction; `point` is the same without blur.
void expectSpreadOfRays(const Moments& got, const Moments& point, const glm::dvec2& deg,
                        double off_D) {
  const Moments rays = raysOf(deg, off_D);
  const std::string where =
      std::to_string(deg.x) + "," + std::to_string(deg.y) + " deg, " + std::to_string(off_D) + " D";
  const double x = rays.variance_x_px2 + point.variance_x_px2;
  const double y = rays.variance_y_px2 + point.variance_y_px2;
  EXPECT_NEAR(got.variance_x_px2 / x, 1.0, kVarianceTolerance) << where;
  EXPECT_NEAR(got.variance_y_px2 / y, 1.0, kVarianceTolerance) << where;
}

class FieldOfView : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ByMethod, FieldOfView,
                         testing::Values("sweep", "sweep:7", "sweep:19", "sweep-lod"),
                         [](const auto& spec) {
                           std::string name = spec.param;
                           std::erase_if(name, [](char c) { return c == ':' || c == '-'; });
                           return name;
                         });

TEST_P(FieldOfView, SpreadsLightAsTheRaysDo) {
  for (const int field_deg : {0, 10, 20, 30, 40}) {
    double off_D = 0.0;  // in focus at gaze, and 1 D nearer, by turns
    for (const glm::dvec2 along : {glm::dvec2(1, 0), {0, -1}, {-1, 0}, {0, 1}}) {
      const glm::dvec2 deg = static_cast<double>(field_deg) * along;
      const glm::dvec3 to = directionAt(deg);
      const double point_D = 1.0;
      const SurfelCloud light = lightAt(to, point_D);
      const View view = viewAround(to, glm::vec2(0.0f));
      RenderSettings sharp = eyeFor(view, point_D);
      sharp.defocus.radius_px_per_D = glm::vec2(0.0f);
      const Moments point = momentsOf(render("sweep", light, view, sharp));
      const Moments got = seenAt(GetParam(), to, light, point_D + off_D);
      expectSpreadOfRays(got, point, deg, off_D);
      off_D = -1.0 - off_D;
    }
  }
}

TEST(FieldOfGaussians, SpreadsTheLightOfAGaussianAsTheRaysDo) {
  for (const int field_deg : {0, 20, 40}) {
    double off_D = 0.0;
    for (const glm::dvec2 along : {glm::dvec2(1, 0), {0, -1}, {-1, 0}, {0, 1}}) {
      const glm::dvec2 deg = static_cast<double>(field_deg) * along;
      const glm::dvec3 to = directionAt(deg);
      GaussianCloud cloud;
      // Dark, so that linear light is in proportion to display values.
      addGaussian(cloud, glm::vec3(to.x, -to.y, -to.z), glm::vec3(1e-3f), 0.99f, glm::vec3(0.03f));
      const GaussianCloud& light = cloud;
      const View view = viewAround(to, glm::vec2(0.0f));
      RenderSettings settings = eyeFor(view, 1.0 + off_D);
      const Moments got = momentsOf(render("sweep:19", light, view, settings));
      settings.defocus.radius_px_per_D = glm::vec2(0.0f);
      expectSpreadOfRays(got, momentsOf(render("sweep", light, view, settings)), deg, off_D);
      off_D = -1.0 - off_D;
    }
  }
}

TEST(AutoBesideTheGaze, PredictsItsError) {
  SurfelCloud cloud;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> grey(0.0f, 1.0f);
  constexpr int kSurfels = 48;
  for (int i = 0; i < kSurfels * kSurfels; ++i) {
    const glm::vec2 at = 0.8f / kSurfels * (glm::vec2(i % kSurfels, i / kSurfels) + 0.5f) - 0.4f;
    appendSurfel(cloud, {at, -1.0f}, {0.0f, 0.0f, 1.0f}, kSigmaPerSpacing * 0.8f / kSurfels,
                 0.64f / (kSurfels * kSurfels), glm::vec3(grey(random)));
  }
  const View view = squareView(64, 90.0f);
  RenderSettings settings;
  settings.defocus = defocusOfLens(30e-3, view.focal_px, 1.0, DistanceAlong::sight);
  settings.defocus.field = std::make_shared<const LensField>(
      typicalField(), false, view, view.principal_px + glm::vec2(50.0f, 0.0f), settings.defocus);
  settings.pupil.diameter_m = 30e-3;
  settings.quality.check = ErrorCheck::at_once;
  const Frame truth = render("accumulate:256", cloud, view, settings);
  for (const float tolerance : {1.0f, 0.5f}) {
    settings.quality.tolerance = tolerance;
    Frame frame;
    const RenderStats stats = makeMethod("auto", cloud)->render(view, settings, frame);
    EXPECT_LE(visibleErrorOf(frame, truth), stats.tolerance_error.value_or(0.0)) << tolerance;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
