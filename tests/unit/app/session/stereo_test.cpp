#include "app/session/stereo.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

constexpr double kBetween_m = 0.064, kDistance_m = 0.6;
constexpr double kFloat_px = 1e-2;  // of floats around 1000 px

View middleView() {
  return viewThroughScreen(glm::mat4(1.0f), {800, 400}, {0.5, 0.25}, kDistance_m);
}

glm::dvec2 disparity_px(StereoView stereo, const glm::dvec3& p_middle) {
  const auto eyes = eyeViews(stereo, middleView(), kBetween_m, kDistance_m);
  return (projectForEye(eyes[1], p_middle) - glm::dvec2(eyes[1].corner_px)) -
         (projectForEye(eyes[0], p_middle) - glm::dvec2(eyes[0].corner_px));
}

TEST(Stereo, HasNoDisparityOnTheScreen) {
  for (const StereoView stereo :
       {StereoView::side_by_side, StereoView::top_bottom, StereoView::anaglyph}) {
    for (const glm::dvec2 at_m : {glm::dvec2(0.0), glm::dvec2(0.2, -0.1), glm::dvec2(-0.1, 0.12)}) {
      const glm::dvec2 disparity = disparity_px(stereo, {at_m, -kDistance_m});
      EXPECT_NEAR(disparity.x, 0.0, kFloat_px);
      EXPECT_NEAR(disparity.y, 0.0, kFloat_px);
    }
  }
}

TEST(Stereo, IsTheEyesDistanceApartAtInfinity) {
  const double between_px = kBetween_m * 800 / 0.5;
  EXPECT_NEAR(disparity_px(StereoView::anaglyph, {0, 0, -1e6}).x, between_px, kFloat_px);
  EXPECT_NEAR(disparity_px(StereoView::side_by_side, {0, 0, -1e6}).x, between_px / 2, kFloat_px);
  EXPECT_NEAR(disparity_px(StereoView::top_bottom, {0, 0, -1e6}).x, between_px, kFloat_px);
}

TEST(Stereo, CrossesBeforeTheScreen) {
  // Half way to the screen the lines of sight are as far apart on it as the eyes, the other way.
  EXPECT_NEAR(disparity_px(StereoView::anaglyph, {0, 0, -kDistance_m / 2}).x,
              -kBetween_m * 800 / 0.5, kFloat_px);
}

TEST(Stereo, EachEyeStandsAtItsOwnPlace) {
  const auto eyes = eyeViews(StereoView::top_bottom, middleView(), kBetween_m, kDistance_m);
  for (const int side : {0, 1}) {
    const glm::vec3 position = glm::inverse(eyes[side].view.eye_from_world)[3];
    EXPECT_NEAR(position.x, (side == 0 ? -0.5 : 0.5) * kBetween_m, 1e-7);
    EXPECT_EQ(eyes[side].view.size_px, glm::ivec2(800, 200));
    EXPECT_EQ(eyes[side].corner_px, glm::ivec2(0, 200 * side));
  }
}

TEST(Stereo, MonoIsTheViewItself) {
  const auto eyes = eyeViews(StereoView::mono, middleView(), kBetween_m, kDistance_m);
  ASSERT_EQ(eyes.size(), 1u);
  EXPECT_EQ(eyes[0].view.principal_px, middleView().principal_px);
  EXPECT_EQ(eyes[0].view.eye_from_world, glm::mat4(1.0f));
}

Frame ofColour(const glm::ivec2& size_px, const glm::vec4& colour) {
  Frame frame{.size_px = size_px, .rgba = {}, .depth_m = {}};
  frame.rgba.assign(static_cast<std::size_t>(size_px.x) * size_px.y, colour);
  return frame;
}

TEST(Stereo, PutsEachEyeWhereItBelongs) {
  const glm::vec4 left(0.1f, 0.2f, 0.3f, 1.0f), right(0.6f, 0.7f, 0.8f, 1.0f);
  const auto joined = [&](StereoView stereo) {
    Frame whole = ofColour({8, 4}, glm::vec4(0.0f));
    View middle = middleView();
    middle.size_px = whole.size_px;
    const auto eyes = eyeViews(stereo, middle, kBetween_m, kDistance_m);
    putEye(stereo, eyes[0], ofColour(eyes[0].view.size_px, left), whole);
    putEye(stereo, eyes[1], ofColour(eyes[1].view.size_px, right), whole);
    return whole;
  };
  const Frame beside = joined(StereoView::side_by_side);
  EXPECT_EQ(beside.at(3, 2), left);
  EXPECT_EQ(beside.at(4, 2), right);
  const Frame above = joined(StereoView::top_bottom);
  EXPECT_EQ(above.at(5, 1), left);
  EXPECT_EQ(above.at(5, 2), right);
  EXPECT_EQ(joined(StereoView::anaglyph).at(5, 2), glm::vec4(left.r, right.g, right.b, 1.0f));
}

