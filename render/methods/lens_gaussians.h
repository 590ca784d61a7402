// A scene of Gaussians through the observer's lens, on the CPU or on a GPU: through discs on it,
// through parts that see different images, and with diffraction. Every method that renders
// Gaussians goes through `LensGaussians`.
#pragma once

#include <memory>
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

  bool isOnGpu() const { return gpu_ != nullptr; }

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
  std::unique_ptr<GpuGaussians> gpu_;
  std::vector<TileLens> lenses_;  // of the last render on the GPU
};

/// Diffraction spreads all light alike, whatever its distance. So the frame is spread as a whole,
/// in linear light: Gaussians spread one by one would let light through surfaces. The CPU spreads
/// it, also where a GPU renders.
class GaussianEyeMethod : public Method {
 private:
  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) final;

  /// `renderFrame` without diffraction.
  virtual RenderStats renderGeometry(const View& view, const RenderSettings& settings,
                                     Frame& frame) = 0;
};

/// A lens whose parts see different images (`Pupil::hasParts`). Each part is projected by itself,
/// because its focus and its image are its own. Keeps its buffers between frames.
class GaussianParts {
 public:
  /// Renders the mean of the parts. Points stay points; other parts are rendered through the
  /// smaller discs of `subApertureDiscs`.
  RenderStats render(LensGaussians& scene, const std::vector<LensPart>& parts, const View& view,
                     const RenderSettings& settings, const GaussianCutSettings* lod, Frame& frame);

 private:
  Frame part_;
};

}  // namespace foci
