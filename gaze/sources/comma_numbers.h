// The commas in the numbers of a table: decimal ones, as is usual in many countries, or separators
// of thousands.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "gaze/sources/line_reader.h"

namespace foci {

class CommaNumbers {
 public:
  /// @param delimiter  between the fields; if it is a comma, no number has one
  explicit CommaNumbers(char delimiter) : decimal_allowed_(delimiter != ',') {}

  /// A number with a decimal point or a decimal comma.
  std::optional<double> parse(std::string_view text);

  /// Notes whether the column of x (axis 0) or y (axis 1) has separators of thousands.
  /// @param text  that `parse` has read as `number`
  void note(const Place& place, std::size_t column, std::string_view text, std::size_t axis,
            double number);

  /// The first number with a decimal comma; empty if there was none.
  /// @throws InputError if the commas may separate thousands
  const std::string& example() const;

 private:
  bool decimal_allowed_;
  std::string example_{};
  bool decimal_ = false;  // a comma that cannot separate thousands
  // Along x and y: the first number such as "1,271", and whether others reach 100 without a comma.
  std::array<std::optional<InputError>, 2> thousands_{};
  std::array<bool, 2> plain_{};
};

}  // namespace foci
