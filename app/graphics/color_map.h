// Colour maps whose steps look equal: inferno and viridis (van der Walt and Smith 2015), cividis
// (Nunez, Anderton and Renslow 2018), and grey.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string>

namespace foci {

enum class ColorMap { inferno, viridis, cividis, grey };

/// The names, in the order of `ColorMap`.
inline constexpr std::array<const char*, 4> kColorMaps{"inferno", "viridis", "cividis", "grey"};

/// The colour at a share, 0 to 1 from dark to bright: sRGB codes over 255.
glm::vec3 colorAt(ColorMap map, float share);

/// "#rrggbb" of sRGB codes over 255.
std::string hexOf(const glm::vec3& code);

/// How heat covers a grey ground: little heat lets it show. The scale begins above the map's dark
/// end, which looks like a dim scene.
/// @param share  of the scale's end; 0: only ground
/// @param grey   of the ground, sRGB code over 255
glm::vec3 heatAt(ColorMap map, float share, float grey);

}  // namespace foci
