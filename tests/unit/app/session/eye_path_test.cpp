#include "app/session/eye_path.h"

#include <gtest/gtest.h>

namespace foci {
namespace FOCI_FILE {

constexpr double kFloat = 1e-6;  // of matrices of floats

TEST(EyePathOfAHead, TurnsAlongTheShortestArcWithRoll) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, -0.2, 1.0));  // most of it is roll
  const glm::dquat end = glm::angleAxis(glm::radians(80.0), axis);
  // -q is the same orientation as q: the arc must not go the long way round.
  const EyePath path(std::vector<TrackedPose>{
      {.time_s = 1.0, .position_m = {0.0, 1.0, 2.0}},
      {.time_s = 3.0, .position_m = {4.0, 1.0, 2.0}, .world_from_eye = -end}});
  const glm::dmat4 world_from_eye = glm::inverse(glm::dmat4(path.eyeFromWorldAt(1.5)));
  const glm::dmat3 expected = glm::mat3_cast(glm::angleAxis(glm::radians(20.0), axis));
  for (int column = 0; column < 3; ++column) {
    EXPECT_LT(glm::distance(glm::dvec3(world_from_eye[column]), expected[column]), kFloat);
  }
  EXPECT_LT(glm::distance(glm::dvec3(world_from_eye[3]), glm::dvec3(1.0, 1.0, 2.0)), kFloat);
}

TEST(EyePathOfAHead, RestsBeforeAndAfterItsPoses) {
  const EyePath path(std::vector<TrackedPose>{{.time_s = 1.0, .position_m = {1.0, 0.0, 0.0}},
                                              {.time_s = 2.0, .position_m = {2.0, 0.0, 0.0}}});
  EXPECT_EQ(path.eyeFromWorldAt(0.0)[3].x, -1.0f);
  EXPECT_EQ(path.eyeFromWorldAt(9.0)[3].x, -2.0f);
  EXPECT_TRUE(path.followsHead());
  EXPECT_FALSE(EyePath().followsHead());
}

TEST(EyePathOfAHead, IsEqualByItsPoses) {
  const std::vector<TrackedPose> poses = {{.time_s = 1.0, .position_m = {1.0, 0.0, 0.0}}};
  EXPECT_EQ(EyePath(poses), EyePath(poses));
  EXPECT_FALSE(EyePath(poses) == EyePath());
}

}  // namespace FOCI_FILE
}  // namespace foci
