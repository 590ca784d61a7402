#include "render/normalisation/weights.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "base/parallel.h"
#include "render/normalisation/kernel_overlap.h"

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
constexpr float kReserve = 1.06f;     // where curved kernels ripple: below 0.9 the background shows
constexpr int kMeanPasses = 3;        // over the neighbours
constexpr float kCurved = 0.9f, kFlat = 0.98f;  // mean cosines of the neighbours' normals
constexpr float kFacing = 0.995f;  // cosine from which a kernel is not foreshortened: 1 % at most
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
        next_(sigma_m.size()),
        weight_(sigma_m.size()),
        target_(sigma_m.size(), 1.0f) {
    parallelFor(count(), [&](std::size_t i) { weight_[i] = initialWeight(i); });
  }

  /// Sets the targets to local means of the sums that the weights have now, and to one where the
  /// surface is flat.
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
    iterate([&](std::size_t i) { return atBorder(i) ? target_[i] : renderedAt(i, pixel2); });
  }

  /// @param given_m  sigma before the first step
  void stepSigmas(const std::vector<float>& given_m) {
    parallelFor(count(), [&](std::size_t i) {
      next_[i] = sigma_m_[i];
      if (atBorder(i)) return;
      const float step = std::clamp(kStep * sumsAt(i).gradient, -kLargestStep, kLargestStep);
      const float v = sigma_m_[i] * sigma_m_[i] * std::exp(-step);
      const float given = given_m[i] * given_m[i];
      next_[i] = std::sqrt(std::clamp(v, given / kMaxGrowth, given * kMaxGrowth));
    });
    sigma_m_.swap(next_);
  }

  std::vector<float> take() { return std::move(weight_); }

 private:
  std::size_t count() const { return sigma_m_.size(); }
  float maxWeight(std::size_t i) const { return glm::two_pi<float>() * sigma_m_[i] * sigma_m_[i]; }
  float initialWeight(std::size_t i) const {
    return std::min(problem_.spacing_m[i] * problem_.spacing_m[i], maxWeight(i));
  }

  template <typename Covered>
  void aimAtMeansOf(const Covered& covered) {
    parallelFor(count(), [&](std::size_t i) { target_[i] = covered(i); });
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
      if (!atBorder(i)) target_[i] = glm::mix(kReserve * target_[i], 1.0f, flatness(i));
    });
  }

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
      next_[i] = std::clamp(weight_[i] * target_[i] / covered(i), kMinWeight * initialWeight(i),
                            maxWeight(i));
    });
    weight_.swap(next_);
  }

  template <typename Body>
  void forSheet(std::size_t i, const Body& body) const {
    std::uint64_t bits = problem_.sheet[i];
    for (const std::uint32_t j : problem_.near.of(i)) {
      if ((bits & 1u) != 0) body(j);
      bits >>= 1;
    }
  }

  /// A surfel as the eye sees it along a unit vector. The variance of its kernel on the plane
  /// across the vector is `variance` (I - t t'), where t is the normal's part on that plane.
  struct Seen {
    glm::vec3 normal;
    float cosine;    ///< of the normal to the vector
    float variance;  ///< sigma^2 and the prefilter's
    float weight;    ///< foreshortened
  };
  Seen seenAlong(const glm::vec3& along, std::size_t j, float prefilter) const {
    const float cosine = glm::dot(problem_.normal[j], along);
    return {problem_.normal[j], cosine, sigma_m_[j] * sigma_m_[j] + prefilter,
            weight_[j] * std::abs(cosine)};
  }

  /// The overlap of two kernels: x' V^-1 x of their distance x, and |V|^-1/2, for the sum V of
  /// their variances.
  struct Overlap {
    float q, per_area;
  };
  /// @param d_m  from one to the other
  static Overlap overlapOf(const Seen& a, const Seen& b, const glm::vec3& along,
                           const glm::vec3& d_m) {
    const float sum = a.variance + b.variance, off_plane = glm::dot(d_m, along);
    const float x2 = std::max(glm::dot(d_m, d_m) - off_plane * off_plane, 0.0f);
    if (std::min(std::abs(a.cosine), std::abs(b.cosine)) > kFacing) return {x2 / sum, 1.0f / sum};
    const float tilt_a = 1.0f - a.cosine * a.cosine, tilt_b = 1.0f - b.cosine * b.cosine;
    const float common = glm::dot(a.normal, b.normal) - a.cosine * b.cosine;
    const float along_a = glm::dot(a.normal, d_m) - a.cosine * off_plane;
    const float along_b = glm::dot(b.normal, d_m) - b.cosine * off_plane;
    const float rest = sum - a.variance * tilt_a - b.variance * tilt_b;
    const float det = sum * rest + a.variance * b.variance * (tilt_a * tilt_b - common * common);
    const float q = rest * x2 + a.variance * along_a * along_a + b.variance * along_b * along_b;
    return {q / det, 1.0f / std::sqrt(det)};
  }

  /// Calls body(own, neighbour, overlap) for each neighbour on the sheet, and for `i` itself.
  template <typename Body>
  void forOverlaps(std::size_t i, float prefilter, const Body& body) const {
    const glm::vec3 along = problem_.seen_along[i], at_m = problem_.position_m[i];
    const Seen own = seenAlong(along, i, prefilter);
    body(own, own, overlapOf(own, own, along, glm::vec3(0.0f)));
    forSheet(i, [&](std::uint32_t j) {
      const Seen other = seenAlong(along, j, prefilter);
      body(own, other, overlapOf(own, other, along, problem_.position_m[j] - at_m));
    });
  }

  LocalSums sumsAt(std::size_t i) const {
    float sum = 0.0f, slope = 0.0f, variance_sum = 0.0f, seen = 0.0f;
    forOverlaps(i, 0.0f, [&](const Seen& own, const Seen& other, const Overlap& overlap) {
      const float variance = own.variance + other.variance;
      const float kernel = other.weight * overlap.per_area * std::exp(-0.5f * overlap.q);
      sum += kernel;
      slope += kernel * (0.5f * overlap.q - 1.0f) / variance;
      variance_sum += variance;
      seen += 1.0f;
    });
    LocalSums sums{sum / glm::two_pi<float>(), slope / glm::two_pi<float>()};
    if (problem_.near.k + 1 < count()) {
      const float variance = variance_sum / seen;
      const float q = 0.5f * problem_.near.reach_m[i] * problem_.near.reach_m[i] / variance;
      const float outside = std::exp(-q);
      sums.covered /= std::max(1.0f - outside, 0.05f);
      sums.gradient += outside > 0.0f ? q * outside / variance : 0.0f;
    }
    sums.gradient *= weight_[i];
    return sums;
  }

  /// `sumsAt` for rendered kernels, prefiltered by a pixel.
  float renderedAt(std::size_t i, float pixel2) const {
    const KernelOverlap& table = KernelOverlap::table();
    const float prefilter = pixel2 * problem_.spacing_m[i] * problem_.spacing_m[i];
    float sum = 0.0f, variance_sum = 0.0f, seen = 0.0f;
    forOverlaps(i, prefilter, [&](const Seen& own, const Seen& other, const Overlap& overlap) {
      const float ratio = std::sqrt(std::min(own.variance, other.variance) /
                                    std::max(own.variance, other.variance));
      sum += other.weight * overlap.per_area * table.of(overlap.q / 16.0f, ratio);
      variance_sum += own.variance + other.variance;
      seen += 1.0f;
    });
    if (problem_.near.k + 1 == count()) return sum;
    const float reach2 = problem_.near.reach_m[i] * problem_.near.reach_m[i];
    const float outside = table.beyond(reach2 * seen / (16.0f * variance_sum));
    return sum / std::max(1.0f - outside, 0.05f);
  }

  bool atBorder(std::size_t i) const {
    const glm::vec3& along = problem_.seen_along[i];
    glm::vec3 centroid(0.0f);
    float seen = 1.0f;
    forSheet(i, [&](std::uint32_t j) {
      const glm::vec3 d = problem_.position_m[j] - problem_.position_m[i];
      centroid += d - glm::dot(d, along) * along;
      seen += 1.0f;
    });
    // The other side of a thin body takes the place of neighbours, and is no gap.
    std::uint64_t bits = problem_.sheet[i];
    float around = 0.0f;
    for (const std::uint32_t j : problem_.near.of(i)) {
      const bool own = (bits & 1u) != 0;
      around += own || glm::dot(problem_.normal[i], problem_.normal[j]) > -kFlat ? 1.0f : 0.0f;
      bits >>= 1;
    }
    return seen < kMinSheet * around ||
           glm::length(centroid) > kBorderOffset * seen * problem_.near.reach_m[i];
  }

  const KernelProblem& problem_;
  std::vector<float>& sigma_m_;
  std::vector<float> next_, weight_;
  std::vector<float> target_;  ///< of the sums
};

}  // namespace

std::vector<float> solveKernels(const KernelProblem& problem, const KernelEffort& effort,
                                std::vector<float>& sigma_m) {
  Solver solver(problem, sigma_m);
  if (problem.near.k == 0) return solver.take();
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
    return solver.take();
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
  return solver.take();
}

}  // namespace foci
