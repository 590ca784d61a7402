// Order statistics.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace foci {

/// The element at the rank nearest to share * (n - 1), without interpolation. Reorders `values`.
/// @param values  not empty (asserted)
/// @param share   0 (minimum) to 1 (maximum)
template <class T>
T quantile(std::vector<T>& values, double share) {
  assert(!values.empty());
  const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace foci
