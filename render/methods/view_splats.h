// The scene as splats for one view: the one door through which methods that render all surfels
// reach projection, binning and the sweep.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "render/methods/method.h"
#include "render/splat/bin.h"
#include "render/splat/project.h"
#include "render/splat/splat.h"

namespace foci {

/// Splats of a view by tile, front to back. Keeps its buffers between frames.
class ViewSplats {
 public:
  /// Projects the whole scene, blurred by `settings.defocus` as `projection` says. Its shading is
  /// the settings'.
  void project(const SurfelCloud& cloud, const View& view, const RenderSettings& settings,
               Projection projection);

  /// Takes those splats of `all` that `belongs` accepts. It is called from several threads.
  void select(const ViewSplats& all, const std::function<bool(const Splat&)>& belongs);

  /// Sweeps the splats over `background` into `frame`, resized as needed.
  /// @return fragments
  std::uint64_t render(const glm::vec3& background, bool depth, Frame& frame) const;

  std::uint64_t count() const { return chunks_.total(); }
  const Splat* splats() const { return chunks_.splats.get(); }

  /// The image in squares of kTile_px, each with the splats that may meet it, front to back.
  static constexpr int kTile_px = kTile;
  std::size_t tileCount() const { return lists_.tiles().size(); }
  glm::ivec2 cornerOf(std::size_t tile) const {
    return {lists_.tiles()[tile].x_px, lists_.tiles()[tile].y_px};
  }
  std::span<const std::uint32_t> splatsOn(std::size_t tile) const { return lists_.splats(tile); }

  /// Calls `visit` for every splat, in order of surfel.
  template <typename Visit>
  void forEach(const Visit& visit) const {
    for (std::size_t c = 0; c < chunks_.count.size(); ++c) {
      for (std::uint32_t i = 0; i < chunks_.count[c]; ++i) {
        visit(chunks_.splats[c * chunks_.chunk_size + i]);
      }
    }
  }

 private:
  SplatChunks chunks_;
  TileLists lists_;
  glm::ivec2 size_px_{0};
  Defocus defocus_;
  bool transparent_ = false;
};

/// Draws the scene unblurred: a pinhole in the middle of the lens. What a post-filter is given.
class PinholeCamera {
 public:
  explicit PinholeCamera(const SurfelCloud& cloud) : sweep_(makeMethod("sweep", cloud)) {}

  /// `settings` without their defocus (but for what distances are measured along), with depth.
  RenderStats render(const View& view, const RenderSettings& settings, Frame& frame);

 private:
  std::unique_ptr<Method> sweep_;
};

}  // namespace foci
