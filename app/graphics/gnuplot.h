// Runs gnuplot, if it is installed.
#pragma once

#include <optional>
#include <string>

namespace foci {

/// Runs gnuplot on a script, without the user's own settings.
/// @return its standard output, not empty; nothing without gnuplot
/// @throws std::runtime_error if gnuplot fails
std::optional<std::string> runGnuplot(const std::string& script);

/// An expression of gnuplot's language for this text, with control characters as escapes. Its
/// strings are in single quotes: in double ones gnuplot runs what stands between backquotes.
std::string gnuplotString(const std::string& text);

}  // namespace foci
