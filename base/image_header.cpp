// PNG (W3C, 2003), JPEG (ITU-T T.81, Annex B), BMP (BITMAPINFOHEADER), WebP (RFC 9649), TIFF 6.0.
#include "base/image_header.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "base/mapped_file.h"

namespace foci {
namespace {

using Bytes = std::span<const unsigned char>;

bool hasText(Bytes bytes, std::size_t at, std::string_view text) {
  if (bytes.size() < at + text.size()) return false;
  return std::string_view(reinterpret_cast<const char*>(bytes.data()) + at, text.size()) == text;
}

std::uint64_t big(Bytes bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | bytes[at + i];
  return value;
}

std::uint64_t little(Bytes bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i > 0; --i) value = value << 8 | bytes[at + i - 1];
  return value;
}

/// Walks over the segments to the frame header: SOF0 to SOF15 without DHT, JPG and DAC.
std::optional<ImageSize> jpegSize(Bytes bytes) {
  for (std::size_t at = 2; at + 9 <= bytes.size();) {
    if (bytes[at] != 0xff) return std::nullopt;
    const unsigned char marker = bytes[at + 1];
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    const bool frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) return ImageSize{big(bytes, at + 7, 2), big(bytes, at + 5, 2)};
    at += 2 + static_cast<std::size_t>(big(bytes, at + 2, 2));
  }
  return std::nullopt;
}

std::optional<ImageSize> bmpSize(Bytes bytes) {
  if (bytes.size() < 26 || little(bytes, 14, 4) < 40) return std::nullopt;
  // A negative number of rows: the first one is on top.
  const auto rows = static_cast<std::int32_t>(little(bytes, 22, 4));
  return ImageSize{little(bytes, 18, 4), static_cast<std::uint64_t>(std::abs(std::int64_t{rows}))};
}

std::optional<ImageSize> webpSize(Bytes bytes) {
  if (bytes.size() < 30) return std::nullopt;
  if (hasText(bytes, 12, "VP8X"))
    return ImageSize{little(bytes, 24, 3) + 1, little(bytes, 27, 3) + 1};
  if (hasText(bytes, 12, "VP8 ")) {
    return ImageSize{little(bytes, 26, 2) & 0x3fff, little(bytes, 28, 2) & 0x3fff};
  }
  if (!hasText(bytes, 12, "VP8L")) return std::nullopt;
  const std::uint64_t bits = little(bytes, 21, 4);
  return ImageSize{(bits & 0x3fff) + 1, (bits >> 14 & 0x3fff) + 1};
}

/// Of the first directory.
std::optional<ImageSize> tiffSize(Bytes bytes) {
  constexpr std::uint64_t kColumns = 256, kRows = 257, kShort = 3;
  const auto number = [&](std::size_t at, std::size_t count) {
    return bytes[0] == 'I' ? little(bytes, at, count) : big(bytes, at, count);
  };
  if (bytes.size() < 8) return std::nullopt;
  const std::size_t begin = number(4, 4);
  if (begin + 2 > bytes.size()) return std::nullopt;
  ImageSize size;
  const std::size_t end = begin + 2 + 12 * number(begin, 2);
  for (std::size_t at = begin + 2; at + 12 <= std::min(end, bytes.size()); at += 12) {
    const std::uint64_t value = number(at + 8, number(at + 2, 2) == kShort ? 2 : 4);
    if (number(at, 2) == kColumns) size.columns = value;
    if (number(at, 2) == kRows) size.rows = value;
  }
  return size.columns > 0 && size.rows > 0 ? std::optional(size) : std::nullopt;
}

}  // namespace

std::optional<ImageSize> statedImageSize(Bytes bytes) {
  if (hasText(bytes, 0, "\x89PNG\r\n\x1a\n")) {
    if (bytes.size() < 24) return std::nullopt;
    return ImageSize{big(bytes, 16, 4), big(bytes, 20, 4)};
  }
  if (hasText(bytes, 0, "\xff\xd8")) return jpegSize(bytes);
  if (hasText(bytes, 0, "BM")) return bmpSize(bytes);
  if (hasText(bytes, 0, "RIFF") && hasText(bytes, 8, "WEBP")) return webpSize(bytes);
  if (hasText(bytes, 0, "II*") || hasText(bytes, 0, {"MM\0*", 4})) return tiffSize(bytes);
  return std::nullopt;
}

void requireWholeImage(const std::filesystem::path& file) {
  const MappedFile mapped(file);
  const std::string_view text(reinterpret_cast<const char*>(mapped.bytes().data()),
                              mapped.bytes().size());
  // The end of the image follows its last scan. The data of a scan hold neither marker.
  const auto last = [&](std::string_view marker) { return text.rfind(marker) + 1; };
  if (text.starts_with("\xff\xd8") && last("\xff\xd9") <= last("\xff\xda")) {
    throw InputError(file.string(), "a JPEG that is cut off: its end is missing");
  }
  const auto size = statedImageSize(mapped.bytes());
  if (!size || size->columns == 0 || size->rows <= kMaxImagePixels / size->columns) return;
  throw InputError(file.string(), std::to_string(size->columns) + "x" + std::to_string(size->rows) +
                                      " px: expected at most " + std::to_string(kMaxImagePixels) +
                                      " px in all");
}

}  // namespace foci
