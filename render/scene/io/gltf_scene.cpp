// glTF 2.0 (Khronos), sections 3.5 (nodes) and 3.7 (meshes); EXT_mesh_gpu_instancing,
// KHR_node_visibility.
#include "render/scene/io/gltf_scene.h"

#include <algorithm>
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxNodeDepth = 500;  // chosen by hand: exporters nest below 100 deep
constexpr double kMaxInstances = 1 << 18;

glm::dmat4 placeOf(const std::array<double, 3>& t, const std::array<double, 4>& q,
                   const std::array<double, 3>& s) {
  const glm::dquat turn(q[3], q[0], q[1], q[2]);
  glm::dmat4 matrix =
      glm::length(turn) > 0.0 ? glm::mat4_cast(glm::normalize(turn)) : glm::dmat4(1.0);
  for (int c = 0; c < 3; ++c) matrix[c] *= s[static_cast<std::size_t>(c)];
  matrix[3] = {t[0], t[1], t[2], 1.0};
  return matrix;
}

/// From a node to its parent.
glm::dmat4 parentFrom(const Json& node) {
  if (node.contains("matrix")) {
    constexpr std::array<double, 16> kUnit = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    return glm::make_mat4(listIn(node, "matrix", kUnit).data());
  }
  return placeOf(listIn<3>(node, "translation", {0, 0, 0}),
                 listIn<4>(node, "rotation", {0, 0, 0, 1}), listIn<3>(node, "scale", {1, 1, 1}));
}

/// The numbers in a list of an object; other entries are left out.
std::vector<std::size_t> numbersIn(const Json& object, const char* key) {
  std::vector<std::size_t> numbers;
  for (const Json& each : arrayIn(object, key)) {
    if (each.is_number_unsigned()) numbers.push_back(each.get<std::size_t>());
  }
  return numbers;
}

class Walk {
 public:
  explicit Walk(const GltfDocument& gltf) : gltf_(gltf) {}

  std::vector<GltfPlace> places(std::vector<std::string>& remarks) {
    const std::size_t count = arrayIn(gltf_.json(), "nodes").size();
    if (count == 0) gltf_.refuse("is no mesh that can be read: it has no scene with nodes");
    open_.assign(count, 0);
    for (const std::size_t root : roots(count)) visit(root, glm::dmat4(1.0), "", 1);
    if (hidden_ == 0) return std::move(places_);
    const std::string hidden = counted(hidden_, "node") + (hidden_ == 1 ? " is" : " are") +
                               " hidden (KHR_node_visibility)";
    if (places_.empty()) {
      gltf_.refuse("shows no mesh, as ", hidden, ": show its nodes, and export it again");
    }
    remarks.push_back(hidden + ": not shown");
    return std::move(places_);
  }

 private:
  std::vector<std::size_t> roots(std::size_t count) const {
    const Json* scene = gltf_.entry("scenes", gltf_.json(), "scene");
    if (scene == nullptr) scene = gltf_.entry("scenes", 0);
    if (scene != nullptr) return numbersIn(*scene, "nodes");
    const GltfNodes nodes(gltf_);
    std::vector<std::size_t> all;
    for (std::size_t n = 0; n < count; ++n) {
      if (nodes.isRoot(n)) all.push_back(n);
    }
    return all;
  }

  void visit(std::size_t number, const glm::dmat4& scene_from_parent, const std::string& above,
             std::size_t depth) {
    const Json* const node = gltf_.entry("nodes", number);
    if (node == nullptr) return;
    const Json* const seen = extensionOf(*node, "KHR_node_visibility");
    if (seen != nullptr && seen->value("visible", Json()) == false) {
      ++hidden_;
      return;  // what is below is hidden, too
    }
    if (open_[number] != 0) gltf_.refuse("node ", number, " is below itself");
    if (depth > kMaxNodeDepth) {
      gltf_.refuse("its nodes nest over ", kMaxNodeDepth, " deep");
    }
    count(1.0);
    open_[number] = 1;
    const glm::dmat4 scene_from_node = scene_from_parent * parentFrom(*node);
    const std::string own = textIn(*node, "name").value_or(""), &name = own.empty() ? above : own;
    if (gltf_.entry("meshes", *node, "mesh") != nullptr) {
      addPlaces(*node, {.node = number,
                        .mesh = numberIn(gltf_, *node, "mesh", kNoEntry),
                        .scene_from_mesh = scene_from_node,
                        .name = name});
    }
    for (const std::size_t child : numbersIn(*node, "children")) {
      visit(child, scene_from_node, name, depth + 1);
    }
    open_[number] = 0;
  }

