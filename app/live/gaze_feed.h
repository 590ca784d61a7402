// Asks a live source on a thread of its own: neither a frame nor the window waits for a tracker.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/live/clock.h"
#include "app/live/sources.h"

namespace foci {

class GazeFeed {
 public:
  /// @param clock  outlives the feed
  GazeFeed(NamedSource source, const LiveClock& clock);

  /// Where the mouse points on the study's screen; absent: elsewhere. Ignored by other sources.
  void pointTo(const std::optional<glm::dvec2>& point_px);

  /// The observer looks there now, on the study's screen: a calibrated webcam's map learns from it.
  /// @return what to tell the observer; "" where the source does not learn
  std::string lookedAt(const glm::dvec2& point_px);

  /// Appends what has come since the last call, oldest first.
  void take(std::vector<GazeSample>& samples);

  const Screen& screen() const { return source_.screen; }
  double rate_Hz() const { return rate_Hz_; }
  std::string status() const;

 private:
  void run(const std::stop_token& stop);

  NamedSource source_;
  const LiveClock& clock_;
  double rate_Hz_;  // as it was at the start
  mutable std::mutex mutex_;
  std::vector<GazeSample> waiting_;
  std::optional<glm::dvec2> pointer_px_;
  std::string status_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
