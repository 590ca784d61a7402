#include "gaze/geometry/gaze_sample.h"

namespace foci {

std::string_view nameOf(GazeState state) {
  switch (state) {
    case GazeState::fixation:
      return "fixation";
    case GazeState::saccade:
      return "saccade";
    case GazeState::oscillation:
      return "pso";
    case GazeState::pursuit:
      return "pursuit";
    case GazeState::blink:
      return "blink";
    case GazeState::lost:
      return "lost";
    case GazeState::unjudged:
      return "unjudged";
  }
  return "lost";
}

}  // namespace foci
