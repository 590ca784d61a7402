// Reading recordings of gaze. The format of a file is recognised from its content.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Turns vectors of another program's frame into foci's: x right, y up, looking along -z.
///   p = M p',  R = M R' M^T
/// The columns of M are where x', y' and z' point. M of a left-handed frame has determinant -1.
class AxisConvention {
 public:
  /// foci's own axes: "right-up-back", as in OpenXR, OpenGL and Tobii's user coordinates.
  AxisConvention() = default;

  /// @param text  where x, y and z point, e.g. "right-up-forward" (Unity, left-handed)
  /// @return nothing unless the three are of right/left, up/down and forward/back, one each
  static std::optional<AxisConvention> named(std::string_view text);

  glm::dvec3 vector(const glm::dvec3& p) const { return from_other_ * p; }
  /// @param q  unit
  glm::dquat rotation(const glm::dquat& q) const;

 private:
  glm::dmat3 from_other_{1.0};
};

/// What `AxisConvention::named` takes, for messages.
inline constexpr std::string_view kAxesExpected =
    "where x, y and z point: \"right-up-back\" (OpenXR, OpenGL), \"right-up-forward\" (Unity), "
    "\"right-down-forward\" (OpenCV), \"forward-left-up\" (ROS), or other such words";

/// The rates of eye trackers.
inline constexpr double kMinRate_Hz = 5.0, kMaxRate_Hz = 20'000.0;

/// Positions farther from the screen's corner are errors in the file, not gaze.
inline constexpr double kFarthestGaze_px = 1e5;

/// Unit of the two columns of a position.
enum class GazeUnits {
  px,   ///< pixels from the screen's top-left corner, y down
  deg,  ///< eccentricity from the screen's centre, y up: atan(offset_m / distance_m), each axis
  normalised,  ///< fractions of the screen; (0, 0) is the top-left corner, (1, 1) the bottom-right
               ///< one
  relative     ///< uncalibrated, of unknown scale: `readTrace` gives them the extent of a screen
};

/// Columns' names, all or none of them empty.
template <std::size_t N>
using ColumnList = std::array<std::string, N>;

/// The frame of the gaze columns.
enum class SightFrame { head, world };

enum class AngleUnit { deg, rad };

/// Columns of one line of sight. Name at most one of direction, angles, quaternion and point.
struct SightColumns {
  ColumnList<3> direction{};  ///< x, y, z
  /// Horizontal, to the right; vertical, upwards. The vertical angle is measured from the
  /// horizontal plane (Fick): d = (sin h cos v, sin v, -cos h cos v).
  ColumnList<2> angles{};
  ColumnList<4> quaternion{};  ///< x, y, z, w; turns the forward axis to the line of sight
  ColumnList<3> point{};       ///< a point in space that the eye looks at
  ColumnList<3> origin{};      ///< of the line of sight

  bool hasSight() const {
    return !direction[0].empty() || !angles[0].empty() || !quaternion[0].empty() ||
           !point[0].empty();
  }
};

/// Gaze in space, as a study describes the columns of a table. See `TraceColumns`.
struct SpaceColumns {
  SightColumns both{};                 ///< of both eyes together
  std::array<SightColumns, 2> eyes{};  ///< left, right
  ColumnList<3> head_position{};
  ColumnList<4> head_quaternion{};  ///< x, y, z, w; turns the head's axes to the world's
  /// To the right, upwards, and clockwise for the observer, turned in this order: about the
  /// upward axis of the world, then about the head's own axes.
  ColumnList<3> head_angles{};
  /// About the recording's own x, y and z, in the sense of its axes, as Unity's `eulerAngles`.
  ColumnList<3> head_euler{};
  std::string head_euler_order = "yxz";  ///< of the turns about the head's own axes
  bool from_head = false;                ///< the head's forward direction replaces gaze
  std::optional<SightFrame> frame{};     ///< needed with a head pose
  std::optional<std::string> axes{};     ///< as `AxisConvention::named` takes it; needed
  double origin_scale_m = 1.0;           ///< metres per unit of origins and points
  double head_scale_m = 1.0;             ///< metres per unit of the head's position
  AngleUnit angle_units = AngleUnit::deg;

