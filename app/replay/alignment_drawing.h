// Plan and side view of a headset recording in its scene, for `foci trace info --scene`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/replay/alignment.h"

namespace foci {

/// An SVG file: for each alignment a caption, and plan and side view of scene, head path and lines
/// of sight. Lines that meet no surface are dashed, and end where the eyes converge.
std::string alignmentSvg(const Scene& scene, const std::vector<Sight>& sights,
                         const std::vector<std::pair<std::string, const AlignmentFit*>>& fits,
                         const glm::dvec3& up);

}  // namespace foci
