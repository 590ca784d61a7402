#include "calibration/webcam/webcam_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/input_error.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {
namespace FOCI_FILE {

/// An observer whose eyes turn by the angle from head to target; 0.3 m of screen width.
struct Observer {
  double width_per_rad = 0.36;  ///< eye widths a radian of turn
  glm::dvec2 camera_m{0.02, 0.17};
  double noise = 0.0;  ///< of the eye's offset, eye widths
  double head_m = 0.0, head_rad = 0.0, roll_rad = 0.0;
};

std::vector<WebcamSample> watch(const Observer& o, int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> gauss;
  std::vector<WebcamSample> samples;
  for (int i = 0; i < count; ++i) {
    WebcamSample s;
    s.target_m = {0.24 * uniform(random), 0.14 * uniform(random)};
    s.view.head_m = glm::dvec3(0.0, -0.15, 0.6) +
                    o.head_m * glm::dvec3{uniform(random), uniform(random), uniform(random)};
    s.view.head_rad = o.head_rad * glm::dvec2{uniform(random), uniform(random)};
    s.view.roll_rad = o.roll_rad * uniform(random);
    const glm::dvec2 aside = s.target_m - glm::dvec2(s.view.head_m) - o.camera_m;
    const glm::dvec2 turn = glm::atan(aside / s.view.head_m.z) - s.view.head_rad;
    const glm::dvec2 eye = o.width_per_rad * glm::sin(turn + glm::dvec2(0.05, -0.08));
    const double c = std::cos(s.view.roll_rad), n = std::sin(s.view.roll_rad);
    s.view.eye = glm::dvec2(c * eye.x - n * eye.y, n * eye.x + c * eye.y) +
                 o.noise * glm::dvec2{gauss(random), gauss(random)};
    samples.push_back(s);
  }
  return samples;
}

double error_deg(const WebcamMap& map, const std::vector<WebcamSample>& samples) {
  double sum = 0.0;
  for (const WebcamSample& s : samples) {
    sum += glm::length(pointOnScreen_m(map, s.view) - s.target_m) / s.view.head_m.z;
  }
  return glm::degrees(sum / static_cast<double>(samples.size()));
}

TEST(FitWebcamMap, CalibratedWithTheHeadStillItHoldsWhenTheHeadMoves) {
  std::mt19937_64 random(1);
  Observer o;
  o.noise = 0.003;
  o.head_m = 0.01;
  const WebcamMap map = fitWebcamMap(watch(o, 300, random), nominalWebcamMap());
  EXPECT_LT(error_deg(map, watch(o, 300, random)), 0.8);
  o.head_m = 0.08;
  o.head_rad = 0.15;
  o.roll_rad = 0.2;
  // What a map of the eyes alone would miss: 8 cm at 0.6 m are 7.6 deg.
  EXPECT_LT(error_deg(map, watch(o, 300, random)), 1.5);
}

TEST(FitWebcamMap, FewSamplesDoNotRunAway) {
  std::mt19937_64 random(2);
  Observer o;
  o.noise = 0.01;
  const double before = error_deg(nominalWebcamMap(), watch(o, 300, random));
  const WebcamMap map = fitWebcamMap(watch(o, 5, random), nominalWebcamMap());
  EXPECT_LT(error_deg(map, watch(o, 300, random)), 0.6 * before);
  EXPECT_EQ(fitWebcamMap({}, nominalWebcamMap()).parameters, nominalWebcamMap().parameters);
}

TEST(FitWebcamMap, ClicksBringADriftedMapBack) {
  std::mt19937_64 random(3);
  Observer o;
  o.noise = 0.003;
  o.head_m = 0.03;
  const WebcamMap map = fitWebcamMap(watch(o, 300, random), nominalWebcamMap());
  constexpr double kFade = 0.005;         // the old 300 samples count as one or two
  o.camera_m += glm::dvec2(0.03, -0.02);  // someone touched the screen
  const double drifted = error_deg(map, watch(o, 300, random));
  const WebcamMap clicked = fitWebcamMap(watch(o, 15, random), map, kFade);
  EXPECT_GT(drifted, 2.5);
  EXPECT_LT(error_deg(clicked, watch(o, 300, random)), 1.0);
}

TEST(WebcamRecalibration, LearnsFromEachClickOnceEyesAreSeen) {
  std::mt19937_64 random(7);
  Observer o;
  o.noise = 0.003;
  o.head_m = 0.03;
  const Screen screen{.size_px = {1920, 1080}, .size_m = {0.53, 0.30}, .distance_m = 0.6};
  const auto px = [&](const WebcamSample& s) {
    return 0.5 * glm::dvec2(screen.size_px) +
           glm::dvec2(s.target_m.x, -s.target_m.y) * glm::dvec2(screen.size_px) / screen.size_m;
  };
  WebcamRecalibration learning(fitWebcamMap(watch(o, 300, random), nominalWebcamMap()), screen);
  EXPECT_FALSE(learning.click({960.0, 540.0}));  // nobody has been seen

  o.camera_m += glm::dvec2(0.03, -0.02);  // someone touched the screen
  const auto error_px = [&] {
    double sum = 0.0;
    for (const WebcamSample& s : watch(o, 100, random)) {
      sum += glm::length(learning.gazeOf(s.view).point_px - px(s)) / 100.0;
    }
    return sum;
  };
  const double drifted_px = error_px();
  for (const WebcamSample& s : watch(o, 15, random)) {
    learning.gazeOf(s.view);
    EXPECT_TRUE(learning.click(px(s)));
  }
  EXPECT_LT(error_px(), 0.4 * drifted_px);
}

TEST(FitWebcamMap, OutliersAreBorne) {
  std::mt19937_64 random(4);
  Observer o;
  o.noise = 0.003;
  auto samples = watch(o, 200, random);
  for (std::size_t i = 0; i < samples.size(); i += 10) samples[i].view.eye += 0.3;
  EXPECT_LT(error_deg(fitWebcamMap(samples, nominalWebcamMap()), watch(o, 300, random)), 1.0);
}

TEST(FitWebcamMap, RefusesAViewWithoutAHead) {
  WebcamSample sample;
  sample.view.head_m.z = 0.0;
  EXPECT_THROW(fitWebcamMap({&sample, 1}, nominalWebcamMap()), InputError);
  sample.view.head_m.z = NAN;
  EXPECT_THROW(fitWebcamMap({&sample, 1}, nominalWebcamMap()), InputError);
}

TEST(FitWebcamMap, RefusesATargetBeyondNumbers) {
  WebcamSample sample;
  sample.target_m.x = 1e308;  // finite, but no angle in degrees is
  try {
    fitWebcamMap({&sample, 1}, nominalWebcamMap());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no parameters fit the samples"), std::string::npos);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
