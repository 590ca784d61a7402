// Recorded gaze from files: EyeLink ASC, and TSV or CSV with named columns.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "gaze/gaze.h"

namespace foci {

/// What the two position columns hold.
///   px          from the screen's top-left corner, y down
///   deg         eccentricity from the screen's centre, y up: atan(offset_m / distance_m) along
///   each axis normalised  fractions of the screen, (0, 0) its top-left and (1, 1) its bottom-right
///   corner
enum class GazeUnits { px, deg, normalised };

/// Which columns of a TSV or CSV to read. What is empty is recognised by the usual names ("time_s",
/// "timestamp", "x_px", "gaze_x", "x_deg", ...). EyeLink files need none of this and ignore it.
struct TraceColumns {
  std::string time{}, x{}, y{};
  std::string pupil{};  ///< diameter, mm
  std::string blink{};  ///< 0 or false: open; 1 or true: the tracker saw a blink
  /// Absent: from the file's first line or the columns' names, else px.
  std::optional<GazeUnits> units{};
  /// Seconds a unit of time, e.g. 0.001; absent: from the column's name, else 1.
  std::optional<double> time_scale_s{};
};

/// Reads a recording, recognised from its content.
///
/// TSV and CSV: the delimiter is found (tab, comma, semicolon); fields may be quoted. A first line
/// `# key=value ...` may carry screen_width_px screen_height_px screen_width_m screen_height_m
/// viewing_distance_m sampling_Hz units. An empty field, ".", NaN, NA, N/A, null is an absent
/// value. EyeLink ASC: any number of recording blocks; of two eyes the mean of those present; the
/// second of two equal integer stamps (2000 Hz) is half a millisecond later; samples between SBLINK
/// and EBLINK of every recorded eye are blinks. Its pupil has arbitrary units and so is absent.
///
/// @param fallback_screen  used, quantity by quantity, for what the file does not say of its screen
/// @return `screen` is always set, from file and fallback; time is the file's own clock in seconds;
///   at least two samples
/// @throws InputError on unreadable, binary or empty files, unknown columns, fields that are not
///   numbers, time that does not increase, a rate outside 5 to 20,000 Hz, lines over 64 KiB
GazeTrace readTrace(const std::filesystem::path& file, const TraceColumns& columns,
                    const Screen& fallback_screen);

}  // namespace foci
