// Man pages and shell completions, from the same source as --help.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace foci {

/// A file of the manual: its path below the folder, and its text.
using ManualFile = std::pair<std::string, std::string>;

/// man1/foci.1, man1/foci-COMMAND.1 for each command, and completions for bash (foci), zsh (_foci)
/// and fish (foci.fish).
/// @param app  the whole command line
std::vector<ManualFile> manualOf(const CLI::App& app);

}  // namespace foci
