// Renders a scene of Gaussians through the lens: one projection and one sorting for all of its
// sub-apertures. The order by depth is the same from every point of the lens, since the lens lies
// in a plane of equal depth.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/gaussians/layer_stack.h"
#include "render/gaussians/projected.h"
#include "render/gaussians/tile_layers.h"
#include "render/gaussians/view_spread.h"
#include "render/image/frame.h"
#include "render/optics/view.h"
#include "render/splat/bin.h"

namespace foci {

/// What a tile is rendered through; without discs, the frame keeps the tile as it is. Called by
/// several threads.
using ChooseLens = std::function<TileLens(std::size_t tile)>;

/// Keeps its buffers between frames.
class GaussianView {
 public:
  /// @param cloud  outlives it
  explicit GaussianView(const GaussianCloud& cloud) : cloud_(&cloud) {}

  /// Projects and sorts what any of the discs shows.
  /// @param lod  renders a cut of the scene's tree (asserted to exist), and fewer samples where all
  ///             is blurred; null: all Gaussians, and each pixel
  void project(const View& view, const Defocus& defocus, const std::vector<LensDisc>& discs,
               const GaussianCutSettings* lod = nullptr);

  /// Renders the projected view through discs that were projected: the mean over the discs, in
  /// linear light.
  /// @param background  linear RGB
  /// @param frame       has the view's size, and depth where it is wanted
  /// @return kernel evaluations inside of footprints
  std::uint64_t render(const std::vector<LensDisc>& discs, const glm::vec3& background,
                       Frame& frame);

  /// The same with discs that each tile chooses for the layers that `divide` gave it.
  /// @param errors  of the tiles that are rendered through more than one disc; null: not wanted
  std::uint64_t render(const ChooseLens& lens_of, const glm::vec3& background, Frame& frame,
                       std::vector<SampledErrors>* errors = nullptr);

  const std::vector<Tile>& tiles() const { return lists_.tiles(); }
  /// Divides each tile into layers, until the next projection.
  /// @param several  false: one layer each
  const std::vector<TileLayers>& divide(bool several);

  std::size_t count() const { return projected_.total(); }

 private:
  static void writeTile(const Tile& tile, const TileSums& sums, const TileLens& lens, Frame& frame);

  const GaussianCloud* cloud_;
  Defocus defocus_;
  glm::ivec2 size_px_{0};
  glm::vec2 principal_px_{0.0f};
  GaussianCut cut_;
  ProjectedGaussians projected_;
  TileLists lists_;
  std::vector<TileLayers> layers_;  // empty: not divided
};

}  // namespace foci
