#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "app/cli/commands.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "app/replay/compare.h"
#include "app/replay/figures.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

struct FiguresOptions {
  std::string run{}, out{}, format = "svg", colors = "inferno", trial{};
  FigureChoice choice{};
  bool overwrite = false;
};

/// The number of a name in a list that has it.
template <class Enum, class Names>
Enum valueNamed(const std::string& name, const Names& names) {
  return static_cast<Enum>(std::ranges::find(names, name) - names.begin());
}

void runFigures(FiguresOptions options) {
  FigureChoice& choice = options.choice;
  choice.style.format = valueNamed<FigureFormat>(options.format, kFigureFormats);
  choice.style.colors = valueNamed<ColorMap>(options.colors, kColorMaps);
  if (!options.trial.empty()) choice.trial = options.trial;
  std::vector<std::filesystem::path> inputs;
  for (const char* name : {"frames.tsv", "fixations.tsv", "manifest.json", "video.mp4"}) {
    inputs.push_back(std::filesystem::path(options.run) / name);
  }
  const FiguresMade made =
      writeFigures(options.run, choice, options.out,
                   OutputGuard(figureFiles(choice, options.out), inputs, options.overwrite));
  for (const std::string& remark : made.remarks) say(remark);
  for (const auto& file : made.files) std::puts(visible(file.string()).c_str());
}

/// An option that takes one of some names.
template <class Names>
CLI::Option* addNames(CLI::App& command, const char* option, auto& value, const char* help,
                      const Names& names) {
  return addOption(command, option, value, "NAME", help)
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
}

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

void addFiguresCommand(CLI::App& app) {
  const auto options = std::make_shared<FiguresOptions>();
  FigureStyle& style = options->choice.style;
  CLI::App* command = app.add_subcommand(
      "figures",
      "Draw figures of a run for a paper: scanpath, maps of gaze on the frame and on the scene, "
      "time series, focus and blur.\n"
      "Example: foci figures out/demo --out out/figures --format pdf --width 85");
  addOption(*command, "RUN", options->run, "DIR", "folder that foci replay wrote")->required();
  addOption(*command, "--out", options->out, "DIR", "folder of the figures")->required();
  addNames(*command, "--format", options->format, "default svg", kFigureFormats);
  addNames(*command, "--only", options->choice.kinds, "only this figure; may be repeated",
           kFigures);
  addOption(*command, "--trial", options->trial, "NAME", "only this trial of the run");
  addOption(*command, "--width", style.width_mm, "MM", "width, mm; default 180")
      ->check(CLI::Range(30.0, 1000.0));
  addOption(*command, "--height", style.height_mm, "MM",
            "height of time series and focus, mm; default 110")
      ->check(CLI::Range(30.0, 1000.0));
  addOption(*command, "--font", style.font_pt, "PT", "size of the letters, points; default 8")
      ->check(CLI::Range(3.0, 40.0));
  addOption(*command, "--line", style.line_pt, "PT", "width of a line, points; default 0.75")
      ->check(CLI::Range(0.1, 10.0));
  addOption(*command, "--dpi", style.dpi, "N",
            "pixels per inch of PNG and of pictures; default 300")
      ->check(CLI::Range(50.0, 1200.0));
  addNames(*command, "--colors", options->colors, "colour map; default inferno", kColorMaps);
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [options] { runFigures(*options); });
}

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
