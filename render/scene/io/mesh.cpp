#include "render/scene/io/mesh.h"

#include <assimp/GltfMaterial.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/parallel.h"
#include "render/image/srgb.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/texture.h"
#include "render/scene/sampling/poisson_disk.h"

namespace foci {
namespace {

constexpr int kMaxTexturePixels = 1 << 26;
constexpr float kMinAlpha = 0.5f;
const glm::vec3 kTowardsLight = glm::normalize(glm::vec3(0.3f, 0.8f, 0.5f));
constexpr float kAmbient = 0.35f;

std::string extensionOf(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

struct MeshMaterial {
  std::shared_ptr<const MeshTexture> texture;
  glm::vec3 factor{1.0f};  ///< times the texture; the colour itself if there is no texture
  float opacity = 1.0f;
  bool cut_out = true;  ///< whether the texture's alpha cuts holes
};

/// All triangles of a file, with the data of their corners.
struct Triangles {
  std::vector<glm::vec3> corners_m;
  std::vector<glm::vec2> uv;
  std::vector<glm::vec3> color;         ///< linear; negative: none
  std::vector<std::uint32_t> material;  ///< one for each triangle
};

glm::vec3 vec3Of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// Clamps to 0 to 1; NaN becomes 0.
glm::vec3 unitColor(const glm::vec3& c) {
  const auto unit = [](float x) { return x >= 0.0f ? std::min(x, 1.0f) : 0.0f; };
  return {unit(c.x), unit(c.y), unit(c.z)};
}

glm::vec3 linearOf(const glm::vec3& srgb) {
  return {linearFromSrgb(srgb.x), linearFromSrgb(srgb.y), linearFromSrgb(srgb.z)};
}

/// Removes faces without corners. Assimp marks their mesh as one with polygons, and its
/// triangulation then asserts that there are polygons.
void dropEmptyFaces(aiMesh& mesh) {
  aiFace* const end = mesh.mFaces + mesh.mNumFaces;
  aiFace* const kept =
      std::remove_if(mesh.mFaces, end, [](const aiFace& face) { return face.mNumIndices == 0; });
  if (kept == end) return;
  mesh.mNumFaces = static_cast<unsigned>(kept - mesh.mFaces);
  const bool polygons =
      std::any_of(mesh.mFaces, kept, [](const aiFace& face) { return face.mNumIndices > 3; });
  if (!polygons) mesh.mPrimitiveTypes &= ~static_cast<unsigned>(aiPrimitiveType_POLYGON);
  if (mesh.mNumFaces == 0) mesh.mPrimitiveTypes = aiPrimitiveType_POINT;  // points are not imported
}

class Loader {
 public:
  explicit Loader(const std::filesystem::path& path) : path_(path) {
    const std::string extension = extensionOf(path);
    gltf_ = extension == ".gltf" || extension == ".glb";
    if (!std::filesystem::is_regular_file(path)) throw InputError(path.string(), "cannot be read");
    importer_.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                 aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    try {
      if (importer_.ReadFile(path.string(), aiProcess_ValidateDataStructure) != nullptr) {
        const aiScene& read = *importer_.GetScene();
        for (unsigned m = 0; m < read.mNumMeshes; ++m) dropEmptyFaces(*read.mMeshes[m]);
        scene_ = importer_.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType |
                                               aiProcess_PreTransformVertices);
      }
    } catch (const std::exception& error) {
      refuse(error.what());
    }
    if (scene_ == nullptr) refuse(importer_.GetErrorString());
  }

  Triangles triangles() const {
    Triangles all;
    for (unsigned m = 0; m < scene_->mNumMeshes; ++m) append(all, *scene_->mMeshes[m]);
    if (!(areaOf_m2(all.corners_m) > 0.0)) {
      throw InputError(path_.string(), "has no triangle with an area");
    }
    return all;
  }

  std::vector<MeshMaterial> materials() {
    std::vector<MeshMaterial> all;
    for (unsigned i = 0; i < scene_->mNumMaterials; ++i) {
      all.push_back(materialOf(*scene_->mMaterials[i]));
    }
    return all;
  }

 private:
  [[noreturn]] void refuse(std::string why) const {
    for (char& c : why) {
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    }
    throw InputError(path_.string(), "is no mesh that can be read: " + why.substr(0, 200));
  }

  void append(Triangles& all, const aiMesh& mesh) const {
    const bool has_uv = mesh.HasTextureCoords(0), has_color = mesh.HasVertexColors(0);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<unsigned, 3> index{face.mIndices[0], face.mIndices[1], face.mIndices[2]};
      const bool usable = std::all_of(index.begin(), index.end(), [&](unsigned i) {
        if (i >= mesh.mNumVertices) return false;
        const aiVector3D& p = mesh.mVertices[i];
        return std::abs(p.x) <= kFarthest_m && std::abs(p.y) <= kFarthest_m &&
               std::abs(p.z) <= kFarthest_m;  // false for NaN
      });
      if (!usable) continue;
      if (mesh.HasNormals()) {
        const glm::vec3 a = vec3Of(mesh.mVertices[index[0]]), b = vec3Of(mesh.mVertices[index[1]]),
                        c = vec3Of(mesh.mVertices[index[2]]);
        glm::vec3 outwards(0.0f);
        for (const unsigned i : index) outwards += vec3Of(mesh.mNormals[i]);
        if (glm::dot(glm::cross(b - a, c - a), outwards) < 0.0f) std::swap(index[1], index[2]);
      }
      for (const unsigned i : index) {
        all.corners_m.push_back(vec3Of(mesh.mVertices[i]));
        glm::vec2 uv(0.0f);
        if (has_uv) uv = {mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y};
        const bool placed = std::abs(uv.x) < 1e6f && std::abs(uv.y) < 1e6f;
        all.uv.push_back(placed ? uv : glm::vec2(0.0f));
        glm::vec3 color(-1.0f);
        if (has_color) {
          const aiColor4D& c = mesh.mColors[0][i];
          color = unitColor({c.r, c.g, c.b});
          if (!gltf_) color = linearOf(color);
        }
        all.color.push_back(color);
      }
      all.material.push_back(mesh.mMaterialIndex);
    }
  }

