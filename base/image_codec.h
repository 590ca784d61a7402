// PNG and JPEG files in memory, the reading of WebP and Targa, and the size of an image from its
// header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace foci {

struct ImageSize {
  std::uint64_t columns = 0, rows = 0;
};

/// The size that a PNG, JPEG, BMP, WebP or TIFF file states. A decoder takes memory for it before
/// it meets the end of a file that is too short. Absent for other formats and broken headers.
std::optional<ImageSize> statedImageSize(std::span<const unsigned char> bytes);

/// Of an image that foci decodes.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 26;

/// Refuses an image that states more, and a JPEG without its end: a decoder would only warn, and
/// fill the rest with grey. @throws InputError
void requireWholeImage(const std::filesystem::path& file);

/// 8 bits a channel, R, G, B and alpha (255 if the file has none), in rows from the top.
struct DecodedImage {
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> rgba{};

  std::size_t total() const { return static_cast<std::size_t>(columns) * rows; }
};

/// Decodes a PNG (16 bits are rounded to 8, gamma and colour profile do not count), a Targa, a
/// JPEG or a WebP. The last two only where foci was built with them.
/// @return nothing for another format, broken bytes, or an image of more than `max_pixels`
std::optional<DecodedImage> decodeImage(std::span<const unsigned char> bytes,
                                        std::uint64_t max_pixels = kMaxImagePixels);

/// Decodes a Truevision TGA (version 2.0, 1991): grey, RGB or palette pixels, packed by run lengths
/// or not. Alpha counts only where the header states its bits. The format has no first bytes of its
/// own: a header that it does not allow, or data that end early, are no Targa.
std::optional<DecodedImage> decodeTarga(std::span<const unsigned char> bytes,
                                        std::uint64_t max_pixels = kMaxImagePixels);

/// A PNG file of 8 bits a channel.
/// @param channels  1 (grey) or 3 (RGB)
std::vector<std::uint8_t> encodePng(int columns, int rows, int channels,
                                    const std::uint8_t* pixels);

/// A JPEG file of RGB.
/// @param quality  1 to 100
/// @throws std::runtime_error where foci was built without JPEG
std::vector<std::uint8_t> encodeJpeg(int columns, int rows, const std::uint8_t* rgb, int quality);

}  // namespace foci
