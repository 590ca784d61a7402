// Mistyped commands and options: one line that names the nearest.
#pragma once

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace foci {

/// The first unknown command or option of a command line that CLI11 refused, with the nearest known
/// one; nothing if all are known.
std::optional<std::string> unknownWord(const CLI::App& app, int argc, char** argv);

}  // namespace foci
