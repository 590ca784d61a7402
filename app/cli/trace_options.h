// The options that describe a recording: its columns, units and screen.
#pragma once

#include <functional>
#include <string>

#include "app/cli/screen_options.h"
#include "gaze/events/event_settings.h"
#include "gaze/sources/trace_reader.h"

namespace CLI {
class App;
}

namespace foci {

struct TraceOptions {
  std::string units{}, study{}, rows{};
  TraceColumns columns{};  ///< `time`, `x` and `y` alone
  ScreenOptions screen{};
  double time_scale_s = 0.0;
};

/// A recording as a study and the options describe it. An option overrides the study's key.
struct TraceDescription {
  TraceColumns columns{};
  Screen screen{};         ///< for what the recording does not state
  EventSettings events{};  ///< those of the study
};

/// Adds --time, --x, --y, --units, --rows, --time-scale-s, --study and the screen's options.
void addTraceOptions(CLI::App& command, TraceOptions& options);

/// @throws InputError
TraceDescription descriptionOf(const TraceOptions& options);

/// Runs `read`. A refusal that names a key of a study also says where to give it, if the user gave
/// no study.
void withTraceHints(const TraceOptions& options, const std::function<void()>& read);

}  // namespace foci
