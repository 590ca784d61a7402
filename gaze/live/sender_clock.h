// The clock of a sender of gaze, seen from ours: offset and drift, from the times at which samples
// arrive. The offset of a sample without delay is the line below all points (sent, arrived - sent)
// of the last seconds: Moon, Skelly and Towsley, "Estimation and removal of clock skew from network
// delay measurements", INFOCOM 1999.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Between samples that a new estimate of the clock brings together.
inline constexpr double kBurst_s = 1e-6;

/// The sender's clock was set.
struct ClockStep {
  double time_s = 0.0;   ///< on our clock
  double ahead_s = 0.0;  ///< by which the sender's clock went ahead; below 0: back
};

struct ClockFacts {
  double offset_s = 0.0;   ///< our time minus the sender's, now
  double drift_ppm = 0.0;  ///< above 0: the sender's clock runs faster than ours
  std::size_t steps = 0;
  std::vector<ClockStep> latest_steps{};
  bool measured = false;  ///< by the sender's protocol; false: estimated from the arrivals
};

/// Why `SenderClock` drops samples, for people.
inline constexpr const char* kUnfitting =
    "their times are repeated, out of order, or fit no clock that counts seconds";

class SenderClock {
 public:
  // Delays differ by tens of milliseconds. Times that are further ahead do not fit the clock.
  static constexpr double kStep_s = 0.05;

  /// @param measured  the times given are on our clock already. They are believed while the
  ///                  shortest delay is plausible
  explicit SenderClock(bool measured = false) : measured_(measured) {}

  /// Takes samples that arrive together, with times on the sender's clock, and appends them with
  /// times on ours: those increase from sample to sample, and are not after `now_s` (but by
  /// microseconds, where samples come in a burst). The shortest delay counts as 0. Samples that do
  /// not fit the clock are held. If those that follow agree with them, the clock has stepped: all
  /// of them are appended. Otherwise they are dropped.
  /// @param now_s   never decreases
  /// @param late_s  by how much delays differ that are no step of the clock
  void take(const std::vector<GazeSample>& news, double now_s, std::vector<GazeSample>& samples,
            double late_s = kStep_s);

  /// Samples dropped so far: repeated, out of order, or far from the clock.
  std::size_t dropped() const { return dropped_; }

  ClockFacts facts() const;

 private:
  /// A sample without delay has arrived at sent_s + offset_s.
  struct Point {
    double sent_s = 0.0, offset_s = 0.0;
  };
  struct Doubt {
    GazeSample sample;
    double now_s = 0.0;
    bool given = false;
    double offset_s() const { return now_s - sample.time_s; }
  };

  void takeOne(const GazeSample& sample, double now_s, double late_s,
               std::vector<GazeSample>& fitting);
  void doubt(const GazeSample& sample, double now_s, std::vector<GazeSample>& fitting);
  void restart();
  void noteStep(double now_s, double offset_s);
  void add(const Point& point, double now_s);
  void fit();
  void dropDoubts();
  double offsetAt(double sent_s) const { return low_.offset_s + slope_ * (sent_s - low_.sent_s); }

  bool measured_;
  std::deque<Point> points_{};    // the lowest of each bin of the window
  double bin_s_ = 0.0;            // begin of the newest bin, on our clock
  Point low_{};                   // a point of the line
  double slope_ = 0.0;            // of the line: seconds per second
  bool known_ = false;            // there is a line
  bool fitted_ = false;           // a sample has fitted it
  std::optional<Point> first_{};  // of the envelope since the last step
  std::vector<Doubt> doubts_{};   // agree with each other, and not with the line
  double began_s_ = 0.0, arrived_s_ = 0.0;
  std::optional<double> sent_s_{}, given_s_{};  // of the newest sample: the sender's time, and ours
  std::size_t dropped_ = 0, steps_ = 0;
  std::vector<ClockStep> latest_steps_{};
};

/// For people: "offset 12.345 s, drift -98 ppm, 2 steps".
std::string clockText(const ClockFacts& clock);

}  // namespace foci
