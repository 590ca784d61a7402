// Collects the triangles of a mesh, whatever the format of its file. Private to the readers of
// meshes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "render/scene/io/mesh_files.h"
#include "render/scene/io/scan_values.h"
#include "render/scene/io/scene_facts.h"

namespace foci {

struct MeshCorner {
  glm::vec3 position{0.0f};
  glm::vec3 normal{0.0f};  ///< of the file; 0: none
  glm::vec2 uv{0.0f};      ///< the origin is the lower left
  glm::vec3 color{-1.0f};  ///< linear RGB; negative: none
  float alpha = 1.0f;
};

/// What turns normals where a matrix turns places: the transposed inverse, if there is one.
glm::dmat3 normalsFrom(const glm::dmat3& places);

/// sRGB 0.6 in linear light, of surfaces for which a file has no colour.
inline constexpr glm::vec3 kPlainSurface{0.3185f};

/// A material as read, and what `foci info` says of it; absent for one that the file does not have.
struct ReadMaterial {
  MeshMaterial material;
  std::optional<MaterialFacts> facts{};
};

class MeshBuilder {
 public:
  explicit MeshBuilder(const std::filesystem::path& file) : file_(file.string()), textures_(file) {}

  /// A new object. @return its number, for `useObject`; 0 if there are too many
  std::uint16_t addObject(std::string name);
  /// Triangles belong to this object from now on.
  void useObject(std::uint16_t number) { object_ = number; }

  /// Turns the triangle to the side of its normals, if it has some. A corner that is not finite or
  /// farther out than kFarthest_m makes it unusable: it is counted.
  void add(const std::array<MeshCorner, 3>& corners, std::uint32_t material);

  /// The same for a polygon, in triangles.
  void addPolygon(std::span<const MeshCorner> corners, std::uint32_t material);

  void remark(std::string text) { mesh_.remarks.push_back(std::move(text)); }
  std::vector<std::string>& remarks() { return mesh_.remarks; }
  /// "3 triangles", or "1 triangle", and what is said of them; nothing for none.
  void remarkCount(std::uint64_t count, const std::string& one, const std::string& says);

  /// Names what a mesh holds beside its triangles.
  void remarkLeftOut(std::uint64_t points, std::uint64_t lines);

  /// A material that is black but emits light has the colour of that light. Names, once, what
  /// becomes of light that materials emit.
  /// @return whether it is such a material
  bool takeLight(bool is_black, const glm::vec3& emitted, MeshMaterial& material);

  /// Those of the materials: `finish` adds their remarks.
  MeshTextures& textures() { return textures_; }

  /// Whether the alpha of corners is an opacity. It is not, with a remark, if all of it is 0.
  bool useAlpha();

  /// Places as floats. If floats would lose their detail, the places become relative to an origin
  /// near the first one, with a remark.
  std::vector<glm::vec3> placesOf(const std::vector<glm::dvec3>& places);

  /// @param facts  kind, unit and up axis
  /// @param read   called once for each material that a triangle uses
  /// @throws InputError if no triangle has an area
  MeshFile finish(SceneFacts facts, const std::function<ReadMaterial(std::uint32_t)>& read);

 private:
  void readMaterials(SceneFacts& facts, const std::function<ReadMaterial(std::uint32_t)>& read);
  void showHidden(SceneFacts& facts);
  void takeColors(SceneFacts& facts);
  void takeObjects(const SceneFacts& facts);

  std::string file_;
  MeshTextures textures_;
  TriangleMesh mesh_;
  std::uint16_t object_ = 0;
  std::vector<std::string> object_names_;
  std::vector<std::uint16_t> objects_;  // by triangle, from 1
  std::vector<std::string> material_names_;
  std::vector<std::uint8_t> used_;  // by material
  std::uint64_t unusable_ = 0;      // triangles
  bool has_normals_ = false;
  bool glowing_ = false, dimmed_ = false;  // a material
};

/// Materials for the colours of faces. With more than 4096 colours, faces count as coloured
/// corners.
class FaceColors {
 public:
  /// The material of a face of this linear colour, which is removed from its corners. Absent if
  /// there are too many: the corners keep the colour.
  std::optional<std::uint32_t> materialOf(const glm::vec3& color);

  /// @param number  of `materialOf`
  ReadMaterial read(std::uint32_t number) const;

 private:
  static constexpr std::size_t kMaxColors = 4096;

  std::map<std::tuple<float, float, float>, std::uint32_t> numbers_;
  std::vector<glm::vec3> colors_;
  bool many_ = false;  // as in a capture, whose colours contain its light
};

}  // namespace foci
