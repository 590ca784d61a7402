// A recording as a live source that plays, pauses and seeks as video players do.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "gaze/live/live_source.h"

namespace foci {

/// From `time_s` on the player's clock, the recording goes on at `recording_s`.
struct PlayPoint {
  double time_s = 0.0;
  double recording_s = 0.0;  ///< on the recording's clock
  double speed = 0.0;        ///< recorded seconds per second; 0: pauses, or a seek's run-up
};

/// Has a clock of its own, on which the times of its samples are. A second of this clock is a
/// second of the recording, at any speed, so that focus moves as it did. The clock stands while the
/// player pauses, and never goes back: after a seek it goes on.
///
/// A seek gives the samples of the last seconds before its target at once. The eye then has the
/// focus there that it would have had if the recording had been played.
class TracePlayer final : public LiveSource {
 public:
  struct State {
    double first_s = 0.0, last_s = 0.0;  ///< of the recording
    double recording_s = 0.0;            ///< now
    double speed = 1.0;
    bool plays = false, loops = false;
  };

  /// Pauses at its first sample.
  /// @param trace  its samples and rate must be known (asserted)
  explicit TracePlayer(GazeTrace trace);

  // From any thread; in force from the next poll on.
  void play(bool on);
  /// @param recording_s  is clamped to the recording
  void seek(double recording_s);
  /// @param speed  is clamped to kMinSpeed ... kMaxSpeed
  void setSpeed(double speed);
  void setLoops(bool on);

  static constexpr double kMinSpeed = 0.125, kMaxSpeed = 8.0;

  State state() const;
  /// The player's clock at the last poll.
  double time_s() const;
  /// The moment of the recording that belongs to a time of the player's clock, since the seek
  /// before the last.
  double recordingAt_s(double time_s) const;
  /// The changes since the last call, in order of time.
  std::vector<PlayPoint> takePoints();
  PlayPoint point() const;  ///< as it plays now

  /// @param now_s  on the caller's clock
  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override { return trace_.rate_Hz; }
  std::string status() const override;

 private:
  PlayPoint pointNow() const;
  void give(std::vector<GazeSample>& samples);
  void advance(double by_s, std::vector<GazeSample>& samples);
  void jump(double to_s, double run_up_s);

  mutable std::mutex mutex_{};
  GazeTrace trace_;
  State now_{};
  double offset_s_;                           // from the recording's clock to the player's
  double before_s_ = 0.0, jumped_s_ = -1e12;  // the offset before the last jump; when that was
  std::size_t next_ = 0;
  std::optional<double> polled_s_{}, seek_s_{};
  std::vector<PlayPoint> points_{};
};

}  // namespace foci
