#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/cli/commands.h"
#include "app/cli/manual.h"
#include "app/cli/option_values.h"
#include "app/platform/output_files.h"
#include "base/text.h"

namespace foci {
namespace {

struct ManualOptions {
  std::string out{};
  bool overwrite = false;
};

void runManual(const CLI::App& app, const ManualOptions& options) {
  const std::filesystem::path out = options.out;
  const std::vector<ManualFile> manual = manualOf(app);
  std::vector<std::filesystem::path> outputs;
  outputs.reserve(manual.size());
  for (const auto& [name, text] : manual) outputs.push_back(out / name);
  OutputFiles files(OutputGuard(outputs, {}, options.overwrite));
  for (const auto& [name, text] : manual) files.write(out / name, text);
  files.commit();
  std::printf("%zu files: man %s\n", manual.size(),
              visible((out / "man1/foci.1").string()).c_str());
}

}  // namespace

void addManualCommand(CLI::App& app) {
  const auto options = std::make_shared<ManualOptions>();
  CLI::App* command = app.add_subcommand(
      "manual",
      "Write a man page for each command, and completions for bash, zsh and fish.\n"
      "Example: foci manual --out manual");
  command->add_option("--out", options->out, "folder of the pages")->type_name("DIR")->required();
  addOverwriteFlag(*command, options->overwrite);
  command->callback([&app, options, command] {
    refuseEmptyValues(*command);
    runManual(app, *options);
  });
}

}  // namespace foci
