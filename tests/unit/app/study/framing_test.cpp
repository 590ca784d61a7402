// Automatic framing against closed forms: cubes, spheres, and clouds with strays.
#include "app/study/framing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "render/optics/view.h"

namespace foci {
namespace FOCI_FILE {

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
  SceneFacts colmap = cloudOf(flat_y);
  colmap.y_is_down = true;
  EXPECT_EQ(upOf(colmap), "-y");
  colmap.up_axis = 1;  // prepared
  EXPECT_EQ(upOf(colmap), "-y");
  colmap.up_axis = 2;
  EXPECT_EQ(upOf(colmap), "z");
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
  const auto side = [](const Framing& framing) {
    return glm::normalize(framing.position_m - framing.look_at_m);
  };
  EXPECT_LT(glm::distance(side(chosen), side(framed(facts, Look::left))), 1e-3);
  EXPECT_NE(framingText(chosen).find("seen from the left"), std::string::npos);
  EXPECT_TRUE(framed(facts, Look::front).why_look.empty());  // as wished
  const Framing solid = framingOf(meshOf(cube(1.0f)), {.screen = screen, .look = {}, .up = {}});
  EXPECT_LT(glm::distance(side(solid), side(framed(meshOf(cube(1.0f))))), 1e-3);
}

/// Points every `step` over a rectangle from `corner` along `a` and `b`.
void addRectangle(std::vector<glm::vec3>& points, const glm::vec3& corner, const glm::vec3& a,
                  const glm::vec3& b, float step = 0.08f) {
  const int along_a = static_cast<int>(glm::length(a) / step);
  const int along_b = static_cast<int>(glm::length(b) / step);
  for (int i = 0; i <= along_a; ++i) {
    for (int j = 0; j <= along_b; ++j) {
      points.push_back(corner + a * (static_cast<float>(i) / static_cast<float>(along_a)) +
                       b * (static_cast<float>(j) / static_cast<float>(along_b)));
    }
  }
}

/// Of 6 x 4 x 2.6 m, z up, with a table of 1.2 x 0.8 m in a corner.
std::vector<glm::vec3> room() {
  std::vector<glm::vec3> points;
  for (const float z : {0.0f, 2.6f}) addRectangle(points, {0, 0, z}, {6, 0, 0}, {0, 4, 0});
  for (const float y : {0.0f, 4.0f}) addRectangle(points, {0, y, 0}, {6, 0, 0}, {0, 0, 2.6f});
  for (const float x : {0.0f, 6.0f}) addRectangle(points, {x, 0, 0}, {0, 4, 0}, {0, 0, 2.6f});
  addRectangle(points, {0.6f, 0.6f, 0.75f}, {1.2f, 0, 0}, {0, 0.8f, 0});
  return points;
}

/// 60 m long and 12 m wide between walls of 8 m, with a post every 10 m.
std::vector<glm::vec3> street() {
  std::vector<glm::vec3> points;
  addRectangle(points, {0, 0, 0}, {60, 0, 0}, {0, 12, 0}, 0.15f);
  for (const float y : {0.0f, 12.0f}) {
    addRectangle(points, {0, y, 0}, {60, 0, 0}, {0, 0, 8}, 0.15f);
  }
  for (float x = 5.0f; x < 60.0f; x += 10.0f) {
    addRectangle(points, {x, 3, 0}, {0.2f, 0, 0}, {0, 0, 3});
  }
  return points;
}

/// Hills of 60 x 60 m, 4 m high.
std::vector<glm::vec3> landscape(float step) {
  std::vector<glm::vec3> points;
  addRectangle(points, {0, 0, 0}, {60, 0, 0}, {0, 60, 0}, step);
  for (glm::vec3& p : points) p.z = 4.0f * std::sin(0.05f * p.x) * std::cos(0.04f * p.y);
  return points;
}

Framing framedFreely(const SceneFacts& facts) {
  return framingOf(facts, {.screen = defaultScreen(), .look = {}, .up = {}});
}

TEST(Framing, AScanOfARoomAStreetOrALandscapeIsEntered) {
  const std::vector<glm::vec3> hills = landscape(0.2f);
  for (const auto& [points, ground] :
       {std::pair(room(), 0.0), std::pair(street(), 0.0), std::pair(hills, 2.0)}) {
    const SceneFacts facts = cloudOf(points);
    const Framing framing = framedFreely(facts);
    ASSERT_TRUE(framing.entered) << framingText(framing);
    EXPECT_EQ(framing.scale_m, 1.0);
    const glm::dvec3 size = framing.box.size();
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_GT(framing.position_m[axis], framing.box.low[axis]);
      EXPECT_LT(framing.position_m[axis], framing.box.high[axis]);
    }
    if (ground == 0.0) {
      EXPECT_NEAR(framing.position_m.z, 1.6, 0.01);
    } else {
      const double height = framing.position_m.z - 4.0 * std::sin(0.05 * framing.position_m.x) *
                                                       std::cos(0.04 * framing.position_m.y);
      EXPECT_NEAR(height, 1.6, 0.5);  // the floor is that of the surroundings
    }
    const glm::dvec3 look = framing.look_at_m - framing.position_m;
    EXPECT_NEAR(look.z, 0.0, 1e-3);
    EXPECT_GT(glm::length(look), 0.3 * std::max(size.x, std::min(size.y, 40.0)) * 0.5);
    EXPECT_NE(framingText(framing).find("--look outside"), std::string::npos);
    // From outside as before.
    const Framing outside = framed(facts, Look::outside);
    EXPECT_FALSE(outside.entered);
    EXPECT_EQ(outside.position_m, framed(facts).position_m);
  }
}

