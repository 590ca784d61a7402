#include "render/normalisation/weights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <span>
#include <utility>

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
constexpr float kOverlapSteps = 65535.0f;       // to a surfel's largest overlap, in two bytes
constexpr float kCurved = 0.9f, kFlat = 0.98f;  // mean cosines of the neighbours' normals
constexpr float kBorderOffset = 0.3f;  // share of the reach; a half-disc's centroid lies at 0.42

class Solver {
 public:
  Solver(const KernelProblem& problem, std::vector<float>& sigma_m)
      : problem_(problem),
        sigma_m_(sigma_m),
        surfel_(sigma_m.size()),
        weight_m2_(sigma_m.size()),
        next_(sigma_m.size()),
        target_(sigma_m.size(), 1.0f),
        row_((problem.near.k + kPairBlock - 1) / kPairBlock * kPairBlock),
        overlaps_(sigma_m.size()),
        of_neighbours_(sigma_m.size() * row_) {
    parallelFor(count(), [&](std::size_t i) {
      weight_m2_[i] = initialWeight(i);
      surfel_[i] = {problem_.position_m[i], sigma_m_[i] * sigma_m_[i], problem_.normal[i], 0.0f};
    });
  }

  /// Before targets, sizes or rendered weights, which leave borders as they are.
  void findBorders() {
    at_border_.resize(count());
    parallelFor(count(), [&](std::size_t i) { at_border_[i] = isAtBorder(i); });
  }

  /// Takes the kernels as Gaussians of the sizes that they have now.
  void measureGaussians() {
    measure([&](std::size_t i, float* each) {
      const PairSums pairs = gaussianPairs(pairsOf(i), each);
      Measured measured{pairs, 0.0f, pairs.slope_per_v};
      if (!isAll()) {
        const float variance = pairs.variance_m2 / pairs.pairs;
        const float q = 0.5f * problem_.near.reach_m[i] * problem_.near.reach_m[i] / variance;
        measured.beyond = std::exp(-q);
        measured.slope_per_v += measured.beyond > 0.0f ? q * measured.beyond / variance : 0.0f;
      }
      return measured;
    });
  }

  /// Takes the kernels as they are rendered.
  /// @param pixel2  squared side of the prefilter's pixel over spacing^2
  void measureRendered(float pixel2) {
    measure([&](std::size_t i, float* each) {
      const float prefilter_m2 = pixel2 * problem_.spacing_m[i] * problem_.spacing_m[i];
      const PairSums pairs = renderedPairs(pairsOf(i), prefilter_m2, each);
      const float reach2 = problem_.near.reach_m[i] * problem_.near.reach_m[i];
      const float q = reach2 * pairs.pairs / (16.0f * pairs.variance_m2);
      return Measured{pairs, isAll() ? 0.0f : KernelOverlap::table().beyond(q), 0.0f};
    });
  }

