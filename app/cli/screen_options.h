// The screen of a recording, as options state it.
#pragma once

#include <string>

#include "gaze/geometry/gaze_sample.h"

namespace CLI {
class App;
}

namespace foci {

/// Texts as the user typed them; an empty text means that the option was not given.
struct ScreenOptions {
  std::string size_px{}, size_m{}, distance_m{};
};

/// Adds --screen-px WxH, --screen-m WxH and --distance-m D.
void addScreenOptions(CLI::App& command, ScreenOptions& options);

/// Quantities that were not given are 0. @throws InputError
Screen screenOf(const ScreenOptions& options);

/// @throws InputError if a quantity that turns pixels into angles is missing
void requireWholeScreen(const Screen& screen, const std::string& file);

}  // namespace foci
