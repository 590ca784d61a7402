// Replaces the window in a build without it (FOCI_WINDOW=OFF).
#include <stdexcept>

#include "app/live/options.h"
#include "app/window/display.h"

namespace foci {

LiveSummary runLive(const Study&, const LiveOptions&, std::optional<SceneFile>) {
  throw std::runtime_error("built without windows: foci live needs one");
}

DisplayFacts describeDisplay() {
  DisplayFacts facts;
  facts.problem = "built without windows (FOCI_WINDOW=OFF)";
  return facts;
}

}  // namespace foci
