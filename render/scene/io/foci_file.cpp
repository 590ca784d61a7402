#include "render/scene/io/foci_file.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "base/parallel.h"
#include "render/scene/gaussian_tree.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

static_assert(sizeof(glm::vec3) == 12);

constexpr std::uint32_t kOriented = 1, kWithOpacity = 2, kMesh = 4, kPlainColors = 8, kBodies = 64,
                        kObjects = 128;
constexpr std::uint32_t kUpAxisX = 16, kUpAxes = 48,  // an up axis is a multiple of kUpAxisX
    kYIsDownOfSurfels = 256, kFlags = 511;

std::uint32_t flagsOf(const SurfelCloud& cloud, const SurfelOrigin& origin) {
  return (cloud.oriented ? kOriented : 0) | (cloud.opacity.empty() ? 0 : kWithOpacity) |
         (origin.mesh ? kMesh : 0) | (origin.plain_colors ? kPlainColors : 0) |
         (cloud.bodies.of_surfel.empty() ? 0 : kBodies) | (cloud.objects.empty() ? 0 : kObjects) |
         (origin.up_axis ? kUpAxisX * static_cast<std::uint32_t>(*origin.up_axis + 1) : 0) |
         (origin.y_is_down ? kYIsDownOfSurfels : 0);
}

SurfelOrigin originOf(std::uint32_t flags) {
  SurfelOrigin origin{.mesh = (flags & kMesh) != 0,
                      .plain_colors = (flags & kPlainColors) != 0,
                      .y_is_down = (flags & kYIsDownOfSurfels) != 0};
  const int axis = static_cast<int>((flags & kUpAxes) / kUpAxisX);
  if (axis > 0) origin.up_axis = axis - 1;
  return origin;
}

/// Names, each ended by a zero.
std::vector<char> joined(const SceneObjects& objects) {
  std::vector<char> all;
  if (objects.empty()) return all;
  for (const std::string& name : objects.names) {
    all.insert(all.end(), name.begin(), name.end());
    all.push_back('\0');
  }
  return all;
}

std::vector<std::string> namesIn(ByteSpan bytes) {
  std::vector<std::string> names{{}};
  for (const unsigned char byte : bytes) {
    if (byte == 0) {
      names.emplace_back();
    } else {
      names.back().push_back(static_cast<char>(byte));
    }
  }
  names.pop_back();
  return names;
}

