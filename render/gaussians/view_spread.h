// How far the views of a tile through parts of the lens lie apart: what the error of their mean is
// judged by.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/gaussians/composite.h"

namespace foci {

/// Errors at the samples that are followed, in just-noticeable differences.
struct SampledErrors {
  static constexpr std::size_t kMost = 16;
  std::array<float, kMost> jnd{};
  std::size_t count = 0;

  std::span<const float> all() const { return {jnd.data(), count}; }
};

/// Follows a tile's sums at up to kAlong x kAlong of its samples, evenly spread.
class ViewSpread {
 public:
  static constexpr int kAlong = 4;
  static_assert(kAlong * kAlong <= SampledErrors::kMost);

  /// @param samples  of the tile along a side
  /// @param apron    of these, on each side; not followed
  void begin(int samples, int apron);

  /// Takes what the last view, of weight 1, has added to the sums.
  void add(const TileSums& sums);

  /// The standard error of the mean of the views, at least two, if they were drawn at random:
  ///   sqrt(sum |J (v - m)|^2 / (n (n - 1))),
  /// with the n views v, their mean m in linear light, and the Jacobian J of L*a*b* at m.
  SampledErrors standardErrors() const;

 private:
  std::vector<std::size_t> places_;  // in the sums
  std::vector<glm::vec3> values_;    // of the views, one after the other: linear light
  std::vector<glm::vec3> sums_;      // so far
};

}  // namespace foci
