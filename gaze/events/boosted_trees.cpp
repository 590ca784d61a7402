#include "gaze/events/boosted_trees.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace foci {

void BoostedTrees::probabilities(std::span<const float> values,
                                 std::span<double> of_classes) const {
  assert(values.size() == features && of_classes.size() == classes && classes <= 8);
  const std::size_t inner = (std::size_t{1} << depth) - 1;
  std::array<std::int32_t, 8> sums{};  // whole numbers: their order does not matter
  for (std::size_t tree = 0; tree < trees(); ++tree) {
    const Node* node = &nodes[tree * inner];
    std::size_t at = 0;
    for (std::size_t level = 0; level < depth; ++level) {
      const Node each = node[at];
      const bool right = each.bin != kNoSplit &&
                         values[each.feature] > edges[each.feature * (kBins - 1) + each.bin];
      at = 2 * at + 1 + (right ? 1 : 0);
    }
    sums[tree % classes] += leaves[(tree << depth) + at - inner];
  }
  double total = 0.0;
  const std::int32_t most =
      *std::max_element(sums.begin(), sums.begin() + static_cast<std::ptrdiff_t>(classes));
  for (std::size_t k = 0; k < classes; ++k) {
    of_classes[k] =
        std::exp(kLeafUnit * (sums[k] - most) + std::log(static_cast<double>(priors[k])));
    total += of_classes[k];
  }
  for (double& each : of_classes) each /= total;
}

}  // namespace foci
