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
  double time_constant_s = 0.2;  ///< of the approach to a nearer target: 63 % of the way; > 0
  std::optional<double> far_time_constant_s{};  ///< to a farther one; absent: the same
  std::optional<double> age_years{};  ///< limits how near the eye can focus; absent: no limit
  double resting_D = 1.0;             ///< focus before there is any target (tonic accommodation)
  /// What the eye at rest is focused on: 0, infinity, with normal sight or with glasses; nearer, >
  /// 0, short-sighted; < 0 long-sighted, so that infinity takes accommodation already.
  double far_point_D = 0.0;
};

/// How much an eye of this age can accommodate, in the mean (Hofstetter 1950): 18.5 - 0.30 age
/// dioptres, never below 0.
double accommodationAmplitude_D(double age_years);

/// The focus nearest to `target_D` that the eye can reach: from its far point to what its age's
/// amplitude adds to that.
double reachableFocus_D(const AccommodationSettings& settings, double target_D);

/// tau dA/dt = target(t - latency) - A, solved exactly between changes of the target, so that the
/// result does not depend on how often it is asked. The first target is taken at once: what the
/// observer did before the recording is not known.
class Accommodation {
 public:
  explicit Accommodation(const AccommodationSettings& settings = {});

  /// From `time_s` on the eye wants `target_D`; it gets as near as its age lets it. Times of both
  /// functions never decrease.
  void setTarget(double time_s, double target_D);

  /// Glasses are put on or off: focus jumps with the far point, since the lens in the eye is as it
  /// was at the last time that was told, and then answers the target as to a new one.
  void setFarPoint(double far_point_D);

  /// Focus at `time_s`, dioptres.
  double focusAt_D(double time_s);

  /// The latest target; absent before the first.
  std::optional<double> target_D() const { return target_D_; }

 private:
  void answerUntil(double time_s);
  double focusFromAnchor_D(double time_s) const;

  AccommodationSettings settings_;
  double now_s_ = 0.0;  // the last time that was told
  std::optional<double> target_D_{};
  // Between targets the focus runs from the anchor towards the drive.
  double anchor_s_ = 0.0, anchor_D_, drive_D_;
  std::deque<std::pair<double, double>>
      pending_{};  // targets seen but not yet answered: from when, dioptres
};

}  // namespace foci
