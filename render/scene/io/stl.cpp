// STL is text, or binary: a header of 80 bytes, a count, and 50 bytes for each triangle, which end
// with a colour of 15 bits below a mark. Usually the mark says that there is a colour, red in the
// high bits. In files of Materialise Magics, which have COLOR= and red, green, blue, alpha in the
// header, the mark says that this colour holds, and red is in the low bits of the others.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/mesh_builder.h"
#include "render/scene/io/mesh_formats.h"

namespace foci {
namespace {

constexpr std::size_t kStlHeader = 80, kStlStart = 84, kStlRecord = 50, kStlColor = 48;
constexpr unsigned kStlMark = 0x8000;
constexpr std::string_view kColorKey = "COLOR=";

class StlMesh {
 public:
  explicit StlMesh(const std::filesystem::path& path)
      : path_(path),
        file_(path),
        text_(reinterpret_cast<const char*>(file_.bytes().data()), file_.bytes().size()),
        builder_(path) {}

  MeshFile read() {
    if (text_.size() >= kStlStart) {
      const std::uint64_t triangles = u32At(file_.bytes(), kStlHeader);
      const std::uint64_t stated = kStlStart + kStlRecord * triangles;
      if (text_.size() == stated || !startsText()) {
        readBinary(triangles, stated);
        return finish();
      }
    } else if (!startsText()) {
      throw InputError(path_.string(),
                       "is no STL: expected the word solid, or a header and triangles");
    }
    readText();
    return finish();
  }

 private:
  static std::string_view withoutBlanks(std::string_view text) {
    return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  }

  bool startsText() const {
    return lowered(withoutBlanks(withoutByteOrderMark(text_)).substr(0, 5)) == "solid";
  }

  void readBinary(std::uint64_t triangles, std::uint64_t stated) {
    if (text_.size() < stated) {
      throw InputError(path_.string(), "is cut off: states ",
                       thousands(static_cast<double>(triangles)), " triangles in ",
                       thousands(static_cast<double>(stated)), " bytes, and has ",
                       thousands(static_cast<double>(text_.size())));
    }
    if (text_.size() > stated) {
      builder_.remark("the last " + thousands(static_cast<double>(text_.size() - stated)) +
                      " bytes are behind the triangles that it states: left out");
    }
    const std::size_t color = text_.substr(0, kStlHeader).find(kColorKey);
    const bool magics = color <= kStlHeader - kColorKey.size() - 3;  // false for npos
    const std::size_t rgb = color + kColorKey.size();
    const auto storedAt = [&](std::uint64_t t) {
      return u16At(file_.bytes(), kStlStart + kStlRecord * t + kStlColor);
    };
    // MeshLab marks triangles that have a colour, Magics those that have none.
    bool marked_own = !magics, plain_own = false;
    for (std::uint64_t t = 0; t < triangles && magics; ++t) {
      const unsigned code = storedAt(t);
      marked_own |= code > kStlMark && code < 0xffffu;
      plain_own |= code > 0 && code < kStlMark;
    }
    const bool marks_own = marked_own && !plain_own;
    for (std::uint64_t t = 0; t < triangles; ++t) {
      const auto record = file_.bytes().subspan(kStlStart + kStlRecord * t, kStlRecord);
      const unsigned stored = storedAt(t);
      const bool marked = (stored & kStlMark) != 0;
      std::array<float, 3> srgb{};
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t place = magics ? i : 2 - i;
        srgb[i] = static_cast<float>(stored >> (5 * place) & 31u) / 31.0f;
        if (!marks_own && marked) srgb[i] = static_cast<float>(file_.bytes()[rgb + i]) / 255.0f;
      }
      const bool colored = marks_own ? marked : stored != 0;
      add({vec3At(record, 12), vec3At(record, 24), vec3At(record, 36)}, vec3At(record, 0),
          colored ? linearColor({srgb[0], srgb[1], srgb[2]}) : kPlainSurface);
    }
  }

  void add(const std::array<glm::vec3, 3>& places, const glm::vec3& normal,
           const glm::vec3& color) {
    std::array<MeshCorner, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = {.position = places[k], .normal = normal};
    }
    const auto material = colors_.materialOf(color);
    if (!material) {
      for (MeshCorner& corner : corners) corner.color = color;
    }
    builder_.add(corners, material.value_or(0));
  }

  /// The next word in small letters; empty at the end.
  std::string_view nextWord() {
    const std::string_view left = withoutBlanks(text_.substr(at_));
    at_ = text_.size() - left.size();
    const std::size_t length = std::min(left.find_first_of(" \t\r\n"), left.size());
    at_ += length;
    return word_ = lowered(left.substr(0, length));
  }

  std::string_view restOfLine() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    const std::string_view rest = trimmed(text_.substr(at_, end - at_));
    at_ = end;
    return rest;
  }

  float nextNumber() {
    const std::string_view word = nextWord();
    if (word.empty()) refuseCut();
    if (word == "nan" || word == "-nan") return std::numeric_limits<float>::quiet_NaN();
    const auto number = parseNumber(word);
    if (!number) {
      throw InputError(
          concat(path_.string(), ":", 1 + std::ranges::count(text_.substr(0, at_), '\n')),
          "expected a number, found ", shown(word));
    }
    return static_cast<float>(*number);
  }

  glm::vec3 nextVector() {
    glm::vec3 vector(0.0f);
    for (int i = 0; i < 3; ++i) vector[i] = nextNumber();
    return vector;
  }

  [[noreturn]] void refuseCut() const {
    throw InputError(path_.string(),
                     "ends within a triangle: the file is cut off; export or copy it again");
  }

  void readText() {
    if (text_.find('\0') != std::string_view::npos) {
      throw InputError(path_.string(), "begins as STL text, and has bytes that are no text");
    }
    text_ = withoutByteOrderMark(text_);
    glm::vec3 normal(0.0f);
    std::array<glm::vec3, 3> corners{};
    std::size_t count = 0;
    bool within = false, ended = false;
    for (std::string_view word = nextWord(); !word.empty(); word = nextWord()) {
      if (word == "solid") {
        builder_.useObject(builder_.addObject(std::string(restOfLine())));
      } else if (word == "endsolid") {
        restOfLine();
        ended = true;
      } else if (word == "facet") {
        within = true;
        count = 0;
        normal = nextWord() == "normal" ? nextVector() : glm::vec3(0.0f);
      } else if (word == "vertex") {
        const glm::vec3 corner = nextVector();
        if (count < corners.size()) corners[count] = corner;
        ++count;
      } else if (word == "endfacet") {
        within = false;
        if (count == corners.size()) add(corners, normal, kPlainSurface);
      }
    }
    if (within) refuseCut();
    if (!ended) builder_.remark("has no line endsolid, so it may be cut off: is it complete?");
  }

  MeshFile finish() {
    return builder_.finish({.kind = SceneKind::stl},
                           [&](std::uint32_t number) { return colors_.read(number); });
  }

  std::filesystem::path path_;
  MappedFile file_;
  std::string_view text_;
  MeshBuilder builder_;
  FaceColors colors_;
  std::size_t at_ = 0;
  std::string word_;
};

}  // namespace

MeshFile readStlMesh(const std::filesystem::path& path) { return StlMesh(path).read(); }

}  // namespace foci