TEST(Framing, AStreetIsSeenAlongItsLengthWithSomethingNear) {
  const SceneFacts facts = cloudOf(street());
  const Framing framing = framedFreely(facts);
  const glm::dvec3 look = glm::normalize(framing.look_at_m - framing.position_m);
  EXPECT_GT(std::abs(look.x), 0.9);
  double nearest = 1e9;
  for (const glm::vec3& p : facts.position) {
    const glm::dvec3 to = glm::dvec3(p) - framing.position_m;
    const double along = glm::dot(to, look);
    if (along > 0.0 && glm::length(to - along * look) < 0.4 * along) {
      nearest = std::min(nearest, glm::length(to));
    }
  }
  EXPECT_LT(nearest, 3.5);
}

TEST(Framing, UnitsAndAxesOfAScanThatIsEnteredCount) {
  std::vector<glm::vec3> turned;  // feet, y down
  for (const glm::vec3& p : room()) turned.push_back(glm::vec3(p.x, -p.z, p.y) / 0.3048f);
  SceneFacts facts = cloudOf(turned);
  facts.unit_m = 0.3048;
  const Framing framing =
      framingOf(facts, {.screen = defaultScreen(), .look = {}, .up = upAxisNamed("-y")});
  ASSERT_TRUE(framing.entered);
  EXPECT_EQ(framing.scale_m, 0.3048);
  EXPECT_NEAR(framing.position_m.y, -1.6, 0.01);
  EXPECT_EQ(framing.up, glm::dvec3(0, -1, 0));
}

TEST(Framing, AnObjectIsSeenFromOutside) {
  std::vector<glm::vec3> statue;  // 3 m high, on a base of 5 m
  for (const glm::vec3& p : sphere(1.0f)) {
    statue.push_back(p * glm::vec3(1, 1, 1.5f) + glm::vec3(0, 0, 1.5f));
  }
  addRectangle(statue, {-2.5f, -2.5f, 0}, {5, 0, 0}, {0, 5, 0});
  EXPECT_FALSE(framedFreely(cloudOf(statue)).entered);
  EXPECT_FALSE(framedFreely(cloudOf(sphere(0.3f))).entered);
  // A model of a room, and a capture of unknown unit.
  std::vector<glm::vec3> model = room();
  for (glm::vec3& p : model) p *= 0.01f;
  EXPECT_FALSE(framedFreely(cloudOf(model)).entered);
  EXPECT_FALSE(framedFreely(gaussiansOf(room(), glm::vec3(0.05f))).entered);
}

TEST(Framing, ASurveyTooCoarseForAnEyeInItIsSeenFromOutside) {
  for (const auto& [step, enters] : {std::pair(0.25f, true), std::pair(0.5f, false)}) {
    EXPECT_EQ(framedFreely(cloudOf(landscape(step))).entered, enters) << step;
  }
  // A hollow object of 80 units, which is a hall if a unit is a metre.
  EXPECT_FALSE(framedFreely(cloudOf(sphere(40.0f, 30'000))).entered);
}

TEST(Framing, TheEyeComesNearEnoughForBlurToShow) {
  // A cube of 0.3 m: depth in view spans 1 D where 1 / (d - a) - 1 / (d + a) = 1.
  for (const float side : {0.3f, 1.0f, 2.0f}) {
    const SceneFacts facts = meshOf(cube(side));
    const Framing near = framedFreely(facts), fitted = framed(facts);
    EXPECT_LE(near.distance_m(), fitted.distance_m() * 1.0001);
    const glm::dvec2 share = filled(facts, near);
    EXPECT_LE(std::max(share.x, share.y), kWholeShare + 1e-3);
    EXPECT_NE(framingText(near).find("depth in view spans "), std::string::npos);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
