// The meaning of each column in a table of gaze, recognised from the columns' names.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_error.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/rows.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

class ColumnNames;
class TableRow;

// Gaze in space: the columns of a table that hold lines of sight and head poses, and the sample in
// one of its rows.

template <std::size_t N>
using ColumnsAt = std::optional<std::array<std::size_t, N>>;

/// Columns of one line of sight, counted from 0. See `SightColumns`.
struct SightAt {
  ColumnsAt<3> direction{}, point{}, origin{};
  ColumnsAt<2> angles{};
  ColumnsAt<4> quaternion{};
  std::optional<std::size_t> validity{};

  bool hasSight() const { return direction || point || angles || quaternion; }
};

struct SpaceLayout {
  SightAt both{};
  std::array<SightAt, 2> eyes{};  ///< left, right
  ColumnsAt<3> head_position{};
  ColumnsAt<4> head_quaternion{};
  ColumnsAt<3> head_angles{}, head_euler{};
  std::array<std::size_t, 3> euler_order{1, 0, 2};  ///< axes in the order of their turns
  bool from_head = false;                           ///< the head's direction replaces gaze
  AxisConvention axes{}, head_axes{};  ///< of gaze, of the head; a study states one for both
  bool in_world = false;               ///< the frame of the gaze columns; else the head's
  double origin_scale_m = 1.0, head_scale_m = 1.0;
  double angle_scale_rad = 1.0, head_angle_scale_rad = 1.0;
  /// The tangents of `angles` are the first and second part of the direction, in `axes`, over its
  /// third one (Project Aria).
  bool tangents = false;
  std::optional<std::size_t> depth_m{};  ///< of the point that both eyes look at along `both`
  glm::dvec2 scale{1.0}, offset{0.0};    ///< of angles, in their unit

  bool hasSight() const { return both.hasSight() || eyes[0].hasSight() || eyes[1].hasSight(); }
  bool hasHead() const { return head_quaternion || head_angles || head_euler; }
};

/// Finds the columns that a study names.
/// @throws InputError if one is missing, or if the study leaves open a frame or axes that the
///   result depends on
SpaceLayout spaceLayoutOf(const Place& place, const ColumnNames& names,
                          const SpaceColumns& columns);

/// Finds the head's columns that a study names, beside gaze in the head's frame.
/// @throws InputError as `spaceLayoutOf`
void takeHead(const Place& place, const ColumnNames& names, const SpaceColumns& columns,
              SpaceLayout& layout);

/// @throws InputError if the study states none
AxisConvention axesOf(const Place& place, const SpaceColumns& columns);

/// Reads head pose, origins and directions into a sample, in the head's frame. A vector or
/// quaternion of zeros, or with an absent field, is absent. The sample's own direction is that of
/// both eyes' column, else the mean of the eyes'. With a depth, both eyes look at that point.
/// @throws InputError for text, a quaternion or direction whose length is not 1, or an angle that
///   no eye has
void readSpace(const TableRow& row, const SpaceLayout& layout, GazeSample& sample);

/// The head stays where it is.
void loseGaze(GazeSample& sample);

/// The mean of the eyes' directions, or the one that there is.
std::optional<glm::dvec3> meanDirection(const std::array<EyeSample, 2>& eyes);

// All columns of a table.

/// The value that marks an eye as seen.
enum class ValidityCode {
  one,        ///< 1 (Tobii Pro SDK)
  zero,       ///< 0 (GazeBase)
  not_zero,   ///< any number but 0 (Neon's and Pupil Invisible's `worn`)
  gaze_bits,  ///< a bit field: 1 for the origin and 2 for the direction (SRanipal)
  below_two   ///< the word Valid, or 0 and 1 of Tobii Studio's 0 to 4
};

