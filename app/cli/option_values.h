// Values of options that several sub-commands take.
#pragma once

#include <glm/glm.hpp>
#include <string>

namespace CLI {
class App;
}

namespace foci {

/// A distance as dioptres: metres, 0.01 or more, or "inf". @throws InputError
double vergenceOf_D(const std::string& option, const std::string& text);

/// @throws InputError if the user gave an option of `command` an empty value
void refuseEmptyValues(const CLI::App& command);

/// Adds --threads N.
void addThreadsOption(CLI::App& command, std::string& threads, const char* help);

/// Adds --overwrite.
void addOverwriteFlag(CLI::App& command, bool& overwrite);

/// The value of --threads; if `threads` is empty, the number that TBB uses now. @throws InputError
unsigned threadsOf(const std::string& threads);

}  // namespace foci
