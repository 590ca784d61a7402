#include "calibration/webcam/webcam_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "base/input_error.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};

WebcamCalibration example() {
  WebcamCalibration calibration;
  calibration.map = nominalWebcamMap();
  calibration.map.parameters[3] = 1.0 / 3.0;
  calibration.screen_m = kScreen.size_m;
  WebcamReference& reference = calibration.reference;
  reference.camera = {{.focal_px = {560.5, 561.0}, .principal_px = {320.25, 240.0}},
                      {-0.1, 0.01, 0.001, -0.002, 1.0 / 3.0},
                      {640, 480}};
  HeadView view;
  view.corner_px = {100.0, -3.0};
  const double c = std::cos(0.1), s = std::sin(0.1);
  view.pose = {.camera_from_head = glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1),
               .position_mm = {10.0, 20.0, 600.0}};
  view.grey.create(49, 51, CV_8UC1);
  cv::RNG(1).fill(view.grey, cv::RNG::UNIFORM, 0, 255);
  reference.head = view;
  reference.eyes_mm = {{{31.0, 0.5, -10.5}, {-32.0, 0.0, -10.5}}};
  return calibration;
}

TEST(WebcamCalibrationFile, ComesBackToTheLastDigit) {
  WebcamCalibration written = example();
  written.reference.by_networks = true;
  const ScratchFile file(webcamCalibrationToml(written));
  const WebcamCalibration read = readWebcamCalibration(file.path());
  EXPECT_EQ(read.map.parameters, written.map.parameters);
  EXPECT_EQ(read.map.information, written.map.information);
  EXPECT_EQ(read.map.sd_deg, written.map.sd_deg);
  EXPECT_EQ(read.screen_m, written.screen_m);
  EXPECT_TRUE(read.reference.camera == written.reference.camera);
  const auto& view = read.reference.head;
  const auto& expected = written.reference.head;
  EXPECT_EQ(view.corner_px, expected.corner_px);
  EXPECT_EQ(view.pose.camera_from_head, expected.pose.camera_from_head);
  EXPECT_EQ(read.reference.eyes_mm, written.reference.eyes_mm);
  EXPECT_TRUE(read.reference.by_networks);
  ASSERT_EQ(view.grey.size(), expected.grey.size());
  EXPECT_EQ(cv::norm(view.grey, expected.grey), 0.0);
}

TEST(WebcamCalibrationFile, HoldsForItsScreenAndCameraAlone) {
  const WebcamCalibration calibration = example();
  EXPECT_NO_THROW(requireSame(calibration, kScreen, std::nullopt));
  EXPECT_NO_THROW(requireSame(calibration, kScreen, calibration.reference.camera));
  Screen other = kScreen;
  other.size_m.x *= 1.1;
  EXPECT_THROW(requireSame(calibration, other, std::nullopt), InputError);
  Lens camera = calibration.reference.camera;
  camera.distortion[0] += 0.01;
  EXPECT_THROW(requireSame(calibration, kScreen, camera), InputError);
}

