#include "gaze/events/online_events.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "gaze/events/saccades.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/geometry/sampling_rate.h"

namespace foci {
namespace {

constexpr double kContext_s = 0.4;  // holds the longest saccade, lid motion and window
// Fixations in noise. These three were chosen by the share of time with a wrong focus beside an
// edge, in simulated noise of 1 and 2 deg at 60 and 250 Hz (see gaze_follower_test.cpp).
constexpr double kFixationError_deg = 0.1;  // a fixation is averaged until its error is as small
constexpr double kMaxMean_s = 1.0;          // but not for longer, because gaze drifts
constexpr double kMoved = 4.0;    // standard errors between two means that belong to two fixations
constexpr double kCalm_s = 0.03;  // holds an oscillation and half of a narrow window
constexpr double kMaxLabelings_Hz = 250.0;  // a higher rate gains nothing

/// Whether the samples are present and too slow for any saccade. Those before `from` are context.
bool isSlow(std::span<const TimedSight> sights, std::size_t from, double rate_Hz,
            const SightNoise& noise, const EventSettings& settings) {
  const double peak_deg_s =
      std::max(settings.saccade_deg_s, settings.rules.peak_noise * noise.velocity_deg_s[0]);
  const auto velocities =
      velocitiesOfSight(sights, scaleWindow_s(0, rate_Hz, settings), longestStep_s(rate_Hz));
  return std::all_of(velocities.begin() + static_cast<std::ptrdiff_t>(from), velocities.end(),
                     [&](const auto& at) { return at && at->speed_deg_s <= peak_deg_s; });
}

}  // namespace

bool isStable(GazeState state) {
  return state == GazeState::fixation || state == GazeState::pursuit;
}

TimedSight sightOf(const GazeSample& sample, const Screen& screen) {
  return {.time_s = sample.time_s, .direction = sightInWorld(sample, screen)};
}

Lookahead::Lookahead(double rate_Hz, const EventSettings& settings) {
  assert(rate_Hz > 0.0);
  constexpr double kRounding = 1e-6;  // samples; keeps a delay of n intervals at n samples
  delay = static_cast<std::size_t>(settings.delay_s * rate_Hz + kRounding);
  hop = std::min(std::max<std::size_t>(static_cast<std::size_t>(rate_Hz / kMaxLabelings_Hz), 1),
                 delay + 1);
}

OnlineEvents::OnlineEvents(const Screen& screen, double rate_Hz, const EventSettings& settings)
    : screen_(screen),
      rate_Hz_(rate_Hz),
      settings_(settings),
      ahead_(rate_Hz, settings),
      noise_(rate_Hz, settings) {
  if (settings.detector == Detector::trained) {
    trained_.emplace(rate_Hz, settings, builtinEventModel());
  }
}

/// Until the delay has passed, each sample with a position counts as a fixation.
GazeNow OnlineEvents::waitFor(const GazeSample& sample, const TimedSight& sight) {
  now_.state = sample.point_px ? GazeState::fixation : GazeState::lost;
  now_.state_time_s = samples_.front().time_s;
  if (sample.point_px) fixate(sample, sight);
  return now_;
}

GazeNow OnlineEvents::pushTrained(const GazeSample& sample) {
  samples_.push_back(sample);
  const auto in_head =
      sample.point_px ? std::optional(lineOfSight(screen_, *sample.point_px)) : std::nullopt;
  const auto label = trained_->push(sample, sightOf(sample, screen_), in_head);
  noise_deg_ = trained_->noise_deg();
  if (!label) return waitFor(sample, sightOf(sample, screen_));
  const GazeSample& subject = samples_.front();
  now_.state = label->state;
  now_.state_time_s = subject.time_s;
  follow(subject, sightOf(subject, screen_), label->state);
  samples_.pop_front();
  return now_;
}

GazeNow OnlineEvents::push(const GazeSample& sample) {
  if (trained_) return pushTrained(sample);
  samples_.push_back(sample);
  sights_.push_back(sightOf(sample, screen_));
  noise_.push(sights_.back());
  blinks_.push_back(sample.blink);

  if (sights_.size() <= ahead_.delay) return waitFor(sample, sights_.back());
  if (noise_.update()) calm_from_ = settled_;  // by the new noise, it may not have been calm
  noise_deg_ = noise_.value().sample_deg;
  if (labels_.empty()) labelNext();
  const GazeSample& subject = samples_.front();
  noteCalm(labels_.front());
  now_.state = settle(subject, sights_[settled_], labels_.front());
  now_.state_time_s = subject.time_s;
  labels_.pop_front();
  samples_.pop_front();
  ++settled_;
  forgetOld();
  return now_;
}

/// Removes the older half in one step, so that the mean cost per sample stays constant.
void OnlineEvents::forgetOld() {
  const std::size_t history =
      static_cast<std::size_t>(kContext_s * rate_Hz_) + 2 * ahead_.delay + 2;
  if (sights_.size() > 2 * history) {
    const std::size_t old = sights_.size() - history;
    sights_.erase(sights_.begin(), sights_.begin() + static_cast<std::ptrdiff_t>(old));
    blinks_.erase(blinks_.begin(), blinks_.begin() + static_cast<std::ptrdiff_t>(old));
    settled_ -= old;
    calm_from_ -= std::min(calm_from_, old);
    context_from_ -= std::min(context_from_, old);
  }
}

/// Calm gaze for longer than the rest of an eyelid, an oscillation and half a window separates what
/// was before from what comes. Unless windows are wide, the context of the next labels begins
/// there.
void OnlineEvents::noteCalm(GazeState label) {
  const auto calm = static_cast<std::size_t>((settings_.rules.lid_rest_s + kCalm_s) * rate_Hz_) + 1;
  const bool joined = settled_ == 0 || sights_[settled_].time_s - sights_[settled_ - 1].time_s <=
                                           longestStep_s(rate_Hz_);
  if (label != GazeState::fixation || !sights_[settled_].direction) {
    calm_from_ = settled_ + 1;
  } else if (!joined) {
    calm_from_ = settled_;
  }
  if (settled_ + 1 >= calm_from_ + calm) context_from_ = settled_ + 1 - calm;
}

void OnlineEvents::labelNext() {
  const auto context = static_cast<std::size_t>(kContext_s * rate_Hz_) + ahead_.delay + 1;
  if (settings_.detector != Detector::rules) {
    const std::span sights = std::span(sights_).last(std::min(context, sights_.size()));
    const auto states = settings_.detector == Detector::ivt
                            ? labelByVelocity(sights, rate_Hz_, settings_.saccade_deg_s)
                            : labelByDispersion(sights);
    labels_.push_back(states[settled_ - (sights_.size() - sights.size())]);
    return;
  }
  const bool narrow = scaleWindow_s(0, rate_Hz_, settings_) <= kWide_s &&
                      !mayHideSaccades(noise_.value().velocity_deg_s[0], 0, rate_Hz_, settings_);
  // Most of the time gaze rests, and goes on to rest.
  const auto reach =
      static_cast<std::size_t>(0.5 * scaleWindow_s(0, rate_Hz_, settings_) * rate_Hz_) + 1;
  if (narrow && context_from_ > calm_from_ && settled_ >= calm_from_ + 2 * reach &&
      std::find(blinks_.begin() + static_cast<std::ptrdiff_t>(settled_), blinks_.end(), true) ==
          blinks_.end() &&
      isSlow(std::span(sights_).subspan(settled_ - 2 * reach), reach, rate_Hz_, noise_.value(),
             settings_)) {
    labels_.resize(std::min(ahead_.hop, sights_.size() - settled_), GazeState::fixation);
    return;
  }
  const std::size_t count = std::min(context, sights_.size() - (narrow ? context_from_ : 0));
  const auto sights = withoutSpikes(std::span(sights_).last(count), rate_Hz_, noise_.value());
  const std::vector<bool> blinks(blinks_.end() - static_cast<std::ptrdiff_t>(count), blinks_.end());
  const auto states = labelSaccades(sights, blinks, rate_Hz_, noise_.value(), settings_);
  const std::size_t first = settled_ - (sights_.size() - count);
  for (std::size_t i = first; i < std::min(first + ahead_.hop, states.size()); ++i) {
    labels_.push_back(states[i]);
  }
}

GazeState OnlineEvents::settle(const GazeSample& sample, const TimedSight& sight, GazeState label) {
  if (sample.point_px) last_present_s_ = sample.time_s;
  if (label == GazeState::blink && !sample.point_px && !sample.blink &&
      !(last_present_s_ && sample.time_s - *last_present_s_ <= settings_.max_blink_s)) {
    label = GazeState::lost;
  }
  if (!follow(sample, sight, label)) stable_.clear();
  if (label != GazeState::fixation) return label;
  if (!sample.point_px) return now_.state;
  if (settings_.detector != Detector::rules) return label;
  if (sample.time_s - stable_.newest_s() > longestStep_s(rate_Hz_)) stable_.clear();
  stable_.add(sample.time_s, *sight.direction);
  return stable_.isPursuit(noise_.value().sample_deg, settings_.rules) ? GazeState::pursuit
                                                                       : GazeState::fixation;
}

/// Moves the point of fixation with stable gaze.
/// @return whether gaze is stable
bool OnlineEvents::follow(const GazeSample& sample, const TimedSight& sight, GazeState label) {
  if (!isStable(label)) {
    if (label == GazeState::blink || label == GazeState::lost) fixation_.clear();
    landed_s_.reset();
    return false;
  }
  if (sample.point_px) fixate(sample, sight);
  return true;
}

void OnlineEvents::fixate(const GazeSample& sample, const TimedSight& sight) {
  if (fixation_.empty()) before_ = recent_ = {};
  const double ratio = noise_deg_ / kFixationError_deg;
  const double enough = std::max(ratio * ratio, 1.0);
  fixation_.push_back({sample.time_s, *sample.point_px, *sight.direction});
  recent_.add(*sample.point_px);
  if (!landed_s_) landed_s_ = sample.time_s;
  const auto isRecent = [&](const Point& point) {
    return sample.time_s - point.time_s <= settings_.position_s && point.time_s >= *landed_s_;
  };
  for (auto i = static_cast<std::size_t>(before_.count); !isRecent(fixation_[i]); ++i) {
    recent_.add(fixation_[i].point_px, -1.0);
    before_.add(fixation_[i].point_px);
  }
  const auto age_s = [&] { return sample.time_s - fixation_.front().time_s; };
  while (age_s() > settings_.position_s &&
         (static_cast<double>(fixation_.size()) > enough || age_s() > kMaxMean_s)) {
    before_.add(fixation_.front().point_px, -1.0);
    fixation_.pop_front();
  }

  // While the head turns, the points move on the screen.
  Sum before = before_, recent = recent_;
  if (sample.head) {
    before = recent = {};
    for (const Point& point : fixation_) {
      const auto point_px =
          pointOnScreen_px(screen_, glm::conjugate(sample.head->world_from_head) * point.sight);
      if (point_px) (isRecent(point) ? recent : before).add(*point_px);
    }
  }
  // Two means that differ by more than the noise belong to two fixations, even if noise has hidden
  // the saccade between them. If they agree, a "saccade" between them was noise alone.
  if (before.count > 0.0 &&
      angleBetween_deg(screen_, recent.mean_px(), before.mean_px()) >
          kMoved * noise_deg_ * std::sqrt(1.0 / recent.count + 1.0 / before.count)) {
    fixation_.erase(fixation_.begin(),
                    fixation_.begin() + static_cast<std::ptrdiff_t>(before_.count));
    before = before_ = {};
  }
  const double count = before.count + recent.count;
  now_.fixation_time_s = sample.time_s;
  now_.fixation_px = (before.points_px + recent.points_px) / count;
  now_.fixation_error_deg = noise_deg_ / std::sqrt(count);
}

}  // namespace foci
