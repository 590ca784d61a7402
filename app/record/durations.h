// A histogram of durations, in constant memory however long a run is.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace foci {

class Durations {
 public:
  void add(double ms) {
    const double bin = std::clamp(ms / kBin_ms, 0.0, static_cast<double>(kBins - 1));
    ++counts_[static_cast<std::size_t>(bin)];
    ++count_;
  }

  std::uint64_t count() const { return count_; }

  /// The value below which a share of all durations lies, ms, in bins of 0.1 ms up to 2 s. 0
  /// without durations.
  double quantile_ms(double share) const {
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(count_));
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      below += counts_[i];
      if (below > wanted || (below == count_ && count_ > 0)) {
        return (static_cast<double>(i) + 0.5) * kBin_ms;
      }
    }
    return 0.0;
  }

 private:
  static constexpr double kBin_ms = 0.1;
  static constexpr std::size_t kBins = 20000;
  std::array<std::uint32_t, kBins> counts_{};
  std::uint64_t count_ = 0;
};

}  // namespace foci
