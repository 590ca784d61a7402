#include "render/methods/blur_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

constexpr int kSize_px = 256;
constexpr float kDistance_m = 0.5f;  // 2 D

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

Frame blurred(const Frame& sharp, float radius_px) {
  BlurPyramid pyramid;
  pyramid.set(sharp, glm::vec2(1000.0f));
  Frame frame{.size_px = sharp.size_px, .rgba = {}, .depth_m = {}};
  frame.rgba.resize(sharp.rgba.size());
  pyramid.blur({.radius_px_per_D = glm::vec2(radius_px), .focus_D = 1.0f}, frame);
  return frame;
}

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
    const Frame frame = blurred(point(), radius_px);
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
    const double variance_px2 = xx / light - (x / light) * (x / light);
    constexpr double kPlace = 0.12;  // where the point lies between a copy's samples counts
    EXPECT_NEAR(light, 1.0, kPlace) << radius_px;
    EXPECT_NEAR(variance_px2 / (0.25 * radius_px * radius_px), 1.0, kPlace) << radius_px;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
