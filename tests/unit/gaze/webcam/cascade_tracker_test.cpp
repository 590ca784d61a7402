#include "gaze/webcam/cascade_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "tests/faces/watched.h"

namespace foci {
namespace FOCI_FILE {

const Pinhole kCamera{.focal_px = {560, 560}, .principal_px = {320, 240}};

TEST(CascadeTracker, FollowsHeadIrisesAndBlinks) {
  CascadeTracker tracker(Lens{kCamera}, std::nullopt);
  const faces::Sitting sitting{.sway_m = 0.02, .sway_rad = 0.08, .blink_every_s = 0.6};
  const faces::Watched w = faces::watch(tracker, faces::somebody(1), sitting, 0.0, 0.9, 2.0, false);
  EXPECT_GE(faces::shareFound(w), 0.97);
  // Position and rotation of the head may have a constant error, which a calibration removes. Their
  // changes must be right.
  std::vector<glm::dvec3> place_off;
  std::vector<glm::dvec2> turn_off;
  int shut = 0, blinks = 0, false_blinks = 0;
  for (std::size_t i = 0; i < w.records.size(); ++i) {
    ASSERT_TRUE(w.records[i].face) << i;
    const faces::Moment& m = w.moments[i];
    if (m.closed > 0.9) {
      ++shut;
      blinks += w.records[i].blink;
    }
    if (m.closed < 0.05) false_blinks += w.records[i].blink;
    if (!w.records[i].view) continue;
    const WebcamView& v = *w.records[i].view;
    const double scale = kMeanIpd_mm / faces::somebody(1).ipd_mm;
    place_off.push_back(v.head_m - scale * glm::dvec3(-m.head_m.x, -m.head_m.y, m.head_m.z));
    turn_off.push_back(v.head_rad - glm::dvec2(m.yaw_rad, m.pitch_rad));
    EXPECT_NEAR(v.roll_rad, m.roll_rad, 0.03);
  }
  ASSERT_GT(shut, 0);
  EXPECT_EQ(blinks, shut);
  EXPECT_EQ(false_blinks, 0);
  for (std::size_t i = 0; i < place_off.size(); ++i) {
    constexpr double kAside_m = 0.003, kAlong_m = 0.012,
                     kTurn_rad = 0.06;  // the tracker assumes an average face
    EXPECT_NEAR(place_off[i].x, place_off[0].x, kAside_m) << i;
    EXPECT_NEAR(place_off[i].y, place_off[0].y, kAside_m) << i;
    EXPECT_NEAR(place_off[i].z, place_off[0].z, kAlong_m) << i;
    EXPECT_NEAR(turn_off[i].x, turn_off[0].x, kTurn_rad) << i;
    EXPECT_NEAR(turn_off[i].y, turn_off[0].y, kTurn_rad) << i;
  }
}

TEST(CascadeTracker, FollowsIrisesBehindGlassesAndNoise) {
  CascadeTracker tracker(Lens{kCamera}, std::nullopt);
  faces::Person person = faces::somebody(2);
  person.glasses = true;
  const faces::Watched w =
      faces::watch(tracker, person, {.blink_every_s = 0.0}, 0.0, 0.7, 5.0, false);
  EXPECT_GE(faces::shareFound(w), 0.85);
}

TEST(CascadeTracker, FindsTheSameHeadAgain) {
  // The head comes back, and at another time it is found from the stored reference.
  const faces::Sitting sitting{.blink_every_s = 0.0};
  CascadeTracker tracker(Lens{kCamera}, std::nullopt);
  const faces::Watched before =
      faces::watch(tracker, faces::somebody(1), sitting, 0.2, 0.5, 2.0, false);
  const cv::Mat nobody(480, 640, CV_8UC1, cv::Scalar(90));
  for (int i = 0; i < 4; ++i) {
    const WebcamRecord record = tracker.push(nobody);
    EXPECT_FALSE(record.face);
    EXPECT_FALSE(record.view);
  }
  const auto mean = [](const faces::Watched& w) {
    glm::dvec2 eye(0.0), turn(0.0);
    double count = 0.0;
    for (const WebcamRecord& r : w.records) {
      if (!r.view) continue;
      eye += r.view->eye;
      turn += r.view->head_rad;
      ++count;
    }
    EXPECT_GT(count, 3.0);
    return std::pair(eye / count, turn / count);
  };
  ASSERT_TRUE(tracker.reference());
  CascadeTracker later(Lens{kCamera}, tracker.reference());
  const auto first = mean(before);
  for (CascadeTracker* other : {&tracker, &later}) {
    const auto again =
        mean(faces::watch(*other, faces::somebody(1), sitting, 0.2, 0.5, 2.0, false));
    // A degree is 0.006 widths of the eye.
    EXPECT_LT(glm::distance(again.first, first.first), 0.004);
    EXPECT_LT(glm::distance(again.second, first.second), 0.01);
  }
}

TEST(CascadeTracker, FindsNobodyInAnEmptyRoom) {
  CascadeTracker tracker(Lens{kCamera}, std::nullopt);
  const WebcamRecord record = tracker.push(cv::Mat(480, 640, CV_8UC1, cv::Scalar(90)));
  EXPECT_FALSE(record.face || record.blink || record.view);
  EXPECT_EQ(record.confidence, 0.0);
  EXPECT_FALSE(tracker.reference());
}

}  // namespace FOCI_FILE
}  // namespace foci
