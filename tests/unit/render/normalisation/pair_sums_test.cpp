#include "render/normalisation/pair_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

namespace foci {
namespace FOCI_FILE {

/// The variance of a kernel on the plane across the z axis.
glm::dmat2 varianceOf(const PairSurfel& surfel) {
  const glm::dvec2 t(surfel.normal);
  return double{surfel.variance_m2} * (glm::dmat2(1.0) - glm::outerProduct(t, t));
}

/// Surfels in reach of each other, of all directions and of a few sizes.
std::vector<PairSurfel> anySurfels(std::size_t count, bool facing) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> side(-1.0f, 1.0f), size(0.2f, 0.5f);
  std::vector<PairSurfel> surfels(count);
  for (PairSurfel& surfel : surfels) {
    const float tilt = facing ? 0.05f : 1.0f;
    surfel = {glm::vec3(side(random), side(random), side(random)), size(random),
              glm::normalize(glm::vec3(tilt * side(random), tilt * side(random), 1.0f)),
              size(random)};
  }
  return surfels;
}

/// Near ones first.
std::vector<std::uint32_t> othersOf(const std::vector<PairSurfel>& surfels) {
  std::vector<std::uint32_t> others(surfels.size() - 1);
  std::iota(others.begin(), others.end(), 1u);
  std::ranges::sort(others, {}, [&](std::uint32_t j) {
    return glm::distance(surfels[j].position_m, surfels[0].position_m);
  });
  return others;
}

/// A bit for each neighbour.
std::uint64_t allOf(const std::vector<std::uint32_t>& near) {
  return (std::uint64_t{1} << near.size()) - 1;
}

TEST(PairSums, OfGaussiansAreThoseOfTheirProjections) {
  const glm::vec3 along(0.0f, 0.0f, 1.0f);
  for (const bool facing : {false, true}) {
    const std::vector<PairSurfel> surfels = anySurfels(60, facing);
    const std::vector<std::uint32_t> near = othersOf(surfels);
    for (const std::uint64_t sheet :
         {std::uint64_t{0x0}, std::uint64_t{0x1}, std::uint64_t{0x05a5a5a5a5a5a5a}, allOf(near)}) {
      double covered = 0.0, variance = 0.0, pairs = 0.0;
      const auto add = [&](const PairSurfel& other) {
        const glm::dmat2 sum = varianceOf(surfels[0]) + varianceOf(other);
        const glm::dvec2 x(other.position_m - surfels[0].position_m);
        covered += double{other.weight_m2} * std::abs(double{other.normal.z}) *
                   std::exp(-0.5 * glm::dot(x, glm::inverse(sum) * x)) /
                   (2.0 * std::numbers::pi * std::sqrt(glm::determinant(sum)));
        variance += double{surfels[0].variance_m2} + double{other.variance_m2};
        pairs += 1.0;
      };
      add(surfels[0]);
      for (std::size_t b = 0; b < near.size(); ++b) {
        if ((sheet >> b & 1u) != 0) add(surfels[near[b]]);
      }
      const PairSums sums = gaussianPairs({surfels, 0, along, near, sheet});
      EXPECT_EQ(sums.pairs, pairs);
      EXPECT_NEAR(sums.variance_m2, variance, 1e-5 * variance);
      // Kernels that face the eye within 6 degrees count as facing it.
      EXPECT_NEAR(sums.covered, covered, (facing ? 5e-3 : 1e-4) * covered) << facing << sheet;
    }
  }
}

TEST(PairSums, SlopeIsTheDerivativeOfTheSums) {
  const glm::vec3 along(0.0f, 0.0f, 1.0f);
  std::vector<PairSurfel> surfels = anySurfels(20, true);
  for (PairSurfel& surfel : surfels) surfel.normal = along;
  const std::vector<std::uint32_t> near = othersOf(surfels);
  const auto sumsAt = [&](float more) {
    std::vector<PairSurfel> wider = surfels;
    for (PairSurfel& surfel : wider) surfel.variance_m2 += 0.5f * more;
    return gaussianPairs({wider, 0, along, near, allOf(near)});
  };
  constexpr float kStep = 0.01f;
  EXPECT_NEAR(sumsAt(0.0f).slope_per_v,
              (sumsAt(kStep).covered - sumsAt(-kStep).covered) / (2.0f * kStep), 1e-3);
}

TEST(PairSums, EndWhereNeighboursAreFar) {
  std::vector<PairSurfel> surfels = anySurfels(60, false);
  const auto alone = surfels[0];
  for (std::size_t i = 1; i < surfels.size(); ++i) surfels[i].position_m += glm::vec3(1e4f, 0, 0);
  const std::vector<std::uint32_t> near = othersOf(surfels);
  const PairsOf pairs{surfels, 0, {0.0f, 0.0f, 1.0f}, near, allOf(near)};
  EXPECT_LT(gaussianPairs(pairs).pairs, 60.0f);
  EXPECT_FLOAT_EQ(gaussianPairs(pairs).covered,
                  alone.weight_m2 / (4.0f * std::numbers::pi_v<float> * alone.variance_m2));
  EXPECT_FLOAT_EQ(
      renderedPairs(pairs, 0.0f).covered,
      9.0f / (20.0f * std::numbers::pi_v<float>)*alone.weight_m2 / (2.0f * alone.variance_m2));
}

}  // namespace FOCI_FILE
}  // namespace foci
