// What is wrong with a command line, in one line.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace foci {

/// Of a command line that CLI11 refused: the first unknown command or option, with the nearest
/// known one, or CLI11's message if all are known. With the words that ask for the command's help.
std::string usageError(const CLI::App& app, int argc, char** argv, std::string message);

}  // namespace foci
