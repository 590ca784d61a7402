// What the window says in a few words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gaze/events/gaze_events.h"
#include "gaze/live/trace_player.h"

namespace foci {

/// The distance of a focus: "0.50 m", "infinity", "behind the eye".
std::string metresText(double focus_D);

/// The new value of a study's key: "pupil 6 mm".
/// @param toml  as `setKey` takes it
std::string changeInWords(std::string_view key, const std::string& toml);

/// What keys and buttons do with a recording that plays.
enum class PlayerStep {
  toggle,  ///< pauses, or plays on
  back,    ///< five seconds
  forward,
  frame_back,  ///< 1/30 s; pauses
  frame_forward,
  fixation_before,  ///< to its middle
  fixation_after,
  begin,
  end,
  slower,  ///< half as fast
  faster,
  loop,
};

/// @param events  of the recording
/// @return what it has done
std::string carryOut(PlayerStep step, TracePlayer& player, const std::vector<GazeEvent>& events);

}  // namespace foci
