// Words, small letters and numbers of a text from outside.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

/// In small letters, as far as they are ASCII.
char lowered(char c);
std::string lowered(std::string_view text);

/// What stands between blanks, or between other characters.
std::vector<std::string_view> wordsOf(std::string_view text, std::string_view between = " \t\r\n");

/// A decimal number that fills the word, "nan" and "inf" among them. One that a double does not
/// hold is infinite, or 0.
std::optional<double> numberOf(std::string_view word);

}  // namespace foci
