// Wavefront's OBJ as text, and its materials (MTL). Private to the readers of scenes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/io/mesh_files.h"

namespace foci {

/// What an OBJ holds. Numbers of corners begin with 0; kNone: none.
struct ObjFile {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  struct Corner {
    std::uint32_t vertex = 0, uv = kNone, normal = kNone;
  };
  struct Face {
    std::uint32_t first = 0, count = 0;  ///< of `corners`
    std::uint32_t material = 0;          ///< of `materials`
    std::uint32_t object = 0;            ///< of `objects`
  };

  std::vector<glm::dvec3> positions{};
  std::vector<glm::vec3> colors{};  ///< sRGB, by vertex; negative: none; empty: none has one
  std::vector<glm::vec2> uv{};
  std::vector<glm::vec3> normals{};
  std::vector<Corner> corners{};
  std::vector<Face> faces{};
  std::vector<std::string> materials{""}, objects{""};  ///< names; [0] is for faces without one
  std::vector<std::string> libraries{};                 ///< names of MTL files
  std::uint64_t points = 0, lines = 0;                  ///< elements p and l
  std::uint64_t two_corners = 0;                        ///< faces, which are left out
  std::vector<std::string> remarks{};
};

/// @throws InputError with file and line, if it is no OBJ as text, or ends within a face
ObjFile parseObj(const std::filesystem::path& path);

/// The MTL files that an OBJ names and that are there.
/// @param missing  gets the names of those that are not; null: not asked for
std::vector<std::filesystem::path> librariesOf(const std::filesystem::path& obj,
                                               const std::vector<std::string>& names,
                                               std::vector<std::string>* missing = nullptr);

/// What follows each `mtllib`, of a file that is not read otherwise.
std::vector<std::string> libraryNames(const std::filesystem::path& obj);

/// A texture with its options. Coordinates are multiplied by the scale (-s), then moved (-o).
struct MtlTexture {
  ImageSource source{};
  glm::vec2 scale{1.0f}, offset{0.0f};
  bool clamped = false;
};

struct MtlMaterial {
  std::string name{};
  std::optional<glm::vec3> diffuse{};                     ///< Kd, linear light
  glm::vec3 emitted{0.0f};                                ///< Ke, linear light
  std::optional<float> opacity{};                         ///< d
  std::optional<float> transparency{};                    ///< Tr
  std::optional<MtlTexture> color{}, emission{}, mask{};  ///< map_Kd, map_Ke, map_d
};

/// An MTL, with the options -s, -o and -clamp of textures.
struct MtlFile {
  std::vector<MtlMaterial> materials{};
  std::vector<std::filesystem::path> textures{};  ///< all that it names and that are there
  std::vector<std::string> remarks{};
};

/// @param obj  the mesh: textures may lie beside it, too
MtlFile readMtl(const std::filesystem::path& mtl, const std::filesystem::path& obj);

}  // namespace foci
