#include "render/scene/io/ply_mesh.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/ply_header.h"

namespace foci {
namespace {

using ply::Element;
using ply::Property;

bool isCorners(const Property& property) {
  return property.list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

bool has(const Element& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& property) { return property.name == name; });
}

bool hasColor(const Element& element) {
  return has(element, "red") || has(element, "r") || has(element, "diffuse_red");
}

/// The name of the opacity of vertices; empty if they have none.
std::string_view alphaOf(const Element& element) {
  if (element.name != "vertex") return "";
  if (has(element, "alpha")) return "alpha";
  if (has(element, "opacity")) return "opacity";
  return has(element, "r") && has(element, "a") ? "a" : "";
}

class FaceCheck {
 public:
  explicit FaceCheck(const std::filesystem::path& path)
      : input_(path), header_(ply::readHeader(input_)) {}

  std::vector<std::string> remarks() {
    bool vertex_colors = false, face_colors = false;
    for (const Element& element : header_.elements) {
      if (element.name == "vertex") {
        vertices_ = element.count;
        vertex_colors = hasColor(element);
      }
      if (element.name == "face") face_colors = hasColor(element);
    }
    for (const Element& element : header_.elements) {
      if (header_.format == ply::Format::ascii) {
        checkText(element);
      } else if (element.name == "face") {
        checkBinary(element);
      } else {
        ply::skipElement(input_, element, header_);
      }
    }
    if (!face_colors || vertex_colors) return {};
    return {"the colours of its faces are not shown: MeshLab can transfer them to the vertices"};
  }

 private:
  void refuseCorner(const std::string& where, double corner) const {
    if (corner >= 0.0 && corner < static_cast<double>(vertices_)) return;
    throw InputError(where, "a face names vertex " + decimal(corner, 0) + ": expected 0 to " +
                                std::to_string(vertices_ - 1) + "; is the file cut off?");
  }

  void checkText(const Element& element) {
    const auto where = [&] { return input_.name() + ":" + std::to_string(header_.lines); };
    for (std::uint64_t i = 0; i < element.count; ++i) {
      std::string_view line;
      while (line.empty()) {
        if (input_.remaining() == 0) {
          throw InputError(input_.name(), "ends after " + std::to_string(i) + " of " +
                                              std::to_string(element.count) + " items of element " +
                                              shown(element.name));
        }
        ++header_.lines;
        line = trimmed(input_.line());
      }
      if (element.name != "face") continue;
      const auto next = [&] {
        const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
        std::string_view word = line.substr(0, end);
        line = trimmed(line.substr(end));
        double value = 0.0;
        const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (word.empty()) throw InputError(where(), "too few values for a face");
        if (error != std::errc() || last != word.data() + word.size()) {
          throw InputError(where(), "expected a number, found " + shown(word));
        }
        return value;
      };
      for (const Property& property : element.properties) {
        const double count = property.list ? next() : 1.0;
        for (double k = 0.0; k < count; ++k) {
          const double value = next();
          if (isCorners(property)) refuseCorner(where(), value);
        }
      }
    }
  }

  void checkBinary(const Element& element) {
    const bool swap = ply::mustSwap(header_.format);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        if (property.list && !isCorners(property)) {
          ply::skipList(input_, property, swap);
          continue;
        }
        std::uint64_t count = 1;
        if (property.list) {
          const double stated = ply::scalarAt(input_.take(ply::sizeOf(property.count_type)),
                                              property.count_type, swap);
          if (stated < 0.0 || stated > static_cast<double>(input_.remaining())) {
            throw InputError(where(i), "has " + decimal(stated, 0) +
                                           " corners, more than the file has room for");
          }
          count = static_cast<std::uint64_t>(stated);
        }
        for (std::uint64_t k = 0; k < count; ++k) {
          const double value =
              ply::scalarAt(input_.take(ply::sizeOf(property.type)), property.type, swap);
          if (isCorners(property)) refuseCorner(where(i), value);
        }
      }
    }
  }

  std::string where(std::uint64_t face) const {
    return input_.name() + ": face " + std::to_string(face + 1);
  }

  ply::Input input_;
  ply::Header header_;
  std::uint64_t vertices_ = 0;
};

}  // namespace

std::vector<std::string> checkPlyFaces(const std::filesystem::path& path) {
  return FaceCheck(path).remarks();
}

PlyVertices plyVertices(const std::filesystem::path& path) {
  ply::Input input(path);
  const ply::Header header = ply::readHeader(input);
  PlyVertices vertices;
  for (const Element& element : header.elements) {
    if (element.name != "vertex") continue;
    vertices = {.color = hasColor(element), .alpha = !alphaOf(element).empty()};
  }
  return vertices;
}

std::string readablePly(const std::filesystem::path& path) {
  ply::Input input(path);
  const ply::Header header = ply::readHeader(input);
  std::vector<std::string> names;
  bool changed = header.renamed;
  for (const Element& element : header.elements) {
    const std::string_view alpha = alphaOf(element);
    for (const Property& property : element.properties) {
      names.push_back(property.name == alpha ? "alpha" : property.name);
      changed |= names.back() != property.name;
    }
  }
  if (!changed) return "";
  std::ifstream in(path, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(in), {});
  std::size_t at = 0;
  for (const std::string& name : names) {
    std::string_view line;
    for (; !line.starts_with("property"); at = text.find('\n', at) + 1) {
      line = trimmed(std::string_view(text).substr(at, text.find('\n', at) - at));
    }
    const auto end = static_cast<std::size_t>(line.data() + line.size() - text.data());
    const std::size_t word = line.size() - line.find_last_of(" \t") - 1;
    text.replace(end - word, word, name);
    at = text.find('\n', end - word) + 1;
  }
  return text;
}

}  // namespace foci
