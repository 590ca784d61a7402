// Training of boosted trees: histograms of gradients (Friedman 2001; Chen and Guestrin 2016, Eq. 6
// and 7).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "base/parallel.h"
#include "gaze/events/event_model.h"

namespace foci {

struct BoostingSettings {
  std::size_t rounds = 60, depth = 5;
  double rate = 0.15;                ///< each tree adds so much of its best step
  double lambda = 5.0;               ///< L2 penalty of a leaf
  double min_weight = 20.0;          ///< of a leaf, second derivative
  double rows = 0.5, columns = 0.4;  ///< share of rows and features that a tree sees
  std::uint64_t seed = 1;
};

/// Rows of features with a class and a weight.
struct TrainingRows {
  std::size_t features = 0;
  std::vector<float> values{};  ///< `features` for each row
  std::vector<std::uint8_t> classes{};
  std::vector<float> weights{};

  std::size_t size() const { return classes.size(); }
};

class Boosting {
 public:
  Boosting(const TrainingRows& rows, std::size_t classes, const BoostingSettings& settings)
      : rows_(rows), settings_(settings), random_(settings.seed) {
    trees_.classes = classes;
    trees_.features = rows.features;
    trees_.depth = settings.depth;
  }

  BoostedTrees train() {
    bin();
    measurePriors();
    const std::size_t classes = trees_.classes, count = rows_.size();
    std::vector<float> scores(count * classes);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < classes; ++k)
        scores[i * classes + k] = std::log(trees_.priors[k]);
    }
    gradients_.resize(count);
    std::vector<float> probabilities(count * classes);
    for (std::size_t round = 0; round < settings_.rounds; ++round) {
      forBlocks(count, [&](std::size_t i) {
        float* p = &probabilities[i * classes];
        const float* s = &scores[i * classes];
        const float most = *std::max_element(s, s + classes);
        float total = 0.0F;
        for (std::size_t k = 0; k < classes; ++k) total += p[k] = std::exp(s[k] - most);
        for (std::size_t k = 0; k < classes; ++k) p[k] /= total;
      });
      choose();
      for (std::size_t k = 0; k < classes; ++k) {
        forBlocks(count, [&](std::size_t i) {
          const float p = probabilities[i * classes + k], w = rows_.weights[i];
          gradients_[i] = {w * (p - (rows_.classes[i] == k ? 1.0F : 0.0F)),
                           w * std::max(p * (1.0F - p), 1e-4F)};
        });
        addTree();
        const std::size_t first_leaf = trees_.leaves.size() - (std::size_t{1} << trees_.depth);
        forBlocks(count, [&](std::size_t i) {
          scores[i * classes + k] +=
              static_cast<float>(BoostedTrees::kLeafUnit) * trees_.leaves[first_leaf + leafOf(i)];
        });
      }
    }
    return trees_;
  }

 private:
  static constexpr std::size_t kBins = BoostedTrees::kBins;
  struct Gradient {
    float first = 0.0F, second = 0.0F;
  };
  struct Sum {
    double first = 0.0, second = 0.0;
  };

  template <typename Function>
  static void forBlocks(std::size_t count, const Function& function) {
    parallelFor(count, [&](std::size_t i) { function(i); });
  }

  /// Edges at quantiles of a sample of the rows.
  void bin() {
    constexpr std::size_t kSample = 20000;
    trees_.edges.assign(rows_.features * (kBins - 1), 0.0F);
    bins_.assign(rows_.features * rows_.size(), 0);
    const std::size_t stride = std::max<std::size_t>(rows_.size() / kSample, 1);
    parallelFor(rows_.features, [&](std::size_t f) {
      std::vector<float> values;
      for (std::size_t i = 0; i < rows_.size(); i += stride) {
        values.push_back(rows_.values[i * rows_.features + f]);
      }
      std::sort(values.begin(), values.end());
      float* edges = &trees_.edges[f * (kBins - 1)];
      for (std::size_t b = 0; b + 1 < kBins; ++b) {
        edges[b] = values[(b + 1) * (values.size() - 1) / kBins];
      }
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        bins_[f * rows_.size() + i] = static_cast<std::uint8_t>(
            std::lower_bound(edges, edges + kBins - 1, rows_.values[i * rows_.features + f]) -
            edges);
      }
    });
  }

  void measurePriors() {
    std::vector<double> sums(trees_.classes, 1e-3);
    double all = 1e-3 * static_cast<double>(trees_.classes);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      sums[rows_.classes[i]] += rows_.weights[i];
      all += rows_.weights[i];
    }
    for (const double sum : sums) trees_.priors.push_back(static_cast<float>(sum / all));
  }

  /// The rows and features of the next round.
  void choose() {
    chosen_.clear();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (static_cast<double>(random_() >> 11) * 0x1p-53 < settings_.rows) {
        chosen_.push_back(static_cast<std::uint32_t>(i));
      }
    }
  }

  std::vector<std::size_t> chosenFeatures() {
    std::vector<std::size_t> all(rows_.features);
    for (std::size_t f = 0; f < all.size(); ++f) all[f] = f;
    for (std::size_t f = 0; f < all.size(); ++f) {
      std::swap(all[f], all[f + random_() % (all.size() - f)]);
    }
    all.resize(std::max<std::size_t>(
        static_cast<std::size_t>(settings_.columns * static_cast<double>(all.size())), 1));
    return all;
  }

  void addTree() {
    const std::size_t inner = (std::size_t{1} << trees_.depth) - 1;
    const std::size_t first_node = trees_.nodes.size();
    trees_.nodes.resize(first_node + inner);
    tree_ = &trees_.nodes[first_node];
    places_.assign(chosen_.size(), 0);
    const std::vector<std::size_t> features = chosenFeatures();
    for (std::size_t level = 0; level < trees_.depth; ++level) split(level, features);
    std::vector<Sum> sums(inner + 1);
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      Sum& sum = sums[places_[i]];
      sum.first += gradients_[chosen_[i]].first;
      sum.second += gradients_[chosen_[i]].second;
    }
    for (const Sum& sum : sums) {
      const double step = -settings_.rate * sum.first / (sum.second + settings_.lambda);
      trees_.leaves.push_back(static_cast<std::int16_t>(
          std::lround(std::clamp(step, -4.0, 4.0) / BoostedTrees::kLeafUnit)));
    }
  }

  struct Split {
    double gain = 1e-3;
    std::uint8_t feature = 0, bin = BoostedTrees::kNoSplit;
  };

  void split(std::size_t level, const std::vector<std::size_t>& features) {
    const std::size_t width = std::size_t{1} << level, first = width - 1;
    std::vector<std::vector<Split>> found(features.size(), std::vector<Split>(width));
    parallelFor(features.size(), [&](std::size_t at) {
      const std::uint8_t* bins = &bins_[features[at] * rows_.size()];
      std::vector<Sum> sums(width * kBins);
      for (std::size_t i = 0; i < chosen_.size(); ++i) {
        Sum& sum = sums[places_[i] * kBins + bins[chosen_[i]]];
        sum.first += gradients_[chosen_[i]].first;
        sum.second += gradients_[chosen_[i]].second;
      }
      for (std::size_t place = 0; place < width; ++place) {
        found[at][place] = bestOf(&sums[place * kBins], features[at]);
      }
    });
    for (std::size_t place = 0; place < width; ++place) {
      Split best;
      for (const auto& each : found) {
        if (each[place].gain > best.gain) best = each[place];
      }
      tree_[first + place] = {best.feature, best.bin};
    }
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      places_[i] = 2 * places_[i] + goesRight(tree_[first + places_[i]], chosen_[i]);
    }
  }

  Split bestOf(const Sum* sums, std::size_t feature) const {
    Sum all;
    for (std::size_t b = 0; b < kBins; ++b) {
      all.first += sums[b].first;
      all.second += sums[b].second;
    }
    const auto value = [&](const Sum& sum) {
      return sum.first * sum.first / (sum.second + settings_.lambda);
    };
    Split best;
    Sum left;
    for (std::size_t b = 0; b + 1 < kBins; ++b) {
      left.first += sums[b].first;
      left.second += sums[b].second;
      const Sum right{all.first - left.first, all.second - left.second};
      if (left.second < settings_.min_weight || right.second < settings_.min_weight) continue;
      const double gain = value(left) + value(right) - value(all);
      if (gain > best.gain) {
        best = {gain, static_cast<std::uint8_t>(feature), static_cast<std::uint8_t>(b)};
      }
    }
    return best;
  }

  bool goesRight(const BoostedTrees::Node& node, std::size_t row) const {
    return node.bin != BoostedTrees::kNoSplit &&
           bins_[node.feature * rows_.size() + row] > node.bin;
  }

  std::size_t leafOf(std::size_t row) const {
    const std::size_t inner = (std::size_t{1} << trees_.depth) - 1;
    std::size_t at = 0;
    while (at < inner) at = 2 * at + 1 + (goesRight(tree_[at], row) ? 1 : 0);
    return at - inner;
  }

  const TrainingRows& rows_;
  BoostingSettings settings_;
  std::mt19937_64 random_;
  BoostedTrees trees_{};
  BoostedTrees::Node* tree_ = nullptr;  // the newest
  std::vector<std::uint8_t> bins_{};    // feature by feature
  std::vector<Gradient> gradients_{};
  std::vector<std::uint32_t> chosen_{};
  std::vector<std::uint32_t> places_{};  // of the chosen rows in the level
};

}  // namespace foci
