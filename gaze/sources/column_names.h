// The names of a table's columns, without the differences in spelling between vendors.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/sources/line_reader.h"

namespace foci {

/// The header line of a table. Each name is split into a key and a unit:
/// "Gaze point X [DACS px]" has the key "gazepointx" and the unit "px".
class ColumnNames {
 public:
  using Keys = std::span<const std::string_view>;

  /// @param lines   for errors; outlives the object
  /// @param header  outlives the object
  /// @throws InputError with more than 4096 columns
  ColumnNames(const LineReader& lines, std::string_view header, char delimiter);

  std::size_t size() const { return texts_.size(); }
  /// The name as the file has it.
  std::string_view text(std::size_t column) const { return texts_[column]; }
  /// Lower-case letters and digits alone, without the unit.
  const std::string& key(std::size_t column) const { return names_[column].key; }
  /// "s", "ms", "us", "ns", "px", "deg", "dva", "norm", "mm", "m" or empty.
  const std::string& unit(std::size_t column) const { return names_[column].unit; }

  /// The column of the first key that the table has.
  std::optional<std::size_t> find(Keys keys) const;
  std::optional<std::size_t> find(std::initializer_list<std::string_view> keys) const {
    return find(Keys(keys.begin(), keys.size()));
  }

  /// The column with exactly this name, or with this number ("#1" is the first).
  /// @throws InputError that names the nearest column
  std::size_t named(const std::string& name) const;

  /// `named` if there is a name, else `find`.
  /// @throws InputError that names the nearest column
  std::size_t require(const std::string& name, Keys keys) const;

 private:
  struct Name {
    std::string key, unit;
  };
  static Name nameOf(std::string_view text);
  std::string nearestTo(std::string_view wanted) const;

  const LineReader& lines_;
  std::vector<std::string_view> texts_{};
  std::vector<Name> names_{};
};

}  // namespace foci
