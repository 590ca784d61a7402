// What `paper` and `paper-lod` have in common: from splats to a frame.
#pragma once

#include "render/methods/abuffer.h"
#include "render/methods/method.h"
#include "render/methods/paper_splat.h"
#include "render/methods/paper_tiles.h"

namespace foci {

/// Bins and renders; `lists` are kept between frames for their memory.
inline RenderStats renderPaper(const PaperSplats& splats, PaperTileLists& lists, const View& view,
                               const RenderSettings& settings, bool transparent, Frame& frame) {
  lists.build(splats, view.size_px);
  RenderStats stats;
  stats.splats = splats.total();
  stats.fragments =
      renderABuffer(splats, lists, settings.background, transparent, settings.depth, frame);
  return stats;
}

}  // namespace foci
