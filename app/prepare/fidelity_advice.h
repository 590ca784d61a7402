// What to do where a mesh is sampled too sparsely for its shape or its colours.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/prepare/fidelity.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

/// A 99 % quantile of the colour error from which `fidelityWarnings` speaks: a tenth of the range
/// of code values, chosen by eye.
inline constexpr double kMaxColor99 = 26.0;

/// One sentence for each goal that is missed, with its figure and the `--points` to set.
///
/// Leaks: more than `kMaxLeakShare` or `kWorstLeak`. Colours: more than `kMaxColor99`, where the
/// surfels are fewer than the mesh's detail asks for. foci suggests
///   - `defaultPoints`, if there are fewer than half: a surfel for each texel or vertex that a
///     screen of `kScreenRows` rows can show;
///   - else four times as many, which halves the spacing;
///   - no number where a pixel is two spacings wide: the pixel filter then hides the surfels.
/// @param surfels  their number
std::vector<std::string> fidelityWarnings(const FidelityReport& report, std::size_t surfels,
                                          const TriangleMesh& mesh);

}  // namespace foci
