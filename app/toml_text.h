// The text of a TOML file, fit to be parsed.
#pragma once

#include <filesystem>
#include <string>

namespace foci {

/// @throws InputError for what cannot be read, is no text, or would exhaust the parser: over 4 MiB,
///   lines over 2000 bytes, values nested over 16 deep, strings of several lines
std::string readTomlText(const std::filesystem::path& path);

}  // namespace foci
