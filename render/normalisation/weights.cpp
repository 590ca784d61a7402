#include "render/normalisation/weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>
#include <span>

#include "base/parallel.h"
#include "render/normalisation/kernel_overlap.h"
#include "render/normalisation/pair_sums.h"

namespace foci {
namespace {

// Chosen by hand; `SurfelsFromPoints` tests bound the sums that they lead to.
constexpr float kMinWeight = 0.05f;   // of spacing^2
constexpr int kWeightsARound = 3;     // iterations of the weights between steps of the sizes
constexpr float kPixel2 = 0.4f;       // squared side of a pixel over spacing^2
constexpr float kStep = 4.0f;         // of log v, against the gradient
constexpr float kLargestStep = 0.1f;  // of log v
constexpr float kMaxGrowth = 2.56f;   // of v: 1.6 of sigma
constexpr float kMinSheet = 0.5f;     // share of the neighbours; a stray or a shred is all border
constexpr float kReserve = 1.12f;     // where curved kernels ripple: below 0.9 the background shows
constexpr int kMeanPasses = 3;        // over the neighbours
constexpr float kCurved = 0.9f, kFlat = 0.98f;  // mean cosines of the neighbours' normals
constexpr float kBorderOffset = 0.3f;  // share of the reach; a half-disc's centroid lies at 0.42

/// Sums over the surfel's own sheet, the surfel included.
struct LocalSums {
  float covered = 0.0f;   ///< sum_j w_j G, > 0
  float gradient = 0.0f;  ///< w_i sum_j w_j dG/dv, dimensionless
};

class Solver {
 public:
  Solver(const KernelProblem& problem, std::vector<float>& sigma_m)
      : problem_(problem),
        sigma_m_(sigma_m),
        surfel_(sigma_m.size()),
        next_(sigma_m.size()),
        target_(sigma_m.size(), 1.0f) {
    parallelFor(count(), [&](std::size_t i) {
      surfel_[i] = {problem_.position_m[i], sigma_m_[i] * sigma_m_[i], problem_.normal[i],
                    initialWeight(i)};
    });
  }

  /// Before targets, sizes or rendered weights, which leave borders as they are.
  void findBorders() {
    at_border_.resize(count());
    parallelFor(count(), [&](std::size_t i) { at_border_[i] = isAtBorder(i); });
  }

  /// Sets the targets to local means of the sums that the weights have now, to one where the
  /// surface is flat, and at a border to what the surface covers.
  void aimAtMeans() {
    aimAtMeansOf([&](std::size_t i) { return sumsAt(i).covered; });
  }
  void aimAtMeansAsRendered() {
    aimAtMeansOf([&](std::size_t i) { return renderedAt(i, 0.0f); });
  }

  void iterateWeights() {
    iterate([&](std::size_t i) { return sumsAt(i).covered; });
  }

  /// @param pixel2  squared side of the prefilter's pixel over spacing^2
  void iterateWeightsAsRendered(float pixel2) {
    // A pixel at a border is covered in part, as it should be.
    iterate([&](std::size_t i) { return at_border_[i] != 0 ? target_[i] : renderedAt(i, pixel2); });
  }

  /// @param given_m  sigma before the first step
  void stepSigmas(const std::vector<float>& given_m) {
    parallelFor(count(), [&](std::size_t i) {
      next_[i] = sigma_m_[i];
      if (at_border_[i] != 0) return;
      const float step = std::clamp(kStep * sumsAt(i).gradient, -kLargestStep, kLargestStep);
      const float v = sigma_m_[i] * sigma_m_[i] * std::exp(-step);
      const float given = given_m[i] * given_m[i];
      next_[i] = std::sqrt(std::clamp(v, given / kMaxGrowth, given * kMaxGrowth));
    });
    sigma_m_.swap(next_);
    parallelFor(count(),
                [&](std::size_t i) { surfel_[i].variance_m2 = sigma_m_[i] * sigma_m_[i]; });
  }

  std::vector<float> weights() const {
    std::vector<float> weight_m2(count());
    std::ranges::transform(surfel_, weight_m2.begin(), &PairSurfel::weight_m2);
    return weight_m2;
  }

