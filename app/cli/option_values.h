// Values of options that several sub-commands take.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace foci {

/// A distance as dioptres: metres, 0.01 or more, or "inf". @throws InputError
double vergenceOf_D(const std::string& option, const std::string& text);

/// Adds an option that takes a value.
/// @param type  as the help shows the value, "FILE"
template <class Value>
CLI::Option* addOption(CLI::App& command, const char* name, Value& value, const char* type,
                       const char* help) {
  return command.add_option(name, value, help)->type_name(type);
}

/// Has `run` called once the command's options are known.
/// @throws InputError instead, while parsing, if the user gave an option an empty value
void onceParsed(CLI::App& command, const std::function<void()>& run);

/// Adds --overwrite.
void addOverwriteFlag(CLI::App& command, bool& overwrite);

/// The value of --threads; if `threads` is empty, the number that TBB uses now. @throws InputError
unsigned threadsOf(const std::string& threads);

}  // namespace foci
