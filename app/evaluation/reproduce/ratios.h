// The figures that the reproduction is judged by: ratios of times, and accuracy.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "app/evaluation/reproduce/measure.h"
#include "app/evaluation/reproduce/scenes.h"

namespace foci {

struct Growth {
  struct Size {
    std::size_t surfels = 0;
    double build_s = 0.0;
    double bytes_per_surfel = 0.0;  ///< without the scene itself
    std::array<double, kApertures> ms_median{};
  };
  Size before, after;

  /// Frame time after over frame time before: the max over the apertures.
  double frameTime() const;
};

inline constexpr int kGrowthRuns = 5;

/// Measures `sweep-lod` on planes of about a tenth of `surfels`, and of about `surfels`.
/// @param on_frame  called after every frame
Growth measureGrowth(std::size_t surfels, const std::function<void()>& on_frame);

/// One figure of one scene.
struct ReproduceRatio {
  std::string key;   ///< for programs
  std::string what;  ///< for people
  std::string scene;
  std::string paper;  ///< the paper's own figure; empty if the paper states none
  double value;       ///< the worst over the rows; may be infinite
  double wanted;
  bool at_most;  ///< true: `wanted` is an upper bound; false: a lower bound
  int digits;

  bool reached() const { return at_most ? value <= wanted : value >= wanted; }
};

/// The figures of one scene. Ratios of times compare medians with the same number of threads:
///   sweep-lod at the largest aperture over sweep-lod without blur,
///   paper-lod over sweep-lod at each aperture,
///   accumulate:200 over sweep-lod at the largest aperture.
/// @param rows      all rows of the scene
/// @param is_plane  true: the plane; false: the lion, which has other bounds
std::vector<ReproduceRatio> ratiosOf(const std::vector<ReproduceRow>& rows, bool is_plane);

/// The figures of a grown scene: time to build the larger hierarchy, its memory, and `frameTime`.
std::vector<ReproduceRatio> ratiosOf(const Growth& growth);

}  // namespace foci
