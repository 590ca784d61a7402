// What the lines before a table of gaze say of the recording.
#pragma once

#include <optional>
#include <string_view>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

struct TablePreamble {
  Screen screen{};
  std::optional<GazeUnits> units{};
  std::optional<double> rate_Hz{};
  bool smi = false;  ///< the file begins as BeGaze's do
};

/// "px", "deg", "normalised" and what others write for them.
std::optional<GazeUnits> unitsNamed(std::string_view name);

/// Takes a line that begins with '#': `# key=value ...`, or BeGaze's
/// `## Calibration Area:<tab>1680<tab>1050` and the like. Keys that are not ours are other people's
/// and pass.
/// @throws InputError on a value out of its range
void readPreambleLine(const LineReader& lines, std::string_view line, TablePreamble& preamble);

/// A number within limits. @param range  them, for the message
/// @throws InputError
double numberIn(const LineReader& lines, std::string_view key, std::string_view text, double low,
                double high, const char* range);

}  // namespace foci
