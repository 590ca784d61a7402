#include "calibration/gaze_map/fit_gaze_map.h"

#include <gtest/gtest.h>

#include <functional>

#include "base/input_error.h"
#include "base/transformed.h"
#include "calibration/gaze_map/gaze_report.h"
#include "tests/unit/calibration/simulated_user.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kSolver_deg = 1e-3;   // noise floor and shrinkage of the fit on exact data
constexpr double kStatistical = 0.05;  // of a share, over the users of a test

const GazeFrame kDegrees{.units = MapUnits::deg, .screen = {}};

/// Mean angle, without noise, between where the user looks and where the map says.
double mapError_deg(const SimulatedUser& user, const GazeMap& map, double half_deg = 10.0) {
  double sum = 0.0;
  const auto points = targetGrid(7, half_deg);
  for (const glm::dvec2& p : points) {
    sum += angle_deg(onPlane(kDegrees, p),
                     onPlane(kDegrees, estimateGaze(map, user.tracked(p)).point));
  }
  return sum / static_cast<double>(points.size());
}

std::string refusalOf(const std::vector<GazePair>& pairs) {
  try {
    fitGazeMap(pairs, kDegrees);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

SimulatedUser curvedUser(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.2, 1.2);
  SimulatedUser user;
  for (glm::dvec2& q : user.square) q = {uniform(random), uniform(random)};
  return user;
}

/// The anchor: ordinary least squares with all terms up to the second order, by Gauss-Jordan.
GazeMap leastSquares(const std::vector<GazePair>& pairs) {
  constexpr std::size_t kTerms = 6;
  double m[kTerms][kTerms + 2] = {};
  for (const GazePair& pair : pairs) {
    const auto t = gazeTerms(*pair.gaze / 12.0);
    for (std::size_t i = 0; i < kTerms; ++i) {
      for (std::size_t j = 0; j < kTerms; ++j) m[i][j] += t[i] * t[j];
      m[i][kTerms] += t[i] * pair.target.x;
      m[i][kTerms + 1] += t[i] * pair.target.y;
    }
  }
  for (std::size_t i = 0; i < kTerms; ++i) {
    for (std::size_t r = 0; r < kTerms; ++r) {
      const double factor = r == i ? 0.0 : m[r][i] / m[i][i];
      for (std::size_t c = i; c < kTerms + 2; ++c) m[r][c] -= factor * m[i][c];
    }
  }
  GazeMap map;
  map.model = GazeModel::second;
  map.scale = {12.0, 12.0};
  map.low = {-9.0, -9.0};
  map.high = {9.0, 9.0};
  map.covariance_deg2.assign(kTerms * kTerms, 0.0);
  for (std::size_t i = 0; i < kTerms; ++i) {
    map.coefficients[i] = {m[i][kTerms] / m[i][i], m[i][kTerms + 1] / m[i][i]};
  }
  return map;
}

TEST(FitGazeMapping, RecoversAnAffineTrackerExactly) {
  std::mt19937_64 random(1);
  const SimulatedUser user;
  const GazeFit fit = fitGazeMap(recordUser(user, targetGrid(3, 12.0), 10, random), kDegrees);
  EXPECT_EQ(fit.map.model, GazeModel::affine);
  EXPECT_LT(mapError_deg(user, fit.map), kSolver_deg);
  EXPECT_TRUE(fit.refused.empty());
}

TEST(FitGazeMapping, MinimalThreeTargetsGiveAnOffset) {
  std::mt19937_64 random(2);
  SimulatedUser user;
  user.linear = glm::dmat2(1.0);
  const auto pairs = recordUser(user, {{-8, -5}, {8, -5}, {0, 6}}, 10, random);
  const GazeFit fit = fitGazeMap(pairs, kDegrees);
  EXPECT_EQ(fit.map.model, GazeModel::offset);
  EXPECT_LT(mapError_deg(user, fit.map), kSolver_deg);
}

TEST(FitGazeMapping, TakesTheOrderThatTheTrackerHas) {
  std::mt19937_64 random(3);
  SimulatedUser user = curvedUser(random);
  user.noise_deg = 0.2;
  EXPECT_EQ(fitGazeMap(recordUser(user, targetGrid(3, 12.0), 200, random), kDegrees).map.model,
            GazeModel::second);
  user.cube = {{{1.5, 0.4}, {0.3, -0.8}, {0.5, 0.5}, {-0.2, 1.1}}};
  EXPECT_EQ(fitGazeMap(recordUser(user, targetGrid(4, 12.0), 200, random), kDegrees).map.model,
            GazeModel::third);
}

TEST(FitGazeMapping, HalvesTheErrorOfLeastSquaresUnderOutliersAndASlip) {
  std::mt19937_64 random(4);
  double ours = 0.0, plain = 0.0, best = 0.0;
  for (int i = 0; i < 20; ++i) {
    SimulatedUser user = curvedUser(random);
    user.noise_deg = i % 2 ? 0.3 : 1.0;
    const auto targets = targetGrid(4, 12.0);
    const auto clean = recordUser(user, targets, 60, random);
    user.outliers = 0.1;
    const auto pairs = recordUser(user, targets, 60, random, i % 16);
    ours += mapError_deg(user, fitGazeMap(pairs, kDegrees).map);
    best += mapError_deg(user, fitGazeMap(clean, kDegrees, GazeModel::second).map);
    plain += mapError_deg(user, leastSquares(pairs));
  }
  EXPECT_LT(ours, 0.5 * plain);
  // The true model had neither outliers nor slip: here the noise of single samples is included, as
  // in use.
  const double noise_deg = 20.0 * 0.3;
  EXPECT_LT(ours + noise_deg, 1.2 * (best + noise_deg));
}

TEST(FitGazeMapping, NamesTheTargetThatNobodyLookedAt) {
  std::mt19937_64 random(5);
  SimulatedUser user;
  user.noise_deg = 0.3;
  const auto targets = targetGrid(3, 12.0);
  for (int slipped = 0; slipped < 9; ++slipped) {
    const GazeFit fit = fitGazeMap(recordUser(user, targets, 100, random, slipped), kDegrees);
    ASSERT_EQ(fit.refused.size(), 1u) << slipped;
    EXPECT_EQ(fit.refused[0], targets[static_cast<std::size_t>(slipped)]);
  }
}

TEST(FitGazeMapping, StatesTheUncertaintyThatIsFound) {
  std::mt19937_64 random(6);
  double within = 0.0;
  constexpr int kUsers = 60;
  for (int i = 0; i < kUsers; ++i) {
    SimulatedUser user = curvedUser(random);
    user.noise_deg = 0.3 + 0.7 * i / kUsers;
    user.target_sd_deg = 0.3;
    user.outliers = 0.1;
    const GazeFit fit = fitGazeMap(recordUser(user, targetGrid(4, 12.0), 100, random), kDegrees);
    const auto other = recordUser(user, targetGrid(5, 10.0), 20, random);
    within += *measureAccuracy(other, kDegrees, &fit.map).overall.within / kUsers;
  }
  EXPECT_NEAR(within, 0.6827, kStatistical);
}

TEST(FitGazeMapping, IsSurerAtTheCentreThanAtTheEdge) {
  std::mt19937_64 random(7);
  SimulatedUser user;
  user.noise_deg = 0.3;
  user.target_sd_deg = 0.4;
  const GazeFit fit =
      fitGazeMap(recordUser(user, targetGrid(3, 12.0), 50, random), kDegrees, GazeModel::second);
  EXPECT_LT(estimateGaze(fit.map, user.tracked({0, 0})).uncertainty_deg,
            estimateGaze(fit.map, user.tracked({12, 8.4})).uncertainty_deg);
}

TEST(FitGazeMapping, RefusesTooFewTargets) {
  std::mt19937_64 random(8);
  const auto pairs = recordUser({}, {{0, 0}, {5, 5}}, 50, random);
  EXPECT_NE(refusalOf(pairs).find("too few targets"), std::string::npos);
  EXPECT_NE(refusalOf({}).find("no sample"), std::string::npos);
}

TEST(FitGazeMapping, RefusesDuplicatesOfTwoTargets) {
  std::mt19937_64 random(9);
  const auto pairs = recordUser({}, {{0, 0}, {5, 5}, {0, 0}, {5, 5}, {0, 0}}, 50, random);
  EXPECT_NE(refusalOf(pairs).find("too few targets"), std::string::npos);
}

TEST(FitGazeMapping, RefusesCollinearTargets) {
  std::mt19937_64 random(10);
  std::vector<glm::dvec2> line;
  for (int i = 0; i < 9; ++i) line.push_back({2.0 * i - 8.0, 1.5 * i - 6.0});
  EXPECT_NE(refusalOf(recordUser({}, line, 50, random)).find("collinear"), std::string::npos);
}

TEST(FitGazeMapping, RefusesContradictions) {
  std::mt19937_64 random(11);
  SimulatedUser user;
  user.noise_deg = 0.3;
  const auto targets = targetGrid(3, 12.0);

  auto shuffled = recordUser(user, targets, 50, random);
  for (GazePair& pair : shuffled) {
    const glm::dvec2 t = pair.target;  // every target takes another's place
    pair.target = {t.y / 0.7 * (t.x < 0 ? 1 : -1),
                   t.x * 0.7 * (t.y < 0 ? -1 : 1) + (t.x == 0 ? t.y : 0)};
  }
  EXPECT_NE(refusalOf(shuffled), "");

  auto twice = recordUser(user, targets, 50, random);
  for (std::size_t i = 0; i < 5 * 50; i += 2) *twice[i].gaze += glm::dvec2(15.0, 10.0);
  EXPECT_NE(refusalOf(twice).find("contradictory"), std::string::npos);

  auto same = recordUser({}, targets, 1, random);
  for (const std::size_t i : {1, 3, 5, 7, 8}) same[i].gaze = same[0].gaze;
  EXPECT_NE(refusalOf(same).find("the same gaze at targets"), std::string::npos);

  auto stuck = recordUser({}, targets, 1, random);
  for (GazePair& pair : stuck) pair.gaze = glm::dvec2(1.0, 1.0);
  EXPECT_NE(refusalOf(stuck).find("contradictory"), std::string::npos);
}

TEST(FitGazeMapping, BadTargetsAreDroppedAndNamed) {
  std::mt19937_64 random(14);
  SimulatedUser user;
  user.noise_deg = 0.3;
  const auto targets = targetGrid(3, 12.0);
  // Gaze wanders over the whole screen at each bad target.
  std::uniform_real_distribution<double> anywhere(-15.0, 15.0);
  for (std::size_t bad = 0; bad < 4; ++bad) {
    auto pairs = recordUser(user, targets, 50, random);
    for (std::size_t i = 0; i < bad * 50; ++i) {
      pairs[i].gaze = glm::dvec2{anywhere(random), anywhere(random)};
    }
    const GazeFit fit = fitGazeMap(pairs, kDegrees);
    ASSERT_EQ(fit.refused.size(), bad);
    for (std::size_t i = 0; i < bad; ++i) {
      EXPECT_NE(std::find(fit.refused.begin(), fit.refused.end(), targets[i]), fit.refused.end());
    }
    EXPECT_LT(mapError_deg(user, fit.map), 0.5) << bad;
  }

  auto stuck = recordUser(user, targets, 50, random);
  for (std::size_t i = 0; i < 100; ++i) stuck[i].gaze = glm::dvec2(1.0, 1.0);
  EXPECT_EQ(fitGazeMap(stuck, kDegrees).refused.size(), 2u);
}

/// What an observer did at a target: which sample of how many, and where the gaze was then.
using Lapse = std::function<std::optional<glm::dvec2>(int sample, const glm::dvec2& target)>;

TEST(FitGazeMapping, ALapseAtTwoTargetsCostsNoCalibration) {
  constexpr int kSamples = 60;
  const glm::dvec2 elsewhere(12.0, 8.4);
  const struct {
    const char* what;
    bool is_named;  // the target tells nothing; else the fit uses its good samples
    Lapse gaze;
  } lapses[] = {
      {"looked at another target", true, [&](int, const glm::dvec2&) { return elsewhere; }},
      {"came late", true,
       [&](int i, const glm::dvec2& target) { return i < 36 ? elsewhere : target; }},
      {"looked to and fro", true,
       [&](int i, const glm::dvec2& target) { return i % 2 ? elsewhere : target; }},
      {"blinked", false,
       [&](int i, const glm::dvec2& target) {
         const bool lid = (10 <= i && i < 15) || (45 <= i && i < 50);
         if (15 <= i && i < 45) return std::optional<glm::dvec2>();
         return std::optional(lid ? target - glm::dvec2(0.0, 10.0) : target);
       }},
      {"closed the eyes", false, [&](int, const glm::dvec2&) { return std::nullopt; }},
  };
  std::mt19937_64 random(15);
  std::normal_distribution<double> gauss;
  const auto targets = targetGrid(3, 12.0);
  for (const auto& [what, is_named, gaze] : lapses) {
    double sum_deg = 0.0;
    for (int person = 0; person < 10; ++person) {
      SimulatedUser user = curvedUser(random);
      user.noise_deg = 0.3;
      user.target_sd_deg = 0.2;
      auto pairs = recordUser(user, targets, kSamples, random);
      const std::size_t bad[] = {static_cast<std::size_t>(person) % 4,
                                 4 + static_cast<std::size_t>(person) % 4};
      for (const std::size_t target : bad) {
        for (int i = 0; i < kSamples; ++i) {
          auto& pair = pairs[target * kSamples + static_cast<std::size_t>(i)];
          pair.gaze = gaze(i, targets[target]);
          const glm::dvec2 noise = user.noise_deg * glm::dvec2{gauss(random), gauss(random)};
          if (pair.gaze) pair.gaze = user.tracked(*pair.gaze + noise);
        }
      }
      const GazeFit fit = fitGazeMap(pairs, kDegrees);
      sum_deg += mapError_deg(user, fit.map);
      for (const std::size_t target : bad) {
        const bool named =
            std::find(fit.refused.begin(), fit.refused.end(), targets[target]) != fit.refused.end();
        EXPECT_EQ(named, is_named) << what << ", person " << person << ", target " << target;
      }
      // Its own samples tell the error of the map, not how far away the observer looked.
      const auto kept = measureAccuracy(keptPairs(pairs, fit), kDegrees, &fit.map);
      EXPECT_LT(*kept.overall.accuracy_deg, 1.5) << what << ", person " << person;
    }
    EXPECT_LT(sum_deg / 10.0, 0.7) << what;
  }
}

TEST(FitGazeMapping, DoesNotMindLostOrShuffledSamples) {
  std::mt19937_64 random(12);
  SimulatedUser user;
  user.noise_deg = 0.2;
  auto pairs = recordUser(user, targetGrid(3, 12.0), 40, random);
  for (std::size_t i = 0; i < pairs.size(); i += 3) pairs[i].gaze.reset();
  const GazeFit in_order = fitGazeMap(pairs, kDegrees);
  std::shuffle(pairs.begin(), pairs.end(), random);
  const GazeFit shuffled = fitGazeMap(pairs, kDegrees);
  EXPECT_LT(mapError_deg(user, in_order.map), 0.2);
  for (std::size_t k = 0; k < kMaxTerms; ++k) {
    EXPECT_NEAR(shuffled.map.coefficients[k].x, in_order.map.coefficients[k].x, 1e-6);
  }
}

TEST(DriftCorrection, MovesTheMapOntoTheTargetAndRefusesALargeOne) {
  std::mt19937_64 random(13);
  const SimulatedUser user;
  const GazeMap map = fitGazeMap(recordUser(user, targetGrid(3, 12.0), 10, random), kDegrees).map;
  const std::vector<glm::dvec2> drifted(20, user.tracked({1.5, -0.7}));
  const GazeMap corrected = correctDrift(map, drifted, {0.0, 0.0});
  EXPECT_LT(glm::length(estimateGaze(corrected, drifted[0]).point), kSolver_deg);
  EXPECT_THROW(correctDrift(map, drifted, {8.0, 0.0}), InputError);
  EXPECT_THROW(correctDrift(map, std::span(drifted).first(4), {0.0, 0.0}), InputError);
}

TEST(DriftCorrection, RefusesSamplesFarApart) {
  std::mt19937_64 random(14);
  SimulatedUser user;
  user.noise_deg = 0.2;
  const GazeMap map = fitGazeMap(recordUser(user, targetGrid(3, 12.0), 10, random), kDegrees).map;
  std::vector<glm::dvec2> gaze;
  for (const GazePair& pair : recordUser(user, {{0.0, 0.0}}, 100, random)) {
    gaze.push_back(*pair.gaze);
  }
  EXPECT_NO_THROW(correctDrift(map, gaze, {0.0, 0.0}));
  for (const std::size_t elsewhere : {40u, 50u, 60u}) {
    auto both = gaze;
    for (std::size_t i = 0; i < elsewhere; ++i) both[i] += user.tracked({4.0, 0.0});
    EXPECT_THROW(correctDrift(map, both, {0.0, 0.0}), InputError) << elsewhere;
  }
}

TEST(DriftCorrection, SparesNoisySamples) {
  std::mt19937_64 random(15);
  const SimulatedUser steady;
  // One sample for each target, as of means: the map knows no scatter.
  const GazeMap map = fitGazeMap(recordUser(steady, targetGrid(3, 12.0), 1, random), kDegrees).map;
  SimulatedUser user;
  for (const double noise_deg : {0.75, 1.0, 2.0}) {
    user.noise_deg = noise_deg;
    const std::vector<glm::dvec2> gaze =
        transformed(recordUser(user, {{0.0, 0.0}}, 200, random),
                    [](const GazePair& pair) { return *pair.gaze; });
    EXPECT_NO_THROW(correctDrift(map, gaze, {0.0, 0.0})) << noise_deg;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
