// The interface of all sources of live gaze.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/sender_clock.h"

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

}  // namespace foci
