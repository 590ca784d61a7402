// The networks on rendered faces, whose irises and poses are known exactly. Their models come from
// app/webcam_models.sh; without them these tests are skipped.
#include "gaze/webcam/network_tracker.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <vector>

#include "tests/faces/watched.h"

namespace foci {
namespace FOCI_FILE {

const Lens kCamera{{.focal_px = {560, 560}, .principal_px = {320, 240}}};

#define SKIP_WITHOUT_MODELS()                                                           \
  if (!FaceNetworks::missing().empty()) {                                               \
    GTEST_SKIP() << "the webcam's networks are not installed: sh app/webcam_models.sh"; \
  }

NetworkTracker trackerOf(const std::optional<WebcamReference>& reference = std::nullopt) {
  return {*FaceNetworks::load(), kCamera, reference};
}

TEST(NetworkTracker, FollowsHeadIrisesAndBlinks) {
  SKIP_WITHOUT_MODELS();
  NetworkTracker tracker = trackerOf();
  const faces::Sitting sitting{.sway_m = 0.02, .sway_rad = 0.08, .blink_every_s = 0.6};
  const faces::Watched w = faces::watch(tracker, faces::somebody(1), sitting, 0.0, 0.9, 2.0, true);
  EXPECT_GE(faces::shareFound(w), 0.95);
  int shut = 0, blinks = 0, false_blinks = 0;
  std::vector<glm::dvec2> turn_off;
  for (std::size_t i = 0; i < w.records.size(); ++i) {
    ASSERT_TRUE(w.records[i].face) << i;
    const faces::Moment& m = w.moments[i];
    if (m.closed > 0.9) {
      ++shut;
      blinks += w.records[i].blink;
    }
    if (m.closed < 0.05) false_blinks += w.records[i].blink;
    if (!w.records[i].view) continue;
    turn_off.push_back(w.records[i].view->head_rad - glm::dvec2(m.yaw_rad, m.pitch_rad));
    EXPECT_NEAR(w.records[i].view->roll_rad, m.roll_rad, 0.03);
  }
  ASSERT_GT(shut, 0);
  EXPECT_EQ(blinks, shut);
  EXPECT_EQ(false_blinks, 0);
  for (std::size_t i = 0; i < turn_off.size(); ++i) {
    constexpr double kTurn_rad = 0.06;  // as for the cascades: a calibration removes the mean
    EXPECT_NEAR(turn_off[i].x, turn_off[0].x, kTurn_rad) << i;
    EXPECT_NEAR(turn_off[i].y, turn_off[0].y, kTurn_rad) << i;
  }
}

TEST(FaceNetworks, TheIrisHasLittleScatter) {
  SKIP_WITHOUT_MODELS();
  glm::dvec2 sum(0.0), sum2(0.0);
  double count = 0.0;
  for (const std::uint32_t person : {0u, 2u, 5u}) {
    NetworkTracker tracker = trackerOf();
    const faces::Watched w =
        faces::watch(tracker, faces::somebody(person), {.blink_every_s = 0.0}, 0.4, 0.8, 2.0, true);
    for (std::size_t i = 0; i < w.records.size(); ++i) {
      for (std::size_t eye = 0; eye < 2; ++eye) {
        if (!w.records[i].irises[eye]) continue;
        const glm::dvec2 off = (w.records[i].irises[eye]->centre_px - w.truths[i].iris_px[eye]) /
                               (2.0 * w.truths[i].iris_radius_px[eye]);
        sum += off;
        sum2 += off * off;
        ++count;
      }
    }
  }
  ASSERT_GT(count, 50.0);
  const glm::dvec2 mean = sum / count, sd = glm::sqrt(sum2 / count - mean * mean);
  constexpr double kBias = 0.1, kScatter = 0.05;  // iris diameters; a calibration removes the bias
  EXPECT_NEAR(mean.x, 0.0, kBias);
  EXPECT_NEAR(mean.y, 0.0, kBias);
  EXPECT_LT(sd.x, kScatter);
  EXPECT_LT(sd.y, kScatter);
}

TEST(NetworkTracker, AFaceThatLooksAheadIsNotTurned) {
  SKIP_WITHOUT_MODELS();
  double pitch = 0.0, yaw = 0.0;
  for (std::uint32_t person = 0; person < 6; ++person) {
    const faces::Face face(faces::somebody(person));
    const cv::Mat image = face.photograph({.head_m = {0.0, 0.0, 0.6}}, faces::Photography{});
    NetworkTracker tracker = trackerOf();
    const WebcamRecord record = tracker.push(image);
    ASSERT_TRUE(record.head) << person;
    const WebcamView view = webcamView(*record.head, glm::dvec2(0.0));
    pitch += view.head_rad.y / 6.0;
    yaw += view.head_rad.x / 6.0;
  }
  EXPECT_NEAR(pitch, 0.0, 0.2);  // the profile of these faces is not that of real ones
  EXPECT_NEAR(yaw, 0.0, 0.02);
}

TEST(NetworkTracker, TheFirstFaceNeedNotLookAhead) {
  SKIP_WITHOUT_MODELS();
  const faces::Face face(faces::somebody(1));
  for (const double yaw_rad : {-0.35, 0.35}) {
    NetworkTracker tracker = trackerOf();
    const WebcamRecord record = tracker.push(
        face.photograph({.head_m = {0.0, 0.0, 0.6}, .yaw_rad = yaw_rad}, faces::Photography{}));
    ASSERT_TRUE(record.head);
    EXPECT_NEAR(webcamView(*record.head, glm::dvec2(0.0)).head_rad.x, yaw_rad, 0.1);
  }
}

TEST(NetworkTracker, FindsTheSameHeadAgain) {
  SKIP_WITHOUT_MODELS();
  const faces::Sitting sitting{.blink_every_s = 0.0};
  NetworkTracker tracker = trackerOf();
  const auto mean = [&](NetworkTracker& by) {
    const faces::Watched w = faces::watch(by, faces::somebody(1), sitting, 0.2, 0.5, 2.0, true);
    glm::dvec4 sum(0.0);
    for (const WebcamRecord& r : w.records) {
      EXPECT_TRUE(r.view);
      if (r.view) sum += glm::dvec4(r.view->eye, r.view->head_rad);
    }
    return sum / static_cast<double>(w.records.size());
  };
  const glm::dvec4 first = mean(tracker);
  const cv::Mat nobody(480, 640, CV_8UC3, cv::Scalar::all(90));
  for (int i = 0; i < 4; ++i) {
    const WebcamRecord record = tracker.push(nobody);
    EXPECT_FALSE(record.face || record.blink || record.view);
    EXPECT_EQ(record.problem, WebcamProblem::no_face);
  }
  ASSERT_TRUE(tracker.reference());
  NetworkTracker later = trackerOf(tracker.reference());
  for (NetworkTracker* other : {&tracker, &later}) {
    const glm::dvec4 again = mean(*other);
    // A degree is 0.006 widths of the eye.
    EXPECT_LT(glm::distance(glm::dvec2(again), glm::dvec2(first)), 0.006);
    EXPECT_LT(glm::distance(glm::dvec2(again.z, again.w), glm::dvec2(first.z, first.w)), 0.02);
  }
}

TEST(NetworkTracker, FindsAFaceThatJumps) {
  SKIP_WITHOUT_MODELS();
  // By up to half a face, as in a film with few frames. The mesh would stay behind, on hair.
  const faces::Face face(faces::somebody(0));
  NetworkTracker tracker = trackerOf();
  int right = 0, all = 0;
  for (int i = 0; i < 12; ++i) {
    const faces::Moment moment{.head_m = {0.05 * (i * 7 % 5 - 2), 0.04 * (i * 5 % 4 - 1), 0.6}};
    const cv::Mat image = face.photograph(moment, faces::Photography{});
    const WebcamRecord record = tracker.push(image);
    const faces::Truth truth = face.truthOf(moment, faces::Photography{});
    for (std::size_t eye = 0; eye < 2; ++eye) {
      ++all;
      right +=
          record.irises[eye] && glm::distance(record.irises[eye]->centre_px, truth.iris_px[eye]) <
                                    truth.iris_radius_px[eye] / 2;
    }
  }
  EXPECT_EQ(right, all);
}

TEST(NetworkTracker, NarrowerEyesAreNotABlinkForEver) {
  SKIP_WITHOUT_MODELS();
  faces::Person narrow = faces::somebody(3);
  narrow.lids = 0.45;
  const faces::Moment moment{.head_m = {0.0, 0.0, 0.45}};
  const cv::Mat wide = faces::Face(faces::somebody(3)).photograph(moment, faces::Photography{});
  const cv::Mat image = faces::Face(narrow).photograph(moment, faces::Photography{});
  NetworkTracker tracker = trackerOf();
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(tracker.push(wide).blink);
  EXPECT_TRUE(tracker.push(image).blink);
  for (int i = 0; i < 15; ++i) tracker.push(image);
  EXPECT_FALSE(tracker.push(image).blink);
}

TEST(NetworkTracker, SaysWhatStandsInTheWay) {
  SKIP_WITHOUT_MODELS();
  const faces::Face face(faces::somebody(0)), other(faces::somebody(4));
  const auto problemOf = [&](const faces::Moment& moment, const faces::Photography& how,
                             const auto& paint) {
    NetworkTracker tracker = trackerOf();
    cv::Mat image = face.photograph(moment, how);
    tracker.push(image);
    paint(image, face.truthOf(moment, how));
    return tracker.push(image).problem;
  };
  const auto leave = [](cv::Mat&, const faces::Truth&) {};
  const auto disk = [](double radii, double level, std::size_t eyes = 1) {
    return [=](cv::Mat& image, const faces::Truth& truth) {
      for (std::size_t i = 0; i < eyes; ++i) {
        cv::circle(image, cv::Point(cv::Point2d(truth.iris_px[i].x, truth.iris_px[i].y)),
                   static_cast<int>(radii * truth.iris_radius_px[i]), cv::Scalar::all(level),
                   cv::FILLED);
      }
    };
  };
  const faces::Moment near{.head_m = {0.0, 0.0, 0.5}}, far{.head_m = {0.0, 0.0, 1.1}};
  EXPECT_EQ(problemOf(near, {}, leave), WebcamProblem::none);
  EXPECT_EQ(problemOf(far, {}, leave), WebcamProblem::too_far);
  EXPECT_EQ(problemOf(near, {}, disk(0.6, 255.0)), WebcamProblem::glints);
  EXPECT_EQ(problemOf(near, {}, disk(3.0, 255.0, 2)), WebcamProblem::glints);
  EXPECT_EQ(problemOf(near, {}, disk(3.0, 110.0)), WebcamProblem::one_eye_hidden);
  const faces::Photography two{.beside = &other, .beside_at = {.head_m = {-0.22, 0.0, 0.75}}};
  EXPECT_EQ(problemOf(near, two, leave), WebcamProblem::several_faces);
}

TEST(NetworkTracker, SeesNoFaceInNoise) {
  SKIP_WITHOUT_MODELS();
  cv::Mat noise(480, 640, CV_8UC3), dark(480, 640, CV_8UC3, cv::Scalar::all(9));
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 255);
  NetworkTracker tracker = trackerOf();
  EXPECT_FALSE(tracker.push(noise).face);
  EXPECT_EQ(tracker.push(dark).problem, WebcamProblem::too_dark);
}

}  // namespace FOCI_FILE
}  // namespace foci
