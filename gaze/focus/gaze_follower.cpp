#include "gaze/focus/gaze_follower.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "gaze/focus/line_of_sight.h"

namespace foci {

GazeFollower::GazeFollower(const Screen& screen, double rate_Hz, SurfaceDistance surface,
                           const FollowSettings& settings)
    : screen_(screen),
      surface_(std::move(surface)),
      settings_(settings),
      events_(screen, rate_Hz, settings.events),
      accommodation_(settings.accommodation),
      longest_silence_s_(settings.events.max_gap_s + 1.5 / rate_Hz) {}

bool GazeFollower::isStable() const {
  return (now_.state == GazeState::fixation || now_.state == GazeState::pursuit) &&
         now_.fixation_px;
}

void GazeFollower::push(const GazeSample& sample) {
  const bool was_stable = isStable();
  now_ = events_.push(sample);
  newest_ = sample;
  if (!isStable()) {
    looked_.reset();
  } else if (!was_stable || !looked_ ||
             angleBetween_deg(screen_, looked_->point_px, *now_.fixation_px) >=
                 0.5 * settings_.cone_half_angle_deg) {
    look(sample.time_s);
  }
}

void GazeFollower::look(double time_s) {
  const glm::dvec2 point_px = *now_.fixation_px;
  looked_ = {
      .time_s = time_s,
      .point_px = point_px,
      .distance_m = surface_(time_s, lineOfSight(screen_, point_px),
                             glm::radians(std::max(settings_.cone_half_angle_deg,
                                                   newest_->uncertainty_deg.value_or(0.0))))};
  if (!looked_->distance_m) return;
  assert(*looked_->distance_m > 0.0);
  accommodation_.setTarget(time_s, 1.0 / *looked_->distance_m);
}

EyeNow GazeFollower::at(double time_s) {
  const bool silent = !newest_ || time_s - newest_->time_s > longest_silence_s_;
  const bool stable = !silent && isStable();
  if (stable && looked_->time_s != time_s) look(time_s);
  return {.time_s = time_s,
          .sample = newest_,
          .state = silent ? GazeState::lost : now_.state,
          .fixation_px = now_.fixation_px,
          .surface_distance_m = stable ? looked_->distance_m : std::nullopt,
          .target_D = accommodation_.target_D(),
          .focus_D = accommodation_.focusAt_D(time_s)};
}

}  // namespace foci
