// A scene of Gaussians through the lens, on the CPU or on a GPU. Every method that renders
// Gaussians goes through this class.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/gaussians/gaussian_view.h"
#include "render/gl/gaussians.h"
#include "render/methods/method.h"

namespace foci {

/// Keeps its buffers between frames.
class LensGaussians {
 public:
  /// @param gpu  renders; null: the CPU does
  LensGaussians(std::shared_ptr<const GaussianCloud> cloud, const SharedGpu& gpu);
  /// Another one of the same scene.
  LensGaussians sharingScene() const;

  bool isOnGpu() const { return gpu_.has_value(); }

  /// `GaussianView::project`. @return its stats
  RenderStats project(const View& view, const Defocus& defocus, const std::vector<LensDisc>& discs,
                      const GaussianCutSettings* lod = nullptr);

  /// `GaussianView::render`: the mean over discs that were projected. Leaves the pixels on the GPU,
  /// if it renders.
  /// @return its stats
  RenderStats render(const std::vector<LensDisc>& discs, const glm::vec3& background, Frame& frame);

  /// The same with discs that each tile chooses for its layers (`GaussianView::render`). Goes on
  /// with what the frame holds, on the GPU if it renders. `divide` comes before it.
  RenderStats render(const ChooseLens& lens_of, const glm::vec3& background, Frame& frame,
                     std::vector<SampledErrors>* errors = nullptr);

  const std::vector<Tile>& tiles();
  /// `GaussianView::divide`.
  const std::vector<TileLayers>& divide(bool several);

 private:
  std::shared_ptr<const GaussianCloud> cloud_;
  GaussianView view_;
  std::optional<GpuGaussians> gpu_;
  std::vector<TileLens> lenses_;  // of the last render on the GPU
};

}  // namespace foci
