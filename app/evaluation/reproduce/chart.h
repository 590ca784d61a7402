// Time against aperture: a line for each method, foci's and the paper's.
#pragma once

#include <string>
#include <vector>

#include "app/evaluation/reproduce/measure.h"

namespace foci {

/// An <svg> element in the page's colours, with logarithmic time.
/// @param threads  selects the rows
std::string chartOf(const ReproduceScene& scene, const std::vector<ReproduceRow>& rows,
                    unsigned threads);

}  // namespace foci
