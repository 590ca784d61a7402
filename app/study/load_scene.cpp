#include "app/study/load_scene.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <random>
#include <system_error>
#include <type_traits>
#include <utility>

#include "app/platform/machine.h"
#include "app/platform/sha256.h"
#include "app/platform/version.h"
#include "app/study/session_settings_of.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/gaussian_tree.h"
#include "render/scene/io/foci_file.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".foci";
/// A surfel with opacity, body and object, and at most one node of the tree.
constexpr std::uint64_t kMaxSurfel_B = 60 + sizeof(LodNode) + sizeof(Coarseness) + sizeof(Facing);
/// What a run that was killed has left.
constexpr std::chrono::hours kAbandoned{1};

class SourceHash {
 public:
  void add(const void* bytes, std::size_t count) {
    hash_.add({static_cast<const unsigned char*>(bytes), count});
  }
  template <typename Value>
  requires std::is_arithmetic_v<Value> || std::is_enum_v<Value>
  void add(Value value) { add(&value, sizeof(value)); }
  template <typename Values>
  requires std::is_trivially_copyable_v<typename Values::value_type>
  void add(const Values& values) {
    add(values.size());
    add(std::as_const(values).data(), values.size() * sizeof(typename Values::value_type));
  }
  void add(const glm::vec3& v) { add(&v, sizeof(v)); }
  void add(const SceneObjects& objects) {
    add(objects.of);
    add(objects.names.size());
    for (const std::string& name : objects.names) add(name);
  }

  template <typename... Values>
  void addAll(const Values&... values) {
    (add(values), ...);
  }

  std::string hex() { return hash_.hex(); }

 private:
  Sha256 hash_;
};

void addMesh(SourceHash& key, const TriangleMesh& mesh) {
  key.addAll(mesh.corners_m, mesh.uv, mesh.color, mesh.alpha, mesh.material, mesh.body,
             mesh.surface, mesh.objects);
  std::vector<const MeshTexture*> textures;  // each once
  const auto addTexture = [&](const MeshTexture* texture) {
    const auto known = std::ranges::find(textures, texture);
    key.add(known - textures.begin());
    if (known != textures.end()) return;
    textures.push_back(texture);
    if (texture == nullptr) return;
    key.addAll(texture->size_px().x, texture->pixels());
  };
  key.add(mesh.materials.size());
  for (const MeshMaterial& material : mesh.materials) {
    addTexture(material.texture.get());
    addTexture(material.mask.get());
    key.addAll(material.factor, material.opacity, material.alpha, material.cutoff);
    for (const TextureWrap wrap : material.wrap) key.add(wrap);
    for (const bool is : {material.tinted, material.unlit, material.shaded}) key.add(is);
  }
}

void addPoints(SourceHash& key, const PointCloud& points) {
  key.addAll(points.position_m, points.normal, points.color, points.radius_m, points.opacity,
             points.body, points.surface, points.area_m2, points.objects);
}

/// Another build of the program may make other surfels.
void addProgram(SourceHash& key) {
  key.add(versionText());
  const MappedFile program(programFile());
  key.add(program.bytes());
}

/// Whether a point's normal has to be estimated.
bool lacksNormals(const PointCloud& points) {
  return points.normal.empty() ||
         std::ranges::find(points.normal, glm::vec3(0.0f)) != points.normal.end();
}

struct Entry {
  fs::path path;
  fs::file_time_type used;
  std::uint64_t bytes;
};

/// The entry used longest ago first. Deletes what killed runs have left.
std::vector<Entry> entriesIn(const fs::path& folder) {
  std::vector<Entry> entries;
  std::error_code ignored;
  for (const fs::directory_entry& file : fs::directory_iterator(folder, ignored)) {
    std::error_code gone;
    const Entry entry{file.path(), file.last_write_time(gone), file.file_size(gone)};
    if (gone) continue;
    if (entry.path.extension() == kEnding) {
      entries.push_back(entry);
    } else if (entry.used + kAbandoned < fs::file_time_type::clock::now()) {
      fs::remove(entry.path, gone);
    }
  }
  std::ranges::sort(entries, {}, &Entry::used);
  return entries;
}

