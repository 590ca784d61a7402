// The scene as splats for one view. Every method that renders all surfels, or all but those finer
// than pixels, goes through this class to projection, binning and the sweep.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "render/gl/splats.h"
#include "render/lod/cut.h"
#include "render/methods/method.h"
#include "render/splat/bin.h"
#include "render/splat/project.h"
#include "render/splat/splat.h"

namespace foci {

/// What a scene with a tree is rendered from at full detail: surfels, and merged ones where they
/// are much finer than pixels. Absent without a tree: every surfel.
std::optional<CutSettings> pixelCutOf(const SurfelCloud& cloud, const Acuity& acuity);

/// Splats of a view by tile, front to back. Keeps its buffers between frames.
class ViewSplats {
 public:
  /// Projects the scene. The blur is that of `settings.defocus`; `projection` says how the blur
  /// enters a splat. `settings.lighting` replaces the projection's.
  /// @param cut  of the scene's tree, e.g. `pixelCutOf`; absent: every surfel
  void project(const SurfelCloud& cloud, const View& view, const RenderSettings& settings,
               Projection projection, const std::optional<CutSettings>& cut = std::nullopt);

  /// Copies the splats of `all` that `belongs` accepts. Several threads call `belongs`.
  void select(const ViewSplats& all, const std::function<bool(const Splat&)>& belongs);

  /// Renders the splats over `background` (linear RGB) into `frame`, which is resized as needed.
  /// @return the number of fragments
  std::uint64_t render(const glm::vec3& background, bool depth, Frame& frame) const;

  std::uint64_t count() const { return chunks_.total(); }
  const Splat* splats() const { return chunks_.splats.get(); }

  /// The image in square tiles, each with the splats that may touch the tile, front to back.
  static constexpr int kTile_px = kTile;
  std::size_t tileCount() const { return lists_.tiles().size(); }
  glm::ivec2 cornerOf(std::size_t tile) const {
    return {lists_.tiles()[tile].x_px, lists_.tiles()[tile].y_px};
  }
  std::span<const std::uint32_t> splatsOn(std::size_t tile) const { return lists_.splats(tile); }

  /// Calls `visit` for every splat, in the order of the surfels.
  template <typename Visit>
  void forEach(const Visit& visit) const {
    for (std::size_t c = 0; c < chunks_.count.size(); ++c) {
      for (std::uint32_t i = 0; i < chunks_.count[c]; ++i) {
        visit(chunks_.splats[c * chunks_.chunk_size + i]);
      }
    }
  }

 private:
  Cut cut_;
  SplatChunks chunks_;
  TileLists lists_;
  glm::ivec2 size_px_{0};
  glm::vec2 principal_px_{0.0f};
  Defocus defocus_;
};

/// The scene at full detail through a part of the lens, on the CPU or on a GPU. Keeps its buffers
/// between frames.
class PartSplats {
 public:
  /// @param cloud  must outlive this
  PartSplats(const SurfelCloud& cloud, const SharedGpu& gpu);

  /// Leaves the pixels on the GPU, if it renders. Adds the cost to the stats.
  void render(const View& view, RenderSettings settings, const LensPart& part, const Acuity& acuity,
              Frame& frame, RenderStats& stats);

 private:
  const SurfelCloud& cloud_;
  std::unique_ptr<GpuSplats> gpu_;
  ViewSplats splats_;
};

/// A request for all surfels, with the settings' lens.
GpuRequest gpuRequestOf(const View& view, const RenderSettings& settings);
RenderStats statsOf(const GpuStats& rendered);

/// The settings without blur.
RenderSettings withoutBlur(const RenderSettings& settings);

/// Renders the scene through a pinhole in the middle of the lens: the sharp image that a
/// post-filter starts from.
class PinholeCamera {
 public:
  explicit PinholeCamera(const SurfelCloud& cloud) : sweep_(makeMethod("sweep", cloud)) {}

  /// Renders with depth and without blur, whatever the settings say of either.
  RenderStats render(const View& view, const RenderSettings& settings, Frame& frame);

 private:
  std::unique_ptr<Method> sweep_;
};

}  // namespace foci
