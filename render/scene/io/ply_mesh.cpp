// Meshes in PLY: faces with the properties that MeshLab (texcoord, texnumber, comments TextureFile)
// and others write, and the triangle strips of the Stanford scans.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/mesh_builder.h"
#include "render/scene/io/mesh_files.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/ply_items.h"

namespace foci {
namespace {

class PlyMesh {
 public:
  explicit PlyMesh(const std::filesystem::path& path)
      : path_(path),
        input_(path),
        header_(ply::readHeader(input_)),
        builder_(path),
        texture_names_(ply::textureNames(header_)) {}

  MeshFile read() {
    if (const ply::Element* vertex = ply::elementNamed(header_, "vertex")) {
      vertices_ = vertex->count;
    }
    for (const ply::Element& element : header_.elements) {
      if (element.name == "vertex") {
        readVertices(element);
      } else if (element.name == "face") {
        readFaces(element);
      } else if (element.name.starts_with("tristrip")) {
        readStrips(element);
      } else {
        ply::skipElement(input_, element, header_);
      }
    }
    if (auto edges = ply::edgesRemark(header_)) builder_.remark(std::move(*edges));
    build();
    return finish();
  }

 private:
  struct Faces {
    std::vector<std::uint32_t> begin = {0}, corners;  // begin: one more than faces
    std::vector<glm::vec2> uv;                        // by corner; empty: none
    std::vector<double> texture;                      // by face; empty: none
    std::vector<glm::vec3> color;                     // by face; empty: none
  };

  void readVertices(const ply::Element& element) {
    ply::Items items(input_, header_, element);
    const auto position = items.findAll({"x", "y", "z"});
    if (position.empty()) {
      throw InputError(input_.name(), "element vertex: expected properties x, y and z");
    }
    const auto normal = items.findAll({"nx", "ny", "nz"}), color = ply::colorOf(items);
    const auto alpha = ply::opacityOf(items);
    std::vector<std::size_t> uv;
    for (const auto& [u, v] : {std::pair{"s", "t"},
                               {"u", "v"},
                               {"texture_u", "texture_v"},
                               {"texture_s", "texture_t"},
                               {"tx", "ty"}}) {
      if (uv.empty()) uv = items.findAll({u, v});
    }
    std::vector<float> alphas;
    while (items.next()) {
      places_.push_back(items.vector(position));
      MeshCorner corner;
      if (!normal.empty()) corner.normal = items.vector(normal);
      if (!uv.empty()) corner.uv = {items.floatValue(uv[0]), items.floatValue(uv[1])};
      if (alpha) alphas.push_back(items.floatValue(*alpha));
      if (!color.empty()) colors_.emplace_back(items.vector(color));
      corners_.push_back(corner);
    }
    if (alpha) ply::normaliseOpacity(alphas, items.property(*alpha).type, input_.name());
    for (std::size_t i = 0; i < alphas.size(); ++i) corners_[i].alpha = alphas[i];
    has_uv_ = !uv.empty();
    fine_ = items.property(position[0]).type == ply::Scalar::float64;
    if (!color.empty()) {
      ply::linearise(colors_, items.property(color[0]).type, input_.name(), "vertex",
                     builder_.remarks());
      for (std::size_t i = 0; i < corners_.size(); ++i) corners_[i].color = colors_[i];
    }
  }

  std::uint32_t cornerOf(double number, const ply::Items& items) const {
    if (number >= 0.0 && number < static_cast<double>(vertices_) && number == std::floor(number)) {
      return static_cast<std::uint32_t>(number);
    }
    throw InputError(items.where(), "a face names vertex ", exactText(number), ": expected 0 to ",
                     vertices_ - 1, "; is the file cut off?");
  }

  static std::size_t listOfCorners(const ply::Items& items, const std::string& file) {
    auto list = items.find("vertex_indices", true);
    if (!list) list = items.find("vertex_index", true);
    if (list && items.property(*list).list) return *list;
    throw InputError(file, "element face: expected a list vertex_indices");
  }

  void readFaces(const ply::Element& element) {
    ply::Items items(input_, header_, element);
    const std::size_t list = listOfCorners(items, input_.name());
    const auto texcoord = items.find("texcoord", true), texture = items.find("texnumber");
    const auto color = ply::colorOf(items);
    while (items.next()) {
      const auto corners = items.list(list);
      for (const double corner : corners) faces_.corners.push_back(cornerOf(corner, items));
      faces_.begin.push_back(static_cast<std::uint32_t>(faces_.corners.size()));
      if (texcoord) {
        const auto uv = items.list(*texcoord);
        for (std::size_t i = 0; i < corners.size(); ++i) {
          const bool placed = 2 * i + 1 < uv.size();
          faces_.uv.push_back(placed ? glm::vec2(uv[2 * i], uv[2 * i + 1]) : glm::vec2(0.0f));
        }
      }
      if (texture) faces_.texture.push_back(items.value(*texture));
      if (!color.empty()) faces_.color.emplace_back(items.vector(color));
    }
    if (color.empty()) return;
    ply::linearise(faces_.color, items.property(color[0]).type, input_.name(), "face",
                   builder_.remarks());
  }

