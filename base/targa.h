// Truevision TGA (Targa) images in memory: version 2.0 of the specification, 1991.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "base/image_codec.h"

namespace foci {

/// Decodes grey, RGB or palette pixels, packed by run lengths or not. Alpha counts only where the
/// header states its bits. The format has no first bytes of its own: a header that it does not
/// allow, or data that end early, are no Targa.
/// @return nothing for other bytes, or an image of more than `max_pixels`
std::optional<DecodedImage> decodeTarga(std::span<const unsigned char> bytes,
                                        std::uint64_t max_pixels);

}  // namespace foci
