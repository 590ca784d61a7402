#include "gaze/focus/accommodation.h"

#include <cassert>
#include <cmath>

namespace foci {

Accommodation::Accommodation(const AccommodationSettings& settings)
    : settings_(settings), anchor_D_(settings.resting_D), drive_D_(settings.resting_D) {
  assert(settings.latency_s >= 0.0 && settings.time_constant_s > 0.0);
}

void Accommodation::setTarget(double time_s, double target_D) {
  assert(std::isfinite(time_s) && target_D >= 0.0);
  answerUntil(time_s);
  if (!target_D_ || !settings_.on) {
    pending_.clear();
    anchor_s_ = time_s;
    anchor_D_ = drive_D_ = target_D;
  } else if (target_D != *target_D_) {
    pending_.emplace_back(time_s + settings_.latency_s, target_D);
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
  return drive_D_ +
         (anchor_D_ - drive_D_) * std::exp(-(time_s - anchor_s_) / settings_.time_constant_s);
}

}  // namespace foci