 private:
  std::size_t count() const { return sigma_m_.size(); }
  float maxWeight(std::size_t i) const { return glm::two_pi<float>() * sigma_m_[i] * sigma_m_[i]; }
  float initialWeight(std::size_t i) const {
    return std::min(problem_.spacing_m[i] * problem_.spacing_m[i], maxWeight(i));
  }

  template <typename Covered>
  void aimAtMeansOf(const Covered& covered) {
    parallelFor(count(), [&](std::size_t i) { target_[i] = covered(i); });
    const std::vector<float> initial = target_;
    for (int pass = 0; pass < kMeanPasses; ++pass) {
      parallelFor(count(), [&](std::size_t i) {
        float sum = target_[i], seen = 1.0f;
        forSheet(i, [&](std::uint32_t j) {
          sum += target_[j];
          seen += 1.0f;
        });
        next_[i] = sum / seen;
      });
      target_.swap(next_);
    }
    parallelFor(count(), [&](std::size_t i) {
      if (at_border_[i] == 0) {
        target_[i] = glm::mix(kReserve * target_[i], 1.0f, flatness(i));
      } else if (offCentre(i, problem_.near.of(i))) {  // nothing lies beyond, as beyond a crease
        target_[i] = coveredAtBorder(initial[i]);
      }
    });
  }

  /// What a surface covers of the kernels at a sample beside its border. `poissonDisk` leaves the
  /// samples denser there than inside, so their kernels sum to more: the power 1.5 is within 0.06
  /// of the kernel's integral over a half-plane, on the mean of samples of equal sums.
  static float coveredAtBorder(float sum) { return sum * std::min(std::sqrt(sum), 1.0f); }

  /// 1 where the normals of the neighbours agree, 0 from a mean cosine of kCurved on.
  float flatness(std::size_t i) const {
    float cosines = 0.0f, seen = 0.0f;
    for (const std::uint32_t j : problem_.near.of(i)) {
      cosines += std::abs(glm::dot(problem_.normal[i], problem_.normal[j]));
      seen += 1.0f;
    }
    return glm::smoothstep(kCurved, kFlat, cosines / std::max(seen, 1.0f));
  }

  template <typename Covered>
  void iterate(const Covered& covered) {
    parallelFor(count(), [&](std::size_t i) {
      next_[i] = std::clamp(surfel_[i].weight_m2 * target_[i] / covered(i),
                            kMinWeight * initialWeight(i), maxWeight(i));
    });
    parallelFor(count(), [&](std::size_t i) { surfel_[i].weight_m2 = next_[i]; });
  }

  template <typename Body>
  void forSheet(std::size_t i, const Body& body) const {
    std::uint64_t bits = problem_.sheet[i];
    for (const std::uint32_t j : problem_.near.of(i)) {
      if ((bits & 1u) != 0) body(j);
      bits >>= 1;
    }
  }

  PairsOf pairsOf(std::size_t i) const {
    return {surfel_, i, problem_.seen_along[i], problem_.near.of(i), problem_.sheet[i]};
  }

  LocalSums sumsAt(std::size_t i) const {
    const PairSums pairs = gaussianPairs(pairsOf(i));
    LocalSums sums{pairs.covered, pairs.slope_per_v};
    if (problem_.near.k + 1 < count()) {
      const float variance = pairs.variance_m2 / pairs.pairs;
      const float q = 0.5f * problem_.near.reach_m[i] * problem_.near.reach_m[i] / variance;
      const float outside = std::exp(-q);
      sums.covered /= std::max(1.0f - outside, 0.05f);
      sums.gradient += outside > 0.0f ? q * outside / variance : 0.0f;
    }
    sums.gradient *= surfel_[i].weight_m2;
    return sums;
  }