/// Columns of one eye, counted from 0.
struct EyeColumns {
  std::optional<std::size_t> x{}, y{};  ///< of the point
  std::optional<std::size_t> point{};   ///< or both coordinates in one field, "(x, y)"
  std::optional<std::size_t> validity{}, pupil_mm{}, pupil_own{};
  ColumnsAt<3> origin_mm{}, direction{}, sight_mm{};               ///< x, y, z
  std::optional<std::size_t> origin_point_mm{}, sight_point_mm{};  ///< or in one field, "(x, y, z)"
  std::optional<std::size_t> origin_validity{};

  bool operator==(const EyeColumns&) const = default;
};

/// Which rows of a table are samples: all without a column.
struct SampleRows {
  std::optional<std::size_t> column{};
  std::string only{};    ///< the field has this word; empty: any text
  std::string except{};  ///< the field has not this word

  bool has(std::string_view field) const {
    return only.empty() ? !field.empty() && (except.empty() || field != except) : field == only;
  }
};

/// A table holds rows of several people, and the study chooses none.
struct SeveralPeople : InputError {
  SeveralPeople(const std::string& source, std::string of_column, std::vector<std::string> all);

  std::string column;               ///< that tells them apart
  std::vector<std::string> values;  ///< of it, in order of appearance
};

/// A column of few values.
struct ValueColumn {
  std::size_t at = 0;
  std::vector<std::string> values{};
};

struct RowGroups {
  std::vector<ValueColumn> only{};      ///< as gaze.rows says: one value each
  std::vector<std::size_t> people{};    ///< another value is another person, or another recording
  std::optional<std::size_t> eye{};     ///< which eye a row is of
  std::array<std::string, 2> eyes{};    ///< its values: left, right
  std::optional<ValueColumn> device{};  ///< a row without gaze and of no such value is foreign
  /// Rows without gaze come between the samples, which are so far apart, in the file's unit of time
  std::optional<double> foreign_within{};
  bool foreign_if_blank = false;  ///< data loss has a validity, a foreign row has none
  double eye_interval = 0.0;      ///< between rows of one eye, in the file's unit of time
  bool eyes_assumed = false;      ///< the values are numbers
  /// Unused columns of few values: where one changes, another recording may begin
  std::vector<std::size_t> watched{};

  bool isEmpty() const {
    return only.empty() && people.empty() && !eye && !device && !foreign_within &&
           !foreign_if_blank && watched.empty();
  }
};

/// What a column holds.
struct ColumnRole {
  enum class Kind { other, gaze, rating };  ///< gaze; what rates it

  std::size_t column = 0;
  std::string meaning{};  ///< for people
  Kind kind = Kind::other;
};

struct TableLayout {
  std::string format;                 ///< "TSV", "Tobii Pro SDK", ...
  std::optional<std::size_t> time{};  ///< absent: the row's number gives the time
  /// Microseconds of the tracker's clock, beside a time in whole milliseconds (Tobii).
  std::optional<std::size_t> fine_time{};
  double rate_Hz = 0.0;       ///< rows per second, without `time`
  double time_scale_s = 0.0;  ///< seconds per unit of time; 0: unknown
  std::optional<std::size_t> x{}, y{};
  std::array<EyeColumns, 2> eyes{};  ///< left, right
  bool has_eyes = false;             ///< the table has any column of either eye
  std::optional<std::size_t> pupil_mm{}, pupil_own{}, blink{}, confidence{}, validity{},
      uncertainty_deg{};
  std::string pupil_unit{};  ///< of `pupil_own`
  ValidityCode validity_code = ValidityCode::below_two;
  std::string validity_note{};  ///< why `validity_code` is not the format's; empty: it is
  std::optional<std::size_t> width_px{}, height_px{};  ///< of the screen, repeated on every row
  std::optional<std::size_t> resolution{};             ///< the same in one field, "1920 x 1080"
  SampleRows rows{};
  std::optional<GazeUnits> units{};  ///< from the columns' names
  double scale = 1.0;                ///< `units` per unit of the columns
  std::string unknown_unit{};        ///< the column of x, if its name has one
  bool y_up = false;                 ///< fractions count from the bottom-left corner (Pupil Core)
  bool size_off_is_absent = false;   ///< the point (-width, -height) means data loss (Tobii Studio)
  bool of_scene_camera = false;      ///< of a camera on the head (Pupil Core, Neon, glasses)
  bool camera_axes = false;          ///< origins and directions have y down, z forward (Pupil Core)
  bool sights_beside = false;        ///< directions are not the gaze: axes of the eyes (Neon)
  bool zero_is_absent = false;       ///< the point (0, 0) means data loss (SMI, Tobii Studio)
  bool named_blink = false;          ///< `blink` holds the blink's number, or nothing (Neon)
  std::optional<double> missing{};   ///< the number that means "no position" or "no pupil"
  RowGroups groups{};
  std::vector<ColumnRole> roles{};        ///< of the columns above; the first one of a column holds
  std::optional<SpaceLayout> space{};     ///< gaze in space; then there are no points
  std::vector<ColumnReading> readings{};  ///< of every column
  std::string lacks{};            ///< a column that the vendor's complete tables have; empty: none
  std::string unused_validity{};  ///< a column that seems to mark data loss; empty: none
  std::string unused_gaze{};      ///< one that seems to be gaze, beside a plain "x"; empty: none
  std::string doubtful_pupil{};   ///< the study's, if its name is of no diameter in mm; else empty
  bool headless = false;          ///< the first line is a row, not a header
  std::size_t names = 0;          ///< number of columns in the header
  std::size_t columns = 0;        ///< number of columns up to the last one in use

