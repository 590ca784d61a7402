#include "gaze/focus/accommodation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace foci {

double accommodationAmplitude_D(double age_years) { return std::max(18.5 - 0.30 * age_years, 0.0); }

namespace {

double inRange_D(const AccommodationSettings& settings, double focus_D) {
  const double amplitude_D =
      settings.age_years ? accommodationAmplitude_D(*settings.age_years) : INFINITY;
  return std::clamp(focus_D, settings.far_point_D, settings.far_point_D + amplitude_D);
}

}  // namespace

double accommodationLag_D(double demand_D) {
  constexpr std::array kDemands_D{0.0, 3.0, 4.0, 5.0}, kLags_D{0.0, 0.35, 0.48, 0.60};
  if (demand_D <= 0.0) return 0.0;
  std::size_t i = 1;
  while (i + 1 < kDemands_D.size() && demand_D > kDemands_D[i]) ++i;
  const double slope = (kLags_D[i] - kLags_D[i - 1]) / (kDemands_D[i] - kDemands_D[i - 1]);
  return kLags_D[i - 1] + slope * (demand_D - kDemands_D[i - 1]);
}

double reachableFocus_D(const AccommodationSettings& settings, double target_D) {
  const double lag_D = settings.lag ? accommodationLag_D(target_D - settings.far_point_D) : 0.0;
  return inRange_D(settings, target_D - lag_D);
}

double restingFocus_D(const AccommodationSettings& settings) {
  return inRange_D(settings, settings.resting_D);
}
Accommodation::Accommodation(const AccommodationSettings& settings)
    : settings_(settings), anchor_D_(restingFocus_D(settings)), drive_D_(anchor_D_) {
  assert(settings.latency_s >= 0.0 && settings.time_constant_s > 0.0 &&
         settings.far_time_constant_s.value_or(1.0) > 0.0);
}

void Accommodation::setTarget(double time_s, double target_D) {
  assert(std::isfinite(time_s) && target_D >= 0.0);
  answerUntil(time_s);
  now_s_ = time_s;
  if (!target_D_ || !settings_.on) {
    pending_.clear();
    anchor_s_ = time_s;
    anchor_D_ = drive_D_ = reachableFocus_D(settings_, target_D);
  } else if (target_D != *target_D_) {
    pending_.emplace_back(time_s + settings_.latency_s, target_D);
  }
  target_D_ = target_D;
}

void Accommodation::setFarPoint(double far_point_D) {
  if (far_point_D == settings_.far_point_D) return;
  const double jump_D = far_point_D - settings_.far_point_D;
  anchor_D_ = drive_D_ = focusFromAnchor_D(now_s_) + jump_D;
  anchor_s_ = now_s_;
  settings_.far_point_D = far_point_D;
  if (!target_D_ || !settings_.on) {
    anchor_D_ = drive_D_ =
        target_D_ ? reachableFocus_D(settings_, *target_D_) : restingFocus_D(settings_);
  } else {
    pending_.emplace_back(now_s_ + settings_.latency_s, *target_D_);
  }
}

double Accommodation::focusAt_D(double time_s) {
  answerUntil(time_s);
  now_s_ = time_s;
  return focusFromAnchor_D(time_s);
}

void Accommodation::answerUntil(double time_s) {
  while (!pending_.empty() && pending_.front().first <= time_s) {
    const auto [from_s, target_D] = pending_.front();
    anchor_D_ = focusFromAnchor_D(from_s);
    anchor_s_ = from_s;
    drive_D_ = reachableFocus_D(settings_, target_D);
    pending_.pop_front();
  }
}

double Accommodation::focusFromAnchor_D(double time_s) const {
  if (anchor_D_ == drive_D_) return drive_D_;
  const double time_constant_s =
      drive_D_ > anchor_D_ ? settings_.time_constant_s
                           : settings_.far_time_constant_s.value_or(settings_.time_constant_s);
  return drive_D_ + (anchor_D_ - drive_D_) * std::exp(-(time_s - anchor_s_) / time_constant_s);
}

}  // namespace foci
