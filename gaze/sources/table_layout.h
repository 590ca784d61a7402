// Which column of a table of gaze means what, recognised from its names.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/sources/line_reader.h"
#include "gaze/sources/table_preamble.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// How a column says that an eye was seen.
enum class ValidityCode {
  one,       ///< 1 (Tobii's SDK)
  zero,      ///< 0 (GazeBase)
  below_two  ///< the word Valid, or 0 and 1 of Tobii Studio's 0 to 4
};

struct EyeColumns {
  std::optional<std::size_t> x{}, y{};  ///< of the point
  std::optional<std::size_t> point{};   ///< or both in one field, "(x, y)"
  std::optional<std::size_t> validity{}, pupil_mm{};
  std::array<std::optional<std::size_t>, 3> origin_mm{}, direction{};  ///< x, y, z
  std::optional<std::size_t> origin_point_mm{}, sight_point_mm{};  ///< "(x, y, z)" (Tobii's SDK)
  std::optional<std::size_t> origin_validity{};
};

/// Of the columns that a study names: how to read their numbers.
struct TableNumbers {
  std::optional<double> missing{};
  glm::dvec2 scale{1.0}, offset{0.0};
  double pupil_scale_mm = 1.0;
};

struct TableLayout {
  std::string format;  ///< "TSV", "Tobii Pro SDK", ...
  char delimiter = ',';
  std::optional<std::size_t> time{};  ///< absent: the rows are counted
  double rate_Hz = 0.0;               ///< of these
  double time_scale_s = 0.0;          ///< seconds a unit; 0: not said
  std::optional<std::size_t> x{}, y{};
  std::array<EyeColumns, 2> eyes{};  ///< left, right
  bool has_eyes = false;             ///< any column of either
  std::optional<std::size_t> pupil_mm{}, blink{}, confidence{}, validity{};
  ValidityCode validity_code = ValidityCode::below_two;
  std::optional<std::size_t> width_px{}, height_px{};  ///< of the screen, on every row
  std::optional<std::size_t>
      kind{};  ///< rows that have another word than `sample_kind` are no samples
  std::string sample_kind{};
  std::optional<GazeUnits> units{};  ///< as the columns' names say
  bool y_up = false;                 ///< the fractions' origin is the bottom-left corner (Pupil)
  bool camera_axes = false;          ///< of origin and direction: y down, z forward (Pupil)
  bool zero_is_absent = false;       ///< a point of 0, 0 is none (SMI)
  bool named_blink = false;          ///< `blink` holds the blink's number, or nothing (Neon)
  TableNumbers numbers{};
  bool headless = false;    ///< the line of names is a row already
  std::size_t columns = 0;  ///< that must be split

  bool hasDirections() const { return eyes[0].direction[0] || eyes[1].direction[0]; }
};

/// @param lines   stands at the header, for errors
/// @param header  the line of names
/// @param before  what the lines before it say
/// @throws InputError where time or positions are not found, naming the nearest column
TableLayout recogniseTable(const LineReader& lines, std::string_view header,
                           const TraceColumns& columns, const TablePreamble& before);

}  // namespace foci
