// A few of many values, evenly spread.
#pragma once

#include <cstddef>
#include <vector>

namespace foci {

inline constexpr std::size_t kEnoughForShares = 8192;  ///< that are exact to a hundredth

/// Every n-th of many values, in constant memory: if there are too many, every other one is
/// dropped.
template <class T, std::size_t most = kEnoughForShares>
class Thinned {
 public:
  /// @param make  gives the value, if it is kept
  template <class Make>
  void add(const Make& make) {
    if (count_++ % stride_ != 0) return;
    kept_.push_back(make());
    if (kept_.size() < most) return;
    for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
    kept_.resize((most + 1) / 2);
    stride_ *= 2;
  }

  const std::vector<T>& kept() const { return kept_; }

 private:
  std::size_t count_ = 0, stride_ = 1;
  std::vector<T> kept_{};
};

}  // namespace foci
