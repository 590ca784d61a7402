// Renders a scene of Gaussians through the lens on the GPU: LOD cut, projection, tiles and
// compositing, all as the CPU does in render/gaussians.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/gaussians/gaussian_cut.h"
#include "render/gaussians/layer_stack.h"
#include "render/gl/gaussian_layers.h"
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

  const std::shared_ptr<const GpuGaussianScene>& scene() const;

 private:
  class Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace foci