  void count(double more) {
    instances_ += more;
    if (instances_ <= kMaxInstances) return;
    gltf_.refuse("its scene graph has more instances of nodes: expected at most ",
                 thousands(kMaxInstances));
  }

  void addPlaces(const Json& node, GltfPlace place) {
    if (gltf_.entry("skins", node, "skin") != nullptr) {
      place.skin = numberIn(gltf_, node, "skin", kNoEntry);
      place.scene_from_mesh = glm::dmat4(1.0);
    }
    const Json* const extension = extensionOf(node, "EXT_mesh_gpu_instancing");
    if (extension == nullptr) {
      places_.push_back(std::move(place));
      return;
    }
    const Json attributes = extension->value("attributes", Json::object());
    std::size_t instances = 0;
    const auto read = [&](const char* name, std::size_t components) {
      const std::size_t accessor = numberIn(gltf_, attributes, name, kNoEntry);
      if (accessor == kNoEntry) return std::vector<float>();
      count(static_cast<double>(gltf_.countOf(accessor)));
      std::vector<float> values = gltf_.floats(accessor, components);
      instances = std::max(instances, values.size() / components);
      return values;
    };
    const auto t = read("TRANSLATION", 3), q = read("ROTATION", 4), s = read("SCALE", 3);
    // The colours of instances, as three.js writes them.
    std::size_t channels = 0;
    std::vector<float> rgb;
    try {
      const std::size_t colors = numberIn(gltf_, attributes, "_COLOR_0", kNoEntry);
      if (colors != kNoEntry) channels = gltf_.componentsOf(colors);
      if (channels >= 3) rgb = gltf_.floats(colors, channels, /*as_unit=*/true);
    } catch (const InputError&) {
      // The name is the file's own, and may stand for something else.
    }
    const glm::dmat4 scene_from_node = place.scene_from_mesh;
    for (std::size_t i = 0; i < instances; ++i) {
      const auto part = [i]<std::size_t N>(const std::vector<float>& all,
                                           std::array<double, N> otherwise) {
        for (std::size_t c = 0; c < N && (i + 1) * N <= all.size(); ++c) {
          otherwise[c] = double{all[i * N + c]};
        }
        return otherwise;
      };
      place.scene_from_mesh = scene_from_node * placeOf(part(t, std::array{0.0, 0.0, 0.0}),
                                                        part(q, std::array{0.0, 0.0, 0.0, 1.0}),
                                                        part(s, std::array{1.0, 1.0, 1.0}));
      place.tint.reset();
      if ((i + 1) * channels <= rgb.size() && channels > 0) {
        place.tint = glm::clamp(glm::make_vec3(&rgb[i * channels]), 0.0f, 1.0f);
      }
      places_.push_back(place);
    }
  }

  const GltfDocument& gltf_;
  std::vector<GltfPlace> places_;
  std::vector<std::uint8_t> open_;  // by node: on the path to the one that is visited
  double instances_ = 0.0;
  std::size_t hidden_ = 0;  // nodes
};

}  // namespace

std::vector<GltfPlace> placesOf(const GltfDocument& gltf, std::vector<std::string>& remarks) {
  return Walk(gltf).places(remarks);
}

GltfNodes::GltfNodes(const GltfDocument& gltf) : gltf_(gltf) {
  const Json& nodes = arrayIn(gltf.json(), "nodes");
  parents_.assign(nodes.size(), kNoEntry);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    for (const std::size_t child : numbersIn(nodes[n], "children")) {
      if (child < parents_.size()) parents_[child] = n;
    }
  }
}

glm::dmat4 GltfNodes::sceneFrom(std::size_t node) const {
  glm::dmat4 place(1.0);
  // A circle, which glTF forbids, ends.
  for (std::size_t step = 0; node < parents_.size() && step < parents_.size(); ++step) {
    if (const Json* const at = gltf_.entry("nodes", node)) place = parentFrom(*at) * place;
    node = parents_[node];
  }
  return place;
}

