// Polls a live source on a thread of its own, so that neither a frame nor the window waits for a
// tracker.
#pragma once

#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "app/live/clock.h"
#include "app/live/sources.h"
#include "app/record/live_facts.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_doubts.h"

namespace foci {

/// The one rule against silence: whenever no gaze is used for more than a second, this says so and
/// why. Window, log, record and the answers to the sender show its remark.
class GazeWatch {
 public:
  /// Gaze has arrived, or might have.
  /// @param samples  that the eye gets
  /// @param dropped  how many others there were
  /// @param why      the latest of those was dropped, or the status of a source without news
  /// @return a line for the log; "" mostly
  std::string arrive(double now_s, const std::vector<GazeSample>& samples, std::size_t dropped,
                     const std::string& why);

  /// A frame has looked at the gaze.
  /// @param uses_gaze  the eye has a state that comes of gaze
  /// @return a line for the log; "" mostly
  std::string look(double now_s, bool uses_gaze);

  std::size_t dropped() const { return all_dropped_; }
  const std::vector<UnusedGaze>& unused() const { return unused_; }
  const std::string& remark() const { return remark_; }

 private:
  std::string reasons(double now_s) const;

  bool looked_ = false;              // there was a frame: before it, the scene is still loading
  double looked_s_ = 0.0;            // at the latest frame
  bool unused_now_ = false;          // since `since_s_`
  std::optional<double> since_s_{};  // no gaze has been used
  double arrived_s_ = -INFINITY;     // at the latest gaze
  std::size_t dropped_ = 0, pointless_ = 0, pointed_ = 0;  // of it
  double oldest_s_ = 0.0;                                  // on arrival, of those with a point
  std::string why_{};
  std::optional<double> logged_s_{};  // end of the latest time that was logged
  bool logs_ = false;                 // this time is logged
  std::size_t all_dropped_ = 0;
  std::vector<UnusedGaze> unused_{};
  std::string remark_{};
};

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
  /// @return as `now_s`: of a recording, all samples up to then have been taken
  double take(std::vector<GazeSample>& samples);

  /// On the clock of the samples: a recording that plays has a clock of its own.
  double now_s() const;

  /// A recording begins to play, with the first frame. Other sources have begun.
  void begin();

  /// From now on the observer looks where they looked last, whatever the source says.
  /// @return false if no gaze has come yet
  bool hold(bool on);
  bool holds() const;

  /// Null: the source is no recording.
  TracePlayer* player() const { return source_.player; }
  const Playback& playback() const { return source_.playback; }

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
  void holdGaze(std::vector<GazeSample>& news);
  void judge(const std::vector<GazeSample>& news, double now_s);

  NamedSource source_;
  const LiveClock& clock_;
  double rate_Hz_;  // at the start
  mutable std::mutex mutex_;
  std::vector<GazeSample> waiting_;
  GazeWatch watch_;
  SenderFacts sender_;  // at the latest poll
  double logged_step_s_ = 0.0;
  TraceDoubts doubts_;  // of the samples since `judged_s_`
  double judged_s_ = 0.0;
  bool looks_right_ = false;
  std::string doubt_;
  std::optional<glm::dvec2> pointer_px_;
  std::string status_;
  double now_s_ = 0.0;                   // of a recording, at the latest poll
  std::optional<glm::dvec2> latest_px_;  // gaze
  bool holds_ = false, begun_ = false;
  std::size_t polls_begun_ = 0, polls_ended_ = 0;
  std::condition_variable polled_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
