#include "render/scene/io/foci_gaussians.h"

#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "render/scene/gaussian_tree.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

static_assert(sizeof(glm::vec3) == 12 && sizeof(Covariance3) == 24);

constexpr std::uint32_t kPreservesLight = 1, kYIsDown = 2;
constexpr std::uint32_t kDegree = 4, kGaussianFlags = 15;  // the degree is a multiple of kDegree

void appendArrays(const GaussianCloud& cloud, std::vector<ByteSpan>& arrays) {
  arrays.insert(arrays.end(),
                {bytesOf(cloud.position_m), bytesOf(cloud.covariance_m2), bytesOf(cloud.opacity),
                 bytesOf(cloud.color), bytesOf(cloud.harmonics)});
}

/// Numbers of bytes of these arrays.
void appendSizes(std::uint64_t count, int degree, std::vector<std::uint64_t>& sizes) {
  sizes.insert(sizes.end(), {12 * count, 24 * count, 4 * count, 12 * count,
                             6 * count * static_cast<std::uint64_t>(harmonicsOf(degree))});
}

template <typename T>
void fill(std::vector<T>& values, ByteSpan bytes) {
  values.resize(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  releasePages(bytes);
}

/// @param arrays  the five of `appendArrays`
void fill(GaussianCloud& cloud, const ByteSpan* arrays) {
  fill(cloud.position_m, arrays[0]);
  fill(cloud.covariance_m2, arrays[1]);
  fill(cloud.opacity, arrays[2]);
  fill(cloud.color, arrays[3]);
  fill(cloud.harmonics, arrays[4]);
}

bool within(float value, float most) { return std::abs(value) <= most; }

bool isSound(const GaussianCloud& cloud, std::size_t i, float max_opacity) {
  constexpr float kMost = std::numeric_limits<float>::max();
  const glm::vec3 &p = cloud.position_m[i], &color = cloud.color[i];
  const Covariance3& v = cloud.covariance_m2[i];
  for (const float value : {v.xx, v.xy, v.xz, v.yy, v.yz, v.zz, color.r, color.g, color.b}) {
    if (!within(value, kMost)) return false;
  }
  return within(p.x, kFarthest_m) && within(p.y, kFarthest_m) && within(p.z, kFarthest_m) &&
         v.xx >= 0.0f && v.yy >= 0.0f && v.zz >= 0.0f && cloud.opacity[i] >= 0.0f &&
         cloud.opacity[i] <= max_opacity;
}

bool isSound(const GaussianTree& tree, std::size_t node) {
  constexpr float kMost = std::numeric_limits<float>::max();
  for (const float value : {tree.radius_m[node], tree.spread_m2[node], tree.growth_per_m2[node]}) {
    if (!(value >= 0.0f && value <= kMost)) return false;
  }
  return isSound(tree.nodes, node, kMost);
}

}  // namespace

void writeFociGaussians(const std::filesystem::path& path, const PreparedScene& scene) {
  const GaussianCloud& cloud = *scene.cloud.gaussians;
  assert(cloud.tree && !cloud.empty());
  const GaussianTree& tree = *cloud.tree;
  std::vector<ByteSpan> arrays;
  appendArrays(cloud, arrays);
  appendArrays(tree.nodes, arrays);
  arrays.insert(arrays.end(),
                {bytesOf(tree.radius_m), bytesOf(tree.spread_m2), bytesOf(tree.growth_per_m2)});
  writeFoci(path,
            {.version = kFociGaussians,
             .flags = (cloud.preserves_light ? kPreservesLight : 0) |
                      (scene.origin.y_is_down ? kYIsDown : 0) |
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
  std::vector<std::uint64_t> sizes;
  appendSizes(header.count, degree, sizes);
  appendSizes(nodes, degree, sizes);
  sizes.insert(sizes.end(), 3, 4 * nodes);
  const std::vector<ByteSpan> arrays = file.arrays(sizes);

  const auto tree = std::make_shared<GaussianTree>();
  const auto cloud = std::make_shared<GaussianCloud>();
  fill(*cloud, arrays.data());
  fill(tree->nodes, arrays.data() + 5);
  fill(tree->radius_m, arrays[10]);
  fill(tree->spread_m2, arrays[11]);
  fill(tree->growth_per_m2, arrays[12]);
  tree->levels = levels;
  for (GaussianCloud* each : {cloud.get(), &tree->nodes}) {
    each->degree = degree;
    each->preserves_light = (header.flags & kPreservesLight) != 0;
  }
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (!isSound(*cloud, i, 1.0f)) file.refuse("Gaussian " + std::to_string(i) + " is not sound");
  }
  for (std::size_t node = 1; node < nodes; ++node) {
    if (!isSound(*tree, node)) file.refuse("node " + std::to_string(node) + " is not sound");
  }
  cloud->tree = tree;
  PreparedScene scene;
  scene.cloud.gaussians = cloud;
  scene.origin.y_is_down = (header.flags & kYIsDown) != 0;
  return scene;
}

}  // namespace foci
