// The meaning of each column in a table of gaze, recognised from the columns' names.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/sources/row_groups.h"
#include "gaze/sources/rows.h"
#include "gaze/sources/space_layout.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

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
  std::array<std::optional<std::size_t>, 3> origin_mm{}, direction{}, sight_mm{};  ///< x, y, z
  std::optional<std::size_t> origin_point_mm{}, sight_point_mm{};  ///< or in one field, "(x, y, z)"
  std::optional<std::size_t> origin_validity{};
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

/// How to read the numbers, as the study says: see `TraceColumns`.
struct TableNumbers {
  std::optional<double> missing{};
  glm::dvec2 scale{1.0}, offset{0.0};
  double pupil_scale_mm = 1.0;
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
  std::optional<std::size_t> width_px{}, height_px{};  ///< of the screen, repeated on every row
  std::optional<std::size_t> resolution{};             ///< the same in one field, "1920 x 1080"
  SampleRows rows{};
  std::optional<GazeUnits> units{};  ///< from the columns' names
  bool y_up = false;                 ///< fractions count from the bottom-left corner (Pupil Core)
  bool size_off_is_absent = false;   ///< the point (-width, -height) means data loss (Tobii Studio)
  bool of_scene_camera = false;      ///< of a camera on the head (Pupil Core, Neon)
  bool camera_axes = false;          ///< origins and directions have y down, z forward (Pupil Core)
  bool sights_beside = false;        ///< directions are not the gaze: axes of the eyes (Neon)
  bool zero_is_absent = false;       ///< the point (0, 0) means data loss (SMI, Tobii Studio)
  bool named_blink = false;          ///< `blink` holds the blink's number, or nothing (Neon)
  TableNumbers numbers{};
  RowGroups groups{};
  std::vector<std::size_t> gaze_columns{}, rated_columns{};  ///< `gazeColumnsOf`
  std::optional<SpaceLayout> space{};     ///< gaze in space; then there are no points
  std::vector<ColumnReading> readings{};  ///< of every column
  std::string unused_validity{};          ///< a column that seems to mark data loss; empty: none
  bool headless = false;                  ///< the first line is a row, not a header
  std::size_t names = 0;                  ///< number of columns in the header
  std::size_t columns = 0;                ///< number of columns up to the last one in use

  /// No vendor's format.
  bool isPlain() const {
    return format.starts_with("TSV") || format.starts_with("CSV") || format.starts_with("text");
  }
  /// Directions that are the gaze.
  bool hasDirections() const {
    return !sights_beside && (eyes[0].direction[0] || eyes[1].direction[0]);
  }
  /// Whether a column has a meaning.
  bool uses(std::size_t column) const;
};

/// @param rows  at the names, before the first row
/// @throws InputError if a column is not found; it names the nearest one
TableLayout recogniseTable(Rows& rows, const TraceColumns& columns);

}  // namespace foci
