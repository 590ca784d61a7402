// Completions of the command line for bash, zsh and fish, from the options that CLI11 knows and the
// table of keys.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace foci {

std::vector<const CLI::App*> commandsByName(const CLI::App& app);

/// Each script offers commands, options, the keys after --set, and files for other values.
std::string bashCompletion(const CLI::App& app);
std::string zshCompletion(const CLI::App& app);
/// With the first line of each description.
std::string fishCompletion(const CLI::App& app);

}  // namespace foci