const HeadsetEyes kDisplays{
    HeadsetEye{.position_m = {-0.5 * kBetween_m, 0.0, 0.0},
               .field = {.left_deg = 54.0, .right_deg = 40.0, .up_deg = 42.0, .down_deg = 53.0}},
    HeadsetEye{.position_m = {0.5 * kBetween_m, 0.0, 0.0},
               .field = {.left_deg = 40.0, .right_deg = 54.0, .up_deg = 42.0, .down_deg = 53.0}}};

/// Where an eye's view shows a direction.
glm::dvec2 shownAt_px(const EyeView& eye, double right_deg, double up_deg) {
  return project(eye.view,
                 {std::tan(glm::radians(right_deg)), std::tan(glm::radians(up_deg)), -1.0});
}

TEST(HeadsetViews, EndWhereEachEyesFieldDoes) {
  const auto eyes = headsetViews(StereoView::side_by_side, glm::mat4(1.0f), kDisplays, {1600, 700});
  ASSERT_EQ(eyes.size(), 2u);
  for (const int side : {0, 1}) {
    EXPECT_EQ(eyes[side].view.size_px, glm::ivec2(800, 700));
    EXPECT_EQ(eyes[side].corner_px, glm::ivec2(800 * side, 0));
    const double left_deg = side == 0 ? 54.0 : 40.0, right_deg = 94.0 - left_deg;
    EXPECT_NEAR(shownAt_px(eyes[side], -left_deg, 0.0).x, 0.0, kFloat_px);
    EXPECT_NEAR(shownAt_px(eyes[side], right_deg, 0.0).x, 800.0, kFloat_px);
    EXPECT_NEAR(shownAt_px(eyes[side], 0.0, 42.0).y, 0.0, kFloat_px);
    EXPECT_NEAR(shownAt_px(eyes[side], 0.0, -53.0).y, 700.0, kFloat_px);
  }
}

TEST(HeadsetViews, LookStraightAheadSideBySide) {
  // A point at infinity lies in the same direction for both; a near one is ipd / distance apart.
  const auto eyes = headsetViews(StereoView::top_bottom, glm::mat4(1.0f), kDisplays, {800, 1400});
  const auto tangentOf = [&](int side, double distance_m) {
    const EyeView& eye = eyes[side];
    const glm::dvec2 at_px =
        projectForEye(eye, {0.0, 0.0, -distance_m}) - glm::dvec2(eye.corner_px);
    return (at_px.x - eye.view.principal_px.x) / eye.view.focal_px.x;
  };
  EXPECT_NEAR(tangentOf(0, 1e6) - tangentOf(1, 1e6), 0.0, 1e-6);
  EXPECT_NEAR(tangentOf(0, 0.5) - tangentOf(1, 0.5), kBetween_m / 0.5, 1e-6);
}

TEST(HeadsetViews, ShareOneFieldInAnAnaglyph) {
  const auto eyes = headsetViews(StereoView::anaglyph, glm::mat4(1.0f), kDisplays, {800, 700});
  EXPECT_EQ(eyes[0].view.principal_px, eyes[1].view.principal_px);
  EXPECT_EQ(eyes[0].view.focal_px, eyes[1].view.focal_px);
}

TEST(HeadsetViews, OfOneEyeAreThatEyes) {
  const auto both = headsetViews(StereoView::side_by_side, glm::mat4(1.0f), kDisplays, {1600, 700});
  const auto right = headsetViews(StereoView::right, glm::mat4(1.0f), kDisplays, {800, 700});
  ASSERT_EQ(right.size(), 1u);
  EXPECT_EQ(right[0].view, both[1].view);
  EXPECT_EQ(right[0].corner_px, glm::ivec2(0));
}

TEST(HeadsetViews, FollowDisplaysThatAreCanted) {
  HeadsetEyes canted = kDisplays;
  const double cant_rad = glm::radians(5.0);  // to the left, and the eye stands lower
  canted[0].head_from_eye = glm::angleAxis(cant_rad, glm::dvec3(0.0, 1.0, 0.0));
  canted[0].position_m.y = -0.002;
  const auto eyes = headsetViews(StereoView::side_by_side, glm::mat4(1.0f), canted, {1600, 700});
  const EyeView& eye = eyes[0];
  const glm::dvec3 p(0.1, 0.2, -1.5);
  // What is 5 degrees to the left of straight ahead is on the display's axis.
  const glm::dvec3 on_axis =
      canted[0].position_m + glm::dvec3(-std::sin(cant_rad), 0.0, -std::cos(cant_rad));
  EXPECT_NEAR(projectForEye(eye, on_axis).x, eye.view.principal_px.x, kFloat_px);
  EXPECT_NEAR(projectForEye(eye, on_axis).y, eye.view.principal_px.y, kFloat_px);
  // Renderers use the matrix, markers the pose: both agree.
  const glm::vec2 rendered =
      project(eye.view, glm::vec3(eye.view.eye_from_world * glm::vec4(glm::vec3(p), 1.0f)));
  EXPECT_LT(glm::distance(projectForEye(eye, p), glm::dvec2(rendered)), kFloat_px);
}

}  // namespace FOCI_FILE
}  // namespace foci
