// Linear filters of images.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// What stands for a pixel beyond the edge: the edge's own, or the one as far inside.
enum class ImageBorder : std::uint8_t { replicate, reflect };

/// Convolves rows, then columns, with a symmetric kernel, in place.
/// @param kernel  from its centre outwards; not empty
void filterSeparably(std::vector<glm::vec4>& pixels, const glm::ivec2& size_px,
                     const std::vector<float>& kernel, ImageBorder border);

}  // namespace foci
