// Points spread evenly over the surface of an implicit solid. Private to the built-in scenes.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// Negative inside, positive outside, smooth; about the distance to the surface near it, metres.
using Solid = std::function<float(const glm::vec3&)>;

struct SolidBounds {
  glm::vec3 low_m, high_m;  ///< the solid lies within
  float cell_m;             ///< nothing of it is thinner than this
};

struct SolidSamples {
  std::vector<glm::vec3> position_m;
  std::vector<glm::vec3> normal;  ///< outwards, unit length
};

/// `count` points, none much closer to another than the rest. The surface is found by marching
/// tetrahedra (Doi and Koide 1991), covered by Poisson disks, and each point is brought onto the
/// surface by Newton's steps. Deterministic at any number of threads. Throws std::invalid_argument
/// where the bounds hold no surface.
SolidSamples sampleSolid(const Solid& solid, const SolidBounds& bounds, std::size_t count);

/// Unit vector along the solid's gradient, by central differences.
glm::vec3 normalOf(const Solid& solid, const glm::vec3& p);

}  // namespace foci
