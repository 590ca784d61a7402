// Order statistics.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace foci {

/// The value below which a share of all lies, 0 to 1, the nearest of them. `values` is reordered,
/// and not empty (asserted).
template <class T>
T quantile(std::vector<T>& values, double share) {
  assert(!values.empty());
  const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace foci
