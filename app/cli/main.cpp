// `foci`: the command line (CLI11), and errors as one line with an exit code.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "app/cli/commands.h"
#include "app/platform/interrupt.h"
#include "app/platform/shell.h"
#include "app/platform/version.h"
#include "app/platform/warnings.h"
#include "base/input_error.h"
#include "base/mapped_file.h"
#include "base/nearest.h"
#include "base/text.h"
#include "base/transformed.h"
#include "render/literature/literature.h"

namespace foci {
namespace {

constexpr int kDone = 0, kFailed = 1, kBadInput = 2;

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
  const auto names = transformed(commandsOf(app), &CLI::App::get_name);
  const auto near = nearWord(word, names);
  return "unknown command " + shown(word) +
         (near ? ": did you mean " + *near + "?" : ": expected one of " + listed(names));
}

/// The first unknown option from `argv[i]` on; absent if all are known.
std::optional<std::string> unknownOption(const CLI::App& command, int i, int argc, char** argv) {
  const std::vector<std::string> known = optionsOf(command);
  for (; i < argc; ++i) {
    const std::string word = argv[i], name = word.substr(0, word.find('='));
    if (name == "--" || !name.starts_with("--")) continue;
    if (std::ranges::find(known, name) != known.end()) continue;
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

/// Of a command line that CLI11 refused: the first unknown command or option, with the nearest
/// known one, or CLI11's message if all are known. With the words that ask for the command's help.
std::string usageError(const CLI::App& app, int argc, char** argv, std::string message) {
  const CLI::App* at = &app;
  std::string path = "foci";
  const auto withHelp = [&](const std::string& error) { return error + " (" + path + " --help)"; };
  int i = 1;
  for (; i < argc && !commandsOf(*at).empty(); ++i) {
    const std::string_view word = argv[i];
    if (word.starts_with('-')) break;
    const auto commands = commandsOf(*at);
    const auto found = std::ranges::find_if(
        commands, [&](const CLI::App* one) { return one->check_name(std::string(word)); });
    if (found == commands.end()) return withHelp(unknownCommand(*at, argv[i]));
    at = *found;
    path += " " + at->get_name();
  }
  const auto unknown = unknownOption(*at, i, argc, argv);
  return withHelp(unknown ? *unknown : knownError(*at, std::move(message)));
}

std::string commandLineOf(int argc, char** argv) {
  std::string text = "foci";
  for (int i = 1; i < argc; ++i) text += " " + shellWord(argv[i]);
  return text;
}

int run(int argc, char** argv) {
  CLI::App app(
      "foci shows a scene as a human eye would focus it, following where the observer looks.\n"
      "Example: foci replay configs/demo.toml --out out/demo",
      "foci");
  app.set_version_flag("--version", "foci " + versionText());
  app.require_subcommand(1);
  const std::string command_line = commandLineOf(argc, argv);
  addReplayCommand(app, command_line);
  addRenderCommand(app);
  addLiveCommand(app, command_line);
  addCalibrateCommand(app);
  addChartCommand(app);
  addDoctorCommand(app);
  addEventsCommand(app);
  addEyeCommand(app);
  addFiguresCommand(app);
  addInfoCommand(app);
  addJoinCommand(app, command_line);
  addCompareCommand(app);
  addKeysCommand(app);
  addManualCommand(app);
  addMethodsCommand(app);
  addPrepareCommand(app);
  addReproduceCommand(app);
  addTraceCommand(app);
  addValidateCommand(app);
  addWebcamCommand(app);
  if (argc > 1 && std::string(argv[1]) == "__complete") {
    std::cout << completionsOf(app, {argv + 2, argv + argc});
    return kDone;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    throw InputError(usageError(app, argc, argv, error.what()));
  }
  return kDone;
}

/// @throws std::runtime_error if standard output took less than was printed
void finishOutput() {
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout) {
    throw std::runtime_error("standard output cannot be written: " +
                             std::generic_category().message(errno));
  }
}

}  // namespace
}  // namespace foci

int main(int argc, char** argv) {
  foci::quietLibraries();
  foci::endOnLostPages();
  foci::endCleanlyOnInterrupts();
  foci::registerLiterature();
  try {
    const int code = foci::run(argc, argv);
    foci::finishOutput();
    return code;
  } catch (const foci::InputError& error) {
    foci::say(error.what());
    return foci::kBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    foci::say(error.path1().string() + ": " + error.code().message());
    return foci::kFailed;
  } catch (const std::bad_alloc&) {
    std::fputs("foci: this input needs more memory than there is\n", stderr);
    return foci::kFailed;
  } catch (const std::exception& error) {
    foci::say(error.what());
    return foci::kFailed;
  }
}
