// TOML from outside, read by toml11. Text that would break the parser is refused first. Private:
// toml11 is heavy to compile.
#pragma once

#include <filesystem>
#include <string>
#include <toml.hpp>

namespace foci {

/// @param where what messages call the text: a file, an option
/// @throws InputError naming the line, for what is not TOML, and for what would break the parser:
///   bytes that are not UTF-8, NUL, values or keys nested over 16 deep, strings of several lines
toml::value parseToml(const std::string& text, const std::string& where);

/// @throws InputError as `parseToml`, and where the file cannot be read, is no regular file or is
///   larger than 4 MiB
toml::value readToml(const std::filesystem::path& path);

}  // namespace foci
