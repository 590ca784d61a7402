#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <utility>

#include "app/cli/commands.h"
#include "app/cli/option_values.h"
#include "app/cli/study_options.h"
#include "app/platform/output_files.h"
#include "app/record/manifest.h"
#include "app/replay/replay.h"
#include "app/study/inputs.h"

namespace foci {
namespace {

struct ReplayOptions : StudyOptions {
  std::string out{};
  bool overwrite = false;
};

void runReplay(const ReplayOptions& options, const std::string& command_line) {
  const unsigned threads = threadsOf(options.threads);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const std::string out = options.out.empty() ? "out" : options.out;
  StudyAsked asked = studyOf(options);
  std::vector<std::filesystem::path> outputs = replayFiles(asked.study, out);
  outputs.emplace_back(options.write_study);
  checkOutputs(outputs, inputFiles(asked.study), options.overwrite);
  const RunSummary summary =
      replay(asked.study, out, command_line, threads, std::move(asked.scene));
  saveStudy(options, asked);
  if (options.json) {
    std::puts(summaryJson(summary).c_str());
    return;
  }
  std::printf(
      "%zu frames, %.2f s; %.0f %% of the gaze samples valid; %zu fixations, %zu saccades\n"
      "%zu frames rendered, %.1f ms each (median; 95 %%: %.1f ms), %llu splats; the other frames "
      "reuse the one before, %.1f ms over all frames (95 %%: %.1f ms)\nreport: %s\n",
      summary.frames, summary.duration_s, 100.0 * summary.gaze_valid, summary.fixations,
      summary.saccades, summary.frames_rendered, summary.rendered_ms_median,
      summary.rendered_ms_p95, static_cast<unsigned long long>(summary.splats),
      summary.render_ms_median, summary.render_ms_p95, (summary.out / "report.html").c_str());
}

}  // namespace

void addReplayCommand(CLI::App& app, const std::string& command_line) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand(
      "replay",
      "Replay a gaze recording: write a video, tables and a report of what the eye saw.\n"
      "Example: foci replay scan.glb --trace gaze.tsv --out out/scan");
  addStudyOptions(*command, *options);
  command
      ->add_option("--trace", options->trace,
                   "recording, or webcam:VIDEO, instead of the study's gaze source")
      ->type_name("FILE");
  command->add_option("--out", options->out, "folder of the results; default: out")
      ->type_name("DIR");
  command
      ->add_option("--seconds", options->seconds,
                   "part of the recording, seconds after its first sample")
      ->type_name("FROM:TO");
  addMarkerOptions(*command, *options);
  addOverwriteFlag(*command, options->overwrite);
  command->callback([options, command, command_line] {
    refuseEmptyValues(*command);
    runReplay(*options, command_line);
  });
}

}  // namespace foci
