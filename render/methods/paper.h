// What `paper` and `paper-lod` have in common: from splats to a frame.
#pragma once

#include "render/methods/abuffer.h"
#include "render/methods/method.h"
#include "render/methods/paper_splat.h"
#include "render/methods/paper_tiles.h"

namespace foci {

/// Bins and draws; `lists` are kept between frames for their memory. `frame` is resized as needed.
inline RenderStats drawPaper(const PaperSplats& splats, PaperTileLists& lists, const View& view,
                             const RenderSettings& settings, bool transparent, Frame& frame) {
  const std::size_t pixels = static_cast<std::size_t>(view.size_px.x) * view.size_px.y;
  frame.size_px = view.size_px;
  frame.rgba.resize(pixels);
  frame.depth_m.resize(settings.depth ? pixels : 0);
  lists.build(splats, view.size_px);
  RenderStats stats;
  stats.splats = splats.total();
  stats.fragments =
      drawABuffer(splats, lists, settings.background, transparent, settings.depth, frame);
  return stats;
}

}  // namespace foci
