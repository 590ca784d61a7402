// Whose rows a table holds: of several people, of one eye each, of other devices between the gaze.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/input_error.h"

namespace foci {

class ColumnNames;
class Rows;
struct TableLayout;
struct TraceColumns;

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

  bool isEmpty() const {
    return only.empty() && people.empty() && !eye && !device && !foreign_within &&
           !foreign_if_blank;
  }
};

/// Judges the first rows.
/// @param layout  with the columns' roles
RowGroups groupRows(Rows& rows, const ColumnNames& names, const TableLayout& layout,
                    const TraceColumns& columns);

/// Columns that a row of the eye tracker fills. @param with_validity  also those that rate gaze
std::vector<std::size_t> gazeColumnsOf(const TableLayout& layout, bool with_validity);

}  // namespace foci
