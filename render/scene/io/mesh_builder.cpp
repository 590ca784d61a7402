#include "render/scene/io/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"
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

/// Adds a remark if the connected parts of a mesh lie so far apart that each is small in view.
void remarkFarApart(TriangleMesh& mesh) {
  constexpr float kFar = 32.0f;  // chosen by hand
  using Box = std::pair<glm::vec3, glm::vec3>;
  std::vector<Box> parts(mesh.surface.empty() ? 0 : 1 + *std::ranges::max_element(mesh.surface),
                         Box(glm::vec3(kFarthest_m), glm::vec3(-kFarthest_m)));
  for (std::size_t i = 0; i < 3 * mesh.surface.size(); ++i) {
    auto& [low, high] = parts[mesh.surface[i / 3]];
    low = glm::min(low, mesh.corners_m[i]);
    high = glm::max(high, mesh.corners_m[i]);
  }
  float sizes = 0.0f;
  for (const auto& [low, high] : parts) sizes += glm::length(high - low);
  const auto [low, high] = boxOf(mesh.corners_m);
  if (glm::length(high - low) <= kFar * sizes) return;
  mesh.remarks.push_back(
      "its " + counted(parts.size(), "part") +
      " lie so far apart that each is small in view: is one in another unit, or out of place?");
}

constexpr std::size_t kMaxEarCorners = 1024;  // ears take quadratic time

/// Twice the signed area.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The corners along the two axes across which the polygon is largest, counter-clockwise.
std::vector<glm::dvec2> flattened(std::span<const glm::dvec3> corners) {
  glm::dvec3 normal(0.0);  // Newell's: twice the area
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += glm::cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
  }
  int drop = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(normal[axis]) > std::abs(normal[drop])) drop = axis;
  }
  const int first = (drop + 1) % 3, second = (drop + 2) % 3;
  const double sign = normal[drop] < 0.0 ? -1.0 : 1.0;
  std::vector<glm::dvec2> flat;
  flat.reserve(corners.size());
  for (const glm::dvec3& p : corners) flat.emplace_back(p[first], sign * p[second]);
  return flat;
}

/// The polygon that is left, as a ring of its corners.
class Ring {
 public:
  explicit Ring(std::vector<glm::dvec2> flat) : flat_(std::move(flat)) {
    const auto count = static_cast<std::uint32_t>(flat_.size());
    before_.resize(count);
    after_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      before_[i] = (i + count - 1) % count;
      after_[i] = (i + 1) % count;
    }
  }

  std::uint32_t before(std::uint32_t i) const { return before_[i]; }
  std::uint32_t after(std::uint32_t i) const { return after_[i]; }

  /// Whether the triangle at a corner lies inside the polygon and holds no other corner.
  bool isEar(std::uint32_t i) const {
    const glm::dvec2 &a = flat_[before_[i]], &b = flat_[i], &c = flat_[after_[i]];
    if (turn(a, b, c) <= 0.0) return false;
    for (std::uint32_t k = after_[after_[i]]; k != before_[i]; k = after_[k]) {
      const glm::dvec2& p = flat_[k];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
    }
    return true;
  }

  bool isConvex() const {
    for (std::uint32_t i = 0; i < flat_.size(); ++i) {
      if (turn(flat_[before_[i]], flat_[i], flat_[after_[i]]) < 0.0) return false;
    }
    return true;
  }

  void cut(std::uint32_t i) {
    after_[before_[i]] = after_[i];
    before_[after_[i]] = before_[i];
  }

 private:
  std::vector<glm::dvec2> flat_;
  std::vector<std::uint32_t> before_, after_;
};

