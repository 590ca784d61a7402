#include "gaze/gaze.h"

namespace foci {

std::string_view nameOf(GazeState state) {
  switch (state) {
    case GazeState::fixation:
      return "fixation";
    case GazeState::saccade:
      return "saccade";
    case GazeState::pursuit:
      return "pursuit";
    case GazeState::blink:
      return "blink";
    case GazeState::lost:
      return "lost";
  }
  return "lost";
}

}  // namespace foci
