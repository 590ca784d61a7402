#include "render/scene/io/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/scan_values.h"
#include "render/scene/io/triangulate.h"
#include "render/scene/mesh/orientation.h"
#include "render/scene/point_cloud.h"
#include "render/scene/sampling/poisson_disk.h"

namespace foci {
namespace {

/// A name as a field of a table: no tab, no line break.
std::string fieldOf(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return text.empty() ? "unnamed" : text;
}

/// Names that are taken get a number: "chair", "chair (2)".
std::vector<std::string> uniqueNames(const std::vector<std::string>& names) {
  std::vector<std::string> unique = {""};
  std::set<std::string> taken;
  std::map<std::string, int> next;
  for (const std::string& name : names) {
    std::string own = fieldOf(name);
    const std::string plain = own;
    for (int& i = next.try_emplace(plain, 2).first->second; !taken.insert(own).second; ++i) {
      own = plain + " (" + std::to_string(i) + ")";
    }
    unique.push_back(std::move(own));
  }
  return unique;
}

bool isUsable(const glm::vec3& p) {
  return std::abs(p.x) <= kFarthest_m && std::abs(p.y) <= kFarthest_m &&
         std::abs(p.z) <= kFarthest_m;  // false for NaN
}

}  // namespace

void MeshBuilder::startObject(std::string name) {
  if (object_names_.size() < kMaxObjects) object_names_.push_back(std::move(name));
}

void MeshBuilder::add(const std::array<MeshCorner, 3>& corners, std::uint32_t material) {
  if (!std::all_of(corners.begin(), corners.end(),
                   [](const MeshCorner& corner) { return isUsable(corner.position); })) {
    ++unusable_;
    return;
  }
  const glm::vec3 outwards = corners[0].normal + corners[1].normal + corners[2].normal;
  std::array<const MeshCorner*, 3> order{&corners[0], &corners[1], &corners[2]};
  if (outwards != glm::vec3(0.0f)) {
    has_normals_ = true;
    const glm::vec3 a = corners[0].position;
    const glm::vec3 cross = glm::cross(corners[1].position - a, corners[2].position - a);
    if (glm::dot(cross, outwards) < 0.0f) std::swap(order[1], order[2]);
  }
  for (const MeshCorner* corner : order) {
    const bool placed = std::abs(corner->uv.x) < 1e6f && std::abs(corner->uv.y) < 1e6f;
    mesh_.uv.push_back(placed ? corner->uv : glm::vec2(0.0f));
    if (corner->color.x >= 0.0f || !mesh_.color.empty()) {
      mesh_.color.resize(mesh_.corners_m.size(), glm::vec3(-1.0f));
      mesh_.color.push_back(corner->color);
    }
    if (corner->alpha < 1.0f || !mesh_.alpha.empty()) {
      mesh_.alpha.resize(mesh_.corners_m.size(), 1.0f);
      mesh_.alpha.push_back(corner->alpha >= 0.0f ? corner->alpha : 0.0f);
    }
    mesh_.corners_m.push_back(corner->position);
  }
  mesh_.material.push_back(material);
  if (material >= used_.size()) used_.resize(material + 1, 0);
  used_[material] = 1;
  objects_.push_back(static_cast<std::uint16_t>(object_names_.size()));
}

void MeshBuilder::addPolygon(std::span<const MeshCorner> corners, std::uint32_t material) {
  if (corners.size() == 3) {
    add({corners[0], corners[1], corners[2]}, material);
    return;
  }
  std::vector<glm::dvec3> places;
  for (const MeshCorner& corner : corners) places.emplace_back(corner.position);
  for (const auto& [a, b, c] : triangulate(places)) {
    add({corners[a], corners[b], corners[c]}, material);
  }
}

void MeshBuilder::remarkCount(std::uint64_t count, const std::string& one,
                              const std::string& several) {
  if (count > 0) remark(thousands(static_cast<double>(count)) + (count == 1 ? one : several));
}

bool MeshBuilder::useAlpha() {
  std::vector<float>& alpha = mesh_.alpha;
  if (alpha.size() == mesh_.corners_m.size() &&
      std::all_of(alpha.begin(), alpha.end(), [](float each) { return each == 0.0f; })) {
    remark("the alpha of all vertices is 0: shown opaque");
    alpha.clear();
  }
  return !alpha.empty();
}

std::vector<glm::vec3> MeshBuilder::placesOf(const std::vector<glm::dvec3>& places) {
  std::vector<glm::vec3> near;
  near.reserve(places.size());
  std::optional<glm::dvec3> first;
  for (const glm::dvec3& place : places) {
    if (!isNearEnough(place)) continue;
    if (!first) first = place;
    near.emplace_back(place);
  }
  const glm::dvec3 origin = first && losesDetail(near) ? originNear(*first) : glm::dvec3(0.0);
  if (const auto moved = originRemark(origin)) remark(*moved);
  near.clear();
  for (const glm::dvec3& place : places) near.emplace_back(place - origin);
  return near;
}

MeshFile MeshBuilder::finish(SceneFacts facts,
                             const std::function<ReadMaterial(std::uint32_t)>& read) {
  if (mesh_.size() == 0 && unusable_ == 0) {
    throw InputError(file_,
                     "is no mesh that can be read: it has no faces, or an empty part: save points "
                     "as PLY or XYZ");
  }
  if (!(areaOf_m2(mesh_.corners_m) > 0.0)) {
    throw InputError(file_, "has no triangle with an area within 1e9 units of the origin");
  }
  if (!mesh_.color.empty()) mesh_.color.resize(mesh_.corners_m.size(), glm::vec3(-1.0f));
  if (!mesh_.alpha.empty()) mesh_.alpha.resize(mesh_.corners_m.size(), 1.0f);
  readMaterials(facts, read);
  remarkCount(unusable_,
              " triangle has a corner that is not finite, or farther than 1e9 units from the "
              "origin: left out",
              " triangles have a corner that is not finite, or farther than 1e9 units from the "
              "origin: left out");
  foldColors();
  takeObjects(facts);
  remarkCount(dropUseless(mesh_), " triangle repeats another one: it is left out",
              " triangles repeat others: they are left out");
  orientOutwards(mesh_);
  facts.triangles = mesh_.size();
  facts.has_normals = has_normals_;
  for (std::size_t i = 0; i < mesh_.alpha.size(); ++i) {
    const MeshMaterial& material = mesh_.materials[mesh_.material[i / 3]];
    if (material.alpha != AlphaUse::blend) continue;
    facts.opacity.x = std::min(facts.opacity.x, mesh_.alpha[i] * material.opacity);
  }
  takeColors(facts);
  if (losesDetail(mesh_.corners_m)) {
    remark(
        "the mesh is so far from the origin that its detail is lost: move it to the origin, e.g. "
        "with CloudCompare");
  }
  return {std::move(mesh_), std::move(facts)};
}

void MeshBuilder::readMaterials(SceneFacts& facts,
                                const std::function<ReadMaterial(std::uint32_t)>& read) {
  mesh_.materials.resize(used_.size());
  material_names_.resize(used_.size());
  for (std::uint32_t m = 0; m < used_.size(); ++m) {
    if (used_[m] == 0) continue;
    ReadMaterial material = read(m);
    mesh_.materials[m] = std::move(material.material);
    if (!material.facts) continue;
    material_names_[m] = material.facts->name;
    facts.opacity.x = std::min(facts.opacity.x, material.facts->opacity);
    facts.materials.push_back(std::move(*material.facts));
  }
}

/// Colours of corners that are the same for all triangles of a material are the material's: such a
/// colour tells nothing of the light where the object was captured.
void MeshBuilder::foldColors() {
  if (mesh_.color.empty()) return;
  std::vector<std::optional<glm::vec3>> color(mesh_.materials.size());
  std::vector<std::uint8_t> varies(mesh_.materials.size(), 0);
  for (std::size_t i = 0; i < mesh_.color.size(); ++i) {
    const std::uint32_t m = mesh_.material[i / 3];
    if (!color[m]) color[m] = mesh_.color[i];
    varies[m] |= mesh_.color[i] != *color[m] || mesh_.color[i].x < 0.0f;
  }
  for (std::size_t m = 0; m < mesh_.materials.size(); ++m) {
    MeshMaterial& material = mesh_.materials[m];
    if (!color[m] || varies[m] != 0) continue;
    if (material.tinted) {
      material.factor *= *color[m];
    } else if (!material.texture) {
      material.factor = *color[m];
    }
  }
  bool any = false;
  for (std::size_t i = 0; i < mesh_.color.size(); ++i) {
    if (varies[mesh_.material[i / 3]] == 0) mesh_.color[i] = glm::vec3(-1.0f);
    any |= mesh_.color[i].x >= 0.0f;
  }
  if (!any) mesh_.color.clear();
}

/// Where the colours come from, of what the triangles use. Beside materials whose colour contains
/// light, those of one colour are shaded.
void MeshBuilder::takeColors(SceneFacts& facts) {
  facts.has_colors = !mesh_.color.empty();
  std::optional<glm::vec3> plain;
  for (std::size_t m = 0; m < mesh_.materials.size(); ++m) {
    if (used_[m] == 0) continue;
    MeshMaterial& material = mesh_.materials[m];
    material.shaded = !material.texture && !material.unlit;
    facts.has_colors |= !material.shaded;
    facts.material_colors |= material.factor != plain.value_or(material.factor);
    plain = material.factor;
  }
  facts.material_colors &= !facts.has_colors;
  if (facts.has_colors) return;
  for (MeshMaterial& material : mesh_.materials) material.shaded = false;
}

/// The objects of the file, or its materials if it has but one object.
void MeshBuilder::takeObjects(const SceneFacts& facts) {
  SceneObjects& objects = mesh_.objects;
  std::vector<std::uint16_t> number(object_names_.size() + 1, 0);  // of those with triangles
  std::vector<std::string> names;
  for (const std::uint16_t object : objects_) {
    if (object == 0 || number[object] != 0) continue;
    names.push_back(object_names_[object - 1]);
    number[object] = static_cast<std::uint16_t>(names.size());
  }
  if (names.size() > 1) {
    for (std::uint16_t& object : objects_) object = number[object];
  } else {
    names.clear();
    std::vector<std::uint16_t> of_material(used_.size(), 0);
    for (std::size_t m = 0; m < used_.size() && names.size() < kMaxObjects; ++m) {
      if (used_[m] == 0) continue;
      names.push_back(material_names_[m]);
      of_material[m] = static_cast<std::uint16_t>(names.size());
    }
    if (names.size() < 2 || facts.materials.empty()) return;
    for (std::size_t t = 0; t < objects_.size(); ++t) {
      objects_[t] = of_material[mesh_.material[t]];
    }
  }
  objects.names = uniqueNames(names);
  objects.of.own() = std::move(objects_);
}

std::optional<std::uint32_t> FaceColors::materialOf(const glm::vec3& color) {
  const auto key = std::tuple(color.x, color.y, color.z);
  if (const auto known = numbers_.find(key); known != numbers_.end()) return known->second;
  many_ = colors_.size() == kMaxColors;
  if (many_) return std::nullopt;
  const auto number = static_cast<std::uint32_t>(colors_.size());
  numbers_.emplace(key, number);
  colors_.push_back(color);
  return number;
}

ReadMaterial FaceColors::read(std::uint32_t number) const {
  return {.material = {.factor = colors_.at(number), .unlit = many_}};
}

}  // namespace foci
