// The options that describe a recording: its columns, units and screen.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "gaze/events/event_settings.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"

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

/// Of `foci trace info REC --scene SCENE`: how a headset recording lies in a scene.
struct AlignmentOptions {
  std::string scene{}, up{}, out{"alignment.svg"};
  bool overwrite = false;
};

void addAlignmentOptions(CLI::App& command, AlignmentOptions& options);

/// Draws the recording in the scene, and prints how well it fits, and what would fit better.
/// @param trace  its study, if there is one, has the scene unless the option names it
/// @throws InputError
void showAlignment(const std::string& recording, const TraceOptions& trace,
                   const AlignmentOptions& options, bool json);

}  // namespace foci
