#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "app/cli/commands.h"
#include "app/cli/option_values.h"
#include "app/platform/output_files.h"
#include "app/replay/compare.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

struct CompareOptions {
  std::vector<std::string> runs{};
  std::string out{};
  bool overwrite = false;
};

void runCompare(const CompareOptions& options) {
  std::vector<std::filesystem::path> folders, inputs;
  for (const std::string& named : options.runs) {
    for (std::filesystem::path& run : runFolders(named)) folders.push_back(std::move(run));
  }
  if (folders.size() < 2) {
    throw InputError("foci compare", "expected two or more folders of runs, or that of a batch");
  }
  for (const std::filesystem::path& folder : folders) {
    for (const char* name : {"frames.tsv", "fixations.tsv", "saccades.tsv", "objects.tsv",
                             "video.mp4", "manifest.json"}) {
      inputs.push_back(folder / name);
    }
  }
  compareRuns(folders, options.out,
              OutputGuard(compareFiles(options.out), inputs, options.overwrite));
  std::printf("%zu runs: %s\n", folders.size(),
              visible((std::filesystem::path(options.out) / "compare.html").string()).c_str());
}

}  // namespace

void addCompareCommand(CLI::App& app) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      app.add_subcommand("compare",
                         "Compare runs of settings or of observers: fixations, blur, dwell "
                         "times, overlap of gaze and images side by side.\n"
                         "Example: foci compare out/old out/young --out out/both");
  addOption(*command, "RUNS", options->runs, "DIR",
            "folders that foci replay wrote, of runs or of batches; the others are compared with "
            "the first")
      ->required();
  addOption(*command, "--out", options->out, "DIR", "folder of the results")->required();
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [options] { runCompare(*options); });
}

}  // namespace foci
