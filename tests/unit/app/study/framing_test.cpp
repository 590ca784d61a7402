// Automatic framing against closed forms: cubes, spheres, and clouds with strays.
#include "app/study/framing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>
#include <vector>

#include "gaze/geometry/default_screen.h"
#include "render/optics/view.h"

namespace foci {
namespace {

constexpr double kFourDigits = 2e-4;  // poses have four significant digits

SceneFacts meshOf(std::vector<glm::vec3> corners, SceneKind kind = SceneKind::obj) {
  SceneFacts facts{.kind = kind, .triangles = 1};
  facts.position = std::move(corners);
  return facts;
}

SceneFacts cloudOf(std::vector<glm::vec3> points) {
  SceneFacts facts{.kind = SceneKind::ply_points, .points = points.size()};
  facts.position = std::move(points);
  return facts;
}

std::vector<glm::vec3> cube(float side, const glm::vec3& middle = glm::vec3(0.0f)) {
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back(middle + side * (glm::vec3(i & 1, i >> 1 & 1, i >> 2) - 0.5f));
  }
  return corners;
}

/// Points spread evenly over a sphere (Fibonacci's spiral).
std::vector<glm::vec3> sphere(float radius, int count = 20'000) {
  std::vector<glm::vec3> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, ring = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    points.emplace_back(glm::dvec3(ring * std::cos(angle), ring * std::sin(angle), z) *
                        double{radius});
  }
  return points;
}

Framing framed(const SceneFacts& facts, Look look = Look::front) {
  return framingOf(facts, {.screen = defaultScreen(), .look = look, .up = {}});
}

/// The share of the image's half height and half width that a scene reaches; absent points behind.
glm::dvec2 filled(const SceneFacts& facts, const Framing& framing) {
  const Screen screen = defaultScreen();
  const View view =
      viewThroughScreen(eyeFromWorld(framing.position_m, framing.look_at_m, framing.up),
                        screen.size_px, screen.size_m, screen.distance_m);
  glm::dvec2 most(0.0);
  for (const glm::vec3& p : facts.position) {
    const glm::vec3 p_eye(view.eye_from_world *
                          glm::vec4(static_cast<float>(framing.scale_m) * p, 1.0f));
    EXPECT_LT(p_eye.z, 0.0f) << "behind the eye";
    const glm::dvec2 at(project(view, p_eye));
    most = glm::max(most, glm::abs(at / (0.5 * glm::dvec2(screen.size_px)) - 1.0));
  }
  return most;
}

TEST(Framing, ACubeFromAboveIsAsFarAwayAsItsUpperFaceNeeds) {
  const SceneFacts facts = meshOf(cube(1.0f));
  const Framing framing = framed(facts, Look::above);
  const Screen screen = defaultScreen();
  const double tangent = kFilledShare * 0.5 * screen.size_m.y / screen.distance_m;
  EXPECT_NEAR(framing.distance_m(), 0.5 + 0.5 / tangent, kFourDigits * framing.distance_m());
  EXPECT_EQ(framing.up, glm::dvec3(0, 0, -1));  // the far side of its front is above
  EXPECT_NEAR(filled(facts, framing).y, kFilledShare, kFourDigits);
}

TEST(Framing, ASphereTouchesTheStatedShareFromEverywhere) {
  const SceneFacts facts = meshOf(sphere(0.5f));
  const Screen screen = defaultScreen();
  const double tangent = kFilledShare * 0.5 * screen.size_m.y / screen.distance_m;
  const double distance_m = 0.5 * std::sqrt(1.0 + 1.0 / (tangent * tangent));
  constexpr double kGaps = 1e-3;  // between 20,000 points
  for (const Look look : {Look::front, Look::left, Look::above}) {
    const Framing framing = framed(facts, look);
    EXPECT_NEAR(framing.distance_m() / distance_m, 1.0, kGaps);
    const glm::dvec2 share = filled(facts, framing);
    EXPECT_NEAR(share.y, kFilledShare, kGaps);
    EXPECT_LT(share.x, kFilledShare);
  }
}

TEST(Framing, WideAndHighScenesFillTheirTighterSide) {
  std::vector<glm::vec3> wide = cube(1.0f), high = cube(1.0f);
  for (glm::vec3& p : wide) p.x *= 9.0f;
  for (glm::vec3& p : high) p.y *= 9.0f;
  for (const auto& corners : {wide, high}) {
    const SceneFacts facts = meshOf(corners);
    const glm::dvec2 share = filled(facts, framed(facts));
    EXPECT_NEAR(std::max(share.x, share.y), kFilledShare, kFourDigits);
  }
}

