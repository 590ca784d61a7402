// The eye's focus over time: a dead time, then an exponential approach in dioptres (formulas.md,
// section 8).
#pragma once

#include <deque>
#include <optional>
#include <utility>

namespace foci {

struct AccommodationSettings {
  bool on = true;                ///< off: focus is the target itself
  double latency_s = 0.3;        ///< from a new target to the first response
  double time_constant_s = 0.2;  ///< of the approach: 63 % of the way; > 0
  double resting_D = 1.0;        ///< focus before there is any target (tonic accommodation)
};

/// tau dA/dt = target(t - latency) - A, solved exactly between changes of the target, so that the
/// result does not depend on how often it is asked. The first target is taken at once: what the
/// observer did before the recording is not known.
class Accommodation {
 public:
  explicit Accommodation(const AccommodationSettings& settings = {});

  /// From `time_s` on the eye wants `target_D`. Times of both functions never decrease.
  void setTarget(double time_s, double target_D);

  /// Focus at `time_s`, dioptres.
  double focusAt_D(double time_s);

  /// The latest target; absent before the first.
  std::optional<double> target_D() const { return target_D_; }

 private:
  void answerUntil(double time_s);
  double focusFromAnchor_D(double time_s) const;

  AccommodationSettings settings_;
  std::optional<double> target_D_{};
  // Between targets the focus runs from the anchor towards the drive.
  double anchor_s_ = 0.0, anchor_D_, drive_D_;
  std::deque<std::pair<double, double>>
      pending_{};  // seen but not yet answered: from when, dioptres
};

}  // namespace foci
