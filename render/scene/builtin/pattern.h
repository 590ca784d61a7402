// Procedural patterns from hashes and noise. Private to the built-in scenes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace foci {

/// 0 to 1, a function of the three integers alone (finaliser of MurmurHash3).
float hash01(std::int32_t x, std::int32_t y, std::int32_t seed);

/// Value noise with smooth interpolation, period none, feature size 1. 0 to 1.
float noise(glm::vec2 p, std::int32_t seed);

/// Noise of `octaves` scales, each half as large and half as strong (fractal noise). 0 to 1.
float fractalNoise(glm::vec2 p, int octaves, std::int32_t seed);

/// Checkerboard of unit squares: 0 or 1.
float checker(glm::vec2 p);

/// 1 within `half_width` of an integer, 0 from twice that on.
float lines(float x, float half_width);

/// Distances to the nearest and second nearest of scattered points, one in each unit square (Worley
/// 1996), and the nearest one's hash.
glm::vec3 cells(glm::vec2 p, std::int32_t seed);

/// Linear RGB of an sRGB colour written as 0xRRGGBB.
glm::vec3 srgb(std::uint32_t rgb);

}  // namespace foci
