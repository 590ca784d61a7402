// A scene in the GPU's memory.
#pragma once

#include <memory>

#include "render/gl/buffer.h"
#include "render/gl/device.h"
#include "render/lod/moment_tree.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// Surfels, and the nodes of their tree where there is one. Several `GpuSplats` may render it.
class GpuScene {
 public:
  /// Copies the scene to the GPU. Throws GpuError where the scene is too large for it.
  GpuScene(std::shared_ptr<GpuDevice> device, const SurfelCloud& cloud);
  GpuScene(std::shared_ptr<GpuDevice> device, const MomentTree& tree);
  GpuScene(const GpuScene&) = delete;
  GpuScene& operator=(const GpuScene&) = delete;

  const std::shared_ptr<GpuDevice>& device() const { return device_; }
  std::size_t surfelCount() const { return surfels_; }
  int levels() const { return levels_; }  ///< of nodes; 0: surfels alone
  bool isOriented() const { return oriented_; }
  bool isTransparent() const { return transparent_; }
  /// The boxes of the closed bodies.
  const ClosedBodies& bodies() const { return bodies_; }

  static constexpr std::size_t kNode_bytes = 48, kSurfel_bytes = 32;
  std::size_t windows() const;  ///< until all nodes and surfels have been seen
  GpuWindow nodeWindow(std::size_t i) const;
  GpuWindow surfelWindow(std::size_t i) const;

  /// As the shaders read them.
  struct Buffers {
    GpuBuffer surfels_a, surfels_b;  // (position, opacity), (u, area); (v, body), (colour, 0)
    GpuBuffer node_places;           // (position, radius)
    GpuBuffer nodes;       // variance xx xy xz yy, (yz, zz, density, own|opacity), (colour, normal)
    GpuBuffer coarseness;  // now, min, `LodNode::added_m2`, packed normal
    GpuBuffer facing;      // body | cos_cone, where there are bodies
    GpuBuffer shapes;      // the table of kernel.h: k0, k1, k2, support2
  };
  const Buffers& buffers() const { return buffers_; }

 private:
  void uploadSurfels(const SurfelCloud& cloud);
  void uploadNodes(const MomentTree& tree);

  std::shared_ptr<GpuDevice> device_;
  Buffers buffers_;
  std::size_t surfels_ = 0, nodes_ = 0;
  int levels_ = 0;
  bool oriented_ = false, transparent_ = false;
  ClosedBodies bodies_;  // without `of_surfel`
};

}  // namespace foci
