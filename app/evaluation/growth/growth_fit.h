// How a cost grows with a size: the exponent of a curve, and where the curve bends.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace foci {

/// Slopes of log cost over log size.
struct GrowthFit {
  struct Bend {
    double at, before, after;
  };
  double exponent = 0.0;  ///< of the line through all points
  std::optional<Bend> bend = {};
};

/// Lines by least squares. The bend is the inner point where two lines meet that fit best, if there
/// are at least four points and the slopes differ by more than kMinBend.
/// @param curve  (size, cost) by size, costs > 0; points of size 0 are left out. At least two sizes
///               are left (asserted)
GrowthFit fitGrowth(const std::vector<glm::dvec2>& curve);
inline constexpr double kMinBend = 0.25;  // noise bends lines by 0.1 to 0.2

/// "0.45; 0.91 up to 3.1, then 0.04". @param unit  of the size in the text
std::string growthText(const GrowthFit& fit, double unit);

/// The cost at a size, on lines through neighbours in log cost over log size, and beyond the ends.
/// @param curve  as above, without size 0
double costAt(const std::vector<glm::dvec2>& curve, double size);

}  // namespace foci