  bool hasHead() const {
    return !head_quaternion[0].empty() || !head_angles[0].empty() || !head_euler[0].empty();
  }
  bool hasSight() const { return both.hasSight() || eyes[0].hasSight() || eyes[1].hasSight(); }
};

/// Straight ahead of a head.
inline constexpr glm::dvec3 kStraightAhead{0.0, 0.0, -1.0};

/// Whether each of x, y and z is named once.
bool isEulerOrder(std::string_view order);

/// Turns the recording's world into the scene's: p_scene = offset + scale R p.
struct SceneAlignment {
  glm::dvec4 rotation{0.0, 0.0, 0.0, 1.0};  ///< R as a quaternion x, y, z, w; any length but 0
  double scale = 1.0;
  glm::dvec3 offset_m{0.0};
};

/// The columns of a table, by name, or by number ("#1" is the first). A table without a header line
/// needs numbers. Columns left empty are recognised by their usual names ("time_s", "timestamp",
/// "x_px", "gaze_x", "x_deg", ...). EyeLink files ignore these settings.
struct TraceColumns {
  /// Columns of one eye. Name both x and y, or neither.
  struct Eye {
    std::string x{}, y{}, pupil{};
  };

  std::string time{}, x{}, y{};
  std::string pupil{};  ///< diameter
  std::string blink{};  ///< 0 or false: open; 1 or true: the tracker reports a blink
  /// Columns and their values: only such rows are read. Needed for a table of several people.
  std::vector<std::pair<std::string, std::string>> rows{};
  std::string stream{};      ///< of an XDF file; empty: its only stream of gaze
  std::string confidence{};  ///< 0 to 1; a sample below 0.6 has no gaze
  /// Left, right. Without `x` and `y` the gaze is the `Cyclopean` point of the two.
  std::array<Eye, 2> eyes{};
  /// Absent: from the file's first line or the columns' names, else px.
  std::optional<GazeUnits> units{};
  /// Seconds per unit of time, e.g. 0.001. Absent: from the column's name. If the name has no unit,
  /// the one of 1, 1e-3, 1e-6 and 1e-9 that gives the rate of a tracker.
  std::optional<double> time_scale_s{};
  /// Sampling rate of a table without a column of time. Absent: from the file's first line.
  std::optional<double> rate_Hz{};
  /// The number that means "no position" or "no pupil", such as -1 or 0.
  std::optional<double> missing{};
  /// Position in `units` = scale * column + offset.
  glm::dvec2 scale{1.0}, offset{0.0};
  double pupil_scale_mm = 1.0;  ///< millimetres per unit of the pupils' columns
  SpaceColumns space{};         ///< gaze in space, instead of positions on a screen
  /// Of a headset, for a recording with head poses. Absent: from the file, else a nominal one.
  std::optional<EyeField> field{};
  double pixels_per_degree = kHeadsetPixelsPerDegree;  ///< in the middle of a headset's display
  /// A gaze map turns the positions into pixels. Before that they may be of any kind.
  bool mapped_later = false;

  bool namesEye(std::size_t side) const {
    return !eyes[side].x.empty() || !eyes[side].y.empty() || !eyes[side].pupil.empty();
  }
};

/// How a column was understood, or several that belong together.
struct ColumnReading {
  std::string columns{};  ///< names, or numbers ("#1")
  std::string meaning{};  ///< with unit and frame; "unused"
  std::string why{};      ///< what makes it sure; empty for unused columns
};

/// What the tracker says of its calibration or of a validation.
struct TrackerCalibration {
  double time_s = 0.0;
  std::string kind{}, targets{}, eye{}, grade{};  ///< "validation", "HV9", "left", "good"
  std::optional<double> mean_deg{}, max_deg{};    ///< errors of a validation
};

/// The properties of a recording besides its samples. The fallback replaces missing quantities of
/// `screen`. With a `field`, it is that of both eyes (`headsetScreen`).
struct TraceHeader : TraceFacts {
  GazeUnits units = GazeUnits::px;       ///< of the file's positions
  std::vector<ColumnReading> columns{};  ///< of a table, in the file's order
  bool gaze_in_world = false;            ///< the frame of the file's directions; else the head's
  bool world_y_up = true;                ///< of the recording's world; false: unknown
  /// Degrees, fractions or lines of sight are put on this screen, because the real one is not
  /// stated. Its quantities mean nothing.
  bool nominal_screen = false;
  std::vector<TrackerCalibration> calibrations{};
};

