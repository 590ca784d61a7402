#include "gaze/events/gaze_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foci {
namespace {

constexpr double kTimeSlack_s = 1e-5;
/// Noise below this is not told apart: eyes tremble by as much.
constexpr double kLeastNoise_deg = 0.005;
/// Noise over longer windows holds saccades; it follows from this scale's as white noise does.
constexpr std::size_t kLongestNoiseScale = 3;
constexpr float kUnknown = -9.0F;

double logOf(double value, double least) { return std::log(value + least); }

/// The cosine between two velocities. Slow ones count as without direction.
double agreement(const glm::dvec3& a, const glm::dvec3& b, double noise_deg_s) {
  return glm::dot(a, b) / (glm::length(a) * glm::length(b) + 2.0 * noise_deg_s * noise_deg_s);
}

}  // namespace

GazeFeatures::GazeFeatures(double rate_Hz, double noise_span_s)
    : rate_Hz_(rate_Hz),
      noise_span_s_(noise_span_s),
      span_(std::max<std::size_t>(static_cast<std::size_t>(noise_span_s * rate_Hz), 16)) {
  for (std::size_t s = 0; s < kScale_s.size(); ++s) {
    changes_deg_s_[s].assign(s <= kLongestNoiseScale ? span_ : 0, -1.0F);
  }
  steps_deg_.assign(span_, -1.0F);
  measureNoise();
}

void GazeFeatures::push(const TimedSight& sight, const std::optional<glm::dvec3>& in_head) {
  assert(rows_.empty() || sight.time_s > rows_.back().time_s);
  Row next{.time_s = sight.time_s, .direction = sight.direction};
  if (!rows_.empty()) {
    next.lost_s = rows_.back().lost_s;
    next.present_s = rows_.back().present_s;
    next.losses = rows_.back().losses;
  } else {
    measured_s_ = sight.time_s;
  }
  (sight.direction ? next.present_s : next.lost_s) = sight.time_s;
  if (!sight.direction) next.losses += 1.0;
  rows_.push_back(next);
  measureWindows();
  noteChanges();
  steps_deg_[changes_from_] =
      in_head && last_in_head_
          ? static_cast<float>(glm::degrees(glm::distance(*in_head, *last_in_head_)))
          : -1.0F;
  if (in_head) last_in_head_ = in_head;
  changes_from_ = (changes_from_ + 1) % span_;
  changes_count_ = std::min(changes_count_ + 1, span_);
  constexpr double kAgain_s = 0.25;  // the noise changes slowly
  if (sight.time_s - measured_s_ >= kAgain_s || changes_count_ <= 32) {
    measured_s_ = sight.time_s;
    measureNoise();
  }
}

void GazeFeatures::forgetBefore(std::size_t sample) {
  constexpr double kReach_s = 0.6;  // of `of`, backwards, with room
  const double from_s = row(std::min(sample, pushed() - 1)).time_s - kReach_s;
  while (rows_.size() > 1 && rows_[1].time_s <= from_s) {
    rows_.pop_front();
    ++dropped_;
  }
}

/// Sums over the samples from the newest backwards; each scale's window holds the one before.
void GazeFeatures::measureWindows() {
  Row& now = rows_.back();
  const double longest_step_s = longestStep_s(rate_Hz_);
  double count = 0.0, time = 0.0, times = 0.0;
  glm::dvec3 sum{0.0}, product{0.0}, origin{0.0};
  double squares = 0.0;
  std::size_t at = rows_.size();
  for (std::size_t s = 0; s < kScale_s.size(); ++s) {
    while (at > 0) {
      const Row& row = rows_[at - 1];
      const double age_s = now.time_s - row.time_s;
      // A slow tracker's window holds two neighbours.
      const bool neighbour = count == 1.0 && row.direction && age_s <= longest_step_s;
      if (age_s > kScale_s[s] + kTimeSlack_s && !neighbour) break;
      --at;
      if (!row.direction) continue;
      if (count == 0.0) origin = *row.direction;
      const glm::dvec3 offset = *row.direction - origin;
      count += 1.0;
      time -= age_s;
      times += age_s * age_s;
      sum += offset;
      product -= age_s * offset;
      squares += glm::dot(offset, offset);
    }
    Window& window = now.windows[s];
    window.count = count;
    window.middle_s = now.time_s;
    if (count == 0.0) continue;
    const glm::dvec3 mean = sum / count;
    window.mean = origin + mean;
    window.middle_s = now.time_s + time / count;
    window.spread_deg =
        glm::degrees(std::sqrt(std::max(squares / count - glm::dot(mean, mean), 0.0)));
    const double spread_s2 = count * times - time * time;
    if (count >= 2.0) {
      window.velocity_deg_s = glm::degrees(1.0) / spread_s2 * (count * product - time * sum);
    }
  }
}

