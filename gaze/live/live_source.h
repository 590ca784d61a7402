// The interface of all sources of live gaze, and those without a tracker: the mouse, and samples
// that another program pushes with its tracker's times.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/live/sender_clock.h"

namespace foci {

/// What a source knows of its sender.
struct SenderFacts {
  std::size_t dropped = 0;            ///< samples and messages that arrived and were not given
  std::string why{};                  ///< of the latest of them
  std::optional<ClockFacts> clock{};  ///< absent: the samples are measured on our clock
};

/// An eye tracker, or a substitute for one. No function waits; the frame loop polls once a frame.
class LiveSource {
 public:
  virtual ~LiveSource() = default;

  /// Appends the samples that have arrived since the last call, oldest first. Their times are on
  /// the caller's clock, increase from sample to sample, and are not after `now_s` (but by
  /// microseconds, see `SenderClock`).
  /// @param now_s  never decreases
  virtual void poll(double now_s, std::vector<GazeSample>& samples) = 0;

  /// Nominal sampling rate, > 0. Some sources return a guess until enough samples have arrived.
  virtual double rate_Hz() const = 0;

  /// One line for the observer: the source's name, and whether it works.
  virtual std::string status() const = 0;

  virtual SenderFacts sender() const { return {}; }
};

/// The pointer replaces gaze. Each poll gives one sample.
class MouseSource : public LiveSource {
 public:
  /// @param rate_Hz  nominal number of polls per second
  explicit MouseSource(double rate_Hz = 60.0) : rate_Hz_(rate_Hz) {}

  /// @param point_px  on the screen; absent while the pointer is elsewhere (data loss)
  void moveTo(const std::optional<glm::dvec2>& point_px) { point_px_ = point_px; }

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override { return rate_Hz_; }
  std::string status() const override { return "mouse"; }

 private:
  double rate_Hz_;
  std::optional<glm::dvec2> point_px_{};
  std::optional<double> last_s_{};
};

/// The samples `TIME X Y [PUPIL]` of a text with `;` between them: seconds on any clock, px on the
/// screen, mm. `nan` in X or Y means data loss.
/// @throws InputError if one is wrong, or not later than the one before
std::vector<GazeSample> samplesOfText(std::string_view text);

class PushedSource : public LiveSource {
 public:
  /// @param rate_Hz         nominal rate of the samples
  /// @param clock_measured  as of `SenderClock`
  explicit PushedSource(double rate_Hz, bool clock_measured = false)
      : rate_Hz_(rate_Hz), clock_(clock_measured) {}

  /// Takes samples that arrive together. May be called from any thread.
  /// @param now_s  on the clock of `poll`
  /// @return how many samples it drops: of these, or of earlier ones that were in doubt
  std::size_t push(const std::vector<GazeSample>& samples, double now_s);

  /// Whether samples have been used in the last two seconds.
  bool isHeard() const;

  void poll(double now_s, std::vector<GazeSample>& samples) override;

  double rate_Hz() const override { return rate_Hz_; }
  std::string status() const override {
    return isHeard() ? "gaze from the socket" : "gaze from the socket, none yet";
  }
  SenderFacts sender() const override;

 private:
  double rate_Hz_;
  mutable std::mutex mutex_{};
  SenderClock clock_;
  std::vector<GazeSample> waiting_{};  // on our clock
  std::optional<double> heard_s_{};    // when samples were used last
  double polled_s_ = 0.0;
};

}  // namespace foci
