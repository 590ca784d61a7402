#include "calibration/gaze_map/target_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace foci {
namespace FOCI_FILE {

constexpr double kTick_s = 1.0 / 60.0;
const std::vector<glm::dvec2> kTargets{{-8, 4}, {8, 4}, {0, -4}};

TEST(TargetLayout, StaysInsideTheScreenWithoutDoubles) {
  for (const int count : {4, 5, 9, 13, 16}) {
    const auto places = targetLayout(count);
    std::set<std::pair<double, double>> different;
    for (const glm::dvec2& p : places) {
      different.emplace(std::round(p.x * 1e6), std::round(p.y * 1e6));
      EXPECT_GE(std::min({p.x, p.y, 1 - p.x, 1 - p.y}), 0.1 - 1e-12);
    }
    EXPECT_EQ(different.size(), static_cast<std::size_t>(count));
  }
}

TEST(TargetLayout, OrderFollowsTheSeed) {
  const auto a = shuffled(targetLayout(9), 1), b = shuffled(targetLayout(9), 2);
  EXPECT_EQ(a, shuffled(targetLayout(9), 1));
  EXPECT_NE(a, b);
  EXPECT_TRUE(std::is_permutation(a.begin(), a.end(), b.begin()));
}

TEST(TargetSession, AnObserverWhoLooksIsLedThrough) {
  TargetSession session(kTargets, false);
  double time_s = 0.0;
  for (; !session.done() && time_s < 30.0; time_s += kTick_s) {
    const auto target = session.update(time_s, std::nullopt).target;
    if (target < kTargets.size()) session.update(time_s, kTargets[target] + 0.3);
  }
  EXPECT_TRUE(session.done());
  EXPECT_LT(time_s, 9.0);
  for (const GazePair& pair : session.pairs()) {
    if (pair.gaze) {
      EXPECT_LT(glm::length(*pair.gaze - pair.target), 0.5);
    }
  }
}

TEST(TargetSession, WaitsWhileNoEyeIsInView) {
  TargetSession session(kTargets, false);
  TargetSession::Step step;
  for (double t = 0.0; t < 20.0; t += kTick_s) step = session.update(t, std::nullopt);
  EXPECT_EQ(step.target, 0u);
  EXPECT_TRUE(step.gaze_missing);
  EXPECT_TRUE(session.pairs().empty());
}

TEST(TargetSession, KeepsNothingOfAnUnsteadyGazeBeforeItsPatienceEnds) {
  TargetSession session(kTargets, false);
  int i = 0;
  for (double t = 0.0; t < 5.0; t += kTick_s)
    session.update(t, glm::dvec2(++i % 2 ? -6.0 : 6.0, 0.0));
  EXPECT_TRUE(session.pairs().empty());
}

TEST(TargetSession, ManualWaitsForTheKey) {
  TargetSession session(kTargets, true);
  double t = 0.0;
  for (; t < 8.0; t += kTick_s) session.update(t, kTargets[0]);
  EXPECT_TRUE(session.pairs().empty());
  session.confirm();
  for (; t < 10.0; t += kTick_s) session.update(t, kTargets[0]);
  EXPECT_FALSE(session.pairs().empty());
  for (const GazePair& pair : session.pairs()) EXPECT_EQ(pair.target, kTargets[0]);
}

}  // namespace FOCI_FILE
}  // namespace foci
