// The names of a table's columns, without the differences in spelling between vendors.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/sources/line_reader.h"

namespace foci {

/// Whether a text, of words with blanks between them, has a word.
bool isWordOf(std::string_view words, std::string_view word);

/// "a", "b", "c"; the first six.
std::string listOf(const std::vector<std::string>& values);

/// The keys of one eye and one axis. In a pattern, EYE is "left" or "right", E is "l" or "r", and A
/// is the axis.
std::string keysOf(std::string_view pattern, std::size_t side, char axis = 'x');

/// The short form of a unit as vendors write it; empty for any other word.
/// @param word  in lower case
std::string shortUnit(std::string_view word);

/// The same for a text in brackets: the last word, or its end ("DACS px", "ADCSpx", "MCSnorm"), or
/// a visual angle.
std::string unitIn(std::string_view text);

/// Degrees in a unit of angle, as `unitIn` gives it; 0: it is none.
double degreesPer(std::string_view unit);

/// The names of a table's columns. Each name is split into a key and a unit:
/// "Gaze point X [DACS px]" has the key "gazepointx" and the unit "px".
class ColumnNames {
 public:
  /// @param place  for errors; outlives the object
  /// @param names  outlive the object
  /// @throws InputError with more than 4096 columns
  ColumnNames(const Place& place, const std::vector<std::string>& names);

  std::size_t size() const { return texts_.size(); }
  /// The name as the file has it.
  std::string_view text(std::size_t column) const { return texts_[column]; }
  /// Lower-case letters and digits alone, without the unit.
  const std::string& key(std::size_t column) const { return names_[column].key; }
  /// "s", "ms", "us", "ns", "min", "h", "px", "deg", "arcmin", "mrad", "rad", "norm", "%", "mm",
  /// "cm", "m" or empty. A name that contains "norm" has the unit "norm".
  const std::string& unit(std::size_t column) const { return names_[column].unit; }
  /// Words in brackets that may be another unit, or empty.
  const std::string& unknownUnit(std::size_t column) const { return names_[column].unknown_unit; }
  /// Of a time; 0: its unit is none.
  double secondsPerUnit(std::size_t column) const;
  /// Whether positions are lengths or per cent, which only gaze.scale converts.
  bool needsScale(std::size_t column) const { return isWordOf("mm cm m in %", unit(column)); }

  /// The column of the first key that the table has. @param keys  separated by blanks
  std::optional<std::size_t> find(std::string_view keys) const;

  /// The first column of such a key that may be a position on the screen: no length, no time, not
  /// on the presented media.
  std::optional<std::size_t> findPosition(std::string_view keys) const;

  /// The columns of x, y and z; nothing unless the table has all of them.
  /// @param pattern  of `keysOf`
  std::optional<std::array<std::size_t, 3>> findTriple(std::string_view pattern,
                                                       std::size_t side) const;

  /// The column with exactly this name, or with this number ("#1" is the first).
  /// @throws InputError that names the nearest column
  std::size_t at(const std::string& name) const;
  /// The same for a column of time, gaze or head: `isNamed` remembers it.
  std::size_t named(const std::string& name) const { return named_.emplace_back(at(name)); }
  bool isNamed(std::size_t column) const;

  /// @throws InputError if another column has the same name, so that the choice is ambiguous
  void refuseTwin(std::size_t column) const;

  enum class Meaning { time, x, y };

  /// The error for a column that was not found: it lists the columns that may be it, and says how
  /// to name one.
  /// @param keys  the usual ones
  InputError missing(Meaning meaning, std::string_view keys) const;

 private:
  struct Name {
    std::string key, unit, unknown_unit;
    bool of_media = false;
  };
  template <class Wanted>
  std::optional<std::size_t> findIf(std::string_view keys, const Wanted& wanted) const;
  std::string otherKind() const;
  bool mayBe(Meaning meaning, std::size_t column) const;
  static Name nameOf(std::string_view text);
  /// The nearest name, or all, as words of an error.
  std::string nearestTo(std::string_view wanted) const;
  template <class Wanted>
  std::string listed(const Wanted& wanted) const;

  const Place& place_;
  std::vector<std::string_view> texts_;
  std::vector<Name> names_{};
  mutable std::vector<std::size_t> named_{};
};

}  // namespace foci