  /// No vendor's format.
  bool isPlain() const {
    return format.starts_with("TSV") || format.starts_with("CSV") || format.starts_with("text");
  }
  /// Directions that are the gaze.
  bool hasDirections() const { return !sights_beside && (eyes[0].direction || eyes[1].direction); }
  /// Whether a column has a role.
  bool uses(std::size_t column) const;
  /// Whether the latest row has gaze. @param with_rating  or what rates it
  bool isFilled(const Rows& row, bool with_rating) const;
};

/// Sets what a vendor's table of gaze in space says: its name, lines of sight, pupils and, unless
/// the study names it, the time.
/// @return false for a table of no such vendor
bool takeSpaceVendor(const ColumnNames& names, const TraceColumns& given, TableLayout& layout);

/// What the columns hold, as far as the layout says.
std::vector<ColumnRole> rolesOf(const TableLayout& layout, const TraceColumns& given);

/// A column that the study names is as the study says. Of the others, a format's own columns are
/// sure, a name with its unit is likely, and a name without one is a guess.
std::vector<ColumnReading> readingsOf(const ColumnNames& names, const TableLayout& layout);

/// Whose rows the table holds, judged by the first ones.
/// @param layout  with the columns' roles
RowGroups groupRows(Rows& rows, const ColumnNames& names, const TableLayout& layout,
                    const TraceColumns& columns);

/// Sets what a vendor's format says beyond its columns' names: its own name, units, the code for
/// data loss, and which rows are samples. Changes nothing for a table of no known vendor.
/// @param layout  with the columns of time, point and eyes
void takeVendorFormat(const ColumnNames& names, const TraceColumns& columns,
                      const TablePreamble& before, TableLayout& layout);

/// Sets the code of validity that the first rows show, where it is not the format's: eyes are valid
/// where they have positions, and one position is a code for data loss.
/// @param layout  with the vendor's code
void judgeValidity(Rows& rows, TableLayout& layout);

/// Whether a table of Tobii Pro Lab is of glasses: by columns that those of screens
/// lack, or in the frame of the head unit (HUCS).
bool isOfProGlasses(const ColumnNames& names);

/// A log of PyTribe, or of another program for The Eye Tribe.
bool isEyeTribe(const ColumnNames& names);

/// Whether the table is of Tobii Studio, which writes names without blanks. Pro Lab writes blanks.
bool isTobiiStudio(const ColumnNames& names, const TablePreamble& before);

/// @param rows  at the names, before the first row
/// @throws InputError if a column is not found; it names the nearest one
TableLayout recogniseTable(Rows& rows, const TraceColumns& columns);

}  // namespace foci