/// The change of velocity between neighbouring windows is that of noise, unless a saccade begins.
void GazeFeatures::noteChanges() {
  const Row& now = rows_.back();
  std::size_t before = rows_.size() - 1;
  for (std::size_t s = 0; s <= kLongestNoiseScale; ++s) {
    const double apart_s = std::max(kScale_s[s], 1.0 / rate_Hz_);
    while (before > 0 && now.time_s - rows_[before].time_s < apart_s - kTimeSlack_s) --before;
    const Window &a = now.windows[s], &b = rows_[before].windows[s];
    const bool known = now.direction && rows_[before].direction && a.count >= 2.0 &&
                       b.count >= 2.0 && before + 1 < rows_.size() &&
                       now.time_s - rows_[before].time_s <= apart_s + longestStep_s(rate_Hz_);
    changes_deg_s_[s][changes_from_] =
        known ? static_cast<float>(glm::distance(a.velocity_deg_s, b.velocity_deg_s)) : -1.0F;
  }
}

void GazeFeatures::measureNoise() {
  constexpr std::size_t kMinChanges = 8;
  const auto quantile = [&](const std::vector<float>& values, double share) -> double {
    sorted_.clear();
    for (std::size_t i = 0; i < changes_count_; ++i) {
      if (values[i] >= 0.0F) sorted_.push_back(values[i]);
    }
    if (sorted_.size() < kMinChanges) return 0.0;
    const auto at =
        sorted_.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted_.size()));
    std::nth_element(sorted_.begin(), at, sorted_.end());
    return *at;
  };
  const double least_deg = std::hypot(kLeastNoise_deg, rounding_deg() / std::sqrt(12.0));
  for (std::size_t s = 0; s < kScale_s.size(); ++s) {
    const double window_s = std::max(kScale_s[s], 1.0 / rate_Hz_);
    if (s > kLongestNoiseScale) {
      noise_deg_s_[s] =
          noise_deg_s_[kLongestNoiseScale] *
          std::pow(window_s / std::max(kScale_s[kLongestNoiseScale], 1.0 / rate_Hz_), -1.5);
      continue;
    }
    // The median of a Rayleigh distribution is sqrt(2 ln 2) times sigma. A difference of two
    // velocities has twice the variance.
    const double measured = quantile(changes_deg_s_[s], 0.5) /
                            (std::sqrt(2.0 * std::numbers::ln2) * std::numbers::sqrt2);
    // The slope over n samples of spacing d has the variance 12 / (n (n^2 - 1)) (sigma / d)^2.
    const double n = std::floor(window_s * rate_Hz_ + 0.01) + 1.0;
    const double least = least_deg * rate_Hz_ * std::sqrt(12.0 / (n * (n * n - 1.0)));
    noise_deg_s_[s] = std::hypot(measured, least);
  }
}

/// Positions that were rounded often repeat, or move by whole steps: the smallest is the unit.
double GazeFeatures::rounding_deg() const {
  constexpr double kMinRepeated = 0.1, kMaxRounding_deg = 0.5;
  double steps = 0.0, repeated = 0.0, least_deg = kMaxRounding_deg;
  for (std::size_t i = 0; i < changes_count_; ++i) {
    if (steps_deg_[i] < 0.0F) continue;
    steps += 1.0;
    if (steps_deg_[i] < 1e-6F) {
      repeated += 1.0;
    } else {
      least_deg = std::min(least_deg, static_cast<double>(steps_deg_[i]));
    }
  }
  const bool is_rounded = repeated < steps && repeated >= kMinRepeated * steps;
  return is_rounded && least_deg < kMaxRounding_deg ? least_deg : 0.0;
}

