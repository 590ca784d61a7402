#include "render/methods/blur_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "render/optics/lens_field.h"

namespace foci {
namespace FOCI_FILE {

constexpr int kSize_px = 256;
constexpr float kDistance_m = 0.5f;  // 2 D
const View kView{.size_px = {kSize_px + 3, kSize_px - 5},
                 .focal_px = {1000.0f, 1000.0f},
                 .principal_px = {0.5f * kSize_px, 0.5f * kSize_px}};

/// A black image with one white pixel in the middle, all at one distance.
Frame point() {
  Frame frame{.size_px = {kSize_px + 3, kSize_px - 5}, .rgba = {}, .depth_m = {}};
  const std::size_t pixels = static_cast<std::size_t>(frame.size_px.x) * frame.size_px.y;
  frame.rgba.assign(pixels, glm::vec4(0.0f));
  frame.depth_m.assign(pixels, kDistance_m);
  frame
      .rgba[static_cast<std::size_t>(frame.size_px.y / 2) * frame.size_px.x + frame.size_px.x / 2] =
      glm::vec4(1.0f);
  return frame;
}

Frame blurred(const Frame& sharp, const Defocus& defocus) {
  BlurPyramid pyramid;
  pyramid.set(sharp, kView);
  Frame frame{.size_px = sharp.size_px, .rgba = {}, .depth_m = {}};
  frame.rgba.resize(sharp.rgba.size());
  pyramid.blur(defocus, frame);
  return frame;
}

Frame blurred(const Frame& sharp, float radius_px) {
  return blurred(sharp, {.radius_px_per_D = glm::vec2(radius_px), .focus_D = 1.0f});
}

/// Variance along x, and all light.
std::pair<double, double> spreadOf(const Frame& frame) {
  double light = 0.0, x = 0.0, xx = 0.0;
  for (int row = 0; row < frame.size_px.y; ++row) {
    for (int column = 0; column < frame.size_px.x; ++column) {
      const double each = frame.at(column, row).r;
      const double from = column - frame.size_px.x / 2;
      light += each;
      x += each * from;
      xx += each * from * from;
    }
  }
  return {xx / light - (x / light) * (x / light), light};
}
constexpr double kPlace = 0.12;  // where the point lies between a copy's samples counts

TEST(BlurPyramid, InFocusIsTheImageItself) { EXPECT_EQ(blurred(point(), 0.0f).rgba, point().rgba); }

TEST(BlurPyramid, AConstantStaysConstant) {
  Frame grey = point();
  for (glm::vec4& each : grey.rgba) each = glm::vec4(0.25f);
  for (const float radius_px : {0.7f, 3.0f, 20.0f, 200.0f}) {
    constexpr float kRounding = 1e-6f;
    for (const glm::vec4& each : blurred(grey, radius_px).rgba) {
      ASSERT_NEAR(each.r, 0.25f, kRounding) << radius_px;
    }
  }
}

TEST(BlurPyramid, APointKeepsItsLightAndGetsTheVarianceOfTheDisc) {
  for (const float radius_px : {2.0f, 2.6f, 5.0f, 9.0f, 16.0f, 25.0f}) {
    const auto [variance_px2, light] = spreadOf(blurred(point(), radius_px));
    EXPECT_NEAR(light, 1.0, kPlace) << radius_px;
    EXPECT_NEAR(variance_px2 / (0.25 * radius_px * radius_px), 1.0, kPlace) << radius_px;
  }
}

TEST(BlurPyramid, APointGetsTheMeanVarianceOfItsDirection) {
  Defocus defocus{.radius_px_per_D = glm::vec2(2.0f), .astigmatism_D = {0.4f, 0.3f}};
  for (const float beside_px : {-500.0f, 700.0f}) {
    for (const float focus_D : {1.0f, 4.0f}) {
      defocus.focus_D = focus_D;
      defocus.field = std::make_shared<const LensField>(
          typicalField(), false, kView, kView.principal_px + glm::vec2(beside_px, 0.0f), defocus);
      const glm::mat2 blur = defocus.field->at({0.0f, 0.0f}).blur_px(defocus, 1.0f / kDistance_m);
      const LocalLens lens = defocus.field->at({0.0f, 0.0f});
      const double expected = 0.125 * (glm::dot(blur[0], blur[0]) + glm::dot(blur[1], blur[1])) +
                              0.5 * (lens[LocalLens::kCxx] + lens[LocalLens::kCyy]);
      EXPECT_NEAR(spreadOf(blurred(point(), defocus)).first / expected, 1.0, kPlace)
          << beside_px << " px, " << focus_D << " D";
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
