// STL is text, or binary: a header of 80 bytes, a count, and 50 bytes for each triangle, which end
// with a colour of 15 bits below a mark. Usually the mark says that there is a colour, red in the
// high bits. In files of Materialise Magics, which have COLOR= and red, green, blue, alpha in the
// header, the mark says that this colour holds, and red is in the low bits of the others.
#include "render/scene/io/stl_bytes.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kStlHeader = 80, kStlStart = 84, kStlRecord = 50, kStlColor = 48;
constexpr unsigned kStlMark = 0x8000;
constexpr std::string_view kColorKey = "COLOR=";

std::string bytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool startsText(std::string_view head) {
  head = trimmed(head);
  return head.starts_with("solid") || head.starts_with("SOLID") || head.starts_with("Solid");
}

/// Removes solids without a triangle, which Assimp refuses.
/// @param text  in small letters
/// @return whether there were any beside others
bool dropEmptySolids(std::string& text) {
  std::string kept;
  std::size_t solid = std::string::npos;  // where one begins in `kept`, up to its first triangle
  bool any = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string_view line = std::string_view(text).substr(at, end - at), word = trimmed(line);
    if (word.starts_with("solid")) solid = kept.size();
    if (word.starts_with("facet")) solid = std::string::npos;
    kept += line;
    if (word.starts_with("endsolid") && solid != std::string::npos) {
      kept.resize(solid);
      any = true;
    }
    at = end;
  }
  if (!any || trimmed(kept).empty()) return false;
  text = std::move(kept);
  return true;
}

MendedFile readableText(const std::filesystem::path& stl) {
  std::string text = bytesOf(stl);
  if (text.find('\0') != std::string::npos) return {};
  const bool plain = trimmed(text).starts_with("solid");
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  MendedFile readable;
  if (text.find("endsolid") == std::string::npos) {
    // Assimp would refuse it, too, but leak.
    const std::size_t begun = text.rfind("facet normal"), ended = text.rfind("endfacet");
    if (begun != std::string::npos && (ended == std::string::npos || ended < begun)) {
      throw InputError(stl.string(),
                       "ends within a triangle: the file is cut off; export or copy it again");
    }
    readable.remarks.emplace_back("has no line endsolid, so it may be cut off: is it complete?");
  }
  const bool several = text.find("endsolid") != text.rfind("endsolid");
  if ((several && dropEmptySolids(text)) || !plain) readable.text = std::move(text);
  return readable;
}

/// Colours of triangles as programs other than Magics write them.
void mendColors(std::string& bytes, std::size_t color) {
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
}

}  // namespace

MendedFile readableStl(const std::filesystem::path& stl) {
  std::ifstream in(stl, std::ios::binary);
  std::string head(kStlStart, '\0');
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(stl, error);
  if (error) return {};
  in.read(head.data(), kStlStart);
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (head.size() < kStlStart) return startsText(head) ? readableText(stl) : MendedFile{};
  std::uint64_t triangles = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    triangles |= std::uint64_t{static_cast<unsigned char>(head[kStlHeader + i])} << (8 * i);
  }
  const std::uint64_t stated = kStlStart + kStlRecord * triangles;
  if (size != stated && startsText(head)) return readableText(stl);
  if (size < stated) {
    throw InputError(stl.string(), "is cut off: states " +
                                       thousands(static_cast<double>(triangles)) +
                                       " triangles in " + thousands(static_cast<double>(stated)) +
                                       " bytes, and has " + thousands(static_cast<double>(size)));
  }
  const std::size_t color = std::string_view(head).find(kColorKey);
  const bool colored = color <= kStlHeader - kColorKey.size() - 3;  // false for npos
  if (triangles == 0 || (size == stated && !colored)) return {};
  MendedFile readable{.text = bytesOf(stl), .remarks = {}};
  if (size > stated) {
    readable.text.resize(stated);
    readable.remarks.push_back("the last " + thousands(static_cast<double>(size - stated)) +
                               " bytes are behind the triangles that it states: left out");
  }
  if (colored) mendColors(readable.text, color);
  return readable;
}

}  // namespace foci