TEST(Framing, FrontLeftAndAboveLookFromThere) {
  const SceneFacts facts = meshOf(cube(1.0f, {3, 4, 5}));
  const auto from = [&](Look look) {
    const Framing framing = framed(facts, look);
    return glm::normalize(framing.position_m - framing.look_at_m);
  };
  const double raise = std::sin(glm::radians(kRaise_deg)), level = std::sqrt(1.0 - raise * raise);
  EXPECT_LT(glm::distance(from(Look::front), glm::dvec3(0, raise, level)), 1e-3);
  EXPECT_LT(glm::distance(from(Look::left), glm::dvec3(-level, raise, 0)), 1e-3);
  EXPECT_LT(glm::distance(from(Look::above), glm::dvec3(0, 1, 0)), 1e-3);
  const Framing framing =
      framingOf(facts, {.screen = defaultScreen(), .look = Look::front, .up = upAxisNamed("z")});
  EXPECT_LT(glm::distance(glm::normalize(framing.position_m - framing.look_at_m),
                          glm::dvec3(0, -level, raise)),
            1e-3);
}

TEST(Framing, AnySizeIsSeenFromAComfortableDistance) {
  for (const float side : {2e-6f, 2e-3f, 0.1f, 1.0f, 4.0f, 250.0f, 4e5f}) {
    for (const SceneKind kind : {SceneKind::obj, SceneKind::gltf}) {
      SceneFacts facts = meshOf(cube(side), kind);
      if (kind == SceneKind::gltf) facts.unit_m = 1.0;
      const Framing framing = framed(facts);
      EXPECT_GE(framing.distance_m(), kNearest_m) << side;
      EXPECT_LE(framing.distance_m(), kMostDistant_m) << side;
      const double power = std::log10(framing.scale_m);
      EXPECT_DOUBLE_EQ(power, std::round(power)) << side;
      EXPECT_NEAR(std::max(filled(facts, framing).x, filled(facts, framing).y), kFilledShare, 1e-3);
      const bool comfortable = side >= 0.1f && side <= 4.0f;
      EXPECT_EQ(framing.scale_m == 1.0, comfortable) << side;
      const std::string text = framingText(framing);
      EXPECT_EQ(text.find("would be") == std::string::npos, comfortable) << text;
    }
  }
}

TEST(Framing, TakesTheUnitAndTheAxisThatAFileStates) {
  SceneFacts facts = meshOf(cube(180.0f), SceneKind::fbx);
  facts.unit_m = 0.01;
  facts.up_axis = 2;
  const Framing framing = framed(facts);
  EXPECT_EQ(framing.scale_m, 0.01);
  EXPECT_EQ(nameOf(framing.up_axis), "z");
}

TEST(Framing, StraysOfAScanDoNotMoveTheEye) {
  std::vector<glm::vec3> points = sphere(1.0f);
  const Framing alone = framed(cloudOf(points));
  for (int i = 0; i < 50; ++i) points.emplace_back(1000.0f + static_cast<float>(i), 0.0f, 500.0f);
  const Framing among = framed(cloudOf(points));
  EXPECT_EQ(among.box.strays, 50u);
  EXPECT_EQ(among.position_m, alone.position_m);
  EXPECT_EQ(boxOf(meshOf(points)).strays, 0u);  // a mesh has none
}

TEST(Framing, KeepsThinPartsOfAScan) {
  std::vector<glm::vec3> points = sphere(1.0f);
  points.emplace_back(0.0f, 1.3f, 0.0f);  // a hair
  const SceneBox box = boxWithoutStrays(points);
  EXPECT_EQ(box.strays, 0u);
  EXPECT_FLOAT_EQ(static_cast<float>(box.high.y), 1.3f);
}

TEST(Framing, ASinglePointHasAnEyeToo) {
  const Framing framing = framed(cloudOf({{1.0f, 2.0f, 3.0f}}));
  EXPECT_GE(framing.distance_m(), kNearest_m);
  EXPECT_EQ(framing.look_at_m, framing.scale_m * glm::dvec3(1, 2, 3));
}

SceneFacts gaussiansOf(std::vector<glm::vec3> positions, const glm::vec3& reach) {
  SceneFacts facts = cloudOf(std::move(positions));
  facts.kind = SceneKind::gaussians;
  facts.reach.assign(facts.position.size(), reach);
  return facts;
}

