// The time from the landing of a saccade to the first frame at full quality, which a frame-time
// budget may delay.
#pragma once

#include <cstdint>
#include <optional>

#include "app/record/durations.h"
#include "app/session/frame_record.h"

namespace foci {

class Landings {
 public:
  /// Takes a frame that was shown. Frames come in order.
  /// @param full  at full quality: the frame-time budget took nothing away
  /// @return for the first full frame after a landing, the time since then, ms
  std::optional<double> add(const FrameRecord& record, bool full, double swap_s) {
    ++frames_;
    full_frames_ += full;
    const GazeState state = record.eye.state;
    if (state == GazeState::saccade) {
      in_saccade_ = true;
    } else if (isStable(state) && in_saccade_) {
      in_saccade_ = false;
      landed_s_ = record.eye.state_time_s;
      ++count_;
    }
    if (!isStable(state)) landed_s_.reset();  // the eye has left again
    if (!full || !landed_s_) return std::nullopt;
    const double ms = 1e3 * (swap_s - *landed_s_);
    landed_s_.reset();
    to_full_.add(ms);
    return ms;
  }

  std::uint64_t count() const { return count_; }
  /// Of the landings that had a full frame before the eye left again.
  const Durations& toFull() const { return to_full_; }
  /// Share of all frames that were full.
  double fullShare() const {
    return frames_ == 0 ? 0.0 : static_cast<double>(full_frames_) / static_cast<double>(frames_);
  }

 private:
  std::uint64_t frames_ = 0, full_frames_ = 0, count_ = 0;
  bool in_saccade_ = false;
  std::optional<double> landed_s_;
  Durations to_full_;
};

}  // namespace foci
