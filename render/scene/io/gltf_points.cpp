#include "render/scene/io/gltf_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/gaussian_transform.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/gltf_accessors.h"
#include "render/scene/io/gltf_document.h"
#include "render/scene/io/scan_values.h"
#include "render/scene/joined_scene.h"

namespace foci {
namespace {

using JsonValue = nlohmann::json;

constexpr std::size_t kAbsent = SIZE_MAX;
constexpr std::size_t kPointsMode = 0, kTrianglesMode = 4, kMostDepth = 256;
constexpr const char* kExtension = "KHR_gaussian_splatting";

template <std::size_t N>
std::array<double, N> listIn(const JsonValue& node, const char* key, std::array<double, N> usual) {
  const auto found = node.find(key);
  if (found == node.end() || !found->is_array() || found->size() != N) return usual;
  return found->get<std::array<double, N>>();
}

/// From a node to its parent.
glm::dmat4 parentFromNode(const JsonValue& node) {
  glm::dmat4 matrix(1.0);
  if (node.contains("matrix")) {
    const auto m = listIn<16>(node, "matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = m[static_cast<std::size_t>(i)];
    return matrix;
  }
  const auto t = listIn<3>(node, "translation", {0, 0, 0}), s = listIn<3>(node, "scale", {1, 1, 1});
  const auto q = listIn<4>(node, "rotation", {0, 0, 0, 1});
  matrix = glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
  for (int c = 0; c < 3; ++c) matrix[c] *= s[static_cast<std::size_t>(c)];
  matrix[3] = {t[0], t[1], t[2], 1.0};
  return matrix;
}

glm::vec3 vectorAt(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Linear light as a display value, and how much that changes with it (IEC 61966-2-1).
std::pair<float, float> displayOfLinear(float x) {
  if (x <= 0.0031308f) return {12.92f * x, 12.92f};
  const float power = std::pow(std::min(x, 1.0f), 1.0f / 2.4f);
  return {1.055f * power - 0.055f, 1.055f / 2.4f * power / std::min(x, 1.0f)};
}

class GltfPointReader {
 public:
  explicit GltfPointReader(const std::filesystem::path& path)
      : gltf_(readGltf(path)), accessors_(gltf_.path, gltf_.json) {}

  GltfPoints read() {
    for (const std::size_t root : roots()) visit(root, glm::dmat4(1.0), 0);
    GltfPoints found{.has_triangles = has_triangles_};
    if (joined_.gaussians) {
      found.gaussians = GaussianFile{.cloud = *joined_.gaussians,
                                     .format = kExtension,
                                     .y_is_up = true,
                                     .dropped = dropped_,
                                     .remarks = {remarks_.begin(), remarks_.end()},
                                     .unit_m = 1.0};
      finishGaussians(*found.gaussians, gltf_.path.string());
    }
    if (points_.size() > 0) {
      positions_.finish();
      points_.format = "glTF points";
      points_.unit_m = 1.0;
      if (!has_normals_) points_.normal.clear();
      remarkDark(points_);
      found.points = std::move(points_);
    }
    return found;
  }

 private:
  InputError refusal(const std::string& what) const { return {gltf_.path.string(), what}; }

  /// The nodes of the scene that the file shows; without scenes, all that no node holds.
  std::vector<std::size_t> roots() const {
    const JsonValue& json = gltf_.json;
    const JsonValue* const scene = listEntry(json, "scenes", numberIn(json, "scene", 0));
    if (scene != nullptr) return scene->value("nodes", std::vector<std::size_t>{});
    std::set<std::size_t> held;
    const JsonValue nodes = json.value("nodes", JsonValue::array());
    for (const JsonValue& node : nodes) {
      for (const std::size_t child : node.value("children", std::vector<std::size_t>{})) {
        held.insert(child);
      }
    }
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!held.contains(i)) roots.push_back(i);
    }
    return roots;
  }

  void visit(std::size_t number, const glm::dmat4& scene_from_parent, std::size_t depth) {
    const JsonValue* const node = listEntry(gltf_.json, "nodes", number);
    if (node == nullptr || depth > kMostDepth) return;
    const glm::dmat4 scene_from_node = scene_from_parent * parentFromNode(*node);
    const JsonValue* const mesh = listEntry(gltf_.json, "meshes", numberIn(*node, "mesh", kAbsent));
    if (mesh != nullptr) {
      for (const JsonValue& primitive : mesh->value("primitives", JsonValue::array())) {
        const std::size_t mode = numberIn(primitive, "mode", kTrianglesMode);
        has_triangles_ = has_triangles_ || mode >= kTrianglesMode;
        if (mode != kPointsMode) continue;
        const JsonValue extensions = primitive.value("extensions", JsonValue::object());
        if (const auto found = extensions.find(kExtension); found != extensions.end()) {
          addGaussians(primitive, *found, scene_from_node);
        } else {
          addPoints(primitive, scene_from_node);
        }
      }
    }
    for (const std::size_t child : node->value("children", std::vector<std::size_t>{})) {
      visit(child, scene_from_node, depth + 1);
    }
  }

  /// The numbers of an attribute, `components` for each point; empty if it is not there.
  std::vector<float> valuesOf(const JsonValue& primitive, const std::string& attribute,
                              std::size_t components, std::size_t count) {
    const JsonValue attributes = primitive.value("attributes", JsonValue::object());
    const std::size_t accessor = numberIn(attributes, attribute.c_str(), kAbsent);
    if (accessor == kAbsent) return {};
    auto values = accessors_.valuesOf(accessor);
    if (!values || (count > 0 && values->size() != count * components) ||
        values->size() % components != 0) {
      throw refusal("the attribute " + attribute +
                    " of points cannot be read: is a buffer's file missing, or compressed?");
    }
    return std::move(*values);
  }

  std::vector<float> positionsOf(const JsonValue& primitive) {
    std::vector<float> positions = valuesOf(primitive, "POSITION", 3, 0);
    if (positions.empty()) throw refusal("has points without POSITION");
    return positions;
  }

  void addPoints(const JsonValue& primitive, const glm::dmat4& scene_from_node) {
    const std::vector<float> positions = positionsOf(primitive);
    const std::size_t count = positions.size() / 3;
    const std::vector<float> normals = valuesOf(primitive, "NORMAL", 3, count);
    std::size_t channels = 4;
    const std::size_t color = numberIn(primitive.at("attributes"), "COLOR_0", kAbsent);
    if (const JsonValue* const accessor = listEntry(gltf_.json, "accessors", color)) {
      channels = accessor->value("type", "") == "VEC3" ? 3 : 4;
    }
    const std::vector<float> colors = valuesOf(primitive, "COLOR_0", channels, count);
    const glm::dmat3 turn = glm::transpose(glm::inverse(glm::dmat3(scene_from_node)));
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec4 p(glm::dvec3(vectorAt(positions, i)), 1.0);
      if (!positions_.append(glm::dvec3(scene_from_node * p))) continue;
      glm::vec3 normal(0.0f);
      if (!normals.empty()) {
        const glm::dvec3 n = turn * glm::dvec3(vectorAt(normals, i));
        if (const double length = glm::length(n); length > 1e-12) normal = glm::vec3(n / length);
      }
      has_normals_ = has_normals_ || normal != glm::vec3(0.0f);
      points_.normal.push_back(normal);
      glm::vec4 light(glm::vec3(kUncolouredLight), 1.0f);
      for (std::size_t c = 0; c < channels && !colors.empty(); ++c) {
        const float value = colors[channels * i + c];  // false for NaN
        light[static_cast<int>(c)] = value >= 0.0f ? std::min(value, 1.0f) : 0.0f;
      }
      points_.color.emplace_back(light);
      points_.opacity.push_back(light.a);
    }
  }

