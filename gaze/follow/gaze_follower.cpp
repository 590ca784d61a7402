#include "gaze/follow/gaze_follower.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

// Constants of the ring around a fixation. Its radius and the number of directions were chosen with
// simulated noise beside an edge (test GazeFollower.KeepsASurfaceThroughNoiseAtASilhouette).
constexpr double kRingRadius = 1.0;  // standard errors of the fixation
constexpr int kRingDirections = 8;
constexpr double kMinRingRadius = 0.1;  // of the cone's half-angle; a smaller ring changes nothing

constexpr double kMoved = 0.1;  // of the cone's half-angle; the surface is then sought again

double longestSilence_s(double rate_Hz, const FollowSettings& settings) {
  return settings.events.merge_gap_s + 1.5 / rate_Hz;
}

}  // namespace

GazeFollower::GazeFollower(const Screen& screen, double rate_Hz, SurfaceDistance surface,
                           const FollowSettings& settings)
    : screen_(screen),
      surface_(std::move(surface)),
      settings_(settings),
      watch_(rate_Hz),
      events_(screen, rate_Hz, settings.events),
      accommodation_(settings.accommodation),
      longest_silence_s_(longestSilence_s(rate_Hz, settings)) {}

bool GazeFollower::isFixating() const { return isStable(now_.state) && now_.fixation_px; }

void GazeFollower::push(const GazeSample& sample) {
  const bool was_stable = isFixating();
  if (const auto begun = watch_.push(sample.time_s)) {
    events_ = OnlineEvents(screen_, begun->rate_Hz, settings_.events);
    longest_silence_s_ = longestSilence_s(begun->rate_Hz, settings_);
  }
  now_ = events_.push(sample);
  newest_ = sample;
  if (!isFixating()) {
    looked_.reset();
    vergence_.reset();
    vergence_sum_D_ = 0.0;
    vergence_count_ = 0;
    return;
  }
  converge(sample);
  if (!was_stable || !looked_ ||
      angleBetween_deg(screen_, looked_->point_px, *now_.fixation_px) >=
          0.5 * settings_.cone_half_angle_deg) {
    look(std::max(sample.time_s, last_asked_s_));
  }
}

void GazeFollower::converge(const GazeSample& sample) {
  const bool directed = sample.eyes[0].direction && sample.eyes[1].direction;
  const auto rays =
      directed || settings_.vergence ? raysOf(sample, screen_, settings_.ipd_m) : std::nullopt;
  const auto now =
      rays ? vergenceOf(rays->first, rays->second, settings_.eye_error_deg) : std::nullopt;
  if (!now) return;
  vergence_sum_D_ += now->value_D;
  ++vergence_count_;
  vergence_ = {.value_D = vergence_sum_D_ / vergence_count_, .error_D = now->error_D};
}

std::optional<double> GazeFollower::surfaceAround(double time_s, const glm::dvec3& sight,
                                                  double half_angle_rad) const {
  const auto changeOf_D = [&](const std::optional<double>& distance_m) {
    return distance_m ? std::abs(1.0 / *distance_m - *surface_D_) : INFINITY;
  };
  const auto ahead_m = surface_(time_s, sight, half_angle_rad);
  const double ring_deg = kRingRadius * now_.fixation_error_deg;
  if (!surface_D_ || changeOf_D(ahead_m) <= settings_.surface_error_D ||
      ring_deg < kMinRingRadius * glm::degrees(half_angle_rad)) {
    return ahead_m;
  }
  const glm::dvec3 aside = glm::normalize(glm::cross(sight, glm::dvec3(0.0, 1.0, 0.0)));
  const glm::dvec3 above = glm::cross(aside, sight);
  std::optional<double> nearest_m;
  for (int k = 0; k < kRingDirections; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kRingDirections;
    const glm::dvec3 off = std::cos(angle) * aside + std::sin(angle) * above;
    const auto around_m = surface_(
        time_s, glm::normalize(sight + std::tan(glm::radians(ring_deg)) * off), half_angle_rad);
    if (changeOf_D(around_m) < changeOf_D(nearest_m)) nearest_m = around_m;
  }
  return changeOf_D(nearest_m) <= settings_.surface_error_D ? nearest_m : ahead_m;
}

/// Whether the last answer may differ from that to a question now by more than noise.
bool GazeFollower::hasMoved() const {
  return eye_moved_ || settings_.vergence || newest_->head || newest_->uncertainty_deg ||
         angleBetween_deg(screen_, looked_->point_px, *now_.fixation_px) >=
             kMoved * settings_.cone_half_angle_deg;
}

void GazeFollower::look(double time_s) {
  eye_moved_ = false;
  const glm::dvec2 point_px = *now_.fixation_px;
  const double pose_s = newest_->head ? now_.fixation_time_s : time_s;
  looked_ = {
      .time_s = time_s,
      .point_px = point_px,
      .distance_m = surfaceAround(pose_s, lineOfSight(screen_, point_px),
                                  glm::radians(std::max(settings_.cone_half_angle_deg,
                                                        newest_->uncertainty_deg.value_or(0.0))))};
  std::vector<DioptreEstimate> estimates;
  if (looked_->distance_m) {
    assert(*looked_->distance_m > 0.0);
    surface_D_ = 1.0 / *looked_->distance_m;
    estimates.push_back({*surface_D_, settings_.surface_error_D});
  }
  if (vergence_ && settings_.vergence) estimates.push_back(*vergence_);
  if (estimates.empty()) return;
  accommodation_.setTarget(time_s, estimates.size() == 1 && looked_->distance_m
                                       ? estimates[0].value_D
                                       : std::max(combined(estimates).value_D, 0.0));
}

std::optional<bool> vergenceDisagrees(const EyeNow& eye) {
  constexpr double kErrors = 3.0;
  if (!eye.vergence || !eye.surface_distance_m) return std::nullopt;
  return std::abs(eye.vergence->value_D - 1.0 / *eye.surface_distance_m) >
         kErrors * std::hypot(eye.vergence->error_D, FollowSettings{}.surface_error_D);
}

EyeNow GazeFollower::at(double time_s, AskSurface ask) {
  last_asked_s_ = time_s;
  const bool silent = !newest_ || time_s - newest_->time_s > longest_silence_s_;
  const bool stable = !silent && isFixating();
  if (stable && looked_->time_s != time_s && (ask == AskSurface::always || hasMoved())) {
    look(time_s);
  }
  return {.time_s = time_s,
          .sample = newest_,
          .state = silent ? GazeState::lost : now_.state,
          .state_time_s = now_.state_time_s,
          .fixation_px = now_.fixation_px,
          .fixation_time_s = now_.fixation_time_s,
          .surface_distance_m = stable ? looked_->distance_m : std::nullopt,
          .vergence = stable ? vergence_ : std::nullopt,
          .target_D = accommodation_.target_D(),
          .focus_D = accommodation_.focusAt_D(time_s)};
}

}  // namespace foci