/// Triangles of a polygon, by numbers of its corners, in its winding: ears are cut off in the plane
/// of the polygon (Meisters 1975). A polygon that crosses itself, or has more than 1024 corners,
/// becomes a fan.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const glm::dvec3> corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (corners.size() < 3) return triangles;
  const auto count = static_cast<std::uint32_t>(corners.size());
  triangles.reserve(count - 2);
  Ring ring(flattened(corners));
  std::uint32_t at = 0;
  if (count > 3 && count <= kMaxEarCorners && !ring.isConvex()) {
    std::vector<std::uint8_t> ear(count);  // a cut changes those of its two neighbours
    for (std::uint32_t i = 0; i < count; ++i) ear[i] = ring.isEar(i);
    std::uint32_t refused = 0;
    for (std::uint32_t left = count; left > 3 && refused < left;) {
      if (ear[at] == 0) {
        at = ring.after(at);
        ++refused;
        continue;
      }
      const std::uint32_t before = ring.before(at), after = ring.after(at);
      triangles.push_back({before, at, after});
      ring.cut(at);
      ear[before] = ring.isEar(before);
      ear[after] = ring.isEar(after);
      --left;
      refused = 0;
      at = ring.after(after);  // not `after`: slivers around one corner would result
    }
  }
  // A triangle, a convex polygon, or what has no ears.
  const std::uint32_t first = at;
  for (std::uint32_t i = ring.after(first); ring.after(i) != first; i = ring.after(i)) {
    triangles.push_back({first, i, ring.after(i)});
  }
  return triangles;
}

}  // namespace

glm::dmat3 normalsFrom(const glm::dmat3& places) {
  return glm::determinant(places) == 0.0 ? places : glm::transpose(glm::inverse(places));
}

std::uint16_t MeshBuilder::addObject(std::string name) {
  if (object_names_.size() == kMaxObjects) return 0;
  object_names_.push_back(std::move(name));
  return static_cast<std::uint16_t>(object_names_.size());
}

void MeshBuilder::add(const std::array<MeshCorner, 3>& corners, std::uint32_t material) {
  if (!std::ranges::all_of(corners, isNearEnough, &MeshCorner::position)) {
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
      mesh_.alpha.push_back(corner->alpha >= 0.0f ? std::min(corner->alpha, 1.0f) : 0.0f);
    }
    mesh_.corners_m.push_back(corner->position);
  }
  mesh_.material.push_back(material);
  if (material >= used_.size()) used_.resize(material + 1, 0);
  used_[material] = 1;
  objects_.push_back(object_);
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
                              const std::string& says) {
  if (count > 0) remark(counted(count, one) + " " + says);
}

void MeshBuilder::remarkLeftOut(std::uint64_t points, std::uint64_t lines) {
  if (mesh_.size() == 0 && lines > 0 && points == 0) {
    throw InputError(file_, "holds lines, and foci shows triangles, points and Gaussians");
  }
  if (mesh_.size() == 0) return;
  remarkCount(points, "point", "beside the triangles left out");
  remarkCount(lines, "line", "beside the triangles left out");
}

bool MeshBuilder::takeLight(bool is_black, const glm::vec3& emitted, MeshMaterial& material) {
  const bool emits = emitted != glm::vec3(0.0f), glows = emits && is_black;
  if (glows && !glowing_) {
    remark(
        "materials that are black but emit light have the colour of that light; they light nothing "
        "else");
  } else if (!glows && emits && !dimmed_) {
    remark(
        "materials that emit light and have a colour are shown in that colour, without the light");
  }
  glowing_ |= glows;
  dimmed_ |= !glows && emits;
  if (glows) material.factor = emitted;
  material.unlit = glows;
  return glows;
}

