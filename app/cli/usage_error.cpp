#include "app/cli/usage_error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
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

std::string unknownCommand(const CLI::App& app, const std::string& path, const char* word) {
  std::vector<std::string> names;
  std::string all;
  for (const CLI::App* command : commandsOf(app)) {
    names.push_back(command->get_name());
    all += (all.empty() ? "" : ", ") + names.back();
  }
  const auto near = nearWord(word, names);
  return "unknown command " + shown(word) +
         (near ? ": did you mean " + *near + "?" : ": expected one of " + all) + " (" + path +
         " --help)";
}

}  // namespace

std::optional<std::string> unknownWord(const CLI::App& app, int argc, char** argv) {
  const CLI::App* at = &app;
  std::string path = "foci";
  int i = 1;
  for (; i < argc && !commandsOf(*at).empty(); ++i) {
    const std::string_view word = argv[i];
    if (word.starts_with('-')) break;
    const auto commands = commandsOf(*at);
    const auto found = std::find_if(commands.begin(), commands.end(), [&](const CLI::App* one) {
      return one->check_name(std::string(word));
    });
    if (found == commands.end()) return unknownCommand(*at, path, argv[i]);
    at = *found;
    path += " " + at->get_name();
  }
  const std::vector<std::string> known = optionsOf(*at);
  for (; i < argc; ++i) {
    const std::string word = argv[i], name = word.substr(0, word.find('='));
    if (name == "--" || !name.starts_with("--")) continue;
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto near = nearWord(name, known);
    return "unknown option " + shown(name) + (near ? ": did you mean " + *near + "?" : "") + " (" +
           path + " --help)";
  }
  return std::nullopt;
}

}  // namespace foci
