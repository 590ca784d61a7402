// How far two labellings of the same samples agree beyond chance.
#pragma once

#include <algorithm>
#include <optional>

namespace foci {

/// Cohen's kappa (1960) of two labellings into yes and no: (p_o - p_e) / (1 - p_e).
class CohensKappa {
 public:
  void add(bool a, bool b) {
    count_ += 1.0;
    a_ += a;
    b_ += b;
    both_ += a && b;
  }

  /// 1 where they agree wholly, 0 by chance; nothing where chance alone would agree, that is where
  /// both say always yes, or always no.
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
