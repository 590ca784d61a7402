#include "app/study/scene_cache.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <random>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/platform/machine.h"
#include "app/platform/sha256.h"
#include "app/platform/version.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/mapped_file.h"
#include "render/lod/moment_tree.h"
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
    const auto known = std::find(textures.begin(), textures.end(), texture);
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

std::string keyOf(const SurfelSource& source) {
  SourceHash key;
  addProgram(key);
  if (source.mesh != nullptr) addMesh(key, *source.mesh);
  if (source.points != nullptr) addPoints(key, *source.points);
  if (source.viewpoint_m) key.add(*source.viewpoint_m);
  return key.hex();
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

}  // namespace

SceneCache::SceneCache(fs::path folder, const Limits& limits)
    : folder_(std::move(folder)), limits_(limits) {}

std::optional<fs::path> SceneCache::userFolder() {
  const auto cache = foci::userFolder("XDG_CACHE_HOME", ".cache");
  return cache ? std::optional(*cache / "foci" / "scenes") : std::nullopt;
}

SurfelCloud SceneCache::surfelsOf(const SurfelSource& source,
                                  const std::function<SurfelCloud()>& make) const {
  const auto made = [&] { return withTree(make()); };
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) return made();
  if (source.points != nullptr && source.points->size() < limits_.min_surfels) return made();
  const fs::path entry = folder_ / (keyOf(source) + kEnding);
  if (fs::exists(entry, failed)) {
    try {
      PreparedScene found = readSceneFile(entry, kCheckAll_B);
      fs::last_write_time(entry, fs::file_time_type::clock::now(), failed);
      if (auto* const surfels = std::get_if<SurfelCloud>(&found.scene.splats)) {
        return std::move(*surfels);
      }
    } catch (const InputError&) {
      fs::remove(entry, failed);
    }
  }
  SurfelCloud cloud = made();
  if (cloud.size() >= limits_.min_surfels) keep(entry, cloud);
  return cloud;
}

void SceneCache::keep(const fs::path& entry, const SurfelCloud& cloud) const {
  const std::uint64_t max_B = kMaxSurfel_B * cloud.size();
  std::error_code failed;
  if (max_B > limits_.max_B || fs::space(folder_, failed).available < 2 * max_B || failed) return;
  const fs::path aside = entry.string() + "." + std::to_string(std::random_device()());
  try {
    writeSceneFile(aside, {{cloud}, {}});
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