  /// Strips end with -1. Every second triangle is wound the other way round.
  void readStrips(const ply::Element& element) {
    ply::Items items(input_, header_, element);
    const std::size_t list = listOfCorners(items, input_.name());
    while (items.next()) {
      const auto strip = items.list(list);
      std::size_t begin = 0;
      for (std::size_t i = 0; i < strip.size(); ++i) {
        if (strip[i] == -1.0) {
          begin = i + 1;
        } else if (i >= begin + 2) {
          const bool turned = (i - begin) % 2 == 1;
          for (const std::size_t at : {i - 2, turned ? i : i - 1, turned ? i - 1 : i}) {
            faces_.corners.push_back(cornerOf(strip[at], items));
          }
          faces_.begin.push_back(static_cast<std::uint32_t>(faces_.corners.size()));
        }
      }
    }
  }

  /// The material of a face: a texture, the one of no texture, or its colour.
  std::uint32_t materialOf(std::size_t face, std::span<MeshCorner> corners) {
    const auto plain = static_cast<std::uint32_t>(texture_names_.size());
    if (!texture_names_.empty() && (has_uv_ || !faces_.uv.empty())) {
      const double number = face < faces_.texture.size() ? faces_.texture[face] : 0.0;
      if (number >= 0.0 && number < plain) return static_cast<std::uint32_t>(number);
      untextured_ += number != -1.0;  // MeshLab: no texture
    }
    if (!colors_.empty() || face >= faces_.color.size()) return plain;
    const glm::vec3 color = faces_.color[face];
    const auto own = face_colors_.materialOf(color);
    for (MeshCorner& corner : corners) corner.color = own ? glm::vec3(-1.0f) : color;
    return own ? plain + 1 + *own : plain;
  }

  void build() {
    // A float has lost what an origin nearby would keep.
    const std::vector<glm::vec3> places =
        fine_ ? builder_.placesOf(places_) : std::vector<glm::vec3>(places_.begin(), places_.end());
    std::vector<MeshCorner> corners;
    for (std::size_t face = 0; face + 1 < faces_.begin.size(); ++face) {
      corners.clear();
      for (std::uint32_t i = faces_.begin[face]; i < faces_.begin[face + 1]; ++i) {
        const std::uint32_t vertex = faces_.corners[i];
        corners.push_back(corners_[vertex]);
        corners.back().position = places[vertex];
        if (i < faces_.uv.size()) corners.back().uv = faces_.uv[i];
      }
      const std::uint32_t material = materialOf(face, corners);
      builder_.addPolygon(corners, material);
    }
  }

  MeshFile finish() {
    const bool placed = has_uv_ || !faces_.uv.empty();
    const bool colored = !colors_.empty() || !faces_.color.empty();
    if (!placed && !texture_names_.empty()) {
      builder_.remark("names a texture, but has no texture coordinates: shown without the texture");
    } else if (placed && texture_names_.empty() && !colored) {
      builder_.remark(
          "has texture coordinates, but names no texture: add a line `comment TextureFile NAME` to "
          "its header, or save it as OBJ");
    }
    builder_.remarkCount(untextured_, "face", "with a texture that the file does not have");
    const bool blend = builder_.useAlpha();
    const auto plain = static_cast<std::uint32_t>(texture_names_.size());
    SceneFacts facts{.kind = SceneKind::ply_mesh};
    if (std::ranges::any_of(header_.comments, [](const std::string& comment) {
          return comment.starts_with("Created by Blender") ||
                 comment.starts_with("Created in Blender");
        })) {
      facts.format = "PLY mesh of Blender";
      facts.up_axis = 2;
    }
    return builder_.finish(std::move(facts), [&](std::uint32_t number) {
      ReadMaterial read{.material = {.factor = kPlainSurface}};
      if (number > plain) read = face_colors_.read(number - plain - 1);
      if (number < plain) read = textured(texture_names_[number]);
      if (blend) read.material.alpha = AlphaUse::blend;
      return read;
    });
  }

  ReadMaterial textured(const std::string& name) {
    const ImageSource source{.name = name, .file = namedFile(path_, name)};
    ReadMaterial read;
    read.material.texture = builder_.textures().read(source);
    if (!read.material.texture) read.material.factor = kPlainSurface;
    read.facts.emplace();
    read.facts->name = name;
    read.facts->textures = {factsOf(source)};
    return read;
  }

  std::filesystem::path path_;
  ply::Input input_;
  ply::Header header_;
  MeshBuilder builder_;
  std::vector<std::string> texture_names_;
  std::uint64_t vertices_ = 0, untextured_ = 0;
  std::vector<glm::dvec3> places_;
  std::vector<MeshCorner> corners_;  // by vertex; places are apart
  std::vector<glm::vec3> colors_;    // by vertex; empty: none
  bool has_uv_ = false, fine_ = false;
  Faces faces_;
  FaceColors face_colors_;
};

}  // namespace

bool isPlyMesh(const ply::Header& header) {
  return std::ranges::any_of(header.elements, [](const auto& element) {
    return (element.name == "face" || element.name.starts_with("tristrip")) && element.count > 0;
  });
}

MeshFile readPlyMesh(const std::filesystem::path& path) { return PlyMesh(path).read(); }

}  // namespace foci
