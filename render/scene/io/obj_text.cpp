// Wavefront's OBJ: vertices, and the end of the file.
#include "render/scene/io/obj_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <glm/glm.hpp>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Empty if there is none to mend.
std::string withLeadingZeros(const std::string& text) {
  std::string mended;
  std::size_t kept = 0;
  bool vertex = false;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    const bool begins = i == 0 || text[i - 1] == '\n' || text[i - 1] == '\r';
    if (begins) vertex = text[i] == 'v';
    if (!vertex || text[i] != '.' || begins || !isBlank(text[i - 1]) || !isDigit(text[i + 1])) {
      continue;
    }
    mended.append(text, kept, i - kept);
    mended += '0';
    kept = i;
  }
  if (kept > 0) mended.append(text, kept);
  return mended;
}

/// The corners of a face, as "1/2/3" each; none for another line.
std::vector<std::string_view> cornersOf(std::string_view line) {
  std::vector<std::string_view> corners;
  line = line.substr(0, line.find('#'));
  if (nextObjWord(line) != "f") return corners;
  while (!trimmed(line).empty()) corners.push_back(nextObjWord(line));
  return corners;
}

std::size_t wordsIn(std::string_view line) {
  std::size_t words = 0;
  while (!nextObjWord(line).empty()) ++words;
  return words;
}

/// Faces in the words of Assimp: without a comment at their end, and with two corners as a line.
struct PlainFaces {
  std::string text;       ///< empty: nothing had to change
  std::size_t lines = 0;  ///< faces with two corners
};

PlainFaces withPlainFaces(const std::string& text) {
  PlainFaces plain;
  for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
    end = std::min(text.find('\n', at), text.size());
    if (text[at] != 'f' || at + 1 == end || !isBlank(text[at + 1])) continue;
    const std::string_view line = std::string_view(text).substr(at, end - at);
    if (line.find('\\') != std::string_view::npos) continue;  // goes on in the next line
    const std::size_t comment = std::min(line.find('#'), line.size());
    const bool two = wordsIn(line.substr(0, comment)) == 3;  // with the f
    if (!two && comment == line.size()) continue;
    if (plain.text.empty()) plain.text = text;
    plain.text.replace(at + comment, line.size() - comment, line.size() - comment, ' ');
    if (two) plain.text[at] = 'l';
    plain.lines += two;
  }
  return plain;
}

/// A vertex, and the part of the text that states its place.
struct ObjVertex {
  glm::dvec3 place;
  std::size_t begin, end;
};

/// The vertex of the line that begins at `at`.
std::optional<ObjVertex> objVertexAt(std::string_view text, std::size_t at) {
  if (at + 1 >= text.size() || text[at] != 'v' || !isBlank(text[at + 1])) return std::nullopt;
  ++at;
  const std::size_t begin = at;
  ObjVertex vertex{{}, begin, begin};
  for (int axis = 0; axis < 3; ++axis) {
    while (at < text.size() && isBlank(text[at])) ++at;
    const auto [end, error] =
        std::from_chars(text.data() + at, text.data() + text.size(), vertex.place[axis]);
    if (error != std::errc()) return std::nullopt;
    at = static_cast<std::size_t>(end - text.data());
    if (at < text.size() && !isBlank(text[at]) && text[at] != '\n' && text[at] != '\r') {
      return std::nullopt;  // such as a decimal comma
    }
  }
  vertex.end = at;
  return vertex;
}

/// Calls `take` with each vertex in turn.
template <class Take>
void eachObjVertex(std::string_view text, const Take& take) {
  for (std::size_t at = 0; at < text.size();) {
    if (const auto vertex = objVertexAt(text, at)) take(*vertex);
    at = std::min(text.find('\n', at), text.size() - 1) + 1;
  }
}

