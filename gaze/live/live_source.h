// The interface of all sources of live gaze, and those without a tracker: the mouse, and a
// recording played in real time.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
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

/// Plays a recording in real time. The first poll gives the first sample.
class TraceSource : public LiveSource {
 public:
  /// @param trace  its samples and rate must be known (asserted)
  explicit TraceSource(GazeTrace trace);

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override { return trace_.rate_Hz; }
  std::string status() const override;
  bool ended() const { return next_ == trace_.samples.size(); }

 private:
  GazeTrace trace_;
  std::size_t next_ = 0;
  std::optional<double> offset_s_{};  // from the recording's clock to the caller's
};

}  // namespace foci
