// gnuplot, where it is installed.
#pragma once

#include <optional>
#include <string>

namespace foci {

/// Runs gnuplot on a script, without settings of the user's own.
/// @return its standard output, never empty; nothing where there is no gnuplot
/// @throws std::runtime_error where it fails
std::optional<std::string> runGnuplot(const std::string& script);

}  // namespace foci