  MeshMaterial materialOf(const aiMaterial& from) {
    MeshMaterial material;
    aiColor4D color(0.6f, 0.6f, 0.6f, 1.0f);
    if (!gltf_ || from.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS) {
      from.Get(AI_MATKEY_COLOR_DIFFUSE, color);
    }
    material.factor = unitColor({color.r, color.g, color.b});
    if (!gltf_) material.factor = linearOf(material.factor);
    float opacity = gltf_ ? color.a : 1.0f;
    if (!gltf_) from.Get(AI_MATKEY_OPACITY, opacity);
    aiString mode;
    const bool opaque = gltf_ && (from.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) != aiReturn_SUCCESS ||
                                  std::string(mode.C_Str()) == "OPAQUE");
    material.opacity = opaque || !(opacity >= 0.0f) ? 1.0f : std::min(opacity, 1.0f);
    material.cut_out = !opaque;
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      aiString name;
      if (from.GetTexture(type, 0, &name) != aiReturn_SUCCESS) continue;
      material.texture = textureOf(name.C_Str());
      if (!gltf_) material.factor = glm::vec3(1.0f);
      break;
    }
    return material;
  }

  std::shared_ptr<const MeshTexture> textureOf(const std::string& name) {
    std::shared_ptr<const MeshTexture>& texture = textures_[name];
    if (texture) return texture;
    cv::Mat image;
    try {
      image = imageOf(name);
    } catch (const cv::Exception&) {
      image.release();
    }
    const bool usable = !image.empty() && image.total() <= kMaxTexturePixels &&
                        (image.depth() == CV_8U || image.depth() == CV_16U) &&
                        image.channels() != 2;
    if (!usable) {
      throw InputError(path_.string(), "texture " + name.substr(0, 200) +
                                           " cannot be read, or has more than 2^26 pixels");
    }
    texture = std::make_shared<const MeshTexture>(image);
    return texture;
  }

  cv::Mat imageOf(std::string name) const {
    if (const aiTexture* embedded = scene_->GetEmbeddedTexture(name.c_str())) {
      const int width = static_cast<int>(embedded->mWidth);
      if (embedded->mHeight == 0) {  // the bytes of an image file
        return cv::imdecode(cv::Mat(1, width, CV_8U, embedded->pcData), cv::IMREAD_UNCHANGED);
      }
      return cv::Mat(static_cast<int>(embedded->mHeight), width, CV_8UC4, embedded->pcData);
    }
    std::replace(name.begin(), name.end(), '\\', '/');
    return cv::imread((path_.parent_path() / name).string(), cv::IMREAD_UNCHANGED);
  }

  std::filesystem::path path_;
  bool gltf_ = false;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
  std::map<std::string, std::shared_ptr<const MeshTexture>> textures_;
};

