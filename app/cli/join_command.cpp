#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/commands.h"
#include "app/cli/option_values.h"
#include "app/platform/output_files.h"
#include "app/record/manifest.h"
#include "app/replay/part.h"
#include "base/transformed.h"

namespace foci {
namespace {

struct JoinOptions {
  std::vector<std::string> parts{};
  std::string out{};
  bool json = false, overwrite = false;
};

void runJoin(const JoinOptions& options, const std::string& command_line) {
  const std::vector<Part> parts = inOrder(transformed(options.parts, readPart));
  const Study study = studyOf(parts.front());
  std::vector<std::filesystem::path> inputs;
  for (const Part& part : parts) {
    for (auto& file : partFiles(part.folder)) inputs.push_back(std::move(file));
    inputs.insert(inputs.end(), part.input_places.begin(), part.input_places.end());
  }
  const OutputGuard guard(RunWriter::files(study, options.out), inputs, options.overwrite);
  const RunResult run = join(parts, study, options.out, command_line, guard);
  std::puts((options.json ? summaryJson(run.summary) : summaryText(run.summary)).c_str());
}

}  // namespace

void addJoinCommand(CLI::App& app, const std::string& command_line) {
  const auto options = std::make_shared<JoinOptions>();
  CLI::App* command =
      app.add_subcommand("join",
                         "Join the parts of a run into the files that a single replay writes.\n"
                         "Example: foci join out/part-* --out out/run");
  addOption(*command, "PARTS", options->parts, "DIR",
            "folders that foci replay --frames wrote, in any order")
      ->required();
  addOption(*command, "--out", options->out, "DIR", "folder of the results")->required();
  command->add_flag("--json", options->json, "print the summary as JSON");
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [options, command_line] { runJoin(*options, command_line); });
}

}  // namespace foci
