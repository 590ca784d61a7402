#include "gaze/focus/accommodation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace foci {

double accommodationAmplitude_D(double age_years) { return std::max(18.5 - 0.30 * age_years, 0.0); }

Accommodation::Accommodation(const AccommodationSettings& settings)
    : settings_(settings),
      nearest_D_(settings.age_years ? accommodationAmplitude_D(*settings.age_years) : INFINITY),
      anchor_D_(std::min(settings.resting_D, nearest_D_)),
      drive_D_(anchor_D_) {
  assert(settings.latency_s >= 0.0 && settings.time_constant_s > 0.0 &&
         settings.far_time_constant_s.value_or(1.0) > 0.0);
}

void Accommodation::setTarget(double time_s, double target_D) {
  assert(std::isfinite(time_s) && target_D >= 0.0);
  answerUntil(time_s);
  if (!target_D_ || !settings_.on) {
    pending_.clear();
    anchor_s_ = time_s;
    anchor_D_ = drive_D_ = std::min(target_D, nearest_D_);
  } else if (target_D != *target_D_) {
    pending_.emplace_back(time_s + settings_.latency_s, std::min(target_D, nearest_D_));
  }
  target_D_ = target_D;
}

double Accommodation::focusAt_D(double time_s) {
  answerUntil(time_s);
  return focusFromAnchor_D(time_s);
}

void Accommodation::answerUntil(double time_s) {
  while (!pending_.empty() && pending_.front().first <= time_s) {
    const auto [from_s, target_D] = pending_.front();
    anchor_D_ = focusFromAnchor_D(from_s);
    anchor_s_ = from_s;
    drive_D_ = target_D;
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
