#include "render/optics/view.h"

#include <gtest/gtest.h>

namespace foci {
namespace FOCI_FILE {

constexpr float kFloat = 1e-3f;  // pixels, at a thousand pixels

TEST(View, ThroughScreenMakesFrustumAndScreenAgree) {
  // A point on the screen's own corner falls on the image's corner.
  const View view = viewThroughScreen(glm::mat4(1.0f), {1280, 720}, {0.5, 0.28}, 0.6);
  const glm::vec2 corner = project(view, {0.25f, 0.14f, -0.6f});
  EXPECT_NEAR(corner.x, 1280.0f, kFloat);
  EXPECT_NEAR(corner.y, 0.0f, kFloat);
  EXPECT_FLOAT_EQ(view.focal_px.x, static_cast<float>(0.6 * 1280 / 0.5));
}

TEST(View, DirectionThroughInvertsProject) {
  const View view = viewThroughScreen(glm::mat4(1.0f), {1024, 768}, {0.38, 0.30}, 0.67);
  for (const glm::dvec2 point :
       {glm::dvec2(0, 0), glm::dvec2(512, 384), glm::dvec2(1000.5, 20.25)}) {
    const glm::vec2 back = project(view, glm::vec3(3.0 * directionThrough(view, point)));
    EXPECT_NEAR(back.x, point.x, kFloat);
    EXPECT_NEAR(back.y, point.y, kFloat);
  }
}

TEST(View, EyeLooksAlongMinusZWithYUp) {
  const glm::mat4 eye_from_world = eyeFromWorld({1, 2, 3}, {1, 2, -7}, {0, 1, 0});
  const glm::vec4 p = eye_from_world * glm::vec4(1.5f, 2.25f, -7.0f, 1.0f);
  EXPECT_NEAR(p.x, 0.5f, kFloat);
  EXPECT_NEAR(p.y, 0.25f, kFloat);
  EXPECT_NEAR(p.z, -10.0f, kFloat);
}

TEST(View, OfCameraSpansItsFieldOfView) {
  const View view = viewOfCamera(glm::mat4(1.0f), {512, 256}, glm::radians(90.0));
  EXPECT_NEAR(project(view, {0.0f, 1.0f, -1.0f}).y, 0.0f, kFloat);
  EXPECT_NEAR(project(view, {0.0f, -1.0f, -1.0f}).y, 256.0f, kFloat);
}

}  // namespace FOCI_FILE
}  // namespace foci
