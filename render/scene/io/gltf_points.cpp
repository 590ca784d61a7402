#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/gltf_scene.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/scan_values.h"
#include "render/scene/scene.h"

namespace foci {
namespace {

using JsonValue = nlohmann::json;

constexpr const char* kExtension = "KHR_gaussian_splatting";

glm::vec3 vectorAt(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Linear light as a display value, and how much that changes with it (IEC 61966-2-1).
std::pair<float, float> displayAndSlope(float x) {
  if (x <= 0.0031308f) return {12.92f * x, 12.92f};
  const float power = std::pow(std::min(x, 1.0f), 1.0f / 2.4f);
  return {1.055f * power - 0.055f, 1.055f / 2.4f * power / std::min(x, 1.0f)};
}

class GltfPointReader {
 public:
  explicit GltfPointReader(const GltfDocument& gltf) : gltf_(gltf) {}

  GltfPoints read() {
    std::vector<std::string> said;
    for (const GltfPlace& place : placesOf(gltf_, said)) addPlace(place);
    if (has_triangles_) said.clear();  // the mesh says it, too
    if (joined_) remarks_.insert(said.begin(), said.end());
    if (!joined_) points_.remarks = std::move(said);
    GltfPoints found{.has_triangles = has_triangles_};
    if (joined_) {
      found.gaussians = GaussianFile{.cloud = std::move(*joined_),
                                     .format = kExtension,
                                     .y_is_up = true,
                                     .dropped = dropped_,
                                     .remarks = {remarks_.begin(), remarks_.end()},
                                     .unit_m = 1.0};
      finishGaussians(*found.gaussians, gltf_.path().string());
    }
    if (points_.size() > 0) {
      positions_.finish(gltf_.path().string());
      points_.format = "glTF points";
      points_.unit_m = 1.0;
      if (!has_normals_) points_.normal.clear();
      remarkDark(points_);
      dropPlainOpacity(points_);
      found.points = std::move(points_);
    }
    return found;
  }

 private:
  void addPlace(const GltfPlace& place) {
    const JsonValue& mesh = *gltf_.entry("meshes", place.mesh);
    for (const JsonValue& primitive : mesh.value("primitives", JsonValue::array())) {
      const std::size_t mode = modeOf(gltf_, primitive);
      has_triangles_ = has_triangles_ || mode >= 4;
      if (mode != 0) continue;
      if (const JsonValue* const extension = extensionOf(primitive, kExtension)) {
        addGaussians(primitive, *extension, place.scene_from_mesh);
      } else {
        addPoints(primitive, place.scene_from_mesh);
      }
    }
  }

  void addPoints(const JsonValue& primitive, const glm::dmat4& scene_from_node) {
    const GltfPrimitive numbers(gltf_, primitive);
    const std::vector<float> positions = numbers.floats("POSITION", 3),
                             normals = numbers.floats("NORMAL", 3);
    const std::size_t count = numbers.vertices(),
                      channels = numbers.componentsOf("COLOR_0") == 3 ? 3 : 4;
    const std::vector<float> colors = numbers.floats("COLOR_0", channels);
    const JsonValue* const material = gltf_.entry("materials", primitive, "material");
    const JsonValue* const base = material ? partOf(*material, "pbrMetallicRoughness") : nullptr;
    const auto factor =
        listIn<4>(base ? *base : JsonValue(), "baseColorFactor", {1.0, 1.0, 1.0, 1.0});
    const glm::vec3 tint(glm::clamp(glm::dvec3(factor[0], factor[1], factor[2]), 0.0, 1.0));
    const glm::dmat3 turn = glm::transpose(glm::inverse(glm::dmat3(scene_from_node)));
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec4 p(glm::dvec3(vectorAt(positions, i)), 1.0);
      if (!positions_.append(glm::dvec3(scene_from_node * p))) continue;
      const glm::vec3 normal =
          normals.empty() ? glm::vec3(0.0f) : unitNormal(turn * glm::dvec3(vectorAt(normals, i)));
      has_normals_ = has_normals_ || normal != glm::vec3(0.0f);
      points_.normal.push_back(normal);
      glm::vec4 light(material || !colors.empty() ? glm::vec3(1.0f) : glm::vec3(kUncolouredLight),
                      1.0f);
      for (std::size_t c = 0; c < channels && !colors.empty(); ++c) {
        const float value = colors[channels * i + c];  // false for NaN
        light[static_cast<int>(c)] = value >= 0.0f ? std::min(value, 1.0f) : 0.0f;
      }
      points_.color.push_back(glm::vec3(light) * tint);
      points_.opacity.push_back(light.a);
    }
  }

  void addGaussians(const JsonValue& primitive, const JsonValue& extension,
                    const glm::dmat4& scene_from_node) {
    const JsonValue* const compression = compressionIn(extension);
    GaussianFile file =
        compression != nullptr ? unpackedGaussians(*compression) : plainGaussians(primitive);
    if (extension.value("colorSpace", "srgb_rec709_display") == "lin_rec709_display") {
      toDisplay(file.cloud);
    }
    if (const std::string kernel = extension.value("kernel", "ellipse"); kernel != "ellipse") {
      remarks_.insert("its Gaussians have the kernel " + shown(kernel) + ": shown as ellipses");
    }
    dropped_ += file.dropped;
    remarks_.insert(file.remarks.begin(), file.remarks.end());
    if (!(std::abs(glm::determinant(glm::dmat3(scene_from_node))) > 1e-30)) {
      remarks_.insert("a node scales Gaussians to nothing: they are left out");
      return;
    }
    transform(file.cloud, glm::mat3(scene_from_node), glm::vec3(scene_from_node[3]));
    joined_ = joined_ ? joined(std::move(*joined_), std::move(file.cloud)) : std::move(file.cloud);
  }

  static const JsonValue* compressionIn(const JsonValue& extension) {
    const auto inner = extension.find("extensions");
    if (inner == extension.end()) return nullptr;
    for (const auto& [name, value] : inner->items()) {
      if (name.starts_with("KHR_gaussian_splatting_compression_spz")) return &value;
    }
    return nullptr;
  }

  GaussianFile unpackedGaussians(const JsonValue& compression) {
    const auto bytes = gltf_.view(numberIn(gltf_, compression, "bufferView", kNoEntry));
    return readSpz(FileBytes(gltf_.path().string(), {bytes.begin(), bytes.end()}));
  }

  /// Coefficients of degree 1 and more, by degree and order; as many as the file has whole degrees.
  std::vector<std::vector<float>> harmonicsIn(const GltfPrimitive& numbers) {
    std::vector<std::vector<float>> all;
    for (int degree = 1; degree <= kMaxHarmonicsDegree + 1; ++degree) {
      for (int order = 0; order <= 2 * degree; ++order) {
        auto values = numbers.floats(coefficientName(degree, order), 3);
        if (values.empty() && order == 0) return all;
        if (values.empty()) {
          gltf_.refuse("expected the attribute ", coefficientName(degree, order));
        }
        if (degree > kMaxHarmonicsDegree) {
          remarks_.insert(kDegree4);
          return all;
        }
        all.push_back(std::move(values));
      }
    }
    return all;
  }

  static std::string coefficientName(int degree, int order) {
    return std::string(kExtension) + ":SH_DEGREE_" + std::to_string(degree) + "_COEF_" +
           std::to_string(order);
  }

  GaussianFile plainGaussians(const JsonValue& primitive) {
    const GltfPrimitive numbers(gltf_, primitive);
    const std::vector<float> positions = numbers.floats("POSITION", 3);
    const std::size_t count = numbers.vertices();
    const auto attribute = [&](const char* name, std::size_t components) {
      const std::string whole = std::string(kExtension) + ":" + name;
      std::vector<float> values = numbers.floats(whole, components);
      if (values.empty()) gltf_.refuse("expected the attribute ", whole);
      return values;
    };
    const auto rotations = attribute("ROTATION", 4), opacities = attribute("OPACITY", 1);
    std::vector<float> scales = attribute("SCALE", 3);
    if (std::ranges::any_of(scales, [](float s) { return s < 0.0f; })) {
      remarks_.insert("its scales are negative: taken for logarithms, as drafts of " +
                      std::string(kExtension) + " had them");
      for (float& s : scales) s = std::exp(s);
    }
    const auto colors = attribute("SH_DEGREE_0_COEF_0", 3);
    const auto coefficients = harmonicsIn(numbers);
    int degree = 0;
    while (harmonicsOf(degree) < static_cast<int>(coefficients.size())) ++degree;
    GaussianFile file;
    GaussianCollector collector(file, count, degree);
    std::vector<float> harmonics(file.cloud.harmonicsPerGaussian());
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < coefficients.size(); ++k) {
        std::copy_n(coefficients[k].begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                    harmonics.begin() + static_cast<std::ptrdiff_t>(3 * k));
      }
      collector.append({.position = vectorAt(positions, i),
                        .sigma = vectorAt(scales, i),
                        .rotation = {rotations[4 * i], rotations[4 * i + 1], rotations[4 * i + 2],
                                     rotations[4 * i + 3]},
                        .opacity = opacities[i],
                        .color = 0.5f + kHarmonic0 * vectorAt(colors, i)},
                       harmonics);
    }
    return file;
  }