  /// Sets the targets to local means of the sums that the weights have now, to one where the
  /// surface is flat, and at a border to what the surface covers.
  void aimAtMeans() {
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

  enum class Borders { solved, kept };

  /// For the kernels as last measured. A pixel at a border is covered in part, as it should be,
  /// where borders are kept.
  void iterateWeights(Borders borders) {
    parallelFor(count(), [&](std::size_t i) {
      const bool kept = borders == Borders::kept && at_border_[i] != 0;
      const float ratio = kept ? 1.0f : target_[i] / covered(i);
      next_[i] = std::clamp(weight_m2_[i] * ratio, kMinWeight * initialWeight(i), maxWeight(i));
    });
    weight_m2_.swap(next_);
  }

  /// By the gradient of the Gaussians as last measured.
  /// @param given_m  sigma before the first step
  void stepSigmas(const std::vector<float>& given_m) {
    parallelFor(count(), [&](std::size_t i) {
      if (at_border_[i] != 0) return;
      const float step = std::clamp(kStep * overlaps_[i].gradient, -kLargestStep, kLargestStep);
      const float v = sigma_m_[i] * sigma_m_[i] * std::exp(-step);
      const float given = given_m[i] * given_m[i];
      surfel_[i].variance_m2 = std::clamp(v, given / kMaxGrowth, given * kMaxGrowth);
      sigma_m_[i] = std::sqrt(surfel_[i].variance_m2);
    });
  }

  std::vector<float> weights() && { return std::move(weight_m2_); }

 private:
  /// The overlaps of a surfel with itself and its neighbours, 1/m^2.
  struct Overlaps {
    float own = 0.0f;
    float step = 0.0f;             ///< the neighbours' are multiples of it, `of_neighbours_`
    std::uint32_t neighbours = 0;  ///< that count: the first ones of its sheet
    float gradient = 0.0f;         ///< w_i sum_j w_j dK/dv, dimensionless
  };

  struct Measured {
    PairSums pairs;
    float beyond;  ///< share of the sum that lies beyond the neighbours
    float slope_per_v;
  };

  std::size_t count() const { return sigma_m_.size(); }
  /// Whether a surfel's neighbours are all others.
  bool isAll() const { return problem_.near.k + 1 == count(); }
  float maxWeight(std::size_t i) const { return glm::two_pi<float>() * sigma_m_[i] * sigma_m_[i]; }
  float initialWeight(std::size_t i) const {
    return std::min(problem_.spacing_m[i] * problem_.spacing_m[i], maxWeight(i));
  }

  /// @param pairs  (surfel, K of each neighbour) -> Measured
  template <typename Pairs>
  void measure(const Pairs& pairs) {
    parallelFor(count(), [&](std::size_t i) { surfel_[i].weight_m2 = weight_m2_[i]; });
    parallelFor(count(), [&](std::size_t i) {
      std::array<float, kMaxNeighbours> each;
      const Measured measured = pairs(i, each.data());
      const auto neighbours = static_cast<std::uint32_t>(measured.pairs.pairs) - 1;
      const float of_sum = 1.0f / std::max(1.0f - measured.beyond, 0.05f);
      const float largest =
          neighbours == 0 ? 0.0f : *std::max_element(each.begin(), each.begin() + neighbours);
      const bool counts = largest > kOverlapSteps / std::numeric_limits<float>::max();
      const float steps = counts ? kOverlapSteps / largest : 0.0f;
      std::transform(
          each.begin(), each.begin() + neighbours, &of_neighbours_[i * row_],
          [&](float k) {  // an overlap of huge or tiny kernels may be infinite, or no number
            return static_cast<std::uint16_t>(std::min(kOverlapSteps, k * steps) + 0.5f);
          });
      overlaps_[i] = {measured.pairs.own * of_sum, largest / kOverlapSteps * of_sum, neighbours,
                      weight_m2_[i] * measured.slope_per_v};
    });
  }

  /// The sum of the kernels at a surfel, > 0.
  float covered(std::size_t i) const {
    const Overlaps& overlaps = overlaps_[i];
    const std::uint16_t* each = &of_neighbours_[i * row_];
    std::uint64_t bits = problem_.sheet[i];
    const std::span<const std::uint32_t> near = problem_.near.of(i);
    const auto total = [&](const auto& nextPlace) {
      std::uint32_t n = 0;
      const auto next = [&] {
        const std::uint32_t place = nextPlace(n);
        return weight_m2_[near[place]] * each[n++];
      };
      std::array<float, 4> sums{};  // an addition waits for the one before it
      while (n + sums.size() <= overlaps.neighbours) {
        for (float& sum : sums) sum += next();
      }
      while (n < overlaps.neighbours) sums[0] += next();
      return (sums[0] + sums[1]) + (sums[2] + sums[3]);
    };
    const bool first_ones = std::countr_one(bits) >= static_cast<int>(overlaps.neighbours);
    const float sum =
        first_ones ? total([](std::uint32_t n) { return n; }) : total([&](std::uint32_t) {
          const auto place = std::countr_zero(bits);
          bits &= bits - 1;
          return static_cast<std::uint32_t>(place);
        });
    return weight_m2_[i] * overlaps.own + overlaps.step * sum;
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
  std::vector<PairSurfel> surfel_;  ///< weights as when last measured
  std::vector<float> weight_m2_, next_;
  std::vector<std::uint8_t> at_border_;
  std::vector<float> target_;  ///< of the sums
  std::size_t row_;            ///< places of a surfel's neighbours
  std::vector<Overlaps> overlaps_;
  std::vector<std::uint16_t> of_neighbours_;
};

}  // namespace

std::vector<float> solveKernels(const KernelProblem& problem, const KernelEffort& effort,
                                std::vector<float>& sigma_m) {
  Solver solver(problem, sigma_m);
  if (problem.near.k == 0) return std::move(solver).weights();
  const bool heeds_borders =
      problem.areas_known || effort.sigma_rounds > 0 || effort.rendered_iterations > 0;
  if (heeds_borders) solver.findBorders();
  const int rounds = problem.areas_known ? 0 : effort.sigma_rounds;  // an even sampling's stay
  const int total = rounds + effort.weight_iterations + effort.rendered_iterations;
  int done = 0;
  const auto tick = [&] {
    if (effort.progress) {
      effort.progress(static_cast<std::size_t>(++done), static_cast<std::size_t>(total));
    }
  };
  using Borders = Solver::Borders;
  const auto iterate = [&](int iterations, Borders borders) {
    for (int i = 0; i < iterations; ++i) {
      solver.iterateWeights(borders);
      tick();
    }
  };
  if (problem.areas_known) {  // one kind of iteration does
    const bool as_rendered = effort.rendered_iterations > 0;
    as_rendered ? solver.measureRendered(0.0f) : solver.measureGaussians();
    solver.aimAtMeans();
    as_rendered ? iterate(effort.rendered_iterations, Borders::kept)
                : iterate(effort.weight_iterations, Borders::solved);
    return std::move(solver).weights();
  }
  const std::vector<float> given_m = rounds > 0 ? sigma_m : std::vector<float>();
  if (rounds > 0) solver.measureGaussians();
  for (int round = 0; round < rounds; ++round) {
    for (int i = 0; i < kWeightsARound; ++i) solver.iterateWeights(Borders::solved);
    solver.measureGaussians();
    solver.stepSigmas(given_m);
    tick();
  }
  if (effort.weight_iterations > 0) solver.measureGaussians();
  iterate(effort.weight_iterations, Borders::solved);
  const int without_pixel = (effort.rendered_iterations + 3) / 4;
  if (effort.rendered_iterations == 0) return std::move(solver).weights();
  solver.measureRendered(0.0f);
  iterate(without_pixel, Borders::kept);
  solver.measureRendered(kPixel2);
  iterate(effort.rendered_iterations - without_pixel, Borders::kept);
  return std::move(solver).weights();
}

}  // namespace foci
