// Time against aperture, every method a line, the paper's own among them.
#pragma once

#include <string>
#include <vector>

#include "app/evaluation/reproduce/measure.h"

namespace foci {

/// An <svg> element that takes the page's colours; logarithmic in time.
/// @param threads  whose rows are drawn
std::string chartOf(const ReproduceScene& scene, const std::vector<ReproduceRow>& rows,
                    unsigned threads);

}  // namespace foci
