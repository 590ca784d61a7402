// Spreads points evenly over the surface of an implicit solid. Private to the built-in scenes.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// A smooth function, negative inside and positive outside the solid. Near the surface its value is
/// about the distance to the surface, metres.
using Solid = std::function<float(const glm::vec3&)>;

struct SolidBounds {
  glm::vec3 low_m, high_m;  ///< the solid lies within
  float cell_m;             ///< smaller than the solid's thinnest part
};

struct SolidSamples {
  std::vector<glm::vec3> position_m;
  std::vector<glm::vec3> normal;  ///< outwards, unit length
};

/// Samples `count` evenly spaced points. Marching tetrahedra (Doi and Koide 1991) find the surface,
/// Poisson-disk sampling covers it, and Newton steps move each point onto it. The result does not
/// depend on the number of threads. Throws std::invalid_argument if the bounds hold no surface.
SolidSamples sampleSolid(const Solid& solid, const SolidBounds& bounds, std::size_t count);

/// Unit vector along the solid's gradient, from central differences.
glm::vec3 normalOf(const Solid& solid, const glm::vec3& p);

}  // namespace foci
