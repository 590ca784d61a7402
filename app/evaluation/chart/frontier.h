// The methods that no other method beats.
#pragma once

#include <vector>

namespace foci {

/// The Pareto frontier of (cost, worth). Entry i lies on the frontier if no other entry costs at
/// most as much and is worth at least as much, one of the two strictly. Equal entries lie on the
/// frontier together. Infinities are ordinary values. NaN and lists of different lengths are not
/// allowed (asserted).
std::vector<bool> paretoFrontier(const std::vector<double>& cost, const std::vector<double>& worth);

}  // namespace foci
