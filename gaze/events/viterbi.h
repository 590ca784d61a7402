// A hidden Markov model that smooths probabilities of states: the most likely path (Viterbi 1967).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace foci {

/// The most likely path of K states while probabilities arrive. Neighbouring samples are not
/// independent: a sample stands for the time to the next one, so that evidence is the integral of
/// the log probability over time, at any sampling rate. A change of the state costs `switch_s` of
/// it. A shorter and less certain event than this is noise.
template <std::size_t K>
class ViterbiPath {
 public:
  /// From where each state is reached best; with the states of all samples it is the path.
  using From = std::array<std::uint8_t, K>;

  explicit ViterbiPath(double switch_s) : switch_s_(switch_s) {}

  /// @param step_s  time that the sample stands for
  From push(const std::array<double, K>& probabilities, double step_s) {
    constexpr double kLeast = 1e-4;  // nothing is impossible
    From from{};
    std::array<double, K> next{};
    const std::size_t best = bestState();
    for (std::size_t k = 0; k < K; ++k) {
      const double changed = scores_[best] - switch_s_;
      from[k] = static_cast<std::uint8_t>(scores_[k] >= changed ? k : best);
      next[k] = std::max(scores_[k], changed) + step_s * std::log(probabilities[k] + kLeast);
    }
    // Only differences count.
    scores_ = next;
    const double top = scores_[bestState()];
    for (double& score : scores_) score -= top;
    return from;
  }

  /// The end of the most likely path up to the newest sample. Equal scores: the first state.
  std::size_t bestState() const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < K; ++k) best = scores_[k] > scores_[best] ? k : best;
    return best;
  }

  /// Forgets the past; the next sample begins in any state, or in the given one.
  void restart() { scores_ = {}; }
  void restartIn(std::size_t state) {
    scores_.fill(-switch_s_);
    scores_[state] = 0.0;
  }

 private:
  double switch_s_;
  std::array<double, K> scores_{};
};

/// What a sample tells `ViterbiPath::push`.
template <std::size_t K>
struct Evidence {
  std::array<double, K> probabilities{};
  double step_s = 0.0;
};

/// The states of the most likely path through all samples.
template <std::size_t K>
std::vector<std::size_t> mostLikelyStates(ViterbiPath<K> path,
                                          const std::vector<Evidence<K>>& samples) {
  std::vector<typename ViterbiPath<K>::From> from;
  from.reserve(samples.size());
  for (const Evidence<K>& each : samples)
    from.push_back(path.push(each.probabilities, each.step_s));
  std::vector<std::size_t> states(samples.size());
  std::size_t state = path.bestState();
  for (std::size_t i = samples.size(); i-- > 0;) {
    states[i] = state;
    state = from[i][state];
  }
  return states;
}

}  // namespace foci
