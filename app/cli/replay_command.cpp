#include <tbb/global_control.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/commands.h"
#include "app/platform/output_files.h"
#include "app/record/manifest.h"
#include "app/replay/part.h"
#include "app/replay/recordings.h"
#include "app/replay/replay.h"
#include "app/study/inputs.h"
#include "base/input_error.h"
#include "base/text.h"
#include "base/transformed.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {
namespace {

struct ReplayOptions : StudyRequest {
  std::vector<std::string> traces{};
  std::string out{}, frames{}, heatmap{};
  bool overwrite = false;
};

/// A whole number of --frames; `absent` for an empty text.
std::size_t countOf(const std::string& option, std::string_view text, std::size_t absent) {
  constexpr double kMaxFrame = 1e9;  // far above what a replay renders
  if (text.empty()) return absent;
  const auto number = parseNumber(text);
  if (!number || *number < 0 || *number > kMaxFrame || *number != std::floor(*number)) {
    throw InputError(
        "--frames " + option,
        "expected FIRST:END, e.g. 0:900; the part ends before frame END; or PART/PARTS, e.g. 1/4");
  }
  return static_cast<std::size_t>(*number);
}

FramesAsked framesOf(const std::string& text) {
  const std::string_view all = text;
  if (const std::size_t at = text.find('/'); at != text.npos) {
    const FramesAsked asked{.part = countOf(text, all.substr(0, at), 0),
                            .parts = countOf(text, all.substr(at + 1), 0)};
    if (asked.part < 1 || asked.part > asked.parts) {
      throw InputError("--frames " + text, "expected PART/PARTS, 1/4 to 4/4 for four parts");
    }
    return asked;
  }
  const std::size_t at = text.find(':');
  const FrameSpan span{
      .first = countOf(text, at == text.npos ? "?" : all.substr(0, at), 0),
      .end = countOf(text, all.substr(at + 1), std::numeric_limits<std::size_t>::max())};
  if (span.first >= span.end) {
    throw InputError("--frames " + text, "expected FIRST before END");
  }
  return {.span = span};
}

/// `foci replay --trace A.tsv STUDY`: the study may come after the recordings.
void takeStudyFromTraces(ReplayOptions& options) {
  if (!options.study.empty()) return;
  if (options.traces.size() < 2) throw InputError("STUDY is required (foci replay --help)");
  options.study = options.traces.back();
  options.traces.pop_back();
}

void runPart(const ReplayOptions& options, StudyAsked&& asked, unsigned threads) {
  const FramesAsked frames = framesOf(options.frames);
  std::vector<std::filesystem::path> outputs = partFiles(options.out);
  outputs.emplace_back(options.write_study);
  const OutputGuard guard(outputs, inputFiles(asked.study), options.overwrite);
  ReplayedScene scene(std::move(asked.scene));
  const FrameSpan rendered = replayPart(asked.study, frames, options.out, threads, scene, guard);
  saveStudy(options, asked, guard);
  if (options.json) {
    std::printf("{\"first\":%zu,\"end\":%zu}\n", rendered.first, rendered.end);
  } else {
    std::printf("frames %zu to %zu of the run; foci join joins all parts into one run\n",
                rendered.first, rendered.end - 1);
  }
}

void runOne(const ReplayOptions& options, StudyAsked&& asked, const std::string& command_line,
            unsigned threads) {
  std::vector<std::filesystem::path> outputs = RunWriter::files(asked.study, options.out);
  outputs.emplace_back(options.write_study);
  outputs.emplace_back(options.heatmap);
  const OutputGuard guard(outputs, inputFiles(asked.study), options.overwrite);
  ReplayedScene scene(std::move(asked.scene));
  std::optional<std::filesystem::path> heatmap;
  if (!options.heatmap.empty()) heatmap = options.heatmap;
  const RunResult run =
      replay(asked.study, options.out, command_line, threads, scene, guard, heatmap);
  saveStudy(options, asked, guard);
  std::puts((options.json ? summaryJson(run.summary) : summaryText(run.summary)).c_str());
}

/// Each of `--trace`; of a table of several people, each of them, in a folder of its own.
std::vector<BatchRecording> recordingsOf(const ReplayOptions& options, const Study& base) {
  std::vector<BatchRecording> recordings;
  const std::vector<std::string> names =
      options.traces.empty() ? std::vector<std::string>{} : folderNames(options.traces);
  for (std::size_t i = 0; i < names.size(); ++i) {
    Study study = base;
    overrideKey(study, "gaze.source", options.traces[i], "--trace");
    const auto people = study.gaze.columns.rows.empty()
                            ? peopleOf(study.gaze.source, study.columnsInForce())
                            : std::vector<std::pair<std::string, std::string>>{};
    if (people.empty()) {
      recordings.push_back(
          {.trace = options.traces[i], .name = names[i], .study = std::move(study)});
      continue;
    }
    for (const auto& person : people) {
      Study own = study;
      own.gaze.columns.rows = {person};
      recordings.push_back({.trace = options.traces[i] + ", " + person.second,
                            .name = names[i] + "-" + person.second,
                            .study = std::move(own)});
    }
  }
  nameSafely(recordings);
  return recordings;
}

/// @throws once all are done, if a recording has no run: InputError if its input was bad, else
/// std::runtime_error
void runBatch(const ReplayOptions& options, StudyAsked&& asked,
              const std::vector<BatchRecording>& recordings, const std::string& command_line,
              unsigned threads) {
  std::vector<std::filesystem::path> inputs;
  for (const BatchRecording& each : recordings) {
    checkStudy(each.study);
    for (auto& file : inputFiles(each.study)) inputs.push_back(std::move(file));
  }
  std::vector<std::filesystem::path> outputs = batchFiles(recordings, options.out);
  outputs.emplace_back(options.write_study);
  const OutputGuard guard(outputs, inputs, options.overwrite);
  ReplayedScene scene(std::move(asked.scene));
  const auto results = replayAll(recordings, options.out, command_line, threads, scene, guard);
  saveStudy(options, asked, guard);
  std::string failed;
  bool bad_input = true;
  for (const BatchResult& result : results) {
    if (!result.problem.empty()) {
      failed += (failed.empty() ? "" : ", ") + result.recording.trace;
      bad_input = bad_input && result.bad_input;
    } else if (options.json) {
      std::puts(summaryJson(result.run.summary).c_str());
    }
  }
  const std::filesystem::path out = options.out;
  if (!options.json) {
    std::printf("%zu recordings: %s\n", results.size(),
                visible((out / "index.html").string()).c_str());
  }
  if (failed.empty()) return;
  failed = "without a run: " + failed + " (" + (out / "recordings.tsv").string() + ")";
  if (bad_input) throw InputError(failed);
  throw std::runtime_error(failed);
}

void runReplay(ReplayOptions options, const std::string& command_line) {
  takeStudyFromTraces(options);
  const unsigned threads = threadsOf(options.threads);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  if (options.out.empty()) options.out = "out";
  if (!options.traces.empty()) options.trace = options.traces.front();
  StudyAsked asked = studyOf(options);
  const auto recordings = recordingsOf(options, asked.study);
  const bool batch = recordings.size() > 1;
  if (batch && !options.frames.empty()) {
    throw InputError("--frames " + options.frames, "expected one recording at a time");
  }
  if (!options.heatmap.empty()) {
    if (batch || !options.frames.empty()) {
      throw InputError("--heatmap " + options.heatmap, "expected one recording, without --frames");
    }
    if (std::filesystem::path(options.heatmap).extension() != ".ply") {
      throw InputError("--heatmap " + options.heatmap, "expected a name that ends in .ply");
    }
  }
  if (batch) {
    runBatch(options, std::move(asked), recordings, command_line, threads);
  } else if (!options.frames.empty()) {
    runPart(options, std::move(asked), threads);
  } else {
    runOne(options, std::move(asked), command_line, threads);
  }
}

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

void addReplayCommand(CLI::App& app, const std::string& command_line) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand(
      "replay",
      "Replay a gaze recording: write a video, tables and a report of what the eye saw.\n"
      "Example: foci replay scan.glb --trace gaze.tsv --out out/scan");
  addStudyOptions(*command, *options);
  command->get_option("STUDY")->required(false);  // `takeStudyFromTraces` asks for it
  addOption(
      *command, "--trace", options->traces, "FILE",
      "recording, or webcam:VIDEO, instead of the study's gaze source; with several, each gets a "
      "folder in DIR, and index.html lists all; so does each person of a table of several people")
      ->expected(1, -1);
  addOption(*command, "--out", options->out, "DIR", "folder of the results; default: out");
  addOption(*command, "--seconds", options->seconds, "FROM:TO",
            "part of the recording, seconds after its first sample");
  addOption(*command, "--frames", options->frames, "FIRST:END|PART/PARTS",
            "render only frames FIRST to END - 1, or one of equal parts, for foci join");
  addOption(*command, "--heatmap", options->heatmap, "FILE",
            "also write the scene's surfels with the time that gaze rested on each, .ply");
  addMarkerOptions(*command, *options);
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [options, command_line] { runReplay(*options, command_line); });
}

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