TEST(Framing, GaussiansReachBeyondTheirPositions) {
  const SceneFacts one = gaussiansOf({{1.0f, 2.0f, 3.0f}}, {0.1f, 0.2f, 0.4f});
  EXPECT_LT(glm::distance(boxOf(one).size(), glm::dvec3(0.2, 0.4, 0.8)), 1e-6);
  // As far away as the ball of the positions that is as large.
  constexpr double kGaps = 1e-3;  // between 20,000 points
  const Framing framing = framed(gaussiansOf(sphere(0.4f), glm::vec3(0.1f)));
  EXPECT_NEAR(framing.distance_m() / framed(cloudOf(sphere(0.5f))).distance_m(), 1.0, kGaps);
  // One that reaches far, as a sky, is there without its reach.
  SceneFacts sky = gaussiansOf(sphere(0.4f), glm::vec3(0.1f));
  sky.position.emplace_back(0.0f);
  sky.reach.emplace_back(300.0f);
  EXPECT_EQ(framed(sky).position_m, framing.position_m);
  EXPECT_EQ(framed(sky).box.strays, 0u);
}

TEST(Framing, TakesTheScaleOfThePreparedScene) {
  const Framing framing = framingOf(
      cloudOf(sphere(100.0f)), {.screen = defaultScreen(), .look = {}, .up = {}, .scale_m = 0.5});
  EXPECT_EQ(framing.scale_m, 0.5);
  EXPECT_NE(framing.why_scale.find("--scale"), std::string::npos);
}

TEST(Framing, OfAPreparedSceneOfGaussiansNamesWhatStatesTheUnit) {
  SceneFacts facts = gaussiansOf(sphere(0.5f), glm::vec3(0.01f));
  facts.unit_m = 1.0;
  EXPECT_EQ(framed(facts).why_scale, "as the prepared scene states");
}

TEST(UpAxis, FollowsConventionUnlessAScanIsFlat) {
  const auto upOf = [](SceneFacts facts) { return nameOf(upAxisOf(facts, boxOf(facts))); };
  std::vector<glm::vec3> flat_y = cube(1.0f), flat_z = cube(1.0f), flat_x = cube(1.0f);
  for (glm::vec3& p : flat_y) p.y *= 0.1f;
  for (glm::vec3& p : flat_z) p.z *= 0.1f;
  for (glm::vec3& p : flat_x) p.x *= 0.1f;
  for (const SceneKind kind : {SceneKind::obj, SceneKind::gltf}) {
    EXPECT_EQ(upOf(meshOf(flat_z, kind)), "y");
  }
  EXPECT_EQ(upOf(meshOf(cube(1.0f), SceneKind::stl)), "z");
  EXPECT_EQ(upOf(meshOf(cube(1.0f), SceneKind::ply_mesh)), "y");
  EXPECT_EQ(upOf(meshOf(flat_z, SceneKind::ply_mesh)), "z");
  EXPECT_EQ(upOf(cloudOf(cube(1.0f))), "z");
  EXPECT_EQ(upOf(cloudOf(flat_y)), "y");
  EXPECT_EQ(upOf(cloudOf(flat_x)), "z");  // a wall stands
  EXPECT_EQ(nameOf(*upAxisNamed("-y")), "-y");
  EXPECT_FALSE(upAxisNamed("w"));
}

TEST(Framing, IslandsOfAMapDoNotShrinkTheMainland) {
  // A hundred points for each of 9900: more than 1 % on one end, as overseas departments are.
  std::vector<glm::vec3> points = sphere(1.0f, 9'850);
  for (int i = 0; i < 150; ++i)
    points.emplace_back(-90.0f - 0.1f * static_cast<float>(i), -60, -80);
  const SceneBox box = boxWithoutStrays(points);
  EXPECT_EQ(box.strays, 150u);
  EXPECT_NEAR(box.longest(), 2.0, 0.01);
}

TEST(Framing, AFlatSceneIsSeenFromItsSide) {
  std::vector<glm::vec3> upright;  // in the plane x = 0
  for (const glm::vec3& p : cube(1.0f)) upright.emplace_back(0.0f, p.y, p.z);
  const SceneFacts facts = meshOf(upright);
  const Screen screen = defaultScreen();
  const Framing chosen = framingOf(facts, {.screen = screen, .look = {}, .up = {}});
  EXPECT_EQ(chosen.position_m, framed(facts, Look::left).position_m);
  EXPECT_NE(framingText(chosen).find("seen from the left"), std::string::npos);
  EXPECT_TRUE(framed(facts, Look::front).why_look.empty());  // as wished
  const Framing solid = framingOf(meshOf(cube(1.0f)), {.screen = screen, .look = {}, .up = {}});
  EXPECT_EQ(solid.position_m, framed(meshOf(cube(1.0f))).position_m);
}

}  // namespace
}  // namespace foci
