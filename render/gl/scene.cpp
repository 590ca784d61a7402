#include "render/gl/scene.h"

#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "render/gl/scene_buffers.h"
#include "render/kernel/kernel.h"

namespace foci {
namespace {

/// Fills a buffer in pieces, so that a copy of the whole never lies in memory. `make(i, to)` writes
/// the `width` vectors of element i.
template <typename Vector = glm::vec4, typename Make>
void upload(GpuDevice& device, GpuBuffer& buffer, std::size_t count, std::size_t width,
            const char* what, bool windowed, const Make& make) {
  constexpr std::size_t kPiece = 1 << 16;
  const std::size_t each_bytes = width * sizeof(Vector);
  const std::size_t bytes = std::max<std::size_t>(count, 1) * each_bytes;
  if (windowed) {
    buffer.reserveWindowed(device, bytes, what);
  } else {
    buffer.reserve(device, bytes, what);
  }
  std::vector<Vector> piece(kPiece * width);
  for (std::size_t first = 0; first < count; first += kPiece) {
    const std::size_t some = std::min(kPiece, count - first);
    for (std::size_t i = 0; i < some; ++i) make(first + i, piece.data() + width * i);
    buffer.write(first * each_bytes, some * each_bytes, piece.data());
  }
}

std::uint32_t packed(std::uint16_t low, std::uint16_t high) {
  return std::uint32_t{low} | std::uint32_t{high} << 16;
}

std::uint32_t packedNormal(const LodNode& node) {
  return packed(static_cast<std::uint16_t>(node.normal[0]),
                static_cast<std::uint16_t>(node.normal[1]));
}

glm::uvec4 bitsOf(const glm::vec3& floats, std::uint32_t last) {
  return {glm::floatBitsToUint(floats), last};
}

/// The kernel's table in the steps of `kernelShape`.
constexpr int kShapeSteps = 256;

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

GpuScene::~GpuScene() = default;

std::size_t GpuScene::windowSize(std::size_t each_bytes) const {
  const std::size_t step = device_->blockAlignment_bytes();
  return std::max(device_->maxBlock_bytes() / each_bytes / step, std::size_t{1}) * step;
}

GpuScene::Window GpuScene::windowOf(std::size_t i, std::size_t each_bytes, std::size_t all) const {
  const std::size_t size = windowSize(each_bytes), first = std::min(i * size, all);
  return {first, std::min(size, all - first)};
}

std::size_t GpuScene::windows() const {
  const auto needed = [&](std::size_t all, std::size_t each_bytes) {
    const std::size_t size = windowSize(each_bytes);
    return (all + size - 1) / size;
  };
  return std::max({needed(nodes_, kNode_bytes), needed(surfels_, kSurfel_bytes), std::size_t{1}});
}

void GpuScene::uploadSurfels(const SurfelCloud& cloud) {
  buffers_ = std::make_unique<Buffers>();
  surfels_ = cloud.size();
  oriented_ = cloud.oriented;
  transparent_ = !cloud.opacity.empty();
  bodies_.boxes = cloud.bodies.boxes;
  const MappedVector<std::uint16_t>& body = cloud.bodies.of_surfel;
  upload(*device_, buffers_->surfels_a, surfels_, 2, "the surfels", true,
         [&](std::size_t i, glm::vec4* to) {
           to[0] = {cloud.position_m[i], transparent_ ? cloud.opacity[i] : 1.0f};
           to[1] = {cloud.axis_u_m[i], cloud.area_m2[i]};
         });
  upload(*device_, buffers_->surfels_b, surfels_, 2, "the surfels", true,
         [&](std::size_t i, glm::vec4* to) {
           to[0] = {cloud.axis_v_m[i], body.empty() ? 0.0f : static_cast<float>(body[i])};
           to[1] = {cloud.color[i], 0.0f};
         });
  upload(*device_, buffers_->shapes, kShapeSteps + 1, 1, "the kernels", false,
         [](std::size_t i, glm::vec4* to) {
           const KernelShape& shape =
               kernelShape(kMaxExponent * static_cast<float>(i) / kShapeSteps);
           to[0] = {shape.k0, shape.k1, shape.k2, shape.support2};
         });
}

void GpuScene::uploadNodes(const MomentTree& tree) {
  levels_ = tree.levels();
  const std::size_t count = nodes_ = tree.nodes().size();
  upload(*device_, buffers_->node_places, count, 1, "the nodes", false,
         [&](std::size_t i, glm::vec4* to) {
           to[0] = {tree.nodes()[i].position_m, tree.nodes()[i].radius_m};
         });
  // As bits: a float would lose what is packed where its bits are a denormal number.
  upload<glm::uvec4>(*device_, buffers_->nodes, count, 3, "the nodes", true,
                     [&](std::size_t i, glm::uvec4* to) {
                       const LodNode& node = tree.nodes()[i];
                       const float* v = node.variance_m2;
                       to[0] = glm::floatBitsToUint(glm::vec4(v[0], v[1], v[2], v[3]));
                       to[1] = bitsOf({v[4], v[5], node.density}, packed(node.opacity, node.own));
                       to[2] = bitsOf(node.color, packedNormal(node));
                     });
  upload<glm::uvec4>(
      *device_, buffers_->coarseness, count, 1, "the nodes", false,
      [&](std::size_t i, glm::uvec4* to) {
        const LodNode& node = tree.nodes()[i];
        const Coarseness& coarse = tree.coarseness()[i];
        to[0] = bitsOf({coarse.now_m2, coarse.min_m2, node.added_m2()}, packedNormal(node));
      });
  const std::span<const Facing> facing = tree.facing();
  static_assert(sizeof facing[0] == sizeof(std::uint32_t));
  if (facing.empty()) return;
  buffers_->facing.reserve(*device_, count * sizeof facing[0], "the nodes");
  buffers_->facing.write(0, count * sizeof facing[0], facing.data());
}

}  // namespace foci
