// What a live run records of itself: how its gaze arrived, and how soon frames had full quality.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/session/frame_record.h"
#include "gaze/live/sender_clock.h"

namespace foci {

/// A histogram of durations, in constant memory however long a run is.
class Durations {
 public:
  void add(double ms) {
    const double bin = std::clamp(ms / kBin_ms, 0.0, static_cast<double>(kBins - 1));
    ++counts_[static_cast<std::size_t>(bin)];
    ++count_;
  }

  std::uint64_t count() const { return count_; }

  /// The value below which a share of all durations lies, ms, in bins of 0.1 ms up to 2 s. 0
  /// without durations.
  double quantile_ms(double share) const {
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(count_));
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      below += counts_[i];
      if (below > wanted || (below == count_ && count_ > 0)) {
        return (static_cast<double>(i) + 0.5) * kBin_ms;
      }
    }
    return 0.0;
  }

 private:
  static constexpr double kBin_ms = 0.1;
  static constexpr std::size_t kBins = 20000;
  std::array<std::uint32_t, kBins> counts_{};
  std::uint64_t count_ = 0;
};

/// The time from the landing of a saccade to the first frame at full quality, which a frame-time
/// budget may delay.
class Landings {
 public:
  /// Takes a frame that was shown. Frames come in order.
  /// @param state_s  time of the sample that its gaze state is of, on the clock of swap_s
  /// @param full     at full quality: the frame-time budget took nothing away
  /// @return for the first full frame after a landing, the time since then, ms
  std::optional<double> add(const FrameRecord& record, double state_s, bool full, double swap_s) {
    ++frames_;
    full_frames_ += full;
    const GazeState state = record.eye.state;
    if (state == GazeState::saccade) {
      in_saccade_ = true;
    } else if (isStable(state) && in_saccade_) {
      in_saccade_ = false;
      landed_s_ = state_s;
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

/// No gaze was used during this time.
struct UnusedGaze {
  double from_s = 0.0, to_s = 0.0;
  std::string why;
};

/// The sender's clock, and what was lost and when.
struct GazeReception {
  std::optional<ClockFacts> clock{};  ///< of the sender; absent: the samples have our times
  std::size_t dropped = 0;            ///< samples that arrived and were not given to the eye
  std::vector<UnusedGaze> unused{};   ///< longer than a second each
  /// "gaze arrives, but none of it has been used for 3 s: ..."; empty while gaze is used.
  std::string remark{};
  /// "gaze may be wrong: ..." where its unit may be another; empty: it looks right.
  std::string doubt{};
};

}  // namespace foci
