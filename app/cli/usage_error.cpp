#include "app/cli/usage_error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/nearest.h"
#include "base/text.h"

namespace foci {
namespace {

std::vector<const CLI::App*> commandsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Options by their long names, "--out".
std::vector<std::string> optionsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string unknownCommand(const CLI::App& app, const char* word) {
  std::vector<std::string> names;
  std::string all;
  for (const CLI::App* command : commandsOf(app)) {
    names.push_back(command->get_name());
    all += (all.empty() ? "" : ", ") + names.back();
  }
  const auto near = nearWord(word, names);
  return "unknown command " + shown(word) +
         (near ? ": did you mean " + *near + "?" : ": expected one of " + all);
}

/// The first unknown option from `argv[i]` on; absent if all are known.
std::optional<std::string> unknownOption(const CLI::App& command, int i, int argc, char** argv) {
  const std::vector<std::string> known = optionsOf(command);
  for (; i < argc; ++i) {
    const std::string word = argv[i], name = word.substr(0, word.find('='));
    if (name == "--" || !name.starts_with("--")) continue;
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto near = nearWord(name, known);
    return "unknown option " + shown(name) + (near ? ": did you mean " + *near + "?" : "");
  }
  return std::nullopt;
}

/// CLI11's message without line breaks, with what a study may be where it is missing.
std::string knownError(const CLI::App& command, std::string message) {
  for (char& c : message) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  if (message == "STUDY is required" && command.get_option_no_throw("--scene") != nullptr) {
    message += ": a study (TOML), or a scene, which needs no --scene";
  }
  return message;
}

}  // namespace

std::string usageError(const CLI::App& app, int argc, char** argv, std::string message) {
  const CLI::App* at = &app;
  std::string path = "foci";
  const auto withHelp = [&](const std::string& error) { return error + " (" + path + " --help)"; };
  int i = 1;
  for (; i < argc && !commandsOf(*at).empty(); ++i) {
    const std::string_view word = argv[i];
    if (word.starts_with('-')) break;
    const auto commands = commandsOf(*at);
    const auto found = std::find_if(commands.begin(), commands.end(), [&](const CLI::App* one) {
      return one->check_name(std::string(word));
    });
    if (found == commands.end()) return withHelp(unknownCommand(*at, argv[i]));
    at = *found;
    path += " " + at->get_name();
  }
  const auto unknown = unknownOption(*at, i, argc, argv);
  return withHelp(unknown ? *unknown : knownError(*at, std::move(message)));
}

}  // namespace foci
