#include "render/methods/lens_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace foci {
namespace FOCI_FILE {

/// Root mean square of the error of the mean over the points, for edges at many places of the lens
/// that are as soft as `softness` lens radii.
double edgeError(const std::vector<glm::vec2>& points, double softness) {
  constexpr int kTurns = 24, kPlaces = 41, kExact = 20000;
  static const std::vector<glm::vec2> exact = [] {
    std::vector<glm::vec2> all;
    for (int i = 0; i < kExact; ++i) all.push_back(lensSample(i, kExact));
    return all;
  }();
  const auto brightness = [&](const std::vector<glm::vec2>& of, const glm::dvec2& normal,
                              double at) {
    double sum = 0.0;
    for (const glm::vec2& point : of) {
      sum += 0.5 * std::erfc((at - glm::dot(glm::dvec2(point), normal)) / softness);
    }
    return sum / static_cast<double>(of.size());
  };
  double squares = 0.0;
  for (int place = 0; place < kPlaces; ++place) {
    const double at = 2.0 * place / (kPlaces - 1) - 1.0;
    const double lens = brightness(exact, {1.0, 0.0}, at);
    for (int turn = 0; turn < kTurns; ++turn) {
      const double angle_rad = std::numbers::pi * (turn + 0.3) / kTurns;
      const double error =
          brightness(points, {std::cos(angle_rad), std::sin(angle_rad)}, at) - lens;
      squares += error * error;
    }
  }
  return std::sqrt(squares / (kTurns * kPlaces));
}

std::vector<glm::vec2> sunflower(int n) {
  // As wide as the lens: the variance of the points is 1/4 along both axes, nearly.
  std::vector<glm::vec2> points;
  for (int i = 0; i < n; ++i) points.push_back(lensSample(i, n));
  return points;
}

TEST(SubApertures, ErrLessThanASunflowersPoints) {
  constexpr double kHard = 1e-3, kSoft = 0.57;
  for (const int n : {4, 7, 13, 19, 37, 61}) {
    EXPECT_LT(edgeError(subApertureCentres(n), kHard), edgeError(sunflower(n), kHard)) << n;
    EXPECT_LT(edgeError(subApertureCentres(n), kSoft), 0.6 * edgeError(sunflower(n), kSoft)) << n;
  }
}

TEST(SubApertures, AreAsManyAsAsked) {
  for (int n = 1; n <= 256; ++n)
    EXPECT_EQ(subApertureCentres(n).size(), static_cast<std::size_t>(n));
}

}  // namespace FOCI_FILE
}  // namespace foci
