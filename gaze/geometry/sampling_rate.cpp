#include "gaze/geometry/sampling_rate.h"

#include <algorithm>
#include <utility>

#include "base/quantile.h"

namespace foci {
namespace {

constexpr double kOther = 1.4;  // above the jitter of cameras, below a doubled rate
constexpr double kSpan_s = 0.5;
constexpr std::size_t kMinIntervals = 16;
constexpr double kGap = 3.0;  // usual intervals; a longer one is data loss

/// The mean rate, without gaps. Rows that come in pairs have no usual interval.
double rateOf_Hz(std::vector<double> intervals_s) {
  const double longest_s = kGap * quantile(intervals_s, 0.5);
  double sum_s = 0.0, count = 0.0;
  for (const double interval_s : intervals_s) {
    if (interval_s > longest_s) continue;
    sum_s += interval_s;
    count += 1.0;
  }
  return count / sum_s;
}

}  // namespace

std::optional<RateStretch> RateWatch::push(double time_s) {
  const double interval_s = time_s - last_s_;
  const RateStretch before{.first = count_ - 1, .time_s = last_s_};
  last_s_ = time_s;
  if (count_++ == 0) return std::nullopt;
  const double relative = interval_s * rate_Hz_;
  const int side = rate_Hz_ == 0.0 ? 0 : relative > kOther ? 1 : relative * kOther < 1.0 ? -1 : 0;
  if (side != run_side_) {
    run_ = before;
    run_side_ = side;
  }
  recent_.push_back({interval_s, side});
  short_ += side < 0;
  long_ += side > 0;
  const auto span = static_cast<std::size_t>(kSpan_s * rate_Hz_);
  const std::size_t most = std::max(kMinIntervals, span);
  if (rate_Hz_ == 0.0) {
    if (recent_.size() < most) return std::nullopt;
    rate_Hz_ = newestRate_Hz(recent_.size());
    recent_.clear();
    return std::nullopt;
  }
  if (recent_.size() > most) {
    short_ -= recent_.front().side < 0;
    long_ -= recent_.front().side > 0;
    recent_.pop_front();
  }
  const bool ran =
      run_side_ != 0 && count_ - run_.first > kMinIntervals && time_s - run_.time_s >= kSpan_s;
  if (ran) return change(run_side_);
  if (recent_.size() < most) return std::nullopt;
  if (2 * long_ > recent_.size()) return change(1);
  if (2 * short_ > recent_.size()) return change(-1);
  return std::nullopt;
}

double RateWatch::newestRate_Hz(std::size_t intervals) const {
  std::vector<double> lengths_s;
  for (std::size_t i = recent_.size() - intervals; i < recent_.size(); ++i) {
    lengths_s.push_back(recent_[i].length_s);
  }
  return rateOf_Hz(std::move(lengths_s));
}

std::optional<RateStretch> RateWatch::change(int side) {
  const bool ran = run_side_ == side;
  const double rate_Hz =
      newestRate_Hz(ran ? std::min(recent_.size(), count_ - 1 - run_.first) : recent_.size() / 2);
  recent_.clear();
  short_ = long_ = 0;
  if (rate_Hz < kOther * rate_Hz_ && rate_Hz_ < kOther * rate_Hz) return std::nullopt;
  RateStretch begun =
      run_side_ == side ? run_ : RateStretch{.first = count_ - 1, .time_s = last_s_};
  begun.rate_Hz = rate_Hz_ = rate_Hz;
  run_side_ = 0;
  return begun;
}

std::vector<RateStretch> rateStretchesOf(const GazeTrace& trace) {
  std::vector<RateStretch> stretches{{.rate_Hz = trace.rate_Hz}};
  RateWatch watch;
  for (const GazeSample& sample : trace.samples) {
    const double before_Hz = watch.rate_Hz();
    const auto begun = watch.push(sample.time_s);
    if (!begun) continue;
    if (stretches.size() == 1) stretches[0].rate_Hz = before_Hz;
    if (begun->first > stretches.back().first) {
      stretches.push_back(*begun);
    } else {
      stretches.back().rate_Hz = begun->rate_Hz;
    }
  }
  return stretches;
}

GazeTrace stretchOf(const GazeTrace& trace, const std::vector<RateStretch>& stretches,
                    std::size_t i) {
  const std::size_t end = i + 1 < stretches.size() ? stretches[i + 1].first : trace.samples.size();
  const auto at = [&](std::size_t sample) {
    return trace.samples.begin() + static_cast<std::ptrdiff_t>(sample);
  };
  GazeTrace stretch{{.format = trace.format, .screen = trace.screen}, stretches[i].rate_Hz};
  stretch.samples.assign(at(stretches[i].first), at(end));
  return stretch;
}

}  // namespace foci