glm::vec3 startOfEye_m(const Study& study) {
  return glm::vec3(glm::inverse(eyePathOf(study).eyeFromWorldAt(0.0))[3]);
}

/// How fine a captured scene has to be: a pixel, at the distance of a box from the eye. Out of an
/// eye's view that does not move, the coarsest level will do.
Fineness finenessOf(const Study& study) {
  const View view = firstViewOf(study);
  const bool moves = study.eye.recorded || !study.eye.path.empty();
  const glm::vec2 tangent = 0.5f * glm::vec2(view.size_px) / view.focal_px;
  return [=, eye_m = startOfEye_m(study)](const glm::vec3& low, const glm::vec3& high) {
    const glm::vec3 nearest = glm::clamp(eye_m, low, high), middle = 0.5f * (low + high);
    const glm::vec3 p(view.eye_from_world * glm::vec4(middle, 1.0f));
    const glm::vec2 aside =
        (glm::abs(glm::vec2(p)) + p.z * tangent) / glm::sqrt(1.0f + tangent * tangent);
    const float radius = 0.5f * glm::distance(low, high);
    const bool is_in_view = p.z < radius && aside.x < radius && aside.y < radius;
    if (!moves && !is_in_view) return std::numeric_limits<float>::infinity();
    return std::max(glm::distance(eye_m, nearest), view.near_m) / view.focal_px.y;
  };
}

/// @param eye_m     in the frame of the file
/// @param fineness  of a streamed scene
Scene opened(const Study& study, SceneFile&& file, double scale_m, const glm::vec3& eye_m,
             const Fineness& fineness, Warnings& warnings) {
  const std::string path = file.path.string();
  std::optional<SceneCache> cache;
  if (const auto folder = SceneCache::userFolder(); folder && study.scene.cache) {
    cache.emplace(*folder);
  }
  const auto entry = cache ? cache->entryOf(file, scale_m, eye_m) : std::nullopt;
  std::optional<SurfelCloud> found = entry ? cache->find(*entry) : std::nullopt;
  const bool is_new = entry && !found;
  OpenedScene scene = openScene(std::move(file), scale_m, eye_m, fineness, std::move(found));
  warnings.addAll(path, scene.remarks);
  // The order of their tree, which those of the cache have.
  if (auto sorted = withSurfelTree(scene.scene)) scene.scene = std::move(*sorted);
  if (is_new) cache->keep(*entry, scene.scene);
  return std::move(scene.scene);
}

}  // namespace

Scene loadScene(const Study& study, Warnings& warnings, std::optional<SceneFile> file) {
  Scene scene;
  if (study.scene.file) {
    if (!file) file = readScene(*study.scene.file);
    scene = opened(study, std::move(*file), study.scene.scale_m, startOfEye_m(study),
                   finenessOf(study), warnings);
  } else {
    scene = {study.scene.builtin == "plane" ? makePlane() : makeGallery()};
  }
  // The file of the first Gaussians: they say how small ones are low-passed.
  std::string captured = study.scene.file ? study.scene.file->string() : study.scene.builtin;
  for (std::size_t i = 0; i < study.scene.parts.size(); ++i) {
    const ScenePart& part = study.scene.parts[i];
    std::error_code ignored;
    if (!fs::exists(part.file, ignored)) {
      throw InputError(study.file.string(), "scene.part, entry " + std::to_string(i + 1) +
                                                ": file = " + quotedText(part.file.string()) +
                                                ": no such file");
    }
    const glm::dvec4 q = glm::normalize(part.rotation);
    const Placement place{.position_m = glm::vec3(part.position_m),
                          .rotation = glm::quat(static_cast<float>(q.w), static_cast<float>(q.x),
                                                static_cast<float>(q.y), static_cast<float>(q.z))};
    const glm::vec3 eye_m =
        glm::conjugate(place.rotation) * (startOfEye_m(study) - place.position_m);
    Scene more = opened(study, readScene(part.file), part.scale_m, eye_m, {}, warnings);
    if (!scene.preservesLight()) captured = part.file.string();
    if (const auto remark = lowPassRemark(scene, captured, more, part.file.string())) {
      warnings.add(study.file.string(), *remark);
    }
    scene = joined(std::move(scene), placed(std::move(more), place), part.file.stem().string());
  }
  if (study.scene.file || study.eye.position_m || !study.eye.path.empty() || study.eye.recorded) {
    warnings.addAll(study.file.string(), viewRemarks(study, scene));
  }
  warnings.add(study.file.string(), memoryRemark(study, scene));
  return std::visit([](auto& cloud) { return Scene{withTree(std::move(cloud))}; }, scene.splats);
}

