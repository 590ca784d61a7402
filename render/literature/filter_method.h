// What the post-filters share: each blurs the finished pinhole image.
#pragma once

#include <utility>

#include "base/parallel.h"
#include "render/methods/method.h"
#include "render/methods/post_filter.h"
#include "render/methods/view_splats.h"

namespace foci {

class FilterMethod : public Method {
 public:
  explicit FilterMethod(const SurfelCloud& cloud) : camera_(cloud) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) final {
    const RenderStats stats = camera_.render(view, settings, frame);
    filter(view, settings.defocus, frame);
    if (!settings.depth) frame.depth_m.clear();
    return stats;
  }

 protected:
  /// Calls visit(tile, begin, end) for each tile of `discs_`, in parallel: it has the pixels from
  /// `begin` on, before `end`.
  template <typename Visit>
  void forEachTile(const Visit& visit) const {
    parallelFor(static_cast<std::size_t>(discs_.tileCount()), [&](std::size_t t) {
      const int tile = static_cast<int>(t);
      const glm::ivec2 begin = discs_.tileAt(tile) * DiscImage::kTile_px;
      visit(tile, begin, glm::min(begin + DiscImage::kTile_px, discs_.size_px()));
    });
  }

  DiscImage discs_;

 private:
  virtual void filter(const View& view, const Defocus& defocus, Frame& frame) = 0;

  PinholeCamera camera_;
};

/// The entry of a post-filter. All of them render round lenses alone, and trees of surfels.
template <class M>
MethodEntry filterEntry(MethodInfo info) {
  info.ellipses = false;
  info.lod = true;
  return {.info = std::move(info), .make = makeAs<M>};
}

}  // namespace foci
