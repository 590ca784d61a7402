// Times of a stream on the recorder's clock, after pyxdf (Boulay and others,
// github.com/xdf-modules/pyxdf): split at resets of the stream's clock, a robust line through the
// clock offsets of each part, even intervals.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "base/quantile.h"
#include "base/transformed.h"
#include "gaze/sources/lsl_stream.h"

namespace foci {
namespace {

constexpr double kReset_s = 1.0;      // a larger step of the offset is a reset, as in pyxdf
constexpr std::size_t kSettled = 3;   // so many offsets that agree are no wild ones
constexpr double kReach_s = 15.0;     // nearer than any part: three usual intervals of offsets
constexpr double kMeasured_s = 1e-5;  // offsets are measured over a network, no better than this
constexpr double kSigmas = 5.0;
constexpr std::size_t kMaxForSlopes = 500;   // offsets; their pairs cost its square
constexpr std::size_t kIntervalsInOne = 16;  // chunks of samples may share a time

struct Point {
  double x = 0.0, y = 0.0;
};

/// y = at.y + slope (x - at.x)
struct Line {
  Point at{};
  double slope = 0.0;

  double operator()(double x) const { return at.y + slope * (x - at.x); }
};

/// By least squares. @param points  at least one
Line fitLine(const std::vector<Point>& points) {
  const Point& first = points.front();  // keeps the digits of large times
  Point sum{};
  for (const Point& p : points) {
    sum.x += p.x - first.x;
    sum.y += p.y - first.y;
  }
  const auto count = static_cast<double>(points.size());
  const Point mean{first.x + sum.x / count, first.y + sum.y / count};
  double product = 0.0, spread = 0.0;
  for (const Point& p : points) {
    product += (p.x - mean.x) * (p.y - mean.y);
    spread += (p.x - mean.x) * (p.x - mean.x);
  }
  return {mean, spread > 0.0 ? product / spread : 0.0};
}

double medianDistance(const std::vector<Point>& points, const Line& line) {
  auto distances = transformed(points, [&](const Point& p) { return std::abs(p.y - line(p.x)); });
  return quantile(distances, 0.5);
}

/// The line by least squares through the points near that of Theil and Sen: the median of the
/// slopes of all pairs.
Line fitRobustLine(const std::vector<Point>& points) {
  if (points.size() < kSettled) return fitLine(points);
  std::vector<double> slopes, heights;
  const std::size_t stride = 1 + points.size() / kMaxForSlopes;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    for (std::size_t j = i + stride; j < points.size(); j += stride) {
      if (points[j].x == points[i].x) continue;
      slopes.push_back((points[j].y - points[i].y) / (points[j].x - points[i].x));
    }
  }
  Line line{points.front(), slopes.empty() ? 0.0 : quantile(slopes, 0.5)};
  for (const Point& p : points) heights.push_back(p.y - line(p.x));
  line.at.y += quantile(heights, 0.5);
  const double limit = std::max(kMeasured_s, kSigmas * kSigmaPerMad * medianDistance(points, line));
  std::vector<Point> near;
  for (const Point& p : points) {
    if (std::abs(p.y - line(p.x)) <= limit) near.push_back(p);
  }
  return fitLine(near);
}

/// The offsets between two resets.
struct Part {
  std::vector<Point> points{};  // recorder's time, offset: a wild offset does not move in x
  Line offset{};
  double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s;  // stream's clock

  void add(const ClockOffset& measured) {
    points.push_back({measured.collected_s + measured.offset_s, measured.offset_s});
    first_s = std::min(first_s, measured.collected_s);
    last_s = std::max(last_s, measured.collected_s);
  }

  /// t = s + offset(t)
  double recorderTime_s(double stream_s) const {
    return offset.at.x + (stream_s + offset.at.y - offset.at.x) / (1.0 - offset.slope);
  }

