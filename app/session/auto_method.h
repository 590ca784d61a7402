// What sets method `auto` apart, told by its name in this place alone.
#pragma once

#include <string_view>

namespace foci {

/// Whether the method chooses a quality level for each frame itself. Its small errors are allowed,
/// so frames that change too little to see are reused.
inline bool choosesQuality(std::string_view method) { return method == "auto"; }

/// Whether the method takes notice of `Quality`: `auto`, or `auto:N` with a forced quality level.
inline bool usesQuality(std::string_view method) {
  return choosesQuality(method) || method.starts_with("auto:");
}

}  // namespace foci