/// The text with vertices relative to an origin.
std::string movedText(std::string_view text, const glm::dvec3& origin) {
  std::string moved;
  moved.reserve(text.size());
  std::size_t kept = 0;
  eachObjVertex(text, [&](const ObjVertex& vertex) {
    moved.append(text, kept, vertex.begin - kept);
    for (int axis = 0; axis < 3; ++axis) {
      // Fixed, as Assimp reads no exponents of all kinds. No float far out is finer than 1e-6.
      std::array<char, 400> number{};
      const auto [end, error] =
          std::to_chars(number.data(), number.data() + number.size(),
                        vertex.place[axis] - origin[axis], std::chars_format::fixed, 6);
      moved += ' ';
      moved.append(number.data(), end);
    }
    kept = vertex.end;
  });
  moved.append(text, kept);
  return moved;
}

/// Whether a face ends within a corner: each corner has the slashes of the first.
bool endsWithinCorner(const std::vector<std::string_view>& corners) {
  const auto slashes = [](std::string_view corner) {
    return std::count(corner.begin(), corner.end(), '/');
  };
  const auto& first = corners.front();
  const auto& last = corners.back();
  return slashes(last) < slashes(first) || (last.ends_with('/') && !first.ends_with('/'));
}

/// Whether the last number of a face has fewer digits than all others of its kind, or the face has
/// fewer corners than the one before.
bool seemsShort(const std::vector<std::string_view>& face,
                const std::vector<std::string_view>& before) {
  const auto digits = [](std::string_view corner) {
    return corner.size() - (corner.rfind('/') + 1);  // of none: npos + 1 is 0
  };
  return face.size() < before.size() ||
         std::all_of(face.begin(), face.end() - 1,
                     [&](std::string_view corner) { return digits(corner) > digits(face.back()); });
}

/// Judges a last line without an end.
/// @return a remark if the line may be cut off; empty: nothing
/// @throws InputError if a face is cut off
std::string endOf(std::string_view text, const std::filesystem::path& obj) {
  if (text.empty() || text.ends_with('\n') || text.ends_with('\r')) return "";
  const std::size_t begin = text.rfind('\n') + 1;  // without a line before: npos + 1 is 0
  const std::string_view last = text.substr(begin);
  const std::vector<std::string_view> face = cornersOf(last);
  if (trimmed(last) == "f" || (!face.empty() && (face.size() < 3 || endsWithinCorner(face)))) {
    throw InputError(
        obj.string() + ":" + std::to_string(1 + std::count(text.begin(), text.end(), '\n')),
        "ends within a face, " + shown(trimmed(last)) +
            ": the file is cut off; export or copy it again");
  }
  if (face.empty() || begin == 0) return "";
  const std::string_view above = text.substr(0, begin - 1);
  if (!seemsShort(face, cornersOf(above.substr(above.rfind('\n') + 1)))) return "";
  return "the last line has no end, and its face is shorter than others, so it may be cut off: is "
         "the file complete?";
}

}  // namespace

std::string_view nextObjWord(std::string_view& rest) {
  rest = trimmed(rest);
  const std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
  rest.remove_prefix(word.size());
  return word;
}

MendedFile readableObj(const std::filesystem::path& obj) {
  std::ifstream in(obj, std::ios::binary);
  const std::string original(std::istreambuf_iterator<char>(in), {});
  MendedFile readable{.text = withLeadingZeros(original), .remarks = {}};
  if (std::string remark = endOf(original, obj); !remark.empty()) {
    readable.remarks.push_back(std::move(remark));
  }
  PlainFaces plain = withPlainFaces(readable.text.empty() ? original : readable.text);
  if (!plain.text.empty()) readable.text = std::move(plain.text);
  if (plain.lines > 0) {
    readable.remarks.push_back(thousands(static_cast<double>(plain.lines)) +
                               (plain.lines == 1 ? " face has" : " faces have") +
                               " two corners, and so no area: left out");
  }
  const std::string& text = readable.text.empty() ? original : readable.text;
  std::vector<glm::vec3> places;
  std::optional<glm::dvec3> first;
  eachObjVertex(text, [&](const ObjVertex& vertex) {
    if (!isNearEnough(vertex.place)) return;
    if (!first) first = vertex.place;
    places.emplace_back(vertex.place);
  });
  if (!first || !losesDetail(places)) return readable;
  const glm::dvec3 origin = originNear(*first);
  if (const auto remark = originRemark(origin)) {
    readable.text = movedText(text, origin);
    readable.remarks.push_back(*remark);
  }
  return readable;
}

}  // namespace foci
