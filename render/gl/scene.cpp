#include "render/gl/scene.h"

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>

#include "render/kernel/kernel.h"

namespace foci {

namespace {

std::uint32_t packedNormal(const LodNode& node) {
  return packed(static_cast<std::uint16_t>(node.normal[0]),
                static_cast<std::uint16_t>(node.normal[1]));
}

glm::uvec4 bitsOf(const glm::vec3& floats, std::uint32_t last) {
  return {glm::floatBitsToUint(floats), last};
}

}  // namespace

GpuScene::GpuScene(std::shared_ptr<GpuDevice> device, const SurfelCloud& cloud)
    : device_(std::move(device)) {
  const GpuDevice::Use use(*device_);
  uploadSurfels(cloud);
}

GpuScene::GpuScene(std::shared_ptr<GpuDevice> device, const MomentTree& tree)
    : device_(std::move(device)) {
  const GpuDevice::Use use(*device_);
  uploadSurfels(tree.surfels());
  uploadNodes(tree);
}

std::size_t GpuScene::windows() const {
  return std::max({windowsOver(*device_, kNode_bytes, nodes_),
                   windowsOver(*device_, kSurfel_bytes, surfels_), std::size_t{1}});
}

GpuWindow GpuScene::nodeWindow(std::size_t i) const {
  return windowOf(*device_, i, kNode_bytes, nodes_);
}

GpuWindow GpuScene::surfelWindow(std::size_t i) const {
  return windowOf(*device_, i, kSurfel_bytes, surfels_);
}

void GpuScene::uploadSurfels(const SurfelCloud& cloud) {
  surfels_ = cloud.size();
  oriented_ = cloud.oriented;
  transparent_ = !cloud.opacity.empty();
  bodies_.boxes = cloud.bodies.boxes;
  const MappedVector<std::uint16_t>& body = cloud.bodies.of_surfel;
  upload(*device_, buffers_.surfels_a, surfels_, 2, "the surfels", true,
         [&](std::size_t i, glm::vec4* to) {
           to[0] = {cloud.position_m[i], transparent_ ? cloud.opacity[i] : 1.0f};
           to[1] = {cloud.axis_u_m[i], cloud.area_m2[i]};
         });
  upload(*device_, buffers_.surfels_b, surfels_, 2, "the surfels", true,
         [&](std::size_t i, glm::vec4* to) {
           to[0] = {cloud.axis_v_m[i], body.empty() ? 0.0f : static_cast<float>(body[i])};
           to[1] = {cloud.color[i], 0.0f};
         });
  upload(*device_, buffers_.shapes, kKernelShapes, 1, "the kernels", false,
         [](std::size_t i, glm::vec4* to) {
           const KernelShape& shape = kernelShapes()[i];
           to[0] = {shape.k0, shape.k1, shape.k2, shape.support2};
         });
}

void GpuScene::uploadNodes(const MomentTree& tree) {
  levels_ = tree.levels();
  const std::size_t count = nodes_ = tree.nodes().size();
  upload(*device_, buffers_.node_places, count, 1, "the nodes", false,
         [&](std::size_t i, glm::vec4* to) {
           to[0] = {tree.nodes()[i].position_m, tree.nodes()[i].radius_m};
         });
  // As bits: a float would lose what is packed where its bits are a denormal number.
  upload<glm::uvec4>(*device_, buffers_.nodes, count, 3, "the nodes", true,
                     [&](std::size_t i, glm::uvec4* to) {
                       const LodNode& node = tree.nodes()[i];
                       const float* v = node.variance_m2;
                       to[0] = glm::floatBitsToUint(glm::vec4(v[0], v[1], v[2], v[3]));
                       to[1] = bitsOf({v[4], v[5], node.density}, packed(node.opacity, node.own));
                       to[2] = bitsOf(node.color, packedNormal(node));
                     });
  upload<glm::uvec4>(
      *device_, buffers_.coarseness, count, 1, "the nodes", false,
      [&](std::size_t i, glm::uvec4* to) {
        const LodNode& node = tree.nodes()[i];
        const Coarseness& coarse = tree.coarseness()[i];
        to[0] = bitsOf({coarse.now_m2, coarse.min_m2, node.added_m2()}, packedNormal(node));
      });
  const std::span<const Facing> facing = tree.facing();
  static_assert(sizeof facing[0] == sizeof(std::uint32_t));
  if (facing.empty()) return;
  buffers_.facing.reserve(*device_, count * sizeof facing[0], "the nodes");
  buffers_.facing.write(0, count * sizeof facing[0], facing.data());
}

}  // namespace foci
