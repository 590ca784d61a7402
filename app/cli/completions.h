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

/// The first sentence of a command's description, for lists that have one line for each command.
std::string firstSentence(const std::string& description);

/// Each script offers commands, options, the keys after --set, and files for other values.
std::string bashCompletion(const CLI::App& app);
std::string zshCompletion(const CLI::App& app);
/// With the first sentence of each command, and the description of each option.
std::string fishCompletion(const CLI::App& app);

}  // namespace foci