  /// Linear colours become display values; what depends on the direction, to first order.
  void toDisplay(GaussianCloud& cloud) {
    remarks_.insert(
        "its colours are linear: shown as display values, and what depends on the direction only "
        "nearly so");
    const std::size_t each = cloud.harmonicsPerGaussian();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        float& color = cloud.color[i][static_cast<int>(c)];
        const auto [display, slope] = displayAndSlope(color);
        color = display;
        for (std::size_t k = c; k < each; k += 3) {
          const float steps = slope * static_cast<float>(cloud.harmonics[i * each + k]);
          cloud.harmonics[i * each + k] =
              static_cast<std::int16_t>(std::clamp(steps, -32767.0f, 32767.0f));
        }
      }
    }
  }

  const GltfDocument& gltf_;
  std::optional<GaussianCloud> joined_;  // so far
  PointCloud points_;
  ScanPositions positions_{points_};
  std::set<std::string> remarks_;
  std::size_t dropped_ = 0;
  bool has_triangles_ = false, has_normals_ = false;
};

}  // namespace

GltfPoints readGltfPoints(const GltfDocument& gltf) {
  try {
    return GltfPointReader(gltf).read();
  } catch (const JsonValue::exception&) {
    gltf.refuse("is no glTF that can be read: a part has another type than glTF states");
  }
}

}  // namespace foci
