// What the hierarchy of sweep-lod costs as the scene grows: the plane with ten times the surfels,
// seen in the same view.
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
    double bytes_per_surfel = 0.0;  ///< besides the scene's own
    std::array<double, kApertures> ms_median{};
  };
  Size before, after;

  /// The largest over the apertures of time after over time before.
  double frameTime() const;
};

inline constexpr int kGrowthRuns = 5;

/// Planes of about a tenth of `surfels` and about as many, `sweep-lod` on both.
/// @param on_frame  called after every frame
Growth measureGrowth(std::size_t surfels, const std::function<void()>& on_frame);

}  // namespace foci