using TakeSample = std::function<void(const GazeSample&)>;

/// Reads a recording sample by sample, in constant memory.
///
/// It recognises the formats of docs/recordings.md and docs/vr.md from the content, and reads any
/// TSV or CSV with named columns, with one point or two eyes.
///
/// A table is delimited by tabs, commas, semicolons or blanks. Fields may be quoted, and files may
/// be gzipped. A first line `# key=value ...` may contain screen_width_px screen_height_px
/// screen_width_m screen_height_m viewing_distance_m sampling_Hz units. Absent values are an empty
/// field, ".", "-", NaN, NA, N/A, null and none. Times are numbers, or dates and times of day
/// (`ClockTimes`). A first line `sep=;` states the separator. Lines between the rows that begin
/// with # are comments.
///
/// `GazeSample::point_px` is the recording's own point for both eyes, else the `Cyclopean` point.
/// Degrees without a known screen are put on a nominal screen.
///
/// EyeLink: the pupil has the tracker's own unit. At 2000 Hz two samples have the same time stamp;
/// the second one is put half a millisecond later. A blink of one eye counts for both, unless it
/// lasts more than a second.
///
/// Pupil Core: the point is where the mean of the two lines of sight meets the screen. Samples of a
/// confidence below 0.6 have no point.
/// Positions without a stated unit are pixels. Half of them within two pixels of the corner, and no
/// whole numbers, are refused as fractions.
/// @throws InputError on unreadable, binary or empty files, unknown columns, fields that are not
///   numbers, time that does not increase, and lines over 64 KiB
TraceHeader streamTrace(const std::filesystem::path& file, const TraceColumns& columns,
                        const Screen& fallback_screen, const TakeSample& take);

/// The files beside a recording that are read with it: sidecars of BIDS, scene_setting.csv.
std::vector<std::filesystem::path> companionsOf(const std::filesystem::path& file);

/// "EyeLink ASC", "BIDS"; nothing for a plain table and for what is no recording.
std::optional<std::string> recordingKindOf(const std::filesystem::path& file);

/// The people of a table, or its recordings: each as `TraceColumns::rows` chooses it. Empty for a
/// recording of one person, for another format, and for a file that cannot be read.
std::vector<std::pair<std::string, std::string>> peopleOf(const std::filesystem::path& file,
                                                          const TraceColumns& columns);

/// What a file of gaze in space says before it is read.
struct SpacePreview {
  bool has_head = false;                  ///< the samples have head poses
  std::optional<double> scene_scale_m{};  ///< as `GazeTrace::scene_scale_m`
};

/// Looks at the first line of a recording. A file that cannot be read has no head.
SpacePreview previewSpace(const std::filesystem::path& file, const TraceColumns& columns);

/// Reads a complete recording.
/// @param rate_Hz  absent: from the median interval. Give the rate if the file has times of
///   arrival, because the median of their intervals may differ from it.
/// @return at least two samples, on the file's own clock in seconds; `screen` is always set
/// @throws InputError as `streamTrace`, and if no sample has a position, or if the rate is outside
///   5 to 20,000 Hz
GazeTrace readTrace(const std::filesystem::path& file, const TraceColumns& columns,
                    const Screen& fallback_screen, std::optional<double> rate_Hz = {});

// Recordings whose samples human coders have labelled.

struct Coder {
  std::string name;  ///< name of the column
  /// One for each sample. Absent if the word is none of `nameOf`.
  std::vector<std::optional<GazeState>> labels{};
};

struct LabelledTrace {
  GazeTrace trace;
  std::vector<Coder> coders;  ///< one or more
};

/// Reads a table as `readTrace` does, with one column of labels for each coder. Such a column is
/// called coder, coder_NAME or label, and holds the words of `nameOf`.
/// @throws InputError as `readTrace`, and if there is no column of labels, or if a column has none
///   of those words
LabelledTrace readLabelledTrace(const std::filesystem::path& file, const Screen& fallback_screen,
                                const TraceColumns& described = {});

}  // namespace foci
