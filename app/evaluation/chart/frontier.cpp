#include "app/evaluation/chart/frontier.h"

#include <cassert>
#include <cmath>

namespace foci {

std::vector<bool> paretoFrontier(const std::vector<double>& cost,
                                 const std::vector<double>& worth) {
  assert(cost.size() == worth.size());
  std::vector<bool> on(cost.size(), true);
  for (std::size_t i = 0; i < cost.size(); ++i) {
    assert(!std::isnan(cost[i]) && !std::isnan(worth[i]));
    for (std::size_t j = 0; j < cost.size() && on[i]; ++j) {
      const bool no_worse = cost[j] <= cost[i] && worth[j] >= worth[i];
      on[i] = !(no_worse && (cost[j] < cost[i] || worth[j] > worth[i]));
    }
  }
  return on;
}

}  // namespace foci