double GazeFeatures::noise_deg() const {
  const double n = std::floor(std::max(kScale_s[0], 1.0 / rate_Hz_) * rate_Hz_ + 0.01) + 1.0;
  return noise_deg_s_[0] / rate_Hz_ * std::sqrt(n * (n * n - 1.0) / 12.0);
}

/// The last sample up to a time, from a sample forwards.
std::size_t GazeFeatures::lastUpTo(std::size_t from, double time_s) const {
  while (from + 1 < pushed() && row(from + 1).time_s <= time_s + kTimeSlack_s) ++from;
  return from;
}

/// The last sample up to a time, from a sample backwards. The oldest, if all are later.
std::size_t GazeFeatures::lastBefore(std::size_t from, double time_s) const {
  while (from > dropped_ && row(from).time_s > time_s + kTimeSlack_s) --from;
  return from;
}

GazeFeatureVector GazeFeatures::of(std::size_t sample, double ahead_s) const {
  GazeFeatureVector features{};
  float* out = features.data();
  const auto add = [&](double value) { *out++ = static_cast<float>(value); };
  const double now_s = row(sample).time_s;
  const std::size_t newest = lastUpTo(sample, now_s + std::min(ahead_s, kMaxAhead_s));
  std::size_t centre = sample, after = sample;
  for (std::size_t s = 0; s < kScale_s.size(); ++s) {
    const double half_s = 0.5 * std::max(kScale_s[s], 1.0 / rate_Hz_);
    centre = std::min(lastUpTo(centre, now_s + half_s), newest);
    after = std::min(lastUpTo(after, now_s + 2.0 * half_s), newest);
    const std::size_t before = lastBefore(after, row(after).time_s - 2.0 * half_s);
    const Window& around = row(centre).windows[s];
    const Window &late = row(after).windows[s], &early = row(before).windows[s];
    const double noise_deg_s = noise_deg_s_[s];
    const double noise_step_deg = noise_deg_s * 2.0 * half_s;
    if (around.count < 2.0) {
      for (int i = 0; i < 4; ++i) add(kUnknown);
    } else {
      const double speed_deg_s = glm::length(around.velocity_deg_s);
      add(logOf(speed_deg_s, 0.5));
      add(logOf(speed_deg_s / noise_deg_s, 0.1));
      add(logOf(around.spread_deg, 0.005));
      add(logOf(around.spread_deg / noise_step_deg, 0.02));
    }
    if (late.count < 2.0 || early.count < 2.0 || before == after) {
      for (int i = 0; i < 3; ++i) add(kUnknown);
    } else {
      const double step_deg = glm::degrees(glm::distance(late.mean, early.mean));
      add(agreement(early.velocity_deg_s, late.velocity_deg_s, noise_deg_s));
      add(logOf(step_deg, 0.005));
      add(logOf(step_deg / noise_step_deg, 0.02));
    }
  }
  addPeaks(sample, newest, 0, out);
  addPeaks(sample, newest, 2, out);
  addProgress(sample, newest, 0.03, out);
  addProgress(sample, newest, 0.08, out);
  addLosses(sample, newest, out);
  // Lids move the pupil's image up and down.
  const std::size_t at = lastUpTo(sample, now_s + 0.5 * kScale_s[3]);
  const glm::dvec3 velocity = row(std::min(at, newest)).windows[3].velocity_deg_s;
  add(std::abs(velocity.y) / (glm::length(velocity) + noise_deg_s_[3]));
  assert(out <= features.data() + kGazeFeatures);
  return features;
}

