// Completions of the command line for bash, zsh and fish, from the options that CLI11 knows and the
// table of keys.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace foci {

std::vector<const CLI::App*> commandsByName(const CLI::App& app);

/// The first sentence of a command's description, for lists that have one line for each command.
std::string firstSentence(const std::string& description);

/// What may stand at the last word, as `foci __complete WORD...` prints it for the shells: a line
/// "word<tab>help" for each command, option, value or key, or the one line ":files".
/// @param words  after "foci"; the last is what has been typed of the word, maybe nothing
std::string completionsOf(const CLI::App& app, const std::vector<std::string>& words);

/// Name and text of each shell's script, which asks `foci __complete`: foci (bash), _foci (zsh),
/// foci.fish.
std::array<std::pair<std::string, std::string>, 3> completionScripts();

}  // namespace foci
