// The eye's focus over time: a latency, then an exponential approach in dioptres.
#pragma once

#include <deque>
#include <optional>
#include <utility>

namespace foci {

struct AccommodationSettings {
  bool on = true;                ///< off: the focus equals the target at all times
  double latency_s = 0.3;        ///< from a new target to the first response
  double time_constant_s = 0.2;  ///< towards a nearer target, > 0: 63 % of the change
  std::optional<double> far_time_constant_s{};  ///< towards a farther target; absent: the same
  std::optional<double> age_years{};  ///< limits how near the eye can focus; absent: no limit
  double resting_D = 1.0;             ///< tonic accommodation: the focus before the first target
  /// Focus of the relaxed eye. 0 is infinity: normal sight, or glasses. A short-sighted eye has a
  /// far point > 0. A long-sighted eye has one < 0 and must accommodate even for infinity.
  double far_point_D = 0.0;
  bool lag = false;  ///< the eye focuses less near than its target (`accommodationLag_D`)
};

/// Mean amplitude of accommodation at an age (Hofstetter 1950): 18.5 - 0.30 age dioptres, never
/// below 0.
double accommodationAmplitude_D(double age_years);

/// Mean lag of accommodation behind its demand in young adults: 0.35, 0.48 and 0.60 D at 3, 4 and 5
/// D (Seidemann and Schaeffel, Vision Research 43, 2003), linear from 0 at 0 D, between these
/// values and beyond. Measured lags may be overstated: visual acuity asks for less (Labhishetty,
/// Cholewiak, Roorda and Banks, Journal of Vision 21(3), 2021).
/// @param demand_D  target less far point
double accommodationLag_D(double demand_D);

/// The focus of an eye at rest.
double restingFocus_D(const AccommodationSettings& settings);

/// The focus nearest to `target_D`, less its lag, that the eye can reach. Its range begins at the
/// far point and is as long as the amplitude of its age.
double reachableFocus_D(const AccommodationSettings& settings, double target_D);

/// Solves tau dA/dt = target(t - latency) - A exactly between changes of the target. The result
/// does not depend on how often the focus is asked for. The focus starts at the first target,
/// without latency, because the recording does not show what the observer did before.
class Accommodation {
 public:
  explicit Accommodation(const AccommodationSettings& settings = {});

  /// From `time_s` on, the eye tries to focus at `target_D`. Its age limits how near it gets.
  /// @param time_s  never decreases, over the calls of this function and of `focusAt_D`
  void setTarget(double time_s, double target_D);

  /// The observer puts glasses on or off. The lens in the eye is still the same, so the focus jumps
  /// with the far point. After the latency the eye then approaches its target again.
  void setFarPoint(double far_point_D);

  /// Focus at `time_s`, dioptres.
  double focusAt_D(double time_s);

  /// The latest target; absent before the first.
  std::optional<double> target_D() const { return target_D_; }

 private:
  void answerUntil(double time_s);
  double focusFromAnchor_D(double time_s) const;

  AccommodationSettings settings_;
  double now_s_ = 0.0;  // time of the latest call
  std::optional<double> target_D_{};
  // Between targets the focus moves from the anchor towards the drive.
  double anchor_s_ = 0.0, anchor_D_, drive_D_;
  std::deque<std::pair<double, double>>
      pending_{};  // targets whose latency is not over: when it ends, dioptres
};

}  // namespace foci
