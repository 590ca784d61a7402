#include "gaze/live/sender_clock.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"

namespace foci {
namespace {

constexpr double kWindow_s = 10.0;  // a drift that changes is followed within half of it
constexpr double kBin_s = 0.05;     // of the window, which so has 200 points at most
constexpr double kSpan_s = 2.0;     // of the points, from which on they tell the drift
constexpr double kMaxSlope = 0.1;   // chrony slews a clock by 8.3 % at most (maxslewrate)
// Doubtful samples that agree with each other to `kAgree_s`, for so long, are a step of the clock.
constexpr double kAgree_s = 0.25, kConfirm_s = 0.2;
constexpr std::size_t kConfirm = 3;
constexpr double kYoung_s = 0.5;         // a first sample may have waited longer than the others
constexpr double kPause_s = 2.0;         // after it, a sender may have a new clock
constexpr double kPauseDrift = 1e-3;     // of the estimate, over a pause
constexpr std::size_t kMaxSteps = 1000;  // that are listed

}  // namespace

void SenderClock::take(const std::vector<GazeSample>& news, double now_s,
                       std::vector<GazeSample>& samples, double late_s) {
  std::vector<GazeSample> fitting;
  for (const GazeSample& sample : news) takeOne(sample, now_s, late_s, fitting);
  for (GazeSample& sample : fitting) {
    sample.time_s = std::min(sample.time_s + offsetAt(sample.time_s), now_s);
    // A lower line may move a sample to the time of one that was given, or before it.
    if (given_s_) sample.time_s = std::max(sample.time_s, *given_s_ + kBurst_s);
    given_s_ = sample.time_s;
    samples.push_back(sample);
  }
}

void SenderClock::takeOne(const GazeSample& sample, double now_s, double late_s,
                          std::vector<GazeSample>& fitting) {
  const double sent_s = sample.time_s, offset_s = now_s - sent_s;
  const double pause_s = known_ ? now_s - arrived_s_ : 0.0;
  arrived_s_ = now_s;
  if (!known_) {
    began_s_ = now_s;
    known_ = true;
    low_ = {sent_s, measured_ ? 0.0 : offset_s};
  }
  const double delay_s = offset_s - offsetAt(sent_s);
  const bool fits = delay_s >= -kStep_s && delay_s <= late_s;
  if (pause_s > kPause_s && !fits) {  // another clock, or too long a pause for the drift
    dropDoubts();
    if (std::abs(delay_s) > kStep_s + kPauseDrift * pause_s) noteStep(now_s, offset_s);
    began_s_ = now_s;
    restart();
  } else if (!fits && delay_s < 0.0 &&
             (now_s - began_s_ <= kYoung_s || delay_s >= -late_s)) {  // a shorter delay
    dropDoubts();
    restart();
  } else if (!fits) {
    doubt(sample, now_s, fitting);
    return;
  } else if (sent_s_ && sent_s <= *sent_s_) {
    ++dropped_;
    return;
  }
  dropDoubts();
  fitted_ = true;
  add({sent_s, offset_s}, now_s);
  sent_s_ = sent_s;
  fitting.push_back(sample);
}

/// A sample that does not fit the line: a step of the clock, a wild time, or a long delay.
void SenderClock::doubt(const GazeSample& sample, double now_s, std::vector<GazeSample>& fitting) {
  const bool agrees = !doubts_.empty() && sample.time_s > doubts_.back().sample.time_s &&
                      std::abs(now_s - sample.time_s - doubts_.front().offset_s()) <= kAgree_s;
  if (!agrees) dropDoubts();
  // A long delay is possible, a sample from the future is not.
  const bool late =
      now_s - sample.time_s > offsetAt(sample.time_s) && !(sent_s_ && sample.time_s <= *sent_s_);
  if (late) {
    sent_s_ = sample.time_s;
    fitting.push_back(sample);
  }
  doubts_.push_back({.sample = sample, .now_s = now_s, .given = late});
  if (doubts_.size() < kConfirm || now_s - doubts_.front().now_s < kConfirm_s) return;
  double offset_s = doubts_.front().offset_s();
  for (const Doubt& each : doubts_) offset_s = std::min(offset_s, each.offset_s());
  noteStep(now_s, offset_s);
  restart();
  const std::vector<Doubt> believed = std::exchange(doubts_, {});
  for (const Doubt& each : believed) add({each.sample.time_s, each.offset_s()}, each.now_s);
  for (const Doubt& each : believed) {
    if (!each.given) fitting.push_back(each.sample);
  }
  sent_s_ = sample.time_s;
}

/// Forgets the window. The drift stays, since a clock that is set runs on as before.
void SenderClock::restart() {
  measured_ = false;
  points_.clear();
  first_.reset();
}

void SenderClock::noteStep(double now_s, double offset_s) {
  if (!std::exchange(fitted_, true)) return;  // the first samples did not fit what was measured
  const double unstepped_s = now_s - offsetAt(sent_s_.value_or(low_.sent_s));
  const double ahead_s = offsetAt(unstepped_s) - offset_s;
  ++steps_;
  if (latest_steps_.size() == kMaxSteps) latest_steps_.erase(latest_steps_.begin());
  latest_steps_.push_back({now_s, ahead_s});
}

void SenderClock::add(const Point& point, double now_s) {
  if (measured_) return;
  if (points_.empty() || now_s - bin_s_ >= kBin_s) {
    bin_s_ = now_s;
    points_.push_back(point);
  } else if (point.offset_s < points_.back().offset_s) {
    points_.back() = point;
  }
  while (point.sent_s - points_.front().sent_s > kWindow_s) points_.pop_front();
  fit();
}

/// The line below all points that has the least sum of distances to them: the edge of their lower
/// hull across their middle. Few seconds do not tell the drift: the line then keeps its slope.
void SenderClock::fit() {
  const double begin_s = points_.front().sent_s, end_s = points_.back().sent_s;
  bool sloped = end_s - begin_s >= kSpan_s;
  if (sloped) {
    std::vector<Point> hull;
    for (const Point& point : points_) {
      while (hull.size() > 1) {
        const Point &a = hull[hull.size() - 2], &b = hull.back();
        if ((b.offset_s - a.offset_s) * (point.sent_s - a.sent_s) <
            (point.offset_s - a.offset_s) * (b.sent_s - a.sent_s)) {
          break;
        }
        hull.pop_back();
      }
      hull.push_back(point);
    }
    std::size_t end = 1;
    while (hull[end].sent_s < 0.5 * (begin_s + end_s)) ++end;
    const Point &a = hull[end - 1], &b = hull[end];
    slope_ = std::clamp((b.offset_s - a.offset_s) / (b.sent_s - a.sent_s), -kMaxSlope, kMaxSlope);
  }
  const auto height_s = [this](const Point& point) {
    return point.offset_s - slope_ * (point.sent_s - points_.front().sent_s);
  };
  low_ = *std::ranges::min_element(points_, {}, height_s);
  if (sloped && !first_) first_ = Point{begin_s, offsetAt(begin_s)};
}

void SenderClock::dropDoubts() {
  dropped_ += static_cast<std::size_t>(
      std::ranges::count_if(doubts_, [](const Doubt& each) { return !each.given; }));
  doubts_.clear();
}

ClockFacts SenderClock::facts() const {
  ClockFacts facts{.steps = steps_, .latest_steps = latest_steps_, .measured = measured_};
  if (!known_) return facts;
  const double sent_s = sent_s_.value_or(low_.sent_s);
  facts.offset_s = offsetAt(sent_s);
  // A longer time tells the drift better than the window.
  double slope = slope_;
  if (first_ && sent_s - first_->sent_s > kWindow_s) {
    slope = (facts.offset_s - first_->offset_s) / (sent_s - first_->sent_s);
  }
  facts.drift_ppm = 1e6 * (1.0 / (1.0 + slope) - 1.0);
  return facts;
}

std::string clockText(const ClockFacts& clock) {
  const std::string offset = "offset " + decimal(clock.offset_s, 3) + " s";
  const std::string steps = clock.steps == 0 ? "" : ", " + counted(clock.steps, "step");
  if (clock.measured) return offset + ", measured" + steps;
  return offset + ", drift " + decimal(clock.drift_ppm, 0) + " ppm" + steps;
}

}  // namespace foci
