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
  /// Shares the other's scene.
  LensGaussians(const LensGaussians& other, std::nullptr_t);

  bool isOnGpu() const { return gpu_.has_value(); }

  /// `GaussianView::project`. @return its stats
  RenderStats project(const View& view, const Defocus& defocus, const std::vector<LensDisc>& discs,
                      const GaussianCutSettings* lod = nullptr);

  /// `GaussianView::render`: the mean over discs that were projected. Leaves the pixels on the GPU,
  /// if it renders.
  /// @return its stats
  RenderStats render(const std::vector<LensDisc>& discs, const glm::vec3& background, Frame& frame);

  /// The Gaussians that `isOnGpu` leaves to the CPU (asserted).
  GaussianView& onCpu();

 private:
  std::shared_ptr<const GaussianCloud> cloud_;
  GaussianView view_;
  std::optional<GpuGaussians> gpu_;
};

}  // namespace foci
