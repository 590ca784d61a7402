#include "gaze/webcam/webcam_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "tests/faces/observer.h"

namespace foci {
namespace {

constexpr double kRate_Hz = 30.0;
const Pinhole kCamera{.focal_px = {560, 560}, .principal_px = {320, 240}};

/// An observer, filmed at 30 frames per second, and the tracker's records.
struct Watched {
  std::vector<WebcamRecord> records;
  std::vector<faces::Truth> truths;
  std::vector<faces::Moment> moments;
};

Watched watch(WebcamTracker& tracker, const faces::Person& person, const faces::Sitting& sitting,
              double from_s, double to_s, double noise) {
  const faces::Face face(person);
  const faces::Observer observer(sitting, {{0.0, 0.6, {0.0, 0.0}},
                                           {0.6, 1.2, {0.2, 0.1}},
                                           {1.2, 1.8, {-0.2, -0.1}},
                                           {1.8, 9.0, {0.1, -0.1}}});
  Watched watched;
  faces::Photography how;
  how.noise = noise;
  for (int frame = 0; frame < std::lround((to_s - from_s) * kRate_Hz); ++frame) {
    const faces::Moment moment = observer.at(from_s + frame / kRate_Hz);
    how.seed = static_cast<std::uint32_t>(frame);
    cv::Mat grey;
    cv::cvtColor(face.photograph(moment, how), grey, cv::COLOR_BGR2GRAY);
    watched.records.push_back(tracker.push(grey));
    watched.truths.push_back(face.truthOf(moment, how));
    watched.moments.push_back(moment);
  }
  return watched;
}

/// Share of the frames with open eyes in which both irises are found within 5 % of the
/// interpupillary distance.
double shareFound(const Watched& w) {
  int open = 0, good = 0;
  for (std::size_t i = 0; i < w.records.size(); ++i) {
    if (w.truths[i].closed > 0.05) continue;
    ++open;
    bool both = true;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const auto& iris = w.records[i].irises[eye];
      both = both && iris &&
             glm::distance(iris->centre_px, w.truths[i].iris_px[eye]) <
                 0.05 * w.truths[i].eyeDistance_px();
    }
    good += both;
  }
  return static_cast<double>(good) / open;
}

TEST(WebcamTracker, FollowsHeadIrisesAndBlinks) {
  WebcamTracker tracker(Lens{kCamera});
  const faces::Sitting sitting{.sway_m = 0.02, .sway_rad = 0.08, .blink_every_s = 1.2};
  const Watched w = watch(tracker, faces::somebody(1), sitting, 0.0, 1.9, 2.0);
  EXPECT_GE(shareFound(w), 0.97);
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

TEST(WebcamTracker, FollowsIrisesBehindGlassesAndNoise) {
  WebcamTracker tracker(Lens{kCamera});
  faces::Person person = faces::somebody(2);
  person.glasses = true;
  const Watched w = watch(tracker, person, {.blink_every_s = 0.0}, 0.0, 1.2, 5.0);
  EXPECT_GE(shareFound(w), 0.85);
}

TEST(WebcamTracker, FindsTheSameHeadAgain) {
  // The head comes back, and at another time it is found from the stored reference.
  const faces::Sitting sitting{.blink_every_s = 0.0};
  WebcamTracker tracker(Lens{kCamera});
  const Watched before = watch(tracker, faces::somebody(1), sitting, 0.2, 0.5, 2.0);
  const cv::Mat nobody(480, 640, CV_8UC1, cv::Scalar(90));
  for (int i = 0; i < 4; ++i) {
    const WebcamRecord record = tracker.push(nobody);
    EXPECT_FALSE(record.face);
    EXPECT_FALSE(record.view);
  }
  const auto mean = [](const Watched& w) {
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
  WebcamTracker later(std::nullopt, tracker.reference());
  const auto first = mean(before);
  for (WebcamTracker* other : {&tracker, &later}) {
    const auto again = mean(watch(*other, faces::somebody(1), sitting, 0.2, 0.5, 2.0));
    // A degree is 0.006 widths of the eye.
    EXPECT_LT(glm::distance(again.first, first.first), 0.004);
    EXPECT_LT(glm::distance(again.second, first.second), 0.01);
  }
}

TEST(WebcamTracker, FindsNobodyInAnEmptyRoom) {
  WebcamTracker tracker;
  const WebcamRecord record = tracker.push(cv::Mat(480, 640, CV_8UC1, cv::Scalar(90)));
  EXPECT_FALSE(record.face || record.blink || record.view);
  EXPECT_EQ(record.confidence, 0.0);
  EXPECT_FALSE(tracker.reference());
}

}  // namespace
}  // namespace foci
