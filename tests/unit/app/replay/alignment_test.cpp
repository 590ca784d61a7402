// Headset recordings made from a scene by a known transformation; and scenes that cannot tell.
#include "app/replay/alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <string>
#include <vector>

#include "app/replay/scene_view.h"
#include "render/lod/surface_query.h"

namespace foci {
namespace FOCI_FILE {

using Verdict = AlignmentSearch::Verdict;

const glm::dvec3 kUp(0.0, 1.0, 0.0);
constexpr double kIpd_m = 0.063;
constexpr AlignmentRange kFew{.scales = 2, .yaw_deg = 20.0};

/// Surfels at even steps on a rectangle.
void addWall(SurfelCloud& cloud, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
             float spacing_m) {
  const auto steps = [&](const glm::vec3& side) {
    return std::round(glm::length(side) / spacing_m);
  };
  const glm::vec3 normal = glm::normalize(glm::cross(u, v));
  for (float i = 0.5f; i < steps(u); ++i) {
    for (float j = 0.5f; j < steps(v); ++j) {
      const glm::vec3 at = corner + u * (i / steps(u)) + v * (j / steps(v));
      appendSurfel(cloud, at, normal, kSigmaPerSpacing * spacing_m, spacing_m * spacing_m,
                   glm::vec3(0.5f));
    }
  }
}

void addBox(SurfelCloud& cloud, const glm::vec3& low, const glm::vec3& size, float spacing_m) {
  const glm::vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  addWall(cloud, low, x, y, spacing_m);
  addWall(cloud, low + z, x, y, spacing_m);
  addWall(cloud, low, y, z, spacing_m);
  addWall(cloud, low + x, y, z, spacing_m);
  addWall(cloud, low + y, x, z, spacing_m);
}

/// An L-shaped corner of a room with a table and a post: nothing repeats.
SurfelCloud room() {
  constexpr float kSpacing_m = 0.08f;
  SurfelCloud cloud;
  addWall(cloud, {-2.0f, 0.0f, -2.5f}, {4.5f, 0, 0}, {0, 0, 4.0f}, kSpacing_m);  // floor
  addWall(cloud, {-2.0f, 0.0f, -2.5f}, {4.5f, 0, 0}, {0, 2.4f, 0}, kSpacing_m);  // ahead
  addWall(cloud, {-2.0f, 0.0f, -2.5f}, {0, 0, 3.0f}, {0, 2.4f, 0}, kSpacing_m);  // left
  addBox(cloud, {0.3f, 0.0f, -1.6f}, {1.1f, 0.8f, 0.6f}, kSpacing_m);
  addBox(cloud, {-1.2f, 0.0f, -0.9f}, {0.3f, 1.5f, 0.3f}, kSpacing_m);
  return cloud;
}

/// Sights of a walk in the scene, which see what the scene shows, as recorded by a tracker whose
/// world the alignment takes to the scene's.
/// @param noise_D  of vergence; absent: there is none
RecordedSights recorded(const Scene& scene, const SceneAlignment& truth,
                        const std::optional<double>& noise_D, std::size_t count = 120) {
  const SurfaceQuery query(scene);
  const glm::dquat r(truth.rotation.w, truth.rotation.x, truth.rotation.y, truth.rotation.z);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  RecordedSights all{.sights = {}, .sigma_D = noise_D ? std::hypot(0.1, *noise_D) : 0.0};
  std::vector<Sight>& sights = all.sights;
  while (sights.size() < count) {
    const double time_s = 0.35 * static_cast<double>(sights.size());
    const glm::dvec3 eye_m(0.4 * std::sin(0.3 * time_s), 1.6, 1.0 + 0.4 * std::cos(0.2 * time_s));
    const glm::dvec3 direction =
        glm::normalize(glm::dvec3(0.9 * even(random), -0.3 + 0.45 * even(random), -1.0));
    const auto met_m = query.distance(eye_m, direction, 0.0087, 0.5);
    if (!met_m) continue;
    Sight sight{.time_s = time_s,
                .eye_m = glm::inverse(r) * (eye_m - truth.offset_m) / truth.scale,
                .direction = glm::inverse(r) * direction};
    if (noise_D) sight.vergence_D = truth.scale / *met_m + *noise_D * normal(random);
    sights.push_back(sight);
  }
  return all;
}

SceneAlignment turned(double yaw_deg, double scale, const glm::dvec3& offset_m) {
  const glm::dquat r = glm::angleAxis(glm::radians(yaw_deg), kUp);
  return {.rotation = {r.x, r.y, r.z, r.w}, .scale = scale, .offset_m = offset_m};
}

/// Where the truth and another alignment place what is looked at: the greatest distance, over that
/// of the gaze.
double apart(const RecordedSights& looks, const SceneAlignment& a, const SceneAlignment& b) {
  const auto place = [](const SceneAlignment& by, const glm::dvec3& p) {
    return by.offset_m +
           by.scale * (glm::dquat(by.rotation.w, by.rotation.x, by.rotation.y, by.rotation.z) * p);
  };
  double most = 0.0;
  for (const Sight& sight : looks.sights) {
    const double away_m = probableDistance_m(sight);
    const glm::dvec3 p = sight.eye_m + away_m * sight.direction;
    most = std::max(most, glm::distance(place(a, p), place(b, p)) / (a.scale * away_m));
  }
  return most;
}

TEST(Alignment, RecoversOffsetScaleAndRotation) {
  constexpr double kWithin = 0.03;  // of the distance: the spacing of the surfels over it
  const Scene scene{room()};
  const SceneAlignment truth = turned(130.0, 1.25, {0.7, 0.35, -1.2});
  const auto sights = recorded(scene, truth, 0.0);
  const AlignmentSearch found = searchAlignment(scene, sights, {}, kUp, kFew);
  EXPECT_EQ(found.verdict(), Verdict::propose) << verdictText(found);
  EXPECT_LT(apart(sights, truth, found.best.alignment), kWithin);
  EXPECT_NEAR(found.best.alignment.scale, truth.scale, kWithin * truth.scale);
  EXPECT_GT(found.best.score, 0.9);
  EXPECT_LT(found.now.score, 0.5);
  for (const AlignmentNeighbour& each : found.neighbours) EXPECT_GT(each.drop, 0.01) << each.step;
}

TEST(Alignment, RecoversThemFromNoisyVergence) {
  constexpr double kWithin = 0.15;
  const Scene scene{room()};
  const SceneAlignment truth = turned(-70.0, 1.0, {-0.5, -0.2, 0.8});
  const auto sights = recorded(scene, truth, 0.05);
  const AlignmentSearch found = searchAlignment(scene, sights, {}, kUp, kFew);
  EXPECT_LT(apart(sights, truth, found.best.alignment), kWithin);
  EXPECT_EQ(found.rivals, 0u);
}

TEST(Alignment, KeepsARecordingThatFits) {
  const Scene scene{room()};
  const SceneAlignment truth = turned(0.0, 1.0, {0.0, 0.0, 0.0});
  const AlignmentSearch found =
      searchAlignment(scene, recorded(scene, truth, 0.05), truth, kUp, kFew);
  EXPECT_EQ(found.verdict(), Verdict::keep) << verdictText(found);
}

TEST(Alignment, OfAPlaneProposesNothing) {
  SurfelCloud plane;
  addWall(plane, {-4.0f, 0.0f, -6.0f}, {8.0f, 0, 0}, {0, 0, 8.0f}, 0.1f);
  const SceneAlignment truth = turned(40.0, 1.0, {1.0, 0.5, -0.5});
  const AlignmentSearch found =
      searchAlignment({plane}, recorded({plane}, truth, 0.0), {}, kUp, kFew);
  EXPECT_EQ(found.verdict(), Verdict::ambiguous) << verdictText(found);
  EXPECT_NE(verdictText(found).find("many poses do as well"), std::string::npos);
}

TEST(Alignment, WithoutVergenceInAClosedRoomProposesNothing) {
  SurfelCloud cloud = room();
  addWall(cloud, {-2.0f, 0.0f, 1.5f}, {4.5f, 0, 0}, {0, 2.4f, 0}, 0.08f);
  addWall(cloud, {2.5f, 0.0f, -2.5f}, {0, 0, 4.0f}, {0, 2.4f, 0}, 0.08f);
  addWall(cloud, {-2.0f, 2.4f, -2.5f}, {4.5f, 0, 0}, {0, 0, 4.0f}, 0.08f);
  const Scene scene{cloud};
  const SceneAlignment truth = turned(40.0, 1.0, {6.0, 0.5, -0.5});
  const AlignmentSearch found =
      searchAlignment(scene, recorded(scene, truth, std::nullopt), {}, kUp, kFew);
  EXPECT_EQ(found.verdict(), Verdict::ambiguous) << verdictText(found);
}

TEST(Alignment, OfASceneThatGazeCannotHaveMetFitsNothing) {
  // A pole is all there is, and gaze goes everywhere.
  SurfelCloud pole;
  addBox(pole, {-0.1f, 0.0f, -0.1f}, {0.2f, 1.0f, 0.2f}, 0.03f);
  const auto sights = recorded({room()}, turned(0.0, 1.0, {0.0, 0.0, 0.0}), 0.0);
  const AlignmentSearch found = searchAlignment({pole}, sights, {}, kUp, kFew);
  EXPECT_EQ(found.verdict(), Verdict::nothing_fits) << verdictText(found);
}

TEST(Alignment, TurnsTheRecordingsVerticalToTheScenes) {
  const Scene scene{room()};
  const auto sights = recorded(scene, {}, 0.0);
  SceneAlignment tilted;  // a quarter turn about x
  tilted.rotation = {std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)};
  const AlignmentSearch found = searchAlignment(scene, sights, tilted, kUp, kFew);
  const glm::dvec4& r = found.best.alignment.rotation;
  const glm::dvec3 up = glm::dquat(r.w, r.x, r.y, r.z) * kUp;
  EXPECT_LT(glm::distance(up, kUp), 1e-9);
}

TEST(Alignment, IsWrittenAsKeysOfAStudy) {
  EXPECT_EQ(alignmentToml(turned(90.0, 2.0, {1.0, -0.25, 0.0})),
            "[gaze]\nscene_rotation = [0.000000, 0.707107, 0.000000, 0.707107]\nscene_scale = 2\n"
            "scene_offset_m = [1.0000, -0.2500, 0.0000]\n");
}

TEST(SceneVoxels, AnswerWithinACube) {
  SurfelCloud wall;
  addWall(wall, {-1.0f, -1.0f, -2.0f}, {2.0f, 0, 0}, {0, 2.0f, 0}, 0.05f);
  addWall(wall, {-1.0f, -1.0f, -2.0f}, {2.0f, 0, 0}, {0, 0, 2.0f}, 0.05f);
  const SceneVoxels voxels({wall}, {-1.0, -1.0, -2.0}, {1.0, 1.0, 0.0});
  for (const glm::dvec3 eye_m : {glm::dvec3(0.1, 0.2, 1.0), glm::dvec3(0.3, -0.2, -0.5)}) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.1, 0.15, -1.0));
    const auto met_m = voxels.distance_m(eye_m, direction);
    ASSERT_TRUE(met_m);
    EXPECT_NEAR(*met_m, (eye_m.z + 2.0) / -direction.z, 1.5 * voxels.cube_m());
  }
  EXPECT_FALSE(voxels.distance_m({0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}));
  EXPECT_FALSE(voxels.distance_m({0.0, 5.0, 1.0}, {0.0, 0.0, -1.0}));
  EXPECT_FALSE(voxels.distance_m({0.0, 0.5, -0.5}, {1.0, 0.0, 0.0}));
}

}  // namespace FOCI_FILE
}  // namespace foci
