// `foci`: the command line (CLI11), and errors as one line with an exit code.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "app/cli/commands.h"
#include "app/cli/completions.h"
#include "app/cli/usage_error.h"
#include "app/platform/interrupt.h"
#include "app/platform/quiet_libraries.h"
#include "app/platform/shell_word.h"
#include "app/platform/version.h"
#include "app/platform/warnings.h"
#include "base/input_error.h"
#include "base/mapped_file.h"
#include "render/literature/literature.h"

namespace foci {
namespace {

constexpr int kDone = 0, kFailed = 1, kBadInput = 2;

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
