// What sets method `auto` apart from the others.
#pragma once

#include <string_view>

#include "render/methods/quality_level.h"

namespace foci {

/// Whether the method chooses a quality level for each frame itself. Its small errors are allowed,
/// so frames that change too little to see are reused.
inline bool choosesQuality(std::string_view method) { return method == kAutoMethod; }

/// Whether the method takes notice of `Quality`: `auto`, or `auto:N` with a forced quality level.
inline bool usesQuality(std::string_view method) {
  return choosesQuality(method) || qualityLevelFrom(method).has_value();
}

}  // namespace foci
