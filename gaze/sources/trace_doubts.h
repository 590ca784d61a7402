// What looks wrong in a recording: a wrong unit, origin, column, screen or code for data loss shows
// in its positions. A wrong one gives plausible numbers, so nobody would notice it in a result.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/thinned.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/geometry/sampling_rate.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Where doubts become warnings.
class Doubts {
 public:
  explicit Doubts(std::vector<std::string>& warnings) : warnings_(warnings) {}

  /// @return whether it is doubtful
  bool add(bool is_doubtful, const std::string& sentence) {
    if (is_doubtful) warnings_.push_back(sentence);
    return is_doubtful;
  }

 private:
  std::vector<std::string>& warnings_;
};

/// How the user states a screen.
struct ScreenNames {
  std::string size_px = "screen.size_px", size_m = "screen.size_m",
              distance_m = "screen.distance_m";
};

/// What looks wrong in gaze in space: a wrong frame, axis, unit or order of columns still gives
/// lines of sight.
class SpaceDoubts {
 public:
  void add(const GazeSample& sample);

  /// One sentence for each doubt, with the key to set.
  /// @param in_world  the frame of the gaze columns, as stated
  /// @param y_is_up   in the recording's world; false: unknown
  void state(bool in_world, bool y_is_up, Doubts& doubts) const;

 private:
  void stateGaze(bool in_world, Doubts& doubts) const;
  void stateHead(bool y_is_up, Doubts& doubts) const;
  void stateEyes(Doubts& doubts) const;

  std::size_t gazes_ = 0, behind_ = 0, beside_ = 0;
  Thinned<GazeSample> kept_{};
};

/// What looks wrong in a screen's geometry: pixels that are not square, or an impossible width. A
/// sentence each.
/// @param screen  with resolution, size and distance known
std::vector<std::string> screenDoubts(const Screen& screen, const ScreenNames& names = {});

/// "12 %"
std::string percent(double share);

/// Gathers samples in constant memory, then names the doubts.
class TraceDoubts {
 public:
  void add(const GazeSample& sample);

  /// Adds one warning for each doubt, with the key to set. Positions that a gaze map will change,
  /// or fewer than a hundred of them, raise no doubt of their own. If they raise one, no column is
  /// certain.
  /// @param header  of the same recording; its screen may be unknown in part
  void state(const TraceColumns& columns, TraceHeader& header) const;

  /// Whether there are enough positions to judge.
  bool hasPositions() const;

  /// The part of `state` about unit, origin and columns.
  /// @param may_rest  gaze may stay in one place, as of live gaze
  /// @return whether there is a doubt
  bool statePositions(TraceHeader& header, bool may_rest = false) const;

 private:
  struct Kept {
    glm::dvec2 point_px{0.0};
    std::array<std::optional<glm::dvec2>, 2> eyes_px{};
  };

  void addClock(double time_s);
  void addPoint(const GazeSample& sample);
  void stateRows(Doubts& doubts) const;
  void stateRates(Doubts& doubts) const;
  void stateLoss(const TraceHeader& header, Doubts& doubts) const;
  void stateEyes(const TraceHeader& header, Doubts& doubts) const;
  void stateRepeats(Doubts& doubts) const;
  /// Of the gaze.
  std::vector<glm::dvec2> points_px() const;

  SpaceDoubts space_{};
  RateWatch watch_{};
  double first_rate_Hz_ = 0.0;
  std::vector<RateStretch> rates_{};  // but the first
  std::size_t samples_ = 0, present_ = 0, changes_ = 0;
  std::size_t outside_ = 0;  // gaze in space that meets no screen
  std::size_t away_ = 0;     // lines of sight that lead away from the screen
  double first_s_ = 0.0, last_s_ = 0.0, longest_gap_s_ = 0.0, paused_s_ = 0.0;
  double blink_s_ = 0.0, longest_blink_s_ = 0.0;  // begin of the latest
  bool blinks_ = false;
  glm::dvec2 last_px_{0.0}, before_last_px_{0.0};
  std::size_t alternations_ = 0;  // positions far from the last one, and near the one before it
  bool whole_px_ = true;          // all positions
  double run_s_ = 0.0, longest_hold_s_ = 0.0;  // when a run of equal positions began
  std::size_t run_ = 0, held_ = 0;             // repeats in the run; those of long runs
  Thinned<Kept> kept_{};
  Thinned<double> pupils_mm_{};
};

}  // namespace foci
