// The Geomview manual, "OFF Files".
#include "render/scene/io/point_formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/mesh_builder.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

constexpr glm::vec4 kNoColor(-1.0f);

/// What the word before "OFF" says that a vertex has besides its position.
struct OffKind {
  bool uv = false, color = false, normal = false;
};

/// The colours of the vertices, or of the faces, with alpha.
class OffColors {
 public:
  /// The colour of the next one: three or four numbers of 0 to 1 or 0 to 255 behind the first `at`
  /// of a row, or none.
  void add(const std::vector<std::string_view>& words, const std::vector<double>& row,
           std::size_t at) {
    const std::size_t count = std::min<std::size_t>(row.size() - at, 4);
    glm::vec4 color = kNoColor;
    bool usable = count >= 3, whole = true;
    for (std::size_t i = 0; i < count; ++i) {
      usable = usable && row[at + i] >= 0.0 && row[at + i] <= 255.0;
      whole = whole && words[at + i].find('.') == std::string_view::npos;
      color[static_cast<int>(i)] = static_cast<float>(row[at + i]);
    }
    ++count_;
    if (!usable) return;
    bytes_ |= whole && mostOf(color) > 1.0f;
    colors_.resize(count_, kNoColor);
    whole_.resize(count_);
    colors_.back() = color;
    whole_.back() = whole;
  }

  /// To linear light. Integers of 0 and 1 are 0 to 255 beside larger ones, and else 0 to 1.
  void linearise() {
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      glm::vec4& c = colors_[i];
      if (c.r < 0.0f) continue;
      const float white = mostOf(c) > 1.0f || (whole_[i] && bytes_) ? 255.0f : 1.0f;
      c = glm::vec4(linearColor(glm::vec3(c) / white), c.a < 0.0f ? 1.0f : c.a / white);
    }
  }

  glm::vec4 at(std::size_t i) const { return i < colors_.size() ? colors_[i] : kNoColor; }

 private:
  static float mostOf(const glm::vec4& c) { return std::max({c.r, c.g, c.b, c.a}); }

  std::size_t count_ = 0;
  std::vector<glm::vec4> colors_;  // up to the last one that has a colour
  std::vector<bool> whole_;        // written as integers
  bool bytes_ = false;             // integers above 1 are among them
};

class OffReader {
 public:
  explicit OffReader(const std::filesystem::path& path) : input_(path), builder_(path) {}

  std::variant<PointCloud, MeshFile> read() {
    if (input_.remaining() == 0) throw InputError(input_.name(), "is empty");
    readHeader();
    for (std::uint64_t i = 0; i < vertices_; ++i) readVertex();
    color_.linearise();
    if (faces_ == 0) return finishPoints();
    for (std::uint64_t i = 0; i < faces_; ++i) readFace();
    return finishMesh();
  }

 private:
  std::string where() const { return input_.name() + ":" + std::to_string(line_); }

  /// The words of the next line that has some. @throws InputError at the end of the file
  const std::vector<std::string_view>& nextWords(const char* wanted) {
    words_.clear();
    while (words_.empty()) {
      if (input_.remaining() == 0) {
        throw InputError(where(), "ends early: expected ", wanted, "; the file is cut off");
      }
      const std::string_view line = input_.line();
      ++line_;
      words_ = wordsOf(line.substr(0, line.find('#')));
    }
    return words_;
  }

  const std::vector<double>& nextRow(const char* wanted) {
    nextWords(wanted);
    row_.clear();
    for (const std::string_view word : words_) {
      const auto value = parseNumber(word);
      if (!value) {
        throw InputError(where(), "found ", shown(word), ": expected ", wanted);
      }
      row_.push_back(*value);
    }
    return row_;
  }

  /// The letters before "OFF" in their order; what follows the word is taken off it.
  void takeWord(std::string_view& word) {
    const auto take = [&](std::string_view letters) {
      const bool found = word.starts_with(letters);
      if (found) word.remove_prefix(letters.size());
      return found;
    };
    kind_.uv = take("ST");
    kind_.color = take("C");
    kind_.normal = take("N");
    const bool more = take("4") || take("n");
    if (!take("OFF")) {
      throw InputError(where(),
                       "is no OFF file: expected OFF and the numbers of vertices, faces and edges");
    }
    if (more) throw InputError(where(), "has more than three dimensions: foci shows three");
  }

  void readHeader() {
    const char* const wanted = "the numbers of vertices, faces and edges";
    std::vector<std::string_view> words = nextWords(wanted);
    if (!parseNumber(words[0])) {
      takeWord(words[0]);
      if (words[0].empty()) words.erase(words.begin());  // ModelNet writes "OFF8 6 12"
      if (!words.empty() && words[0] == "BINARY") {
        throw InputError(where(), "is a binary OFF file: save it as text, e.g. with MeshLab");
      }
      if (words.empty()) words = nextWords(wanted);
    }
    std::array<std::optional<std::uint32_t>, 2> counts;
    for (std::size_t i = 0; i < 2 && i < words.size(); ++i) {
      counts[i] = parseInteger<std::uint32_t>(words[i]);
    }
    if (!counts[0] || !counts[1] || words.size() > 3) {
      throw InputError(where(), "expected ", wanted);
    }
    vertices_ = *counts[0];
    faces_ = *counts[1];
    // Two bytes for each number at least.
    if (6 * vertices_ > input_.remaining() + 1 || 2 * faces_ > input_.remaining() + 1) {
      throw InputError(
          where(), "states more vertices or faces than the file has room for: the file is cut off");
    }
  }

