// Gradient-boosted decision trees (Friedman 2001), as packed in a model file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace foci {

/// An additive model of the log odds of some classes. Each round adds one tree for each class. All
/// trees are complete and have the same depth.
struct BoostedTrees {
  static constexpr std::size_t kBins = 64;       ///< of each feature
  static constexpr std::uint8_t kNoSplit = 255;  ///< as `Node::bin`: all samples go to the left
  static constexpr double kLeafUnit = 1.0 / 4096.0;

  struct Node {
    std::uint8_t feature = 0;
    std::uint8_t bin = kNoSplit;  ///< values above `edges[feature][bin]` go to the right
  };

  std::size_t classes = 0, features = 0, depth = 0;
  std::vector<float> edges{};          ///< `kBins - 1` for each feature, ascending
  std::vector<Node> nodes{};           ///< 2^depth - 1 for each tree, level by level
  std::vector<std::int16_t> leaves{};  ///< 2^depth for each tree, in `kLeafUnit`
  std::vector<float> priors{};         ///< share of each class in the training, > 0

  std::size_t trees() const { return leaves.size() >> depth; }

  /// The probability of each class, given the shares of the training. They sum to 1.
  /// @param values  one for each feature
  void probabilities(std::span<const float> values, std::span<double> of_classes) const;
};

}  // namespace foci
