// Renders a scene of Gaussians through the lens on the GPU: LOD cut, projection, tiles and
// compositing, all as the CPU does in render/gaussians. Each tile is one layer.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/gaussians/composite.h"
#include "render/gaussians/gaussian_cut.h"
#include "render/gaussians/tile_layers.h"
#include "render/gaussians/view_spread.h"
#include "render/gl/gaussian_scene.h"
#include "render/gl/image.h"
#include "render/gl/splats.h"

namespace foci {

/// Keeps its buffers between frames.
class GpuGaussians {
 public:
  explicit GpuGaussians(std::shared_ptr<const GpuGaussianScene> scene);
  ~GpuGaussians();
  GpuGaussians(GpuGaussians&&) noexcept;
  GpuGaussians& operator=(GpuGaussians&&) noexcept;

  /// Projects and sorts what sub-apertures of any of the `sizes` show. Throws GpuError where the
  /// GPU fails or lacks memory, as `render` does.
  /// @param lod  renders a cut of the scene's tree (asserted to exist), and fewer samples where all
  ///             is blurred; null: all Gaussians, and each pixel
  /// @return the stats without fragments
  GpuStats project(const View& view, const Defocus& defocus,
                   const std::vector<SubApertureSize>& sizes, const GaussianCutSettings* lod);

  /// Renders the projected view through discs into `image`, a new one: the mean over the discs, in
  /// linear light. The same request gives the same bytes on one device and driver.
  /// @param background  linear RGB
  /// @return the stats without splats
  GpuStats render(std::span<const LensDisc> discs, const glm::vec3& background, bool depth,
                  std::shared_ptr<GpuImage>& image);

  /// The tiles of a projected view, each as one layer with its blur.
  struct Tiles {
    std::vector<Tile> tiles;
    std::vector<TileLayers> layers;  ///< by tile
  };
  /// Of the view that was projected last. Reads them from the GPU once.
  const Tiles& tiles();

  /// What a tile is rendered through.
  struct TileDiscs {
    std::uint32_t first = 0, count = 0;  ///< of all discs; none: the image keeps the tile as it is
    float weight = 1.0f;  ///< of the tile's new image; that of the present is the rest
  };
  /// Renders each tile through discs of its own. `tiles()` comes before it.
  /// @param tiles   by tile
  /// @param image   null: a new one
  /// @param errors  of the tiles that are rendered through more than one disc; null: not wanted
  GpuStats render(std::span<const LensDisc> discs, std::span<const TileDiscs> tiles,
                  const glm::vec3& background, bool depth, std::shared_ptr<GpuImage>& image,
                  std::vector<SampledErrors>* errors);

  const std::shared_ptr<const GpuGaussianScene>& scene() const;

 private:
  class Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace foci
