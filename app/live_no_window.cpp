// What stands in for the window where foci was built without it (FOCI_WINDOW=OFF).
#include <stdexcept>

#include "app/live_options.h"

namespace foci {

LiveSummary runLive(const Study&, const LiveOptions&) {
  throw std::runtime_error("built without windows: foci live needs one");
}

}  // namespace foci
