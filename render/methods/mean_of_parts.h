// The mean of the frames that the parts of the lens see.
#pragma once

#include <vector>

#include "render/image/frame.h"
#include "render/optics/pupil.h"

namespace foci {

/// The fewest parts, of `least`, 7, 19, 37 and 61, in each of which the wavefront's
/// slope is linear up to `kRest_px`, besides a stretch of as much: the number follows from the
/// variance of the slope.
std::vector<LensPart> partsFor(const Defocus& defocus, const Pupil& pupil, int least);

/// The largest `rest_px` of the parts.
float restOf_px(const std::vector<LensPart>& parts);

/// Adds `weight` times a part's frame to the sum. Distances count by their coverage.
/// @param first  replaces the sum
void addPart(const Frame& part, float weight, bool first, Frame& sum);

/// Divides the sums of distances by the coverage.
void finishDepth(Frame& sum);

/// @param part    keeps the buffers of one part's frame
/// @param render  (const LensPart&, Frame&) renders one part
template <typename Render>
void meanOfParts(const std::vector<LensPart>& parts, Frame& part, Frame& mean,
                 const Render& render) {
  if (parts.size() == 1) {
    render(parts.front(), mean);
    return;
  }
  part.resize(mean.size_px, !mean.depth_m.empty());
  for (const LensPart& each : parts) {
    render(each, part);
    addPart(part, each.weight, &each == parts.data(), mean);
  }
  finishDepth(mean);
}

}  // namespace foci