  /// 0 if the times of the run and of the offsets overlap.
  double distance_s(double run_first_s, double run_last_s) const {
    return std::max({0.0, first_s - run_last_s, run_first_s - last_s});
  }
};

/// An offset belongs to the latest part that it continues. Those beside are wild unless there are
/// several that agree.
std::vector<Part> partsOf(const std::vector<ClockOffset>& offsets) {
  std::vector<Part> parts;
  for (const ClockOffset& measured : offsets) {
    if (!std::isfinite(measured.collected_s) || !std::isfinite(measured.offset_s)) continue;
    Part* found = nullptr;
    for (std::size_t i = parts.size(); i-- > 0 && !found;) {
      if (std::abs(measured.offset_s - parts[i].points.back().y) <= kReset_s) found = &parts[i];
      if (parts[i].points.size() >= kSettled) break;
    }
    if (!found) found = &parts.emplace_back();
    found->add(measured);
  }
  for (Part& part : parts) {
    part.offset = fitRobustLine(part.points);
    if (std::abs(part.offset.slope) >= 0.5) throw std::invalid_argument("no clock");
  }
  return parts;
}

/// The part nearest to a run of times, from `from` on.
std::size_t nearestPart(const std::vector<Part>& parts, std::size_t from, double first_s,
                        double last_s) {
  std::size_t best = from;
  const auto distance_s = [&](std::size_t i) {
    return parts[i].distance_s(first_s, last_s) +
           (parts[i].points.size() < kSettled ? kReach_s : 0.0);
  };
  for (std::size_t i = from + 1; i < parts.size(); ++i) {
    if (distance_s(i) < distance_s(best)) best = i;
  }
  return best;
}

/// A stretch of times, [begin, end).
struct Stretch {
  std::size_t begin = 0, end = 0;
  Line time{};  // of the index
  bool is_even = true;
};

void fitStretch(Stretch& stretch, const std::vector<double>& times_s, double interval_s,
                double sigma_s) {
  std::vector<Point> points;
  points.reserve(stretch.end - stretch.begin);
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    points.push_back({static_cast<double>(i), times_s[i]});
  }
  stretch.time = fitLine(points);
  stretch.is_even = medianDistance(points, stretch.time) <= std::max(0.25 * interval_s, sigma_s);
}

}  // namespace

int toRecorderClock(std::vector<double>& times_s, const std::vector<ClockOffset>& offsets) {
  const std::vector<Part> parts = partsOf(offsets);
  if (parts.empty()) return 0;
  std::size_t part = 0;
  int resets = 0;
  for (std::size_t begin = 0, end = 0; begin < times_s.size(); begin = end) {
    for (end = begin + 1; end < times_s.size(); ++end) {
      if (std::abs(times_s[end] - times_s[end - 1]) > kReset_s) break;
    }
    const auto [first, last] =
        std::minmax_element(times_s.begin() + static_cast<std::ptrdiff_t>(begin),
                            times_s.begin() + static_cast<std::ptrdiff_t>(end));
    const double first_s = *first, last_s = *last;
    const bool back = begin > 0 && part + 1 < parts.size() &&
                      parts[part].recorderTime_s(times_s[begin]) < times_s[begin - 1];
    const std::size_t next = nearestPart(parts, part + (back ? 1 : 0), first_s, last_s);
    resets += begin > 0 && next != part;
    part = next;
    for (std::size_t i = begin; i < end; ++i) times_s[i] = parts[part].recorderTime_s(times_s[i]);
  }
  return resets;
}

void removeJitter(std::vector<double>& times_s) {
  if (times_s.size() < kSettled) return;
  std::vector<double> several;
  const std::size_t span = std::min(kIntervalsInOne, times_s.size() - 1);
  for (std::size_t i = 0; i + span < times_s.size(); ++i) {
    several.push_back((times_s[i + span] - times_s[i]) / static_cast<double>(span));
  }
  const double interval_s = quantile(several, 0.5);
  std::vector<double> off_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    off_s.push_back(std::abs(times_s[i] - times_s[i - 1] - interval_s));
  }
  const double sigma_s = kSigmaPerMad * quantile(off_s, 0.5);
  const double gap_s = interval_s + std::max(0.5 * interval_s, kSigmas * sigma_s);
  if (!(interval_s > 0.0)) return;
  std::vector<Stretch> stretches;
  for (std::size_t begin = 0, end = 0; begin < times_s.size(); begin = end) {
    for (end = begin + 1; end < times_s.size(); ++end) {
      const double step_s = times_s[end] - times_s[end - 1];
      if (step_s > gap_s || step_s < -kReset_s) break;
    }
    Stretch stretch{.begin = begin, .end = end};
    fitStretch(stretch, times_s, interval_s, sigma_s);
    // A late time is no gap if the next ones are not late.
    while (!stretches.empty() && times_s[stretch.begin] > times_s[stretch.begin - 1] &&
           stretch.time(static_cast<double>(stretch.begin)) <=
               stretches.back().time(static_cast<double>(stretch.begin - 1))) {
      stretch.begin = stretches.back().begin;
      stretches.pop_back();
      fitStretch(stretch, times_s, interval_s, sigma_s);
    }
    stretches.push_back(stretch);
  }
  for (const Stretch& stretch : stretches) {
    for (std::size_t i = stretch.begin; stretch.is_even && i < stretch.end; ++i) {
      times_s[i] = stretch.time(static_cast<double>(i));
    }
  }
}

}  // namespace foci