std::size_t modeOf(const GltfDocument& gltf, const Json& primitive) {
  return numberIn(gltf, primitive, "mode", 4);
}

GltfPrimitive::GltfPrimitive(const GltfDocument& gltf, const Json& json)
    : gltf_(gltf), json_(json) {
  const std::size_t position =
      numberIn(gltf, json_.value("attributes", Json()), "POSITION", kNoEntry);
  if (position == kNoEntry) gltf.refuse("a primitive has no POSITION");
  vertices_ = gltf.countOf(position);
  const Json* const packed = extensionOf(json, "KHR_draco_mesh_compression");
  if (packed == nullptr) return;
  std::map<std::string, std::uint32_t> ids;
  const Json names = packed->value("attributes", Json::object());
  for (const auto& [name, id] : names.items()) {
    if (id.is_number_unsigned()) ids[name] = id.get<std::uint32_t>();
  }
  draco_ = decodeDraco(gltf.view(numberIn(gltf, *packed, "bufferView", kNoEntry)), ids);
  if (!draco_) {
    gltf.refuse(
        "is compressed with KHR_draco_mesh_compression, and cannot be decoded: save it without "
        "compression");
  }
  vertices_ = draco_->vertices;
}

std::size_t GltfPrimitive::componentsOf(const std::string& attribute) const {
  if (draco_) {
    const auto found = draco_->attributes.find(attribute);
    if (found != draco_->attributes.end()) return found->second.components;
  }
  const std::size_t accessor =
      numberIn(gltf_, json_.value("attributes", Json()), attribute.c_str(), kNoEntry);
  return accessor == kNoEntry ? 0 : gltf_.componentsOf(accessor);
}

std::vector<float> GltfPrimitive::floats(const std::string& attribute,
                                         std::size_t components) const {
  const std::size_t accessor =
      numberIn(gltf_, json_.value("attributes", Json()), attribute.c_str(), kNoEntry);
  if (accessor == kNoEntry) return {};
  std::vector<float> values;
  const auto unpacked =
      draco_ ? draco_->attributes.find(attribute) : decltype(draco_->attributes.find(attribute)){};
  if (draco_ && unpacked != draco_->attributes.end()) {
    if (unpacked->second.components == components) values = unpacked->second.values;
    const Json* const stated = gltf_.entry("accessors", accessor);
    if (stated != nullptr && stated->value("normalized", Json()) == true &&
        !unpacked->second.scaled) {
      const std::size_t type = numberIn(gltf_, *stated, "componentType", 0);
      const float most = type == 5120   ? 127.0f
                         : type == 5121 ? 255.0f
                         : type == 5122 ? 32767.0f
                                        : 65535.0f;
      for (float& value : values) value = std::max(value / most, -1.0f);
    }
  } else {
    // Integer colours are normalised (3.7.2.1), and some exporters forget to say so.
    values = gltf_.floats(accessor, components, /*as_unit=*/attribute.starts_with("COLOR_"));
  }
  if (values.size() == vertices_ * components) return values;
  gltf_.refuse("a primitive cannot be read: it has ", thousands(static_cast<double>(vertices_)),
               " positions and ", thousands(static_cast<double>(values.size() / components)),
               " of ", shown(attribute), ": export it again");
}

std::vector<std::uint32_t> GltfPrimitive::indices() const {
  if (draco_) return draco_->indices;
  const std::size_t accessor = numberIn(gltf_, json_, "indices", kNoEntry);
  if (accessor != kNoEntry) return gltf_.integers(accessor);
  std::vector<std::uint32_t> all(vertices_);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
  return all;
}

std::vector<std::uint32_t> GltfPrimitive::triangles() const {
  const std::size_t mode = modeOf(gltf_, json_);
  if (mode < 4 || mode > 6) return {};
  std::vector<std::uint32_t> corners = indices();
  if (mode == 4 || draco_) {
    corners.resize(corners.size() / 3 * 3);
    return corners;
  }
  std::vector<std::uint32_t> triangles;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const std::size_t odd = i % 2;  // of a strip: wound the other way round
    const std::array<std::size_t, 3> at = mode == 6 ? std::array<std::size_t, 3>{0, i - 1, i}
                                                    : std::array{i - 2, i - 1 + odd, i - odd};
    for (const std::size_t corner : at) triangles.push_back(corners[corner]);
  }
  return triangles;
}

}  // namespace foci