TEST(WebcamCalibrationFile, RefusesWhatIsNone) {
  const std::string good = webcamCalibrationToml(example());
  const auto says = [&](const std::string& text) {
    const ScratchFile file(text);
    try {
      readWebcamCalibration(file.path());
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const auto without = [&](const std::string& what, const std::string& instead) {
    std::string text = good;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, text.npos) << what;
    return text.replace(at, what.size(), instead);
  };
  EXPECT_NE(says(without("sd_deg", "sd_dog")).find("sd_deg"), std::string::npos);
  EXPECT_NE(says(without("rotation = [", "rotation = [0.5, ")).find("rotation"), std::string::npos);
  EXPECT_NE(says(without("rotation = [0.995", "rotation = [0.5")).find("rotation"),
            std::string::npos);
  EXPECT_NE(says(without("image = \"", "image = \"****")).find("image"), std::string::npos);
  EXPECT_NE(says(without("image = \"", "image = \"AAAA")).find("image"), std::string::npos);
  EXPECT_NE(says(good + "more = 1\n").find("more"), std::string::npos);
  EXPECT_NE(says("[map]\nunits = \"deg\"\n").find("webcam.parameters"), std::string::npos);
}

TEST(ReadShownTargets, TakesColumnsInAnyOrder) {
  const ScratchFile file(
      "y_target\tonset_s\tx_target\tduration_s\n2\t0.5\t-1\t1\n# pause\n\n3\t2\t4\t1.5\n");
  const auto targets = readShownTargets(file.path());
  ASSERT_EQ(targets.size(), 2u);
  EXPECT_EQ(targets[0].onset_s, 0.5);
  EXPECT_EQ(targets[0].target_deg, glm::dvec2(-1.0, 2.0));
  EXPECT_EQ(targets[1].duration_s, 1.5);
  for (const char* bad :
       {"", "onset_s duration_s x_target\n", "onset_s duration_s x_target y_target\n",
        "onset_s duration_s x_target y_target\n0 1 2\n",
        "onset_s duration_s x_target y_target\n0 1 2 95\n",
        "onset_s duration_s x_target y_target\n-1 1 2 3\n"}) {
    const ScratchFile broken(bad);
    EXPECT_THROW(readShownTargets(broken.path()), InputError) << bad;
  }
}

TEST(PairFrames, LeavesOutTheTimeToLookThere) {
  std::vector<WebcamFrame> frames(40);
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].time_s = 0.1 * static_cast<double>(i);
  const std::vector<ShownTarget> targets{{0.0, 0.6, {1, 1}}, {1.95, 1.5, {2, 2}}};
  const auto pairs = pairFrames(frames, targets);
  // From 0.3 to 0.6, half of so short a time, and from 2.45 to 3.45.
  EXPECT_EQ(pairs.size(), 3u + 10u);
  EXPECT_NEAR(pairs.front().time_s, 0.3, 1e-12);
  EXPECT_NEAR(pairs[3].time_s, 2.5, 1e-12);
}

TEST(CalibrateWebcam, MeasuresOnTheOthersAndCountsBlinksAsDataLoss) {
  // An observer for whom the nominal map is right.
  const WebcamMap truth = nominalWebcamMap();
  const auto look = [&](double x, double y) {
    WebcamPair pair;
    WebcamView view;
    view.eye = {0.05 * x, 0.04 * y};
    view.head_m = {0.01 * x, -0.12, 0.6};
    pair.view = view;
    pair.target_deg = glm::degrees(glm::atan(pointOnScreen_m(truth, view) / kScreen.distance_m));
    return pair;
  };
  std::vector<WebcamPair> pairs, others;
  for (int i = 0; i < 45; ++i) pairs.push_back(look(i % 3 - 1, i / 3 % 3 - 1));
  for (int i = 0; i < 8; ++i) others.push_back(look(0.5 * (i % 2), 0.5 * (i / 2 % 2)));
  others.back().view.reset();
  WebcamMap map;
  const GazeReport report = calibrateWebcam(pairs, others, kScreen, map);
  EXPECT_TRUE(report.validated);
  EXPECT_EQ(report.accuracy.overall.missing, 1u);
  constexpr double kSolver_deg = 1e-3;
  EXPECT_LT(*report.accuracy.overall.accuracy_deg, kSolver_deg);
  EXPECT_NE(gazeReportJson(report).find("\"model\": \"webcam\""), std::string::npos);
  // In pixels of the screen, y down.
  const WebcamMapping mapping = mappingOf(map, kScreen);
  const glm::dvec2 m = kScreen.distance_m * glm::tan(glm::radians(others.front().target_deg));
  const glm::dvec2 px = mapping(*others.front().view).point_px;
  EXPECT_NEAR(px.x, 960.0 + m.x * 1920.0 / 0.52, 0.1);
  EXPECT_NEAR(px.y, 540.0 - m.y * 1080.0 / 0.2925, 0.1);

  const std::vector<WebcamPair> few(4, look(0, 0));
  EXPECT_THROW(calibrateWebcam(few, {}, kScreen, map), InputError);
}

}  // namespace FOCI_FILE
}  // namespace foci
