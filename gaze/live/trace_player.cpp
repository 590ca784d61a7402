#include "gaze/live/trace_player.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/text.h"

namespace foci {
namespace {

// Ten time constants of accommodation after its latency: by then focus has come to rest.
constexpr double kRunUp_s = 2.3;

}  // namespace

TracePlayer::TracePlayer(GazeTrace trace) : trace_(std::move(trace)) {
  assert(!trace_.samples.empty() && trace_.rate_Hz > 0.0);
  now_.first_s = now_.recording_s = trace_.samples.front().time_s;
  now_.last_s = trace_.samples.back().time_s;
  offset_s_ = -now_.first_s;
}

void TracePlayer::play(bool on) {
  const std::lock_guard lock(mutex_);
  if (on && now_.recording_s >= now_.last_s) seek_s_ = now_.first_s;
  now_.plays = on;
  points_.push_back(pointNow());
}

void TracePlayer::seek(double recording_s) {
  const std::lock_guard lock(mutex_);
  seek_s_ = std::clamp(recording_s, now_.first_s, now_.last_s);
}

void TracePlayer::setSpeed(double speed) {
  const std::lock_guard lock(mutex_);
  now_.speed = std::clamp(speed, kMinSpeed, kMaxSpeed);
  points_.push_back(pointNow());
}

void TracePlayer::setLoops(bool on) {
  const std::lock_guard lock(mutex_);
  now_.loops = on;
}

TracePlayer::State TracePlayer::state() const {
  const std::lock_guard lock(mutex_);
  State state = now_;
  state.recording_s = seek_s_.value_or(state.recording_s);
  return state;
}

double TracePlayer::time_s() const {
  const std::lock_guard lock(mutex_);
  return now_.recording_s + offset_s_;
}

double TracePlayer::recordingAt_s(double time_s) const {
  const std::lock_guard lock(mutex_);
  return time_s - (time_s < jumped_s_ ? before_s_ : offset_s_);
}

std::vector<PlayPoint> TracePlayer::takePoints() {
  const std::lock_guard lock(mutex_);
  return std::exchange(points_, {});
}

PlayPoint TracePlayer::point() const {
  const std::lock_guard lock(mutex_);
  return pointNow();
}

std::string TracePlayer::status() const {
  const State at = state();
  return trace_.format + ", " + decimal(at.recording_s - at.first_s, 2) + " of " +
         decimal(at.last_s - at.first_s, 2) + " s" +
         (at.plays                      ? ""
          : at.recording_s >= at.last_s ? ", ended"
                                        : ", paused");
}

PlayPoint TracePlayer::pointNow() const {
  return {.time_s = now_.recording_s + offset_s_,
          .recording_s = now_.recording_s,
          .speed = now_.plays ? now_.speed : 0.0};
}

/// Appends the samples up to now.
void TracePlayer::give(std::vector<GazeSample>& samples) {
  for (; next_ < trace_.samples.size() && trace_.samples[next_].time_s <= now_.recording_s;
       ++next_) {
    samples.push_back(trace_.samples[next_]);
    samples.back().time_s += offset_s_;
  }
}

/// Goes on at another moment. The samples of the run-up before it come first.
void TracePlayer::jump(double to_s, double run_up_s) {
  const double from_s = std::max(to_s - run_up_s, now_.first_s);
  const double time_s = now_.recording_s + offset_s_ + 1.0 / trace_.rate_Hz;
  jumped_s_ = time_s;
  before_s_ = std::exchange(offset_s_, time_s - from_s);
  const auto first = std::ranges::lower_bound(trace_.samples, from_s, {}, &GazeSample::time_s);
  next_ = static_cast<std::size_t>(first - trace_.samples.begin());
  now_.recording_s = to_s;
  if (from_s < to_s) points_.push_back({.time_s = time_s, .recording_s = from_s, .speed = 0.0});
  points_.push_back(pointNow());
}

void TracePlayer::advance(double by_s, std::vector<GazeSample>& samples) {
  for (;;) {
    const double left_s = now_.last_s - now_.recording_s;
    now_.recording_s += std::min(by_s, left_s);
    give(samples);
    by_s -= left_s;
    if (by_s < 0.0) return;
    if (!now_.loops || now_.last_s <= now_.first_s) break;
    jump(now_.first_s, 0.0);
  }
  if (std::exchange(now_.plays, false)) points_.push_back(pointNow());
}

void TracePlayer::poll(double now_s, std::vector<GazeSample>& samples) {
  const std::lock_guard lock(mutex_);
  const double passed_s = now_s - std::exchange(polled_s_, now_s).value_or(now_s);
  const auto to_s = std::exchange(seek_s_, std::nullopt);
  // A step forwards plays what lies between.
  if (to_s && (*to_s < now_.recording_s || *to_s > now_.recording_s + kRunUp_s)) {
    jump(*to_s, kRunUp_s);
  } else if (to_s) {
    now_.recording_s = *to_s;
  }
  give(samples);
  if (now_.plays && !to_s) advance(now_.speed * passed_s, samples);
}

}  // namespace foci