  /// The sum of `sumsAt` for rendered kernels, prefiltered by a pixel.
  float renderedAt(std::size_t i, float pixel2) const {
    const PairSums pairs =
        renderedPairs(pairsOf(i), pixel2 * problem_.spacing_m[i] * problem_.spacing_m[i]);
    if (problem_.near.k + 1 == count()) return pairs.covered;
    const float reach2 = problem_.near.reach_m[i] * problem_.near.reach_m[i];
    const float q = reach2 * pairs.pairs / (16.0f * pairs.variance_m2);
    return pairs.covered / std::max(1.0f - KernelOverlap::table().beyond(q), 0.05f);
  }

  /// Whether some of the neighbours, seen along the surfel's direction, lie on one side of it.
  template <typename Some>
  bool offCentre(std::size_t i, const Some& some) const {
    const glm::vec3& along = problem_.seen_along[i];
    glm::vec3 centroid(0.0f);
    float seen = 1.0f;
    for (const std::uint32_t j : some) {
      const glm::vec3 d = problem_.position_m[j] - problem_.position_m[i];
      centroid += d - glm::dot(d, along) * along;
      seen += 1.0f;
    }
    return glm::length(centroid) > kBorderOffset * seen * problem_.near.reach_m[i];
  }

  bool isAtBorder(std::size_t i) const {
    std::array<std::uint32_t, kMaxNeighbours> own{};
    std::size_t count = 0;
    forSheet(i, [&](std::uint32_t j) { own[count++] = j; });
    // The other side of a thin body takes the place of neighbours, and is no gap.
    std::uint64_t bits = problem_.sheet[i];
    float around = 0.0f;
    for (const std::uint32_t j : problem_.near.of(i)) {
      around += (bits & 1u) != 0 || glm::dot(problem_.normal[i], problem_.normal[j]) > -kFlat
                    ? 1.0f
                    : 0.0f;
      bits >>= 1;
    }
    return static_cast<float>(count + 1) < kMinSheet * around ||
           offCentre(i, std::span(own.data(), count));
  }

  const KernelProblem& problem_;
  std::vector<float>& sigma_m_;
  std::vector<PairSurfel> surfel_;
  std::vector<std::uint8_t> at_border_;
  std::vector<float> next_;
  std::vector<float> target_;  ///< of the sums
};

}  // namespace

std::vector<float> solveKernels(const KernelProblem& problem, const KernelEffort& effort,
                                std::vector<float>& sigma_m) {
  Solver solver(problem, sigma_m);
  if (problem.near.k == 0) return solver.weights();
  const bool heeds_borders =
      problem.areas_known || effort.sigma_rounds > 0 || effort.rendered_iterations > 0;
  if (heeds_borders) solver.findBorders();
  const int total = effort.sigma_rounds * (kWeightsARound + 1) + effort.weight_iterations +
                    effort.rendered_iterations;
  int done = 0;
  const auto tick = [&](int passes) {
    done += passes;
    if (effort.progress) {
      effort.progress(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
    }
  };
  if (problem.areas_known) {
    // The sampling is even already: sizes stay, and one kind of iteration does.
    const bool as_rendered = effort.rendered_iterations > 0;
    as_rendered ? solver.aimAtMeansAsRendered() : solver.aimAtMeans();
    for (int i = 0; i < effort.weight_iterations && !as_rendered; ++i) solver.iterateWeights();
    for (int i = 0; i < effort.rendered_iterations; ++i) {
      solver.iterateWeightsAsRendered(0.0f);
      tick(1);
    }
    tick(total - done);
    return solver.weights();
  }
  const std::vector<float> given_m = effort.sigma_rounds > 0 ? sigma_m : std::vector<float>();
  for (int round = 0; round < effort.sigma_rounds; ++round) {
    for (int i = 0; i < kWeightsARound; ++i) solver.iterateWeights();
    solver.stepSigmas(given_m);
    tick(kWeightsARound + 1);
  }
  for (int i = 0; i < effort.weight_iterations; ++i) {
    solver.iterateWeights();
    tick(1);
  }
  const int without_pixel = (effort.rendered_iterations + 3) / 4;
  for (int i = 0; i < effort.rendered_iterations; ++i) {
    solver.iterateWeightsAsRendered(i < without_pixel ? 0.0f : kPixel2);
    tick(1);
  }
  return solver.weights();
}

}  // namespace foci