SceneCache::SceneCache(fs::path folder, const Limits& limits)
    : folder_(std::move(folder)), limits_(limits) {}

std::optional<fs::path> SceneCache::userFolder() {
  const auto cache = foci::userFolder("XDG_CACHE_HOME", ".cache");
  return cache ? std::optional(*cache / "foci" / "scenes") : std::nullopt;
}

std::optional<fs::path> SceneCache::entryOf(const SceneFile& file, double scale_m,
                                            const std::optional<glm::vec3>& viewpoint_m) const {
  const auto* const mesh = std::get_if<MeshFile>(&file.content);
  const auto* const points = std::get_if<PointCloud>(&file.content);
  if (!mesh && !(points && points->size() >= limits_.min_surfels)) return std::nullopt;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) return std::nullopt;
  SourceHash key;
  addProgram(key);
  key.add(scale_m);
  if (mesh) addMesh(key, mesh->mesh);
  if (points) {
    addPoints(key, *points);
    if (viewpoint_m && lacksNormals(*points)) key.add(*viewpoint_m);
  }
  return folder_ / (key.hex() + kEnding);
}

std::optional<SurfelCloud> SceneCache::find(const fs::path& entry) const {
  std::error_code failed;
  if (!fs::exists(entry, failed)) return std::nullopt;
  try {
    PreparedScene found = readSceneFile(entry, kCheckAll_B);
    fs::last_write_time(entry, fs::file_time_type::clock::now(), failed);
    if (auto* const surfels = std::get_if<SurfelCloud>(&found.scene.splats)) {
      return std::move(*surfels);
    }
  } catch (const InputError&) {
    fs::remove(entry, failed);
  }
  return std::nullopt;
}

void SceneCache::keep(const fs::path& entry, const Scene& scene) const {
  if (scene.size() < limits_.min_surfels) return;
  const std::uint64_t max_B = kMaxSurfel_B * scene.size();
  std::error_code failed;
  if (max_B > limits_.max_B || fs::space(folder_, failed).available < 2 * max_B || failed) return;
  const fs::path aside = entry.string() + "." + std::to_string(std::random_device()());
  try {
    writeSceneFile(aside, {scene, {}});
    makeRoom(fs::file_size(aside));
    fs::rename(aside, entry);
  } catch (const std::exception&) {  // the scene is there, whether it is kept or not
    fs::remove(aside, failed);
  }
}

void SceneCache::makeRoom(std::uint64_t bytes) const {
  const std::vector<Entry> entries = entriesIn(folder_);
  for (const Entry& entry : entries) bytes += entry.bytes;
  for (const Entry& entry : entries) {
    if (bytes <= limits_.max_B) return;
    fs::remove(entry.path);
    bytes -= entry.bytes;
  }
}

SceneCache::Content SceneCache::content() const {
  Content content;
  for (const Entry& entry : entriesIn(folder_)) {
    ++content.entries;
    content.bytes += entry.bytes;
  }
  return content;
}

}  // namespace foci
