// A scene of Gaussians in the GPU's memory, rendered through the lens: LOD cut, projection, tiles
// and compositing, all as the CPU does in render/gaussians.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "render/gaussians/gaussian_cut.h"
#include "render/gaussians/layer_stack.h"
#include "render/gl/buffer.h"
#include "render/gl/gaussian_layers.h"
#include "render/gl/image.h"
#include "render/gl/splats.h"
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

/// Keeps its buffers between frames.
class GpuGaussians {
 public:
  explicit GpuGaussians(std::shared_ptr<const GpuGaussianScene> scene)
      : scene_(std::move(scene)), device_(scene_->device()), stages_(device_) {}

  /// Projects and sorts what sub-apertures of any of the `sizes` show. Throws GpuError where the
  /// GPU fails or lacks memory, as `render` does.
  /// @param lod  renders a cut of the scene's tree (asserted to exist), and fewer samples where all
  ///             is blurred; null: all Gaussians, and each pixel
  /// @return the stats without fragments
  GpuStats project(const View& view, const Defocus& defocus,
                   const std::vector<SubApertureSize>& sizes, const GaussianCutSettings* lod);

  /// Renders the projected view through discs into `image`, a new one: the mean over the discs, in
  /// linear light. The same request gives the same bytes on one device and driver.
  /// @return the stats without splats
  GpuStats render(const std::vector<LensDisc>& discs, const GpuCompositing& how,
                  std::shared_ptr<GpuImage>& image);

  /// Of the view that was projected last. Reads them from the GPU once.
  const std::vector<Tile>& tiles();
  /// Divides each tile into layers, until the next projection. Reads from the GPU how blurred each
  /// tile is, and with `several` layers each of its Gaussians.
  const std::vector<TileLayers>& divide(bool several);

  /// Renders each tile through discs of its own. `divide` comes before it.
  /// @param lenses  by tile; without discs, the image keeps the tile as it is
  /// @param image   null: a new one
  /// @param errors  of the tiles that are rendered; null: not wanted
  GpuStats render(std::span<const TileLens> lenses, const GpuCompositing& how,
                  std::shared_ptr<GpuImage>& image, std::vector<SampledErrors>* errors);

  const std::shared_ptr<const GpuGaussianScene>& scene() const { return scene_; }

 private:
  struct Buffers {
    GpuBuffer sizes;
    GpuProjected projected;    // by entry
    GpuBuffer weights, radii;  // by tile
  };

  GpuFrameBlock blockOf(const View& view, const Defocus& defocus,
                        const GaussianCutSettings* lod) const;
  void start(const GpuFrameBlock& block, bool cut, const std::vector<SubApertureSize>& sizes);
  void selectCut(float max_px2);
  void projectEntries(bool cut, std::size_t sizes);
  void readTiles();
  GpuStats show(const GpuImage& image, const GpuBuffer* weights);

  std::shared_ptr<const GpuGaussianScene> scene_;
  std::shared_ptr<GpuDevice> device_;
  GpuFrameStages stages_;
  Buffers own_;
  GpuGaussianLayers layers_{device_};
  // Of the last projection; empty: not read, not divided.
  std::vector<GpuTile> on_gpu_;
  std::vector<Tile> tiles_;
  std::vector<TileLayers> divided_;
};

}  // namespace foci