/// The fastest windows before and after, and how the velocity now compares with them.
void GazeFeatures::addPeaks(std::size_t sample, std::size_t newest, std::size_t scale,
                            float*& out) const {
  constexpr double kReach_s = 0.06;
  const double now_s = row(sample).time_s;
  const double half_s = 0.5 * std::max(kScale_s[scale], 1.0 / rate_Hz_);
  const std::size_t centre = std::min(lastUpTo(sample, now_s + half_s), newest);
  const Window& now = row(centre).windows[scale];
  Peak before, after;
  const auto look = [&](std::size_t i, Peak& peak) {
    const Window& window = row(i).windows[scale];
    if (window.count < 2.0) return;
    const double speed_deg_s = glm::length(window.velocity_deg_s);
    if (speed_deg_s <= peak.speed_deg_s) return;
    peak = {speed_deg_s, window.middle_s, window.velocity_deg_s};
  };
  for (std::size_t i = centre + 1; i-- > dropped_;) {
    if (row(centre).time_s - row(i).time_s > kReach_s) break;
    look(i, before);
  }
  for (std::size_t i = centre; i <= newest; ++i) {
    if (row(i).time_s - row(centre).time_s > kReach_s) break;
    look(i, after);
  }
  const double noise_deg_s = noise_deg_s_[scale];
  const double speed_deg_s = glm::length(now.velocity_deg_s);
  for (const Peak& peak : {before, after}) {
    *out++ = static_cast<float>(logOf(peak.speed_deg_s, 0.5));
    *out++ = static_cast<float>(logOf(peak.speed_deg_s / noise_deg_s, 0.1));
    *out++ = static_cast<float>(speed_deg_s / (peak.speed_deg_s + noise_deg_s));
    *out++ = static_cast<float>(agreement(now.velocity_deg_s, peak.velocity_deg_s, noise_deg_s));
    *out++ = static_cast<float>(std::abs(peak.time_s - now_s));
  }
}

/// How far gaze has come from its mean before to its mean after.
void GazeFeatures::addProgress(std::size_t sample, std::size_t newest, double reach_s,
                               float*& out) const {
  constexpr std::size_t kScale = 1;
  const double now_s = row(sample).time_s;
  const double apart_s = std::max(reach_s, 1.0 / rate_Hz_);
  const std::size_t before = lastBefore(sample, now_s - apart_s);
  const std::size_t after = std::min(lastUpTo(sample, now_s + apart_s + kScale_s[kScale]), newest);
  const std::size_t centre = std::min(lastUpTo(sample, now_s + 0.5 * kScale_s[0]), newest);
  const Window &from = row(before).windows[kScale], &to = row(after).windows[kScale];
  const Window& at = row(centre).windows[0];
  if (from.count < 1.0 || to.count < 1.0 || at.count < 1.0) {
    for (int i = 0; i < 3; ++i) *out++ = kUnknown;
    return;
  }
  const glm::dvec3 way = to.mean - from.mean;
  const double noise = glm::radians(noise_deg_s_[kScale] * std::max(kScale_s[1], 1.0 / rate_Hz_));
  *out++ = static_cast<float>(logOf(glm::length(way) / noise, 0.05));
  *out++ =
      static_cast<float>(glm::dot(at.mean - from.mean, way) / (glm::dot(way, way) + noise * noise));
  *out++ = static_cast<float>(logOf(glm::degrees(glm::distance(at.mean, to.mean)), 0.005));
}

void GazeFeatures::addLosses(std::size_t sample, std::size_t newest, float*& out) const {
  constexpr double kFar_s = 0.3;
  const Row& now = row(sample);
  const auto share = [&](std::size_t from, std::size_t until) {
    return (row(until).losses - row(from).losses) /
           static_cast<double>(std::max<std::size_t>(until - from, 1));
  };
  double next_s = kFar_s;
  for (std::size_t i = sample; i <= newest; ++i) {
    if (!row(i).direction) {
      next_s = row(i).time_s - now.time_s;
      break;
    }
  }
  *out++ = now.direction ? 0.0F : 1.0F;
  *out++ = static_cast<float>(std::min(now.time_s - now.lost_s, kFar_s));
  *out++ = static_cast<float>(std::min(now.time_s - now.present_s, kFar_s));
  *out++ = static_cast<float>(next_s);
  *out++ = static_cast<float>(share(lastBefore(sample, now.time_s - kScale_s[5]), newest));
}

}  // namespace foci
