#include "render/literature/paper/abuffer.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "base/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/literature/paper/abuffer.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After it:
#include "render/literature/paper/abuffer_tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

std::size_t renderABufferTile(const ABufferTile& job, bool transparent, FragmentLists& lists) {
  const auto run = [&]<bool kTransparent, bool kDepth>() {
    ABuffer<kTransparent, kDepth> buffer(lists);
    return buffer.run(job);
  };
  if (job.depth_m)
    return transparent ? run.template operator()<true, true>()
                       : run.template operator()<false, true>();
  return transparent ? run.template operator()<true, false>()
                     : run.template operator()<false, false>();
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(renderABufferTile);

std::uint64_t renderABuffer(const PaperSplats& splats, const PaperTileLists& lists,
                            const glm::vec3& background, bool transparent, bool depth,
                            Frame& frame) {
  const glm::ivec2 tiles = lists.tiles();
  const auto tile_count = static_cast<std::size_t>(tiles.x) * tiles.y;
  std::vector<std::size_t> fragments(tile_count);
  parallelFor(tile_count, [&](std::size_t t) {
    static thread_local FragmentLists lists_of_thread;  // keeps its memory between tiles
    const auto list = lists.tile(t);
    const int x_px = static_cast<int>(t % tiles.x) * kPaperTile_px;
    const int y_px = static_cast<int>(t / tiles.x) * kPaperTile_px;
    const std::size_t corner = static_cast<std::size_t>(y_px) * frame.size_px.x + x_px;
    fragments[t] = HWY_DYNAMIC_DISPATCH(renderABufferTile)(
        {.splats = splats.splats.get(),
         .entries = list.data(),
         .count = list.size(),
         .x_px = x_px,
         .y_px = y_px,
         .width_px = std::min(kPaperTile_px, frame.size_px.x - x_px),
         .height_px = std::min(kPaperTile_px, frame.size_px.y - y_px),
         .background = {background.r, background.g, background.b},
         .rgba = frame.rgba.data() + corner,
         .depth_m = depth ? frame.depth_m.data() + corner : nullptr,
         .stride = static_cast<std::size_t>(frame.size_px.x)},
        transparent, lists_of_thread);
  });
  return std::accumulate(fragments.begin(), fragments.end(), std::uint64_t{0});
}

}  // namespace foci
#endif  // HWY_ONCE
