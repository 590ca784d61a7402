// STL, binary: a header of 80 bytes, a count, and 50 bytes for each triangle, which end with a
// colour of 15 bits below a mark. Usually the mark says that there is a colour, red in the high
// bits. In files of Materialise Magics, which have COLOR= and red, green, blue, alpha in the
// header, the mark says that this colour holds, and red is in the low bits of the others.
#include "render/scene/io/stl_bytes.h"

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kStlHeader = 80, kStlStart = 84, kStlRecord = 50, kStlColor = 48;
constexpr unsigned kStlMark = 0x8000;
constexpr std::string_view kColorKey = "COLOR=";

}  // namespace

std::string readableStl(const std::filesystem::path& stl) {
  std::ifstream in(stl, std::ios::binary);
  std::string head(kStlStart, '\0');
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(stl, error);
  if (error || !in.read(head.data(), kStlStart)) return "";
  std::uint64_t triangles = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    triangles |= std::uint64_t{static_cast<unsigned char>(head[kStlHeader + i])} << (8 * i);
  }
  const std::uint64_t stated = kStlStart + kStlRecord * triangles;
  if (!head.starts_with("solid") && !head.starts_with("SOLID") && size < stated) {
    throw InputError(stl.string(), "is cut off: states " +
                                       thousands(static_cast<double>(triangles)) +
                                       " triangles in " + thousands(static_cast<double>(stated)) +
                                       " bytes, and has " + thousands(static_cast<double>(size)));
  }
  const std::size_t color = std::string_view(head).find(kColorKey);
  if (size != stated || color > kStlHeader - kColorKey.size() - 3) return "";
  in.seekg(0);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  const auto byteAt = [&](std::size_t at) {
    return unsigned{static_cast<unsigned char>(bytes[at])};
  };
  const std::size_t rgb = color + kColorKey.size();
  const auto fiveBits = [&](std::size_t channel) {
    return (byteAt(rgb + channel) * 31 + 127) / 255;
  };
  const unsigned of_object = fiveBits(0) << 10 | fiveBits(1) << 5 | fiveBits(2);
  for (std::size_t at = kStlStart + kStlColor; at + 1 < bytes.size(); at += kStlRecord) {
    const unsigned stored = byteAt(at) | byteAt(at + 1) << 8;
    if (stored == 0) continue;
    const unsigned own = (stored & 31) << 10 | (stored & 31 << 5) | (stored >> 10 & 31);
    const unsigned shown = kStlMark | ((stored & kStlMark) != 0 ? of_object : own);
    bytes[at] = static_cast<char>(shown & 255);
    bytes[at + 1] = static_cast<char>(shown >> 8);
  }
  bytes.replace(color, kColorKey.size(), kColorKey.size(), ' ');
  return bytes;
}

}  // namespace foci