  void addGaussians(const JsonValue& primitive, const JsonValue& extension,
                    const glm::dmat4& scene_from_node) {
    GaussianFile file =
        isCompressed(extension) ? unpackedGaussians(extension) : plainGaussians(primitive);
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
    SurfelCloud part;
    part.gaussians = std::make_shared<const GaussianCloud>(std::move(file.cloud));
    joined_ = joined_.gaussians ? joined(std::move(joined_), std::move(part), "") : part;
  }

  static const JsonValue* compressionIn(const JsonValue& extension) {
    const auto inner = extension.find("extensions");
    if (inner == extension.end()) return nullptr;
    for (const auto& [name, value] : inner->items()) {
      if (name.starts_with("KHR_gaussian_splatting_compression_spz")) return &value;
    }
    return nullptr;
  }
  static bool isCompressed(const JsonValue& extension) {
    return compressionIn(extension) != nullptr;
  }

  GaussianFile unpackedGaussians(const JsonValue& extension) {
    const std::size_t view = numberIn(*compressionIn(extension), "bufferView", kAbsent);
    auto bytes = accessors_.bytesOfView(view);
    if (!bytes) throw refusal("its SPZ data cannot be read: is a buffer's file missing?");
    return readSpz(FileBytes(gltf_.path.string(), std::move(*bytes)));
  }

  /// Coefficients of degree 1 and more, by degree and order; as many as the file has whole degrees.
  std::vector<std::vector<float>> harmonicsIn(const JsonValue& primitive, std::size_t count) {
    std::vector<std::vector<float>> all;
    for (int degree = 1; degree <= kMaxHarmonicsDegree + 1; ++degree) {
      for (int order = 0; order <= 2 * degree; ++order) {
        auto values = valuesOf(primitive, coefficientName(degree, order), 3, count);
        if (values.empty() && order == 0) return all;
        if (values.empty()) {
          throw refusal("expected the attribute " + coefficientName(degree, order));
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
    const std::vector<float> positions = positionsOf(primitive);
    const std::size_t count = positions.size() / 3;
    const auto attribute = [&](const char* name, std::size_t components) {
      const std::string whole = std::string(kExtension) + ":" + name;
      std::vector<float> values = valuesOf(primitive, whole, components, count);
      if (values.empty()) throw refusal("expected the attribute " + whole);
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
    const auto coefficients = harmonicsIn(primitive, count);
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
        "its colours are linear: shown as display values, and what depends on the "
        "direction only nearly so");
    const std::size_t each = cloud.harmonicsPerGaussian();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        float& color = cloud.color[i][static_cast<int>(c)];
        const auto [display, slope] = displayOfLinear(color);
        color = display;
        for (std::size_t k = c; k < each; k += 3) {
          const float steps = slope * static_cast<float>(cloud.harmonics[i * each + k]);
          cloud.harmonics[i * each + k] =
              static_cast<std::int16_t>(std::clamp(steps, -32767.0f, 32767.0f));
        }
      }
    }
  }

  GltfDocument gltf_;
  GltfAccessors accessors_;
  SurfelCloud joined_;  // the Gaussians so far
  PointCloud points_;
  ScanPositions positions_{points_};
  std::set<std::string> remarks_;
  std::size_t dropped_ = 0;
  bool has_triangles_ = false, has_normals_ = false;
};

}  // namespace

GltfPoints readGltfPoints(const std::filesystem::path& path) {
  try {
    return GltfPointReader(path).read();
  } catch (const JsonValue::exception&) {
    throw InputError(path.string(),
                     "is no glTF that can be read: a part has another type than "
                     "glTF states");
  }
}

}  // namespace foci
