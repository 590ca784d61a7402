// Truevision TGA (Targa) images in memory.
#include "base/image_codec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace foci {
namespace {

using Bytes = std::span<const unsigned char>;
using Rgba = std::array<std::uint8_t, 4>;

enum Kind { palette = 1, rgb = 2, grey = 3 };
constexpr int kPacked = 8;                   // added to a kind
constexpr int kCounts = 3, kMultiplied = 4;  // types of alpha
constexpr std::size_t kHeader = 18, kMostOfPacket = 128;
constexpr int kAlphaBits = 0x0f, kFromRight = 0x10, kFromTop = 0x20,
              kInterleaved = 0x40;  // of the descriptor

std::size_t wordAt(Bytes bytes, std::size_t at) { return bytes[at] | bytes[at + 1] << 8; }

/// A stored colour, blue first: 1, 3 or 4 bytes, or 5 bits for each channel.
Rgba colorOf(Bytes from, int alpha_bits) {
  if (from.size() == 1) return {from[0], from[0], from[0], 255};
  if (from.size() == 2) {
    const auto channel = [value = wordAt(from, 0)](int shift) {
      return static_cast<std::uint8_t>(((value >> shift & 31) * 255 + 15) / 31);
    };
    const bool clear = alpha_bits == 1 && from[1] < 0x80;
    return {channel(10), channel(5), channel(0), static_cast<std::uint8_t>(clear ? 0 : 255)};
  }
  const bool has_alpha = from.size() == 4 && alpha_bits == 8;
  return {from[2], from[1], from[0], has_alpha ? from[3] : std::uint8_t{255}};
}

/// What an extension of the file says of its alpha: 3 where it counts, 4 where colours are
/// multiplied by it, less where it says nothing. 3 without an extension.
int alphaTypeOf(Bytes bytes) {
  constexpr std::string_view kSignature("TRUEVISION-XFILE.\0", 18);
  constexpr std::size_t kFooter = 26, kAlphaType = 494;
  if (bytes.size() < kFooter) return kCounts;
  const Bytes footer = bytes.last(kFooter);
  if (!std::ranges::equal(footer.subspan(8), kSignature)) return kCounts;
  const std::size_t extension = wordAt(footer, 0) | wordAt(footer, 2) << 16;
  if (extension == 0 || extension + kAlphaType >= bytes.size()) return kCounts;
  return bytes[extension + kAlphaType];
}

/// Calls `take(value)` for `count` stored values of `size` bytes, until it returns false.
/// @return whether the data suffice, and all were taken
template <typename Take>
bool forEachValue(Bytes data, bool packed, std::size_t size, std::size_t count, const Take& take) {
  while (count > 0) {
    std::size_t values = count;
    bool repeats = false;
    if (packed) {
      if (data.empty()) return false;
      repeats = data[0] >= kMostOfPacket;
      values = std::min(data[0] % kMostOfPacket + 1, count);
      data = data.subspan(1);
    }
    const std::size_t stored = repeats ? 1 : values;
    if (data.size() < stored * size) return false;
    for (std::size_t k = 0; k < values; ++k) {
      if (!take(data.subspan(repeats ? 0 : k * size, size))) return false;
    }
    data = data.subspan(stored * size);
    count -= values;
  }
  return true;
}

}  // namespace

std::optional<DecodedImage> decodeTarga(Bytes bytes, std::uint64_t max_pixels) {
  const int alpha_type = alphaTypeOf(bytes);
  if (bytes.size() < kHeader || bytes[1] > 1 || alpha_type == kMultiplied) return std::nullopt;
  const int kind = bytes[2] & ~kPacked, bits = bytes[16], descriptor = bytes[17];
  const bool has_palette = bytes[1] == 1, is_grey = kind == grey || kind == palette;
  const auto isColor = [](int of) { return of == 15 || of == 16 || of == 24 || of == 32; };
  if (kind < palette || kind > grey || descriptor >= kInterleaved ||
      (kind == palette) > has_palette || (has_palette && !isColor(bytes[7])) ||
      !(is_grey ? bits == 8 : isColor(bits))) {
    return std::nullopt;
  }
  DecodedImage image{.columns = static_cast<int>(wordAt(bytes, 12)),
                     .rows = static_cast<int>(wordAt(bytes, 14))};
  const std::size_t first_color = wordAt(bytes, 3), colors = has_palette ? wordAt(bytes, 5) : 0,
                    begin = std::min(bytes.size(), kHeader + bytes[0]);
  const bool packed = (bytes[2] & kPacked) != 0;
  const std::size_t pixels = image.total(), most = (packed ? kMostOfPacket : 1) * bytes.size();
  if (pixels == 0 || pixels > std::min<std::uint64_t>(max_pixels, most)) {
    return std::nullopt;
  }
  const int alpha_bits = alpha_type == kCounts ? descriptor & kAlphaBits : 0;
  std::vector<Rgba> palette_colors;
  const std::size_t color_size = (bytes[7] + 7u) / 8;
  const auto color = [&](Bytes value) { return colorOf(value, alpha_bits); };
  const auto addColor = [&](Bytes value) {
    palette_colors.push_back(color(value));
    return true;
  };
  if (!forEachValue(bytes.subspan(begin), false, color_size, colors, addColor)) return std::nullopt;

  image.rgba.resize(4 * pixels);
  const auto columns = static_cast<std::size_t>(image.columns);
  std::size_t i = 0;
  const auto addPixel = [&](Bytes value) {
    const std::size_t index = value[0] - first_color;
    if (kind == palette && index >= colors) return false;
    std::size_t x = i % columns, y = i / columns;
    if ((descriptor & kFromRight) != 0) x = columns - 1 - x;
    if ((descriptor & kFromTop) == 0) y = pixels / columns - 1 - y;
    std::ranges::copy(kind == palette ? palette_colors[index] : color(value),
                      &image.rgba[4 * (y * columns + x)]);
    ++i;
    return true;
  };
  const bool whole = forEachValue(bytes.subspan(begin + colors * color_size), packed,
                                  (bits + 7u) / 8, pixels, addPixel);
  return whole ? std::optional(std::move(image)) : std::nullopt;
}

}  // namespace foci