bool finite(const glm::vec3& v, float most) {
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

bool sound(const SurfelCloud& cloud, std::size_t i) {
  const glm::vec3 &u = cloud.axis_u_m[i], &v = cloud.axis_v_m[i], &color = cloud.color[i];
  return finite(cloud.position_m[i], kFarthest_m) && finite(u, kFarthest_m) &&
         finite(v, kFarthest_m) && glm::dot(u, u) > 0.0f && glm::dot(v, v) > 0.0f &&
         glm::length(glm::cross(glm::normalize(u), glm::normalize(v))) > 0.5f &&
         finite(color, std::numeric_limits<float>::max()) && color.x >= 0.0f && color.y >= 0.0f &&
         color.z >= 0.0f && cloud.area_m2[i] > 0.0f &&
         cloud.area_m2[i] <= std::numeric_limits<float>::max() &&
         (cloud.opacity.empty() || (cloud.opacity[i] >= 0.0f && cloud.opacity[i] <= 1.0f)) &&
         (cloud.bodies.of_surfel.empty() || cloud.bodies.of_surfel[i] <= kMaxBodies);
}

/// The first of `count` that is not sound; `count`: all are.
template <typename IsSound>
std::size_t firstUnsound(std::size_t count, const IsSound& isSound) {
  constexpr std::size_t kAtOnce = 1 << 16;
  std::vector<std::size_t> first((count + kAtOnce - 1) / kAtOnce, count);
  parallelFor(first.size(), [&](std::size_t b) {
    const std::size_t end = std::min(count, (b + 1) * kAtOnce);
    for (std::size_t i = b * kAtOnce; i < end && first[b] == count; ++i) {
      if (!isSound(i)) first[b] = i;
    }
  });
  return first.empty() ? count : *std::ranges::min_element(first);
}

void requireSound(const FociContainer& file, const SurfelCloud& cloud) {
  const std::size_t unsound =
      firstUnsound(cloud.size(), [&](std::size_t i) { return sound(cloud, i); });
  if (unsound < cloud.size()) file.refuse("surfel ", unsound, " is not sound");
  for (const std::uint16_t object : cloud.objects.of) {
    if (object >= cloud.objects.names.size()) file.refuse("has a surfel of an unknown object");
  }
}

bool sound(const TreeNodes& tree, std::size_t node, std::size_t bodies) {
  constexpr float kMost = std::numeric_limits<float>::max();
  const LodNode& of = tree.nodes[node];
  const Coarseness& coarse = tree.coarseness[node];
  return finite(of.position_m, kFarthest_m) && finite(of.color, kMost) &&
         std::ranges::all_of(of.variance_m2, [](float v) { return std::abs(v) <= kMost; }) &&
         of.density >= 0.0f && of.density <= kMost && of.radius_m >= 0.0f && of.radius_m <= kMost &&
         std::abs(coarse.now_m2) <= kMost && std::abs(coarse.min_m2) <= kMost &&
         (tree.facing.empty() || tree.facing[node].body < bodies ||
          tree.facing[node].body == Facing::kSeveral);
}

/// Numbers of bytes by surfel, in the order of the arrays; 0: there is no such array.
std::vector<std::uint64_t> bytesBySurfel(std::uint32_t flags) {
  const bool opacity = (flags & kWithOpacity) != 0, bodies = (flags & kBodies) != 0,
             objects = (flags & kObjects) != 0;
  return {12, 12, 12, 12, 4, opacity ? 4u : 0u, bodies ? 2u : 0u, objects ? 2u : 0u};
}

/// Calls `each(array, values)` with the number of an array and the vector of its values.
template <typename Cloud, typename Each>
void forArrays(Cloud& cloud, const Each& each) {
  each(0, cloud.position_m);
  each(1, cloud.axis_u_m);
  each(2, cloud.axis_v_m);
  each(3, cloud.color);
  each(4, cloud.area_m2);
  each(5, cloud.opacity);
  each(6, cloud.bodies.of_surfel);
  each(7, cloud.objects.of);
}

constexpr std::uint64_t kAlign = 64;
static_assert(sizeof(Coarseness) == 8 && sizeof(Facing) == 4 && sizeof(ClosedBodies::Box) == 24);

/// Numbers of bytes of the arrays of a scene with a tree. `nodes_at` is the array of the nodes.
std::vector<std::uint64_t> sizesWithTree(const FociHeader& header, std::size_t& nodes_at) {
  std::vector<std::uint64_t> sizes;
  for (const std::uint64_t bytes : bytesBySurfel(header.flags)) {
    sizes.push_back(bytes * header.count);
  }
  const std::uint64_t nodes = std::uint64_t{1} << MomentTree::levelsOf(header.count);
  const bool bodies = (header.flags & kBodies) != 0;
  nodes_at = sizes.size();
  sizes.insert(sizes.end(), {sizeof(LodNode) * nodes, sizeof(Coarseness) * nodes,
                             bodies ? sizeof(Facing) * nodes : 0,
                             sizeof(ClosedBodies::Box) * header.more[0], header.more[1]});
  return sizes;
}

template <typename T>
std::span<const T> as(ByteSpan bytes) {
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

/// The scene stays in the file. @throws InputError
PreparedScene readSurfels(const std::shared_ptr<const FociContainer>& file) {
  const FociHeader& header = file->header();
  if ((header.flags & ~kFlags) != 0) file->refuse("is not a .foci scene");
  if (header.count == 0) file->refuse("has no surfels");
  const bool bodies = (header.flags & kBodies) != 0, objects = (header.flags & kObjects) != 0;
  if (header.count >= std::uint64_t{1} << 31 || header.more[0] > kMaxBodies + std::uint64_t{1} ||
      header.more[1] > header.file_bytes || (header.more[0] > 1) != bodies ||
      (header.more[1] > 0) != objects) {
    file->refuse("is not a .foci scene: its sizes contradict each other");
  }
  std::size_t nodes_at = 0;
  const std::vector<std::uint64_t> sizes = sizesWithTree(header, nodes_at);
  const std::vector<ByteSpan> arrays = file->arrays(sizes, kAlign);

  SurfelCloud cloud;
  forArrays(cloud, [&](std::size_t array, auto& values) {
    using Value = typename std::remove_reference_t<decltype(values)>::value_type;
    values = {as<Value>(arrays[array]), file};
  });
  const TreeNodes nodes{as<LodNode>(arrays[nodes_at]), as<Coarseness>(arrays[nodes_at + 1]),
                        as<Facing>(arrays[nodes_at + 2])};
  const auto boxes = as<ClosedBodies::Box>(arrays[nodes_at + 3]);
  cloud.bodies.boxes.assign(boxes.begin(), boxes.end());
  if (objects) cloud.objects.names = namesIn(arrays[nodes_at + 4]);
  cloud.oriented = (header.flags & kOriented) != 0;
  if (file->isChecked()) {
    requireSound(*file, cloud);
    const std::size_t unsound = firstUnsound(
        nodes.nodes.size() - 1, [&](std::size_t i) { return sound(nodes, i + 1, boxes.size()); });
    if (unsound + 1 < nodes.nodes.size()) {
      file->refuse("node ", unsound + 1, " is not sound");
    }
    for (const std::uint16_t body : std::as_const(cloud).bodies.of_surfel) {
      if (body >= boxes.size()) file->refuse("has a surfel of an unknown body");
    }
  } else if (bodies) {
    // So that each number that the file may hold is one of a box.
    cloud.bodies.boxes.resize(std::size_t{Facing::kSeveral} + 1);
  }
  return {{surfelsOf(std::make_shared<const MomentTree>(std::move(cloud), nodes, file))},
          originOf(header.flags)};
}

static_assert(sizeof(glm::vec3) == 12 && sizeof(Covariance3) == 24);

constexpr std::uint32_t kPreservesLight = 1, kYIsDown = 2;
constexpr std::uint32_t kDegree = 4, kGaussianFlags = 15;  // the degree is a multiple of kDegree

/// Calls `each(values)` for each array of Gaussians and their tree, in the order of the file.
template <typename Cloud, typename Tree, typename Each>
void forGaussianArrays(Cloud& cloud, Tree& tree, const Each& each) {
  for (auto* const of : {&cloud, &tree.nodes}) {
    each(of->position_m);
    each(of->covariance_m2);
    each(of->opacity);
    each(of->color);
    each(of->harmonics);
  }
  each(tree.radius_m);
  each(tree.spread_m2);
  each(tree.growth_per_m2);
}

template <typename T>
void fill(std::vector<T>& values, ByteSpan bytes) {
  values.resize(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  releasePages(bytes);
}

bool isSound(const GaussianCloud& cloud, std::size_t i, float max_opacity) {
  constexpr float kMost = std::numeric_limits<float>::max();
  const Covariance3& v = cloud.covariance_m2[i];
  return finite(cloud.position_m[i], kFarthest_m) && finite(cloud.color[i], kMost) &&
         finite({v.xx, v.yy, v.zz}, kMost) && finite({v.xy, v.xz, v.yz}, kMost) && v.xx >= 0.0f &&
         v.yy >= 0.0f && v.zz >= 0.0f && cloud.opacity[i] >= 0.0f &&
         cloud.opacity[i] <= max_opacity;
}

bool isSound(const GaussianTree& tree, std::size_t node) {
  constexpr float kMost = std::numeric_limits<float>::max();
  for (const float value : {tree.radius_m[node], tree.spread_m2[node], tree.growth_per_m2[node]}) {
    if (!(value >= 0.0f && value <= kMost)) return false;
  }
  return isSound(tree.nodes, node, kMost);
}

void write(const std::filesystem::path& path, const GaussianCloud& cloud,
           const SurfelOrigin& origin) {
  assert(cloud.tree && !cloud.empty());
  std::vector<ByteSpan> arrays;
  forGaussianArrays(cloud, *cloud.tree,
                    [&](const auto& values) { arrays.push_back(bytesOf(values)); });
  writeFoci(
      path,
      {.version = kFociGaussians,
       .flags = (cloud.preserves_light ? kPreservesLight : 0) | (origin.y_is_down ? kYIsDown : 0) |
                kDegree * static_cast<std::uint32_t>(cloud.degree),
       .count = cloud.size()},
      arrays);
}

PreparedScene readFociGaussians(const FociContainer& file) {
  const FociHeader& header = file.header();
  if ((header.flags & ~kGaussianFlags) != 0) file.refuse("is not a .foci scene");
  if (header.count == 0) file.refuse("has no Gaussians");
  if (header.count >= std::uint64_t{1} << 31) {
    file.refuse("is not a .foci scene: its sizes contradict each other");
  }
  const int degree = static_cast<int>(header.flags / kDegree);
  const int levels = gaussianTreeLevels(header.count);
  const std::uint64_t nodes = std::uint64_t{1} << levels;
  const std::uint64_t harmonics_B = 6 * static_cast<std::uint64_t>(harmonicsOf(degree));
  std::vector<std::uint64_t> sizes;
  for (const std::uint64_t n : {std::uint64_t{header.count}, nodes}) {
    sizes.insert(sizes.end(), {12 * n, 24 * n, 4 * n, 12 * n, harmonics_B * n});
  }
  sizes.insert(sizes.end(), 3, 4 * nodes);
  const std::vector<ByteSpan> arrays = file.arrays(sizes);

  const auto tree = std::make_shared<GaussianTree>();
  GaussianCloud cloud;
  auto next = arrays.begin();
  forGaussianArrays(cloud, *tree, [&](auto& values) { fill(values, *next++); });
  tree->levels = levels;
  for (GaussianCloud* each : {&cloud, &tree->nodes}) {
    each->degree = degree;
    each->preserves_light = (header.flags & kPreservesLight) != 0;
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!isSound(cloud, i, 1.0f)) file.refuse("Gaussian ", i, " is not sound");
  }
  for (std::size_t node = 1; node < nodes; ++node) {
    if (!isSound(*tree, node)) file.refuse("node ", node, " is not sound");
  }
  cloud.tree = tree;
  return {{std::move(cloud)}, {.y_is_down = (header.flags & kYIsDown) != 0}};
}

void write(const std::filesystem::path& path, const SurfelCloud& cloud,
           const SurfelOrigin& origin) {
  assert(!cloud.empty());
  SurfelFileWriter writer(path, cloud.size(), 0, cloud, origin);
  writer.add(0, *treeOf(cloud));
  writer.finish();
}

}  // namespace

bool isSceneFile(const std::filesystem::path& path) {
  // Half of the magic is enough; the rest shows how a transfer has altered the file.
  return std::ranges::equal(firstBytes(path, 4), std::span(kFociMagic).first(4));
}

SurfelFileWriter::SurfelFileWriter(const std::filesystem::path& path, std::uint64_t count,
                                   int part_level, const SurfelCloud& like,
                                   const SurfelOrigin& origin)
    : count_(count),
      part_level_(part_level),
      roots_(std::size_t{1} << part_level),
      layout_(like, origin, count),
      writer_(path, layout_.header, layout_.sizes, kAlign) {
  assert(count % roots_.size() == 0 && (part_level == 0 || like.bodies.boxes.empty()));
  const std::vector<char> names = joined(like.objects);
  writer_.write(layout_.nodes_at + 3, 0, bytesOf(like.bodies.boxes));
  writer_.write(layout_.nodes_at + 4, 0, bytesOf(names));
}

SurfelFileWriter::Layout::Layout(const SurfelCloud& like, const SurfelOrigin& origin,
                                 std::uint64_t count)
    : header{.flags = flagsOf(like, origin), .count = count} {
  header.more = {like.bodies.boxes.size(), joined(like.objects).size()};
  sizes = sizesWithTree(header, nodes_at);
}

/// @param first  the level's first node, of `count`, in the file, and `from` the same in `nodes`
void SurfelFileWriter::writeNodes(std::size_t first, const TreeNodes& nodes, std::size_t from,
                                  std::size_t count) {
  const auto put = [&](std::size_t array, auto values) {
    if (values.empty()) return;
    writer_.write(layout_.nodes_at + array, first * sizeof(values[0]),
                  bytesOf(values.subspan(from, count)));
  };
  put(0, nodes.nodes);
  put(1, nodes.coarseness);
  put(2, nodes.facing);
}

void SurfelFileWriter::add(std::size_t part, const MomentTree& tree) {
  const SurfelCloud& surfels = tree.surfels();
  const std::uint64_t first = rangeBelow(count_, part_level_, part).first;
  assert(surfels.size() * roots_.size() == count_);
  assert(tree.levels() + part_level_ == MomentTree::levelsOf(count_));
  forArrays(surfels, [&](std::size_t array, const auto& values) {
    if (!values.empty()) writer_.write(array, first * sizeof(values[0]), bytesOf(values));
  });
  for (int level = 0; level < tree.levels(); ++level) {
    const std::size_t count = std::size_t{1} << level;
    writeNodes((count << part_level_) + part * count,
               {tree.nodes(), tree.coarseness(), tree.facing()}, count, count);
  }
  roots_[part] = {tree.sums(), tree.coarseness()[1].min_m2};
}

void SurfelFileWriter::finish() {
  if (part_level_ > 0) {
    const TreeTop top = topOf(roots_);
    writeNodes(1, {top.nodes, top.coarseness, {}}, 1, top.nodes.size() - 1);
  }
  writer_.finish();
}

void writeSceneFile(const std::filesystem::path& path, const PreparedScene& scene) {
  std::visit([&](const auto& cloud) { write(path, cloud, scene.origin); }, scene.scene.splats);
}

PreparedScene readSceneFile(const std::filesystem::path& path, std::uint64_t checked_B) {
  const auto file = std::make_shared<const FociContainer>(path, checked_B);
  return file->header().version == kFociGaussians ? readFociGaussians(*file) : readSurfels(file);
}

}  // namespace foci
