#include "render/gl/gaussian_scene.h"

#include <algorithm>
#include <utility>

#include "render/gl/upload.h"

namespace foci {

GpuGaussianScene::GpuGaussianScene(std::shared_ptr<GpuDevice> device, const GaussianCloud& cloud)
    : device_(std::move(device)),
      size_(cloud.size()),
      degree_(cloud.degree),
      preserves_light_(cloud.preserves_light) {
  const GpuDevice::Use use(*device_);
  upload(cloud, nullptr, "the Gaussians", buffers_.gaussians);
  if (!cloud.tree) return;
  const GaussianTree& tree = *cloud.tree;
  levels_ = tree.levels;
  nodes_ = tree.nodes.size();
  upload(tree.nodes, tree.growth_per_m2.data(), "the nodes", buffers_.nodes);
  foci::upload(*device_, buffers_.node_places, nodes_, 1, "the nodes", false,
               [&](std::size_t i, glm::vec4* to) {
                 to[0] = {tree.nodes.position_m[i], tree.radius_m[i]};
               });
  foci::upload<float>(*device_, buffers_.node_spreads, nodes_, 1, "the nodes", false,
                      [&](std::size_t i, float* to) { to[0] = tree.spread_m2[i]; });
}

std::size_t GpuGaussianScene::harmonics_bytes() const {
  const auto numbers = 3 * static_cast<std::size_t>(harmonicsOf(degree_));
  return (numbers + 1) / 2 * sizeof(std::uint32_t);
}

std::size_t GpuGaussianScene::widest_bytes() const {
  return std::max(kGaussian_bytes, harmonics_bytes());
}

std::size_t GpuGaussianScene::windows() const {
  return std::max({windowsOver(*device_, widest_bytes(), nodes_),
                   windowsOver(*device_, widest_bytes(), size_), std::size_t{1}});
}

GpuWindow GpuGaussianScene::window(std::size_t i, std::size_t all) const {
  return windowOf(*device_, i, widest_bytes(), all);
}

void GpuGaussianScene::upload(const GaussianCloud& cloud, const float* growth_per_m2,
                              const char* what, Array& to) {
  foci::upload(*device_, to.gaussians, cloud.size(), 4, what, true,
               [&](std::size_t i, glm::vec4* vectors) {
                 const Covariance3& v = cloud.covariance_m2[i];
                 vectors[0] = {cloud.position_m[i], cloud.opacity[i]};
                 vectors[1] = {v.xx, v.xy, v.xz, v.yy};
                 vectors[2] = {v.yz, v.zz, growth_per_m2 ? growth_per_m2[i] : 0.0f, 0.0f};
                 vectors[3] = {cloud.color[i], 0.0f};
               });
  if (cloud.degree == 0) return;
  const std::size_t numbers = cloud.harmonicsPerGaussian();
  foci::upload<std::uint32_t>(
      *device_, to.harmonics, cloud.size(), (numbers + 1) / 2, what, true,
      [&](std::size_t i, std::uint32_t* words) {
        const auto number = [&](std::size_t k) {
          return k < numbers ? static_cast<std::uint16_t>(cloud.harmonics[i * numbers + k])
                             : std::uint16_t{0};
        };
        for (std::size_t k = 0; k < numbers; k += 2)
          words[k / 2] = packed(number(k), number(k + 1));
      });
}

}  // namespace foci
