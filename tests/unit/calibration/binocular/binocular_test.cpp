#include "calibration/binocular/fit_binocular.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <string>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

// The issue's own limits.
constexpr double kPose_m = 0.002;
constexpr double kAngle_deg = 0.1;

struct Tracker {
  BinocularMap truth;
  double noise_deg = 0.0;
  double head_m = 0.0;  ///< how far the head moves
  double outliers = 0.0;
};

/// 5 deg and 5 cm off the nominal pose, kappa of about 2 deg outwards in each eye.
Tracker tracker() {
  Tracker t;
  const auto turn =
      glm::rotate(glm::dmat4(1.0), glm::radians(5.0), glm::normalize(glm::dvec3(1, 2, -1)));
  t.truth.rotation = glm::dmat3(turn);
  t.truth.translation_m = glm::dvec3(0.03, -0.03, 0.6) + glm::dvec3(0.0, 0.0, 0.027);
  t.truth.kappa_rad = {glm::radians(glm::dvec2(1.9, 0.6)), glm::radians(glm::dvec2(-1.8, 0.9))};
  return t;
}

BinocularMap nominal() {
  BinocularMap map;
  map.translation_m = {0.0, 0.0, 0.6};
  return map;
}

std::vector<BinocularSample> record(const Tracker& t, int per_target, std::mt19937_64& random) {
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<BinocularSample> samples;
  for (int target = 0; target < 9; ++target) {
    for (int i = 0; i < per_target; ++i) {
      BinocularSample sample;
      sample.target_m = {0.2 * (target % 3 - 1), 0.11 * (target / 3 - 1)};
      const glm::dvec3 head =
          t.head_m * glm::dvec3{uniform(random), uniform(random), uniform(random)};
      const glm::dvec3 p =
          t.truth.rotation * glm::dvec3(sample.target_m, 0.0) + t.truth.translation_m;
      const bool outlier = 0.5 * (uniform(random) + 1.0) < t.outliers;
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const glm::dvec3 centre = head + glm::dvec3(eye == 0 ? -0.032 : 0.032, 0.0, 0.0);
        const glm::dvec3 d = glm::normalize(p - centre);
        BinocularMap against;
        against.kappa_rad[0] = -t.truth.kappa_rad[eye] +
                               glm::radians(t.noise_deg) * glm::dvec2{gauss(random), gauss(random)};
        if (outlier) against.kappa_rad[0] += 0.2 * glm::dvec2{uniform(random), uniform(random)};
        sample.eyes[eye] = {centre, correctedDirection(against, 0, d)};
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

double turn_deg(const glm::dmat3& a, const glm::dmat3& b) {
  const glm::dmat3 d = glm::transpose(a) * b;
  return glm::degrees(std::acos(std::clamp(0.5 * (d[0][0] + d[1][1] + d[2][2] - 1.0), -1.0, 1.0)));
}

void expectRecovered(const BinocularFit& fit, const BinocularMap& truth) {
  EXPECT_LT(glm::length(fit.map.translation_m - truth.translation_m), kPose_m);
  EXPECT_LT(turn_deg(fit.map.rotation, truth.rotation), kAngle_deg);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    EXPECT_LT(glm::degrees(glm::length(fit.map.kappa_rad[eye] - truth.kappa_rad[eye])), kAngle_deg);
  }
}

TEST(FitBinocular, RecoversPoseAndKappaFromAMovingHead) {
  std::mt19937_64 random(1);
  Tracker t = tracker();
  t.head_m = 0.1;
  expectRecovered(fitBinocular(record(t, 10, random), nominal()), t.truth);
}

TEST(FitBinocular, RecoversThemUnderNoiseAndOutliers) {
  std::mt19937_64 random(2);
  Tracker t = tracker();
  t.head_m = 0.12;
  t.noise_deg = 0.3;
  t.outliers = 0.1;
  expectRecovered(fitBinocular(record(t, 200, random), nominal()), t.truth);
}

TEST(FitBinocular, RemovesTheBiasOfVergence) {
  std::mt19937_64 random(3);
  Tracker t = tracker();
  t.head_m = 0.1;
  t.noise_deg = 0.2;
  const BinocularFit fit = fitBinocular(record(t, 50, random), nominal());
  // 3.7 deg over 64 mm is 1 dioptre.
  EXPECT_GT(std::abs(fit.vergence_bias_before_D), 0.8);
  EXPECT_LT(std::abs(fit.vergence_bias_after_D), 0.03);
}

TEST(FitBinocular, RefusesAHeadThatNeverMovedAndTooLittle) {
  std::mt19937_64 random(4);
  Tracker t = tracker();
  t.noise_deg = 0.5;
  EXPECT_THROW(fitBinocular(record(t, 10, random), nominal()), InputError);
  t.head_m = 0.1;
  auto few = record(t, 10, random);
  few.resize(9);
  EXPECT_THROW(fitBinocular(few, nominal()), InputError);
}

TEST(FitBinocular, RefusesAnEyeOnItsTarget) {
  std::mt19937_64 random(7);
  Tracker t = tracker();
  t.head_m = 0.1;
  auto samples = record(t, 10, random);
  // Its line of sight has no direction: Ceres cannot evaluate the start.
  samples[0].eyes[0]->centre_m =
      nominal().rotation * glm::dvec3(samples[0].target_m, 0.0) + nominal().translation_m;
  try {
    fitBinocular(samples, nominal());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no parameters fit the samples"), std::string::npos);
  }
}

std::string refusalOf(const std::vector<BinocularSample>& samples) {
  try {
    fitBinocular(samples, roughBinocularMap(samples));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string warningsOf(const std::vector<BinocularSample>& samples) {
  std::string all;
  for (const auto& warning : fitBinocular(samples, roughBinocularMap(samples)).warnings) {
    all += warning + "\n";
  }
  return all;
}

/// With z towards the observer.
Tracker trackerOfTobii() {
  Tracker t = tracker();
  t.head_m = 0.1;
  t.truth.translation_m.z = -t.truth.translation_m.z;
  t.truth.kappa_rad = {};
  return t;
}

/// The same eyes in another frame of the tracker.
std::vector<BinocularSample> turned(std::vector<BinocularSample> samples, const glm::dvec3& turn) {
  for (BinocularSample& sample : samples) {
    for (auto& eye : sample.eyes) {
      eye->centre_m *= turn;
      eye->direction *= turn;
    }
  }
  return samples;
}

TEST(FitBinocular, RefusesMirroredTargetsExchangedEyesAndOtherUnits) {
  std::mt19937_64 random(8);
  const auto good = record(trackerOfTobii(), 10, random);
  EXPECT_EQ(refusalOf(good), "");
  EXPECT_EQ(warningsOf(good), "");
  const auto changed = [&](const auto& change) {
    auto samples = good;
    for (BinocularSample& sample : samples) change(sample);
    return samples;
  };
  const auto says = [&](const char* word, const auto& change) {
    const std::string refusal = refusalOf(changed(change));
    EXPECT_NE(refusal.find(word), std::string::npos) << word << ": " << refusal;
  };
  says("y_target_mm", [](BinocularSample& s) { s.target_m.y = 0.3 - s.target_m.y; });
  says("x_target_mm", [](BinocularSample& s) { s.target_m.x = -s.target_m.x; });
  says("x_target_mm", [](BinocularSample& s) { s.target_m = -s.target_m; });
  says("exchange", [](BinocularSample& s) { std::swap(s.eyes[0], s.eyes[1]); });
  for (const double unit : {0.1, 0.001}) {
    says("mm apart", [&](BinocularSample& s) {
      s.target_m *= unit;
      for (auto& eye : s.eyes) eye->centre_m *= unit;
    });
  }
  says("mm from the display: expected 100 to 10000", [](BinocularSample& s) {
    s.eyes[1].reset();
    s.target_m *= 0.1;
    s.eyes[0]->centre_m *= 0.1;
  });
  // Pupil Core's frame: it may be right, so it is named.
  const std::string said = warningsOf(turned(good, {1.0, -1.0, -1.0}));
  EXPECT_NE(said.find("its y down"), std::string::npos) << said;
}

TEST(FitBinocular, TakesTheFrameOfACameraThatFacesTheObserver) {
  std::mt19937_64 random(9);
  const auto good = record(trackerOfTobii(), 10, random);
  // OpenCV's, with y down; OpenGL's, with y up.
  for (const glm::dvec3& turn : {glm::dvec3(-1.0, -1.0, 1.0), glm::dvec3(-1.0, 1.0, -1.0)}) {
    auto samples = turned(good, turn);
    EXPECT_NE(warningsOf(samples).find("observer's left"), std::string::npos) << turn.y;
    for (BinocularSample& sample : samples) sample.eyes[0].reset();
    EXPECT_NE(refusalOf(samples).find("x_target_mm"), std::string::npos) << "one eye cannot tell";
  }
}

TEST(FitBinocular, TakesEyesNearerOrFartherThanAnAdults) {
  std::mt19937_64 random(10);
  const Tracker t = trackerOfTobii();
  const auto good = record(t, 10, random);
  const auto apart = [&](double ipd_m) {
    auto samples = good;
    for (BinocularSample& sample : samples) {
      const glm::dvec3 target =
          t.truth.rotation * glm::dvec3(sample.target_m, 0.0) + t.truth.translation_m;
      for (std::size_t eye = 0; eye < 2; ++eye) {
        sample.eyes[eye]->centre_m.x += (eye == 0 ? -0.5 : 0.5) * (ipd_m - 0.064);
        sample.eyes[eye]->direction = target - sample.eyes[eye]->centre_m;
      }
    }
    return samples;
  };
  EXPECT_EQ(warningsOf(apart(0.05)), "");
  for (const double ipd_m : {0.03, 0.1}) {
    const std::string warning = warningsOf(apart(ipd_m));
    EXPECT_NE(warning.find("mm apart: expected 40 to 80"), std::string::npos) << warning;
  }
  for (const double ipd_m : {0.01, 0.2}) {
    const std::string refusal = refusalOf(apart(ipd_m));
    EXPECT_NE(refusal.find("mm apart: expected 15 to 150"), std::string::npos) << refusal;
  }
}

TEST(FitBinocular, OneEyeIsEnough) {
  std::mt19937_64 random(5);
  Tracker t = tracker();
  t.head_m = 0.1;
  auto samples = record(t, 10, random);
  for (BinocularSample& s : samples) s.eyes[1].reset();
  const BinocularFit fit = fitBinocular(samples, nominal());
  EXPECT_LT(glm::length(fit.map.translation_m - t.truth.translation_m), kPose_m);
  EXPECT_FALSE(vergence_D(fit.map, samples[0]));
}

TEST(PointOnDisplay, IsTheTarget) {
  std::mt19937_64 random(6);
  Tracker t = tracker();
  t.head_m = 0.1;
  for (const BinocularSample& s : record(t, 2, random)) {
    const auto point = pointOnDisplay(t.truth, 1, *s.eyes[1]);
    ASSERT_TRUE(point);
    EXPECT_LT(glm::length(*point - s.target_m), 1e-9);
    BinocularSample::Eye away = *s.eyes[1];
    away.direction = -away.direction;
    EXPECT_FALSE(pointOnDisplay(t.truth, 1, away));
  }
}

TEST(Vergence, IsTheInverseDistanceStraightAheadAndZeroInParallel) {
  BinocularSample s;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const glm::dvec3 centre(eye == 0 ? -0.03 : 0.03, 0.0, 0.0);
    s.eyes[eye] = {centre, glm::dvec3(0.0, 0.0, 0.5) - centre};
  }
  EXPECT_NEAR(*vergence_D({}, s), 2.0, 1e-12);
  s.eyes[0]->direction = s.eyes[1]->direction = {0.0, 0.1, 1.0};
  EXPECT_NEAR(*vergence_D({}, s), 0.0, 1e-12);
}

}  // namespace FOCI_FILE
}  // namespace foci
