// Recorded gaze from files of the usual trackers, recognised from their content.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// What the two position columns hold.
///   px          from the screen's top-left corner, y down
///   deg         eccentricity from the screen's centre, y up: atan(offset_m / distance_m) along
///   each axis normalised  fractions of the screen, (0, 0) its top-left and (1, 1) its bottom-right
///   corner
enum class GazeUnits { px, deg, normalised };

/// Which columns of a table to read, by name, or by number ("#1" is the first), which a table
/// without a header line needs. What is empty is recognised by the usual names ("time_s",
/// "timestamp", "x_px", "gaze_x", "x_deg", ...). EyeLink files need none of this and ignore it.
struct TraceColumns {
  /// Of one eye: both of the point, or neither.
  struct Eye {
    std::string x{}, y{}, pupil{};
  };

  std::string time{}, x{}, y{};
  std::string pupil{};        ///< diameter
  std::string blink{};        ///< 0 or false: open; 1 or true: the tracker saw a blink
  std::string confidence{};   ///< 0 to 1; below 0.6 there is no gaze
  std::array<Eye, 2> eyes{};  ///< left, right; without `x` and `y` the gaze is `Cyclopean` of them
  /// Absent: from the file's first line or the columns' names, else px.
  std::optional<GazeUnits> units{};
  /// Seconds a unit of time, e.g. 0.001; absent: from the column's name, else the one of 1, 1e-3,
  /// 1e-6 and 1e-9 that gives the rate of a tracker.
  std::optional<double> time_scale_s{};
  /// Samples a second of a table that has no column of time; absent: what its first line says.
  std::optional<double> rate_Hz{};
  /// The number that stands for no position or no pupil, as -1 or 0.
  std::optional<double> missing{};
  /// Position in `units` = scale * column + offset.
  glm::dvec2 scale{1.0}, offset{0.0};
  double pupil_scale_mm = 1.0;  ///< millimetres a unit of the pupils' columns

  bool namesEye(std::size_t side) const {
    return !eyes[side].x.empty() || !eyes[side].y.empty() || !eyes[side].pupil.empty();
  }
};

/// What a recording says besides its samples.
struct TraceHeader {
  std::string format{};            ///< as `GazeTrace::format`
  std::optional<Screen> screen{};  ///< what is known of it; from the fallback what the file lacks
};

using TakeSample = std::function<void(const GazeSample&)>;

/// Reads a recording sample by sample, in constant memory.
///
/// Recognised are EyeLink ASC; Tobii Pro Lab TSV and Pro SDK CSV; Pupil Core (gaze_positions.csv)
/// and Neon (gaze.csv); GazeBase and GazeBaseVR; SMI BeGaze text; BIDS eye tracking
/// (`*_physio.tsv.gz` beside its JSON); and any TSV or CSV with named columns, of one point or of
/// two eyes. Delimiters are found (tab, comma, semicolon, blanks); fields may be quoted; files may
/// be gzipped. A first line `# key=value ...` may carry screen_width_px screen_height_px
/// screen_width_m screen_height_m viewing_distance_m sampling_Hz units. An empty field, ".", NaN,
/// NA, N/A, null is an absent value.
///
/// `GazeSample::point_px` is the recording's own point for both eyes, else `Cyclopean` of the two.
/// Degrees where no screen is known are put on a nominal one. EyeLink: the second of two equal
/// integer stamps (2000 Hz) is half a millisecond later; a blink of one eye is one of both unless
/// it lasts over a second; the pupil has arbitrary units and so is absent. Pupil Core: the point is
/// where the mean of the two lines of sight meets the screen; samples of a confidence below 0.6
/// have none.
/// @throws InputError on unreadable, binary or empty files, unknown columns, fields that are not
///   numbers, time that does not increase, lines over 64 KiB
TraceHeader streamTrace(const std::filesystem::path& file, const TraceColumns& columns,
                        const Screen& fallback_screen, const TakeSample& take);

/// The whole of a recording.
/// @param rate_Hz  absent: from the median of the times, which says nothing where they are those
///   of arrival
/// @return `screen` is always set, from file and fallback; time is the file's own clock in seconds;
///   at least two samples
/// @throws InputError as `streamTrace`, and where no sample has a position, or the rate is outside
///   5 to 20,000 Hz
GazeTrace readTrace(const std::filesystem::path& file, const TraceColumns& columns,
                    const Screen& fallback_screen, std::optional<double> rate_Hz = {});

}  // namespace foci
