// Polls a live source on a thread of its own, so that neither a frame nor the window waits for a
// tracker.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "app/live/clock.h"
#include "app/live/gaze_watch.h"
#include "app/live/sources.h"

namespace foci {

class GazeFeed {
 public:
  /// @param clock  outlives the feed
  GazeFeed(NamedSource source, const LiveClock& clock);

  /// Where the mouse points on the study's screen; absent: off the window. Other sources ignore it.
  void pointTo(const std::optional<glm::dvec2>& point_px);

  /// Tells that the observer looks at this point of the study's screen now. The map of a calibrated
  /// webcam learns from it.
  /// @return a notice for the observer; "" if the source does not learn
  std::string lookedAt(const glm::dvec2& point_px);

  /// Takes samples from the socket (`samplesOfText`).
  /// @return the answer: "ok N", "ok N dropped M", "ok N unused: WHY" or "error ..."
  std::string push(std::string_view samples);

  /// Appends the samples since the last call, oldest first.
  void take(std::vector<GazeSample>& samples);

  /// Waits, for a second at most, until the source has been polled anew: `take` then has every
  /// sample that had arrived before.
  void waitForPoll();

  /// Tells that a frame has looked at the gaze.
  /// @param uses_gaze  as of `GazeWatch::look`
  void look(bool uses_gaze);

  GazeReception reception() const;

  const Screen& screen() const { return source_.screen; }
  double rate_Hz() const { return rate_Hz_; }
  const std::vector<std::string>& warnings() const { return source_.warnings.all(); }
  std::string status() const;

 private:
  void run(const std::stop_token& stop);
  void note(const std::vector<GazeSample>& news, SenderFacts&& sender, double now_s);

  NamedSource source_;
  const LiveClock& clock_;
  double rate_Hz_;  // at the start
  mutable std::mutex mutex_;
  std::vector<GazeSample> waiting_;
  GazeWatch watch_;
  SenderFacts sender_;  // at the latest poll
  double logged_step_s_ = 0.0;
  std::optional<glm::dvec2> pointer_px_;
  std::string status_;
  std::size_t polls_begun_ = 0, polls_ended_ = 0;
  std::condition_variable polled_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
