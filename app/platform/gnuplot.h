// Runs gnuplot, if it is installed.
#pragma once

#include <optional>
#include <string>

namespace foci {

/// A chart, or why there is none: a chart never costs the result that it shows.
struct GnuplotChart {
  std::optional<std::string> image = {};  ///< gnuplot's standard output, not empty
  std::string problem = {};               ///< one line
};

/// Runs gnuplot on a script, without the user's own settings and without files.
GnuplotChart runGnuplot(const std::string& script);

/// An expression of gnuplot's language for this text, with control characters as escapes. Its
/// strings are in single quotes: in double ones gnuplot runs what stands between backquotes.
std::string gnuplotString(const std::string& text);

}  // namespace foci
