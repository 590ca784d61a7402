// A scene of Gaussians in the GPU's memory.
#pragma once

#include <cstddef>
#include <memory>

#include "render/gl/buffer.h"
#include "render/gl/windows.h"
#include "render/scene/gaussian_tree.h"

namespace foci {

/// Gaussians, and the nodes of their tree where they have one. Several `GpuGaussians` may render
/// it.
class GpuGaussianScene {
 public:
  /// Copies the scene to the GPU. Throws GpuError where the scene is too large for it.
  GpuGaussianScene(std::shared_ptr<GpuDevice> device, const GaussianCloud& cloud);

  const std::shared_ptr<GpuDevice>& device() const { return device_; }
  std::size_t size() const { return size_; }
  int levels() const { return levels_; }  ///< of nodes; 0: Gaussians alone
  int degree() const { return degree_; }  ///< of the harmonics
  bool preservesLight() const { return preserves_light_; }

  /// Gaussians or nodes as shaders/gaussian_project.glsl reads them.
  struct Array {
    GpuBuffer gaussians, harmonics;
  };
  static constexpr std::size_t kGaussian_bytes = 64;
  std::size_t harmonics_bytes() const;  ///< of a Gaussian

  std::size_t windows() const;  ///< until all nodes and Gaussians have been seen
  GpuWindow nodeWindow(std::size_t i) const { return window(i, nodes_); }
  GpuWindow gaussianWindow(std::size_t i) const { return window(i, size_); }

  struct Buffers {
    Array gaussians, nodes;
    GpuBuffer node_places;   // (position, radius)
    GpuBuffer node_spreads;  // `GaussianTree::spread_m2`
  };
  const Buffers& buffers() const { return buffers_; }

 private:
  void upload(const GaussianCloud& cloud, const float* growth_per_m2, const char* what, Array& to);
  GpuWindow window(std::size_t i, std::size_t all) const;
  std::size_t widest_bytes() const;  ///< of what a window holds for each Gaussian

  std::shared_ptr<GpuDevice> device_;
  Buffers buffers_;
  std::size_t size_ = 0, nodes_ = 0;
  int levels_ = 0, degree_ = 0;
  bool preserves_light_ = false;
};

}  // namespace foci
