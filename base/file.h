// Whole files, written so that no reader meets half of one.
#pragma once

#include <filesystem>
#include <string>

namespace foci {

/// Writes a file aside, under a hidden name, and renames it: it is there whole or not at all.
/// @throws std::runtime_error
void replaceFile(const std::filesystem::path& path, const std::string& bytes);

/// Writes a whole text to a file. @throws std::runtime_error where it cannot be written in full
void writeText(const std::filesystem::path& path, const std::string& text);

}  // namespace foci