/// Colour and alpha of a point, averaged over a square of side `spacing_m`.
glm::vec4 appearance(const Triangles& all, const MeshMaterial& material, const MeshPoint& point,
                     const glm::vec3& normal, float area_m2, float spacing_m) {
  const std::size_t first = 3 * std::size_t{point.triangle};
  const auto blend = [&](const auto& values) {
    return values[first] + point.weights.x * (values[first + 1] - values[first]) +
           point.weights.y * (values[first + 2] - values[first]);
  };
  if (material.texture) {
    const glm::vec2 a = (all.uv[first + 1] - all.uv[first]) * material.texture->size_px();
    const glm::vec2 b = (all.uv[first + 2] - all.uv[first]) * material.texture->size_px();
    const float area_px = 0.5f * std::abs(a.x * b.y - a.y * b.x);
    const glm::vec4 texel =
        material.texture->at(blend(all.uv), spacing_m * std::sqrt(area_px / area_m2));
    return {glm::vec3(texel) * material.factor, material.cut_out ? texel.w : 1.0f};
  }
  if (all.color[first].x >= 0.0f) return {blend(all.color), 1.0f};
  const float lambert = std::max(glm::dot(normal, kTowardsLight), 0.0f);
  return {material.factor * (kAmbient + (1.0f - kAmbient) * lambert), 1.0f};
}

}  // namespace

bool isMeshFile(const std::filesystem::path& path) {
  const std::string extension = extensionOf(path);
  if (extension == ".obj" || extension == ".gltf" || extension == ".glb" || extension == ".stl") {
    return true;
  }
  if (extension != ".ply") return false;
  ply::Input input(path);
  const ply::Header header = ply::readHeader(input);
  return std::any_of(header.elements.begin(), header.elements.end(), [](const auto& element) {
    return element.name == "face" && element.count > 0;
  });
}

PointCloud sampleMesh(const std::filesystem::path& path, const MeshSampling& sampling) {
  Loader loader(path);
  const Triangles all = loader.triangles();
  const std::vector<MeshMaterial> materials = loader.materials();
  const double spacing_m =
      std::sqrt(areaOf_m2(all.corners_m) / static_cast<double>(sampling.points));
  float farthest_m = 0.0f;
  for (const glm::vec3& corner : all.corners_m) {
    farthest_m = std::max({farthest_m, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  }
  if (spacing_m < double{farthest_m} * std::numeric_limits<float>::epsilon()) {
    throw InputError(path.string(), "has so little area for its extent that " +
                                        std::to_string(sampling.points) +
                                        " points would fall on each other");
  }
  const std::vector<MeshPoint> points = poissonDisk(all.corners_m, spacing_m);

  PointCloud cloud;
  cloud.position_m.resize(points.size());
  cloud.normal.resize(points.size());
  cloud.color.resize(points.size());
  cloud.opacity.resize(points.size());
  std::vector<std::uint8_t> keep(points.size());
  const MeshMaterial plain;
  parallelFor(points.size(), [&](std::size_t i) {
    const MeshPoint& point = points[i];
    const glm::dvec3 a = all.corners_m[3 * std::size_t{point.triangle}];
    const glm::dvec3 ab = glm::dvec3(all.corners_m[3 * std::size_t{point.triangle} + 1]) - a;
    const glm::dvec3 ac = glm::dvec3(all.corners_m[3 * std::size_t{point.triangle} + 2]) - a;
    const glm::dvec3 cross = glm::cross(ab, ac);
    const double length = glm::length(cross);
    const std::uint32_t m = all.material[point.triangle];
    const MeshMaterial& material = m < materials.size() ? materials[m] : plain;
    cloud.position_m[i] =
        glm::vec3(a + double{point.weights.x} * ab + double{point.weights.y} * ac);
    cloud.normal[i] = glm::vec3(cross / length);
    const glm::vec4 color =
        appearance(all, material, point, cloud.normal[i], static_cast<float>(0.5 * length),
                   static_cast<float>(spacing_m));
    cloud.color[i] = glm::vec3(color);
    cloud.opacity[i] = material.opacity;
    keep[i] = color.w >= kMinAlpha;
  });

  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (keep[i] == 0) continue;
    cloud.position_m[kept] = cloud.position_m[i];
    cloud.normal[kept] = cloud.normal[i];
    cloud.color[kept] = cloud.color[i];
    cloud.opacity[kept++] = cloud.opacity[i];
  }
  if (kept == 0) throw InputError(path.string(), "has no surface that is not cut out");
  cloud.position_m.resize(kept);
  cloud.normal.resize(kept);
  cloud.color.resize(kept);
  cloud.opacity.resize(kept);
  return cloud;
}

}  // namespace foci
