// Leads an observer from target to target and collects gaze while the eye rests on each.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "calibration/gaze_map/map_units.h"

namespace foci {

/// Positions of 5, 9, 13 or 16 calibration targets, or of 4 validation targets between them;
/// another count asserts. 0 to 1 over the screen, origin top-left. The outermost targets lie a
/// tenth of the screen from the edge.
std::vector<glm::dvec2> targetLayout(int count);

/// The targets in an order drawn from `seed`, the same on every machine.
std::vector<glm::dvec2> shuffled(std::vector<glm::dvec2> targets, std::uint64_t seed);

/// The caller provides the time. Gaze and targets are in degrees.
class TargetSession {
 public:
  struct Step {
    std::size_t target = 0;     ///< index of the target to show; their number once all are done
    double shrink = 0.0;        ///< 0: the dot is large, 1: it has shrunk to its mark
    bool collecting = false;    ///< the session keeps the samples
    bool gaze_missing = false;  ///< no gaze for longer than a blink: the session waits
  };

  /// @param manual  a target is collected only after `confirm`; false: also once gaze is stable
  TargetSession(std::vector<glm::dvec2> targets_deg, bool manual);

  /// Takes one sample of the tracker. Absent gaze is a blink or data loss. Time must not run back.
  Step update(double time_s, const std::optional<glm::dvec2>& gaze);

  /// The observer states that they look at the target.
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
