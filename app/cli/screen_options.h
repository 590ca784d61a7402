// The screen of a recording, as options give it.
#pragma once

#include <string>

#include "gaze/geometry/gaze_sample.h"

namespace CLI {
class App;
}

namespace foci {

struct ScreenOptions {
  std::string size_px{}, size_m{}, distance_m{};  ///< as given; empty: not
};

/// --screen-px WxH, --screen-m WxH, --distance-m D.
void addScreenOptions(CLI::App& command, ScreenOptions& options);

/// What was given; the rest is 0. @throws InputError
Screen screenOf(const ScreenOptions& options);

/// @throws InputError where a quantity that turns pixels into angles is missing
void requireWholeScreen(const Screen& screen, const std::string& file);

}  // namespace foci
