// Agreement beyond chance between two labellings of the same samples.
#pragma once

#include <algorithm>
#include <optional>

namespace foci {

/// Cohen's kappa (1960) of two yes-or-no labellings: (p_o - p_e) / (1 - p_e), with the observed
/// agreement p_o and the agreement p_e that chance alone would give.
class CohensKappa {
 public:
  void add(bool a, bool b) {
    count_ += 1.0;
    a_ += a;
    b_ += b;
    both_ += a && b;
  }

  /// 1 for full agreement, 0 for the agreement of chance. Nothing if both labellings are constant
  /// and equal, because chance alone would agree then.
  std::optional<double> value() const {
    const double chance =
        (a_ * b_ + (count_ - a_) * (count_ - b_)) / std::max(count_ * count_, 1.0);
    if (count_ == 0.0 || chance >= 1.0) return std::nullopt;
    return ((count_ - a_ - b_ + 2.0 * both_) / count_ - chance) / (1.0 - chance);
  }

 private:
  double count_ = 0.0, a_ = 0.0, b_ = 0.0, both_ = 0.0;
};

}  // namespace foci
