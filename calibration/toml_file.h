// TOML from outside, read by toml11. Text that would break the parser is refused first. Private:
// toml11 is heavy to compile.
#pragma once

#include <filesystem>
#include <string>
#include <toml.hpp>
#include <vector>

namespace foci {

/// The line that toml11 3 or 4 states; the first is 1.
template <class Location>
int lineIn(const Location& location) {
  if constexpr (requires { location.first_line_number(); }) {
    return static_cast<int>(location.first_line_number());
  } else {
    return static_cast<int>(location.line());
  }
}

/// A text as toml11 has parsed it. toml11 takes a time that grows with the square of a line's
/// length, so long lists were broken into lines before: `lineOf` undoes that.
struct TomlDocument {
  toml::value root;
  std::vector<int> lines = {};  ///< of the text, by line as parsed; empty: the same

  /// The line of the text where a value stands; the first is 1.
  int lineOf(const toml::value& value) const { return lineOf(lineIn(value.location())); }
  int lineOf(int parsed) const {
    return parsed >= 1 && parsed <= static_cast<int>(lines.size())
               ? lines[static_cast<std::size_t>(parsed) - 1]
               : parsed;
  }
  const toml::table& table() const { return root.as_table(); }
};

/// @param where what messages call the text: a file, an option
/// @throws InputError naming the line, for what is not TOML, and for what would break the parser:
///   bytes that are not UTF-8, NUL, values or keys nested over 16 deep, strings of several lines,
///   a table in braces or another part of a line over 16 KiB
TomlDocument parseToml(const std::string& text, const std::string& where);

/// @throws InputError as `parseToml`, and where the file cannot be read, is no regular file or is
///   larger than 4 MiB
TomlDocument readToml(const std::filesystem::path& path);

}  // namespace foci
