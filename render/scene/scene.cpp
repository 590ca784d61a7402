#include "render/scene/scene.h"

#include <algorithm>
#include <utility>

#include "render/scene/gaussian_merge.h"

namespace foci {
namespace {

/// Thickness of a flat Gaussian over its width: it needs a volume.
constexpr float kThickness = 0.02f;

void addOuter(Covariance3& v, const glm::vec3& a, float weight) {
  v.xx += weight * a.x * a.x;
  v.xy += weight * a.x * a.y;
  v.xz += weight * a.x * a.z;
  v.yy += weight * a.y * a.y;
  v.yz += weight * a.y * a.z;
  v.zz += weight * a.z * a.z;
}

/// Gives all Gaussians harmonics of the degree; new ones are 0.
void raiseDegree(GaussianCloud& cloud, int degree) {
  if (cloud.degree >= degree) return;
  const std::size_t had = cloud.harmonicsPerGaussian(), count = cloud.size();
  cloud.degree = degree;
  const std::size_t has = cloud.harmonicsPerGaussian();
  std::vector<std::int16_t> all(count * has, 0);
  for (std::size_t i = 0; i < count; ++i) {
    std::copy_n(cloud.harmonics.begin() + static_cast<std::ptrdiff_t>(i * had), had,
                all.begin() + static_cast<std::ptrdiff_t>(i * has));
  }
  cloud.harmonics = std::move(all);
}

/// Appends the part's numbers, raised by `offset`; 0 stays 0.
void appendNumbers(MappedVector<std::uint16_t>& to, std::size_t had,
                   const MappedVector<std::uint16_t>& from, std::size_t count, std::size_t offset,
                   std::size_t most) {
  to.resize(had, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t number = from.empty() || from[i] == 0 ? 0 : from[i] + offset;
    to.push_back(number <= most ? static_cast<std::uint16_t>(number) : std::uint16_t{0});
  }
}

void transform(SurfelCloud& cloud, const glm::mat3& rotation, const glm::vec3& offset) {
  for (glm::vec3& p : cloud.position_m) p = rotation * p + offset;
  for (auto* const axes : {&cloud.axis_u_m, &cloud.axis_v_m}) {
    for (glm::vec3& axis : *axes) axis = rotation * axis;
  }
  cloud.mesh.reset();  // it stays where it was
  completeBodies(cloud);
}

SurfelCloud joined(SurfelCloud scene, SurfelCloud part, const std::string& name) {
  const std::size_t had = scene.size(), count = part.size();
  SceneObjects& objects = scene.objects;
  if (objects.names.empty()) objects.names = {""};
  if (part.objects.empty()) {
    part.objects.of.assign(count, 1);
    part.objects.names = {"", name};
  }
  appendNumbers(objects.of, had, part.objects.of, count, objects.names.size() - 1, kMaxObjects);
  objects.names.insert(objects.names.end(), part.objects.names.begin() + 1,
                       part.objects.names.end());
  if (!scene.bodies.of_surfel.empty() || !part.bodies.of_surfel.empty()) {
    const std::size_t bodies = scene.bodies.boxes.empty() ? 0 : scene.bodies.boxes.size() - 1;
    appendNumbers(scene.bodies.of_surfel, had, part.bodies.of_surfel, count, bodies, kMaxBodies);
  }
  if (!scene.opacity.empty() || !part.opacity.empty()) {
    scene.opacity.resize(had, 1.0f);
    part.opacity.resize(count, 1.0f);
    scene.opacity.append(part.opacity);
  }
  scene.position_m.append(part.position_m);
  scene.axis_u_m.append(part.axis_u_m);
  scene.axis_v_m.append(part.axis_v_m);
  scene.color.append(part.color);
  scene.area_m2.append(part.area_m2);
  scene.oriented = scene.oriented && part.oriented;
  scene.mesh.reset();
  completeBodies(scene);
  return scene;
}

GaussianCloud joined(GaussianCloud scene, const SurfelCloud& part, const std::string& /*name*/) {
  return joined(std::move(scene), gaussiansOf(part));
}

/// Surfaces are no captures: the captured scene says how small Gaussians are low-passed.
GaussianCloud joined(const SurfelCloud& scene, GaussianCloud part, const std::string& /*name*/) {
  GaussianCloud all = gaussiansOf(scene);
  all.preserves_light = part.preserves_light;
  return joined(std::move(all), std::move(part));
}

GaussianCloud joined(GaussianCloud scene, GaussianCloud part, const std::string& /*name*/) {
  return joined(std::move(scene), std::move(part));
}

const SceneObjects& objectsOf(const SurfelCloud& cloud) { return cloud.objects; }
const SceneObjects& objectsOf(const GaussianCloud& /*cloud*/) {
  static const SceneObjects none;
  return none;
}

std::optional<bool> lowPassOf(const SurfelCloud& /*cloud*/) { return std::nullopt; }
std::optional<bool> lowPassOf(const GaussianCloud& cloud) { return cloud.preserves_light; }

}  // namespace

std::span<const glm::vec3> Scene::position_m() const {
  const auto places = [](const auto& cloud) -> std::span<const glm::vec3> {
    return cloud.position_m;
  };
  return std::visit(places, splats);
}

const SceneObjects& Scene::objects() const {
  return std::visit([](const auto& cloud) -> const SceneObjects& { return objectsOf(cloud); },
                    splats);
}

std::optional<bool> Scene::preservesLight() const {
  return std::visit([](const auto& cloud) { return lowPassOf(cloud); }, splats);
}

glm::vec3 displayColorOf(const SurfelCloud& cloud, std::size_t i) {
  const glm::vec3 light = glm::clamp(cloud.color[i], 0.0f, 1.0f);
  return {displayOfLinear(light.x), displayOfLinear(light.y), displayOfLinear(light.z)};
}

glm::vec3 displayColorOf(const GaussianCloud& cloud, std::size_t i) {
  return glm::clamp(cloud.color[i], 0.0f, 1.0f);
}

Scene placed(Scene part, const Placement& place) {
  const glm::mat3 rotation = glm::mat3_cast(place.rotation);
  std::visit([&](auto& cloud) { transform(cloud, rotation, place.position_m); }, part.splats);
  return part;
}

GaussianCloud joined(GaussianCloud cloud, GaussianCloud part) {
  cloud.tree.reset();
  const int degree = std::max(cloud.degree, part.degree);
  raiseDegree(cloud, degree);
  raiseDegree(part, degree);
  append(cloud, part);
  return cloud;
}

Scene joined(Scene scene, Scene part, const std::string& name) {
  return std::visit(
      [&](auto& first, auto& second) {
        return Scene{joined(std::move(first), std::move(second), name)};
      },
      scene.splats, part.splats);
}

std::optional<std::string> lowPassRemark(const Scene& scene, const std::string& scene_name,
                                         const Scene& part, const std::string& part_name) {
  const auto first = scene.preservesLight(), second = part.preservesLight();
  if (!first || !second || *first == *second) return std::nullopt;
  return scene_name + " and " + part_name +
         " were trained with different low-passes: both are rendered with that of " + scene_name +
         (*first ? ", which preserves light" : ", which does not preserve light") +
         ", so small Gaussians of " + part_name + " look " + (*first ? "fainter" : "stronger") +
         " than alone";
}

GaussianCloud gaussiansOf(const SurfelCloud& surfels) {
  GaussianCloud cloud;
  const std::size_t count = surfels.size();
  cloud.position_m.assign(surfels.position_m.begin(), surfels.position_m.end());
  cloud.covariance_m2.resize(count);
  cloud.opacity.assign(surfels.opacity.begin(), surfels.opacity.end());
  cloud.opacity.resize(count, 1.0f);
  cloud.color.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 &u = surfels.axis_u_m[i], &v = surfels.axis_v_m[i];
    addOuter(cloud.covariance_m2[i], u, kFlatWidening * kFlatWidening);
    addOuter(cloud.covariance_m2[i], v, kFlatWidening * kFlatWidening);
    const glm::vec3 normal = glm::normalize(glm::cross(glm::normalize(u), glm::normalize(v)));
    const float thin = kThickness * std::min(glm::length(u), glm::length(v));
    addOuter(cloud.covariance_m2[i], normal, thin * thin);
    cloud.color[i] = displayColorOf(surfels, i);
  }
  return cloud;
}

}  // namespace foci
