// The cost of the hierarchy of `sweep-lod` as a scene grows: the same view of the plane, with ten
// times the surfels.
#pragma once

#include <array>
#include <cstddef>
#include <functional>

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

}  // namespace foci