  void readVertex() {
    const char* const wanted = "x y z of a vertex";
    nextRow(wanted);
    const std::size_t least = kind_.normal ? 6 : 3;
    if (row_.size() < least) throw InputError(where(), "expected ", wanted);
    const glm::dvec3 p(row_[0], row_[1], row_[2]);
    if (!isNearEnough(p)) throw InputError(where(), "is a vertex farther out than 1e9 units");
    if (position_.empty()) origin_ = originNear(p);
    position_.push_back(p - origin_);
    if (kind_.normal) normal_.emplace_back(glm::dvec3(row_[3], row_[4], row_[5]));
    const std::size_t after = row_.size() - least;
    // Some writers add colours without the letter C.
    const bool colored = kind_.color || (!kind_.uv && (after == 3 || after == 4));
    color_.add(words_, row_, colored ? least : row_.size());
  }

  void readFace() {
    const char* const wanted = "the number of a face's corners, and the corners";
    nextRow(wanted);
    const double corners = row_[0];
    if (!(corners >= 0.0 && corners <= static_cast<double>(row_.size() - 1)) ||
        corners != std::floor(corners)) {
      throw InputError(where(), "expected ", wanted);
    }
    const auto count = static_cast<std::size_t>(corners);
    for (std::size_t i = 1; i <= count; ++i) {
      if (!(row_[i] >= 0.0 && row_[i] < static_cast<double>(vertices_)) ||
          row_[i] != std::floor(row_[i])) {
        throw InputError(where(), "names vertex ", exactText(row_[i]), ": expected 0 to ",
                         vertices_ - 1);
      }
      corner_.push_back(static_cast<std::uint32_t>(row_[i]));
    }
    end_.push_back(corner_.size());
    face_color_.add(words_, row_, count + 1);
  }

  void addFaces() {
    face_color_.linearise();
    std::vector<MeshCorner> polygon;
    for (std::size_t face = 0, i = 0; face < end_.size(); ++face) {
      const glm::vec4 color = face_color_.at(face);
      const bool colored = color.r >= 0.0f;
      const auto material = color_of_faces_.materialOf(colored ? glm::vec3(color) : kPlainSurface);
      polygon.clear();
      for (; i < end_[face]; ++i) {
        const glm::vec4 own = colored ? color : color_.at(corner_[i]);
        polygon.push_back({.position = position_[corner_[i]],
                           .color = colored && material ? glm::vec3(-1.0f) : glm::vec3(own),
                           .alpha = own.r < 0.0f ? 1.0f : own.a});
      }
      builder_.addPolygon(polygon, material.value_or(0));
    }
  }

  std::variant<PointCloud, MeshFile> finishPoints() {
    if (position_.empty()) throw InputError(input_.name(), "has no vertices");
    PointCloud points;
    points.position_m.assign(position_.begin(), position_.end());
    for (glm::vec3& n : normal_) n = unitNormal(n);
    points.normal = std::move(normal_);
    for (std::uint32_t i = 0; i < position_.size(); ++i) {
      const glm::vec4 color = color_.at(i);
      const bool colored = color.r >= 0.0f;
      points.color.push_back(colored ? glm::vec3(color) : glm::vec3(kUncolouredLight));
      points.opacity.push_back(colored ? color.a : 1.0f);
    }
    dropPlainOpacity(points);
    remarkOrigin(origin_, points.remarks);
    return points;
  }

  std::variant<PointCloud, MeshFile> finishMesh() {
    remarkOrigin(origin_, builder_.remarks());
    addFaces();
    const bool blend = builder_.useAlpha();
    return builder_.finish({.kind = SceneKind::off_mesh}, [&](std::uint32_t number) {
      ReadMaterial read = color_of_faces_.read(number);
      if (blend) read.material.alpha = AlphaUse::blend;
      return read;
    });
  }

  ply::Input input_;
  std::uint64_t line_ = 0, vertices_ = 0, faces_ = 0;
  OffKind kind_;
  std::vector<std::string_view> words_;
  std::vector<double> row_;
  glm::dvec3 origin_{0.0};
  std::vector<glm::dvec3> position_;  // less the origin
  std::vector<glm::vec3> normal_;
  OffColors color_, face_color_;
  std::vector<std::uint32_t> corner_;
  std::vector<std::size_t> end_;  // of the corners, by face
  MeshBuilder builder_;
  FaceColors color_of_faces_;
};

}  // namespace

std::variant<PointCloud, MeshFile> readOff(const std::filesystem::path& path) {
  return OffReader(path).read();
}

}  // namespace foci
