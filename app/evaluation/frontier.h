// Which of several ways nothing beats.
#pragma once

#include <vector>

namespace foci {

/// The Pareto frontier of (cost, worth): entry i is on it where no other costs at most as much and
/// is worth at least as much, one of the two strictly. Equal entries are on it together. Infinities
/// are ordinary values; NaN is not allowed (asserted), nor are lists of different lengths.
std::vector<bool> paretoFrontier(const std::vector<double>& cost, const std::vector<double>& worth);

}  // namespace foci
