// What the rows of a table show together: the unit of positions, a truncated end, rounded times.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>

#include "gaze/sources/line_reader.h"

namespace foci {

/// Judges positions without a stated unit.
class PlainPositions {
 public:
  void add(const glm::dvec2& point_px) {
    ++count_;
    const bool whole = point_px == glm::floor(point_px);
    tiny_ += !whole && glm::all(glm::lessThan(glm::abs(point_px), glm::dvec2(2.0)));
    negative_ += point_px.x < 0.0 || point_px.y < 0.0;
  }

  /// No tracker looks at the corner pixel for half of a recording.
  bool areFractions() const { return tiny_ >= 2 && 2 * tiny_ >= count_; }
  bool areAroundZero() const { return count_ >= 20 && 4 * negative_ >= count_; }

 private:
  std::size_t count_ = 0, tiny_ = 0, negative_ = 0;
};

/// The decimals of each row's last number. A writer with a fixed number of them writes fewer only
/// where the file is cut off.
class LastDecimals {
 public:
  void add(std::string_view text) {
    if (isAbsent(text)) return;
    const std::size_t point = text.find_first_of(".,");
    fixed_ = fixed_ && latest_ == usual_;
    latest_ = point == text.npos ? 0 : text.size() - point - 1;
    if (rows_++ == 0) usual_ = latest_;
  }

  /// In the latest row, if all rows before have the same number.
  bool areFewer() const { return rows_ > kEnough && fixed_ && latest_ < usual_; }

 private:
  static constexpr std::size_t kEnough = 64;  // rows that end in no 0 by chance: a thousandth

  std::size_t rows_ = 0, usual_ = 0, latest_ = 0;
  bool fixed_ = true;
};

/// Gives times in whole milliseconds the steps of the tracker's own clock. The offset between the
/// clocks of computer and tracker follows their drift, and is reset after a jump of either.
class FineClock {
 public:
  bool isUsed() const { return offset_ms_.has_value(); }

  double time_ms(double whole_ms, double fine_ms) {
    const double ahead_ms = offset_ms_ ? whole_ms - fine_ms - *offset_ms_ : kJump_ms;
    if (std::abs(ahead_ms) >= kJump_ms) {
      offset_ms_ = whole_ms - fine_ms;
    } else {
      *offset_ms_ += kFollow * ahead_ms;
    }
    return fine_ms + *offset_ms_;
  }

 private:
  // Whole milliseconds are within 1 of the truth, and quartz drifts by less than 1 ms in ten
  // seconds. A thousandth a sample follows in a few seconds.
  static constexpr double kJump_ms = 20.0, kFollow = 1e-3;

  std::optional<double> offset_ms_{};
};

/// Gives distinct times to samples that share a time, because times are whole units and samples
/// come faster: each follows the one before by an even interval, within its unit. A control loop
/// (proportional and integral, critically damped) keeps the times in the middle of their units.
class WholeTimes {
 public:
  explicit WholeTimes(double interval) : interval_(interval) {}

  double interval() const { return interval_; }

  /// Increases strictly. @param whole  does not decrease
  double time(double whole) {
    constexpr double kGain = 0.01;  // settles within a few hundred samples
    const double end = whole + 1.0;
    double at = last_ ? *last_ + interval_ : whole;
    const double error = whole + 0.5 - at;
    if (std::abs(error) <= 1.0) {
      at += kGain * error;
      interval_ += 0.25 * kGain * kGain * error;
    }
    at = std::max(at, whole);
    if (at >= end) at = 0.5 * (*last_ + end);
    last_ = at;
    return at;
  }

 private:
  double interval_;
  std::optional<double> last_{};
};

}  // namespace foci