bool MeshBuilder::useAlpha() {
  std::vector<float>& alpha = mesh_.alpha;
  if (alpha.size() == mesh_.corners_m.size() &&
      std::ranges::all_of(alpha, [](float each) { return each <= kNoOpacity; })) {
    remark("the alpha of all vertices is 0, or 1 of 255: shown opaque");
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
  remarkOrigin(origin, mesh_.remarks);
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
  for (const std::string& text : textures_.remarks()) remark(text);
  remarkCount(unusable_, "triangle",
              "with a corner that is not finite, or farther than 1e9 units from the origin: left "
              "out");
  takeObjects(facts);
  remarkCount(dropUseless(mesh_), "triangle", "equal to another one: left out");
  orientOutwards(mesh_);
  facts.triangles = mesh_.size();
  facts.has_normals = has_normals_;
  for (std::size_t i = 0; i < mesh_.alpha.size(); ++i) {
    const MeshMaterial& material = mesh_.materials[mesh_.material[i / 3]];
    if (material.alpha != AlphaUse::blend) continue;
    facts.opacity.x = std::min(facts.opacity.x, mesh_.alpha[i] * material.opacity);
  }
  takeColors(facts);
  remarkFarApart(mesh_);
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
  showHidden(facts);
}

/// Some programs write `Tr 1`, or an opacity of 0, for the opposite, or an alpha that they do not
/// use. So it does not count if it would hide all faces.
void MeshBuilder::showHidden(SceneFacts& facts) {
  std::vector<std::uint8_t> clear;  // by material
  for (const MeshMaterial& material : mesh_.materials) {
    clear.push_back(material.alpha != AlphaUse::none && material.texture &&
                    std::ranges::all_of(material.texture->pixels(),
                                        [](const auto& rgba) { return rgba[3] == 0; }));
  }
  const auto hidden =
      static_cast<std::uint64_t>(std::ranges::count_if(mesh_.material, [&](std::uint32_t m) {
        return mesh_.materials[m].opacity <= 0.0f || clear[m] != 0;
      }));
  if (hidden < mesh_.size()) {
    remarkCount(hidden, "triangle",
                "of materials with an opacity, or an alpha of the texture, of 0: not shown");
    return;
  }
  for (std::size_t m = 0; m < clear.size(); ++m) {
    mesh_.materials[m].opacity = 1.0f;
    if (clear[m] != 0) mesh_.materials[m].alpha = AlphaUse::none;
  }
  for (MaterialFacts& material : facts.materials) material.opacity = 1.0f;
  facts.opacity.x = 1.0f;
  remark(
      "its materials would hide every face (`Tr 1`, an opacity of 0, or a texture with an alpha "
      "of 0 everywhere): shown opaque");
}

/// Where the colours come from, of what the triangles use. A colour for each material tells nothing
/// of the light where an object was captured: beside others, such materials are shaded.
void MeshBuilder::takeColors(SceneFacts& facts) {
  std::vector<MeshMaterial>& materials = mesh_.materials;
  std::vector<std::optional<glm::vec3>> one(materials.size());  // of the corners
  std::vector<std::uint8_t> varies(materials.size(), 0);
  for (std::size_t i = 0; i < mesh_.color.size(); ++i) {
    const std::uint32_t m = mesh_.material[i / 3];
    if (!one[m]) one[m] = mesh_.color[i];
    varies[m] |= mesh_.color[i] != *one[m];
  }
  std::optional<glm::vec3> first;
  for (std::size_t m = 0; m < materials.size(); ++m) {
    if (used_[m] == 0) continue;
    const MeshMaterial& material = materials[m];
    const bool own = one[m] && one[m]->x >= 0.0f;
    const glm::vec3 color = !own              ? material.factor
                            : material.tinted ? material.factor * *one[m]
                                              : *one[m];
    facts.has_colors |= material.texture || material.unlit || varies[m] != 0;
    facts.material_colors |= color != first.value_or(color);
    first = color;
  }
  if (!facts.has_colors) return;
  facts.material_colors = false;
  for (std::size_t m = 0; m < materials.size(); ++m) {
    MeshMaterial& material = materials[m];
    material.shaded = !material.texture && !material.unlit;
    if (!material.shaded || varies[m] != 0 || !one[m] || one[m]->x < 0.0f) continue;
    material.factor = material.tinted ? material.factor * *one[m] : *one[m];
  }
  for (std::size_t i = 0; i < mesh_.color.size(); ++i) {
    const std::uint32_t m = mesh_.material[i / 3];
    if (materials[m].shaded && varies[m] == 0) mesh_.color[i] = glm::vec3(-1.0f);
  }
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
