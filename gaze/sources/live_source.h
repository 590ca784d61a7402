// Gaze as it happens, whatever it comes from.
#pragma once

#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// A tracker, or what stands in for one. Never waits: the frame loop asks it once a frame.
class LiveSource {
 public:
  virtual ~LiveSource() = default;

  /// Appends what has come since the last call, oldest first, with times on the caller's clock that
  /// increase from sample to sample and are not after `now_s`.
  /// @param now_s  never decreases
  virtual void poll(double now_s, std::vector<GazeSample>& samples) = 0;

  /// Samples a second, nominal, > 0: known from the start, or a guess until there are enough.
  virtual double rate_Hz() const = 0;

  /// One line for the observer: what it is, whether it is there.
  virtual std::string status() const = 0;
};

}  // namespace foci
