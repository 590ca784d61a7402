// From the paper's splats to a frame, for `paper` and `paper-lod`.
#pragma once

#include "render/literature/paper/abuffer.h"
#include "render/literature/paper/splat.h"
#include "render/literature/paper/tiles.h"
#include "render/methods/method.h"

namespace foci {

/// Bins the splats and renders them. The caller keeps `lists` between frames for their memory.
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
