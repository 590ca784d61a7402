// Leads an observer from target to target and collects gaze while it rests on each.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "calibration/gaze_map/gaze_pairs.h"

namespace foci {

/// Places of 5, 9, 13 or 16 targets, or of 4 for validation between them (another count asserts). 0
/// to 1 over the screen, origin top-left; the outermost lie a tenth of the screen from the edge.
std::vector<glm::dvec2> targetLayout(int count);

/// The same in an order drawn from `seed`, alike on every machine.
std::vector<glm::dvec2> shuffled(std::vector<glm::dvec2> targets, std::uint64_t seed);

/// Time is the caller's; gaze and targets are degrees.
class TargetSession {
 public:
  struct Step {
    std::size_t target = 0;     ///< in force; `count` once all are done
    double shrink = 0.0;        ///< 0: the dot is large, 1: it has shrunk to its mark
    bool collecting = false;    ///< samples are being kept
    bool gaze_missing = false;  ///< for longer than a blink: the session waits
  };

  /// @param manual  a target is collected after `confirm` only; else also when gaze is stable
  TargetSession(std::vector<glm::dvec2> targets_deg, bool manual);

  /// One sample of the tracker, as often as there is one; absent gaze is a loss. Time must not run
  /// back.
  Step update(double time_s, const std::optional<glm::dvec2>& gaze);

  /// The observer says: I look at it.
  void confirm() { confirmed_ = true; }

  bool done() const { return target_ == targets_.size(); }
  const std::vector<GazePair>& pairs() const { return pairs_; }

 private:
  bool stable() const;
  void next(double time_s);

  std::vector<glm::dvec2> targets_;
  bool manual_;
  bool confirmed_ = false;
  std::size_t target_ = 0;
  std::optional<double> shown_since_s_, collecting_since_s_;
  double seen_last_s_ = 0.0;
  std::deque<std::pair<double, glm::dvec2>> recent_;
  std::vector<GazePair> pairs_;
};

}  // namespace foci
