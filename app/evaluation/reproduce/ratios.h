// The figures that the reproduction is judged by: ratios of times, distances from the reference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/reproduce/growth.h"
#include "app/evaluation/reproduce/measure.h"

namespace foci {

/// One figure, of one scene.
struct ReproduceRatio {
  std::string key;   ///< for programs
  std::string what;  ///< for people
  std::string scene;
  std::string paper;  ///< what the paper says of itself; "" where nothing
  double value;       ///< the worst over the rows concerned; infinite is possible
  double wanted;
  bool at_most;  ///< `wanted` is an upper bound, else a lower one
  int digits;

  bool reached() const { return at_most ? value <= wanted : value >= wanted; }
};

/// Of all of one scene's rows. The largest aperture is the last.
///   sweep-lod at the largest aperture over itself without blur, paper-lod over sweep-lod at the
///   same aperture and threads, accumulate:200 over sweep-lod at the largest aperture: medians.
/// @param is_plane  else the lion, of which other figures are wanted
std::vector<ReproduceRatio> ratiosOf(const std::vector<ReproduceRow>& rows, bool is_plane);

/// Of the hierarchy of the larger plane: time to build it, memory, and `frameTime`.
std::vector<ReproduceRatio> ratiosOf(const Growth& growth);

}  // namespace foci
