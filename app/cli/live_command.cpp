#include <cstdio>
#include <memory>
#include <stdexcept>
#include <utility>

#include "app/cli/commands.h"
#include "app/live/options.h"
#include "app/live/record.h"
#include "app/live/sources.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "app/record/manifest.h"
#include "app/study/inputs.h"
#include "app/study/session_settings_of.h"
#include "app/study/study_text.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

/// Default frame-time budget: the window needs the rest of a refresh at 60 Hz.
constexpr double kLiveFrame_ms = 10.0;

struct LiveCommandOptions : StudyRequest {
  LiveOptions live{};
  std::string record{};
  bool latency = false, overwrite = false;
};

std::string liveSummaryJson(const LiveSummary& summary) {
  nlohmann::ordered_json json = {
      {"frames", summary.frames},
      {"repeated", summary.repeated},
      {"dropped", summary.dropped},
      {"first_frame_s", summary.first_frame_s},
      {"sample_to_swap_ms_median", summary.sample_to_swap.quantile_ms(0.5)},
      {"sample_to_swap_ms_p95", summary.sample_to_swap.quantile_ms(0.95)},
      {"sample_to_render_ms_median", summary.sample_to_render.quantile_ms(0.5)},
      {"sample_to_render_ms_p95", summary.sample_to_render.quantile_ms(0.95)},
      {"render_to_swap_ms_median", summary.render_to_swap.quantile_ms(0.5)},
      {"render_to_swap_ms_p95", summary.render_to_swap.quantile_ms(0.95)},
      {"render_ms_median", summary.render.quantile_ms(0.5)},
      {"render_ms_p95", summary.render.quantile_ms(0.95)}};
  if (summary.sample_to_display.count() > 0) {
    json["sample_to_display_ms_median"] = summary.sample_to_display.quantile_ms(0.5);
    json["sample_to_display_ms_p95"] = summary.sample_to_display.quantile_ms(0.95);
  }
  json.update(landingsJson(summary.landings));
  addReception(summary.reception, json["gaze"]);
  json["records"] = nlohmann::ordered_json::array();
  for (const auto& folder : summary.records) json["records"].push_back(folder.string());
  return jsonText(json);
}

std::string medianText(const Durations& times) {
  return decimal(times.quantile_ms(0.5), 1) +
         " ms (median; 95 %: " + decimal(times.quantile_ms(0.95), 1) + " ms)";
}

/// The parts of the time from a sample to the screen, a line each.
std::string latencyText(const LiveSummary& summary) {
  const auto line = [](const char* what, const Durations& part) {
    return "\n  " + std::string(what) + medianText(part);
  };
  return "\ngaze to screen, " + counted(summary.sample_to_swap.count(), "frame") + ":" +
         line("tracker, from the sample to the start of rendering: ", summary.sample_to_render) +
         line("foci, rendering:                                    ", summary.render) +
         line("display, from there to the swap of the buffers:     ", summary.render_to_swap) +
         line("all:                                                ", summary.sample_to_swap) +
         (summary.sample_to_display.count() == 0
              ? ""
              : line("headset, from the sample to the predicted display:  ",
                     summary.sample_to_display));
}

std::string recordText(const std::filesystem::path& folder) {
  return "record: foci replay " + (folder / "study.toml").string() + " --out " +
         (folder / "replay").string();
}

std::string liveSummaryText(const LiveSummary& summary) {
  std::string text =
      counted(summary.frames, "frame") + ", the first after " + decimal(summary.first_frame_s, 2) +
      " s; refreshes that showed an older frame: " + std::to_string(summary.repeated) +
      ", frames never shown: " + std::to_string(summary.dropped) + "\n" +
      (summary.sample_to_swap.count() == 0
           ? "no gaze reached the screen"
           : "gaze to screen " + medianText(summary.sample_to_swap)) +
      "\nrendering " + medianText(summary.render);
  if (summary.sample_to_display.count() > 0) {
    text += "\nage of the gaze when the headset shows it " + medianText(summary.sample_to_display);
  }
  if (const Landings& landings = summary.landings; landings.count() > 0) {
    text +=
        "\nfull quality after " + std::to_string(landings.toFull().count()) + " of " +
        counted(landings.count(), "saccade") + ", " +
        decimal(landings.toFull().quantile_ms(0.5), 0) +
        " ms after the landing (median; 95 %: " + decimal(landings.toFull().quantile_ms(0.95), 0) +
        " ms); in " + decimal(100.0 * landings.fullShare(), 0) + " % of all frames";
  }
  for (const UnusedGaze& time : summary.reception.unused) {
    text += "\nno gaze was used from " + decimal(time.from_s, 1) + " s to " +
            decimal(time.to_s, 1) + " s: " + time.why;
  }
  if (const std::size_t dropped = summary.reception.dropped; dropped > 0) {
    text += "\nsamples of gaze that were dropped: " + std::to_string(dropped);
  }
  if (const auto& clock = summary.reception.clock) {
    text += "\nclock of the gaze's sender: " + clockText(*clock);
  }
  for (const auto& folder : summary.records) {
    text += "\n" + recordText(folder);
  }
  return text;
}

/// The study as the window shows it.
Study studyOfWindow(Study study, const LiveOptions& live) {
  study.output.maps.clear();  // a replay of the record writes them
  if (!study.quality.frame_ms && !live.headset) study.quality.frame_ms = kLiveFrame_ms;
  if (study.eye.path.empty() && !study.eye.position_m) {
    // The observer moves from the scene's own eye pose.
    const EyePose pose = builtinPose(study);
    study.eye.position_m = pose.position_m;
    study.eye.look_at_m = pose.target_m;
    study.eye.up = pose.up;
  }
  return study;
}

void runLiveCommand(const LiveCommandOptions& options, const std::string& command_line) {
  LiveOptions live = options.live;
  if (live.source.starts_with("socket") && live.socket.empty()) {
    throw InputError("--source " + live.source, "expected --socket PORT, which receives the gaze");
  }
  live.command = command_line;
  // The window, the tracker and the system share one thread. A machine with two threads gives up
  // a part of one.
  const unsigned threads = threadsOf(options.threads);
  live.threads = options.threads.empty() && threads > 2 ? threads - 1 : threads;
  if (!options.record.empty()) live.record = options.record;
  StudyAsked asked = studyOf(options);
  if (live.headset && !asked.study.eye.path.empty()) {
    throw InputError("--headset",
                     "the head moves the eye: expected eye.position_m and eye.look_at_m, where the "
                     "observer stands, instead of eye.path");
  }
  const OutputGuard guard({options.write_study}, inputFiles(asked.study), options.overwrite);
  if (live.record) {
    static_cast<void>(studyToml(asked.study));  // the record has it
    makeRecordFolder(*live.record);
  }
  saveStudy(options, asked, guard);
  Study placed;  // before a recorded head has moved its eye
  live.open = [&](const std::filesystem::path& file, Study now) {
    if (now.eye.recorded) {
      now.eye = placed.eye;
      now.display = placed.display;
      now.gaze = placed.gaze;
    }
    return openedFile(file, options, live.source, now);
  };
  LiveNext next{.study = std::move(asked.study),
                .scene = std::move(asked.scene),
                .source = live.source,
                .title = std::filesystem::path(options.study).filename().string()};
  LiveSummary summary;
  for (bool more = true; more;) {
    live.source = next.source;
    live.title = "foci live: " + next.title;
    auto records = std::move(summary.records);
    auto failed = std::move(summary.failed_records);
    placed = studyOfWindow(std::move(next.study), live);
    try {
      summary = runLive(placed, live, std::move(next.scene));
    } catch (...) {  // the files before have their records
      for (const auto& folder : records) std::fprintf(stderr, "%s\n", recordText(folder).c_str());
      for (const auto& line : failed) std::fprintf(stderr, "foci: %s\n", line.c_str());
      throw;
    }
    summary.records.insert(summary.records.begin(), records.begin(), records.end());
    summary.failed_records.insert(summary.failed_records.begin(), failed.begin(), failed.end());
    live.record.reset();  // of the first study alone
    more = summary.next.has_value();
    if (more) next = *std::exchange(summary.next, std::nullopt);
  }
  std::string text = options.json ? liveSummaryJson(summary) : liveSummaryText(summary);
  if (options.latency && !options.json) text += latencyText(summary);
  std::puts(text.c_str());
  if (!summary.failed_records.empty()) {
    std::string lines = summary.failed_records.front();
    for (std::size_t i = 1; i < summary.failed_records.size(); ++i) {
      lines += "\nfoci: " + summary.failed_records[i];
    }
    throw std::runtime_error(lines);
  }
}

}  // namespace

void addLiveCommand(CLI::App& app, const std::string& command_line) {
  const auto options = std::make_shared<LiveCommandOptions>();
  CLI::App* command = app.add_subcommand(
      "live",
      "Show a scene in real time; its focus follows your gaze. Press ? for the keys.\n"
      "Example: foci live configs/demo.toml --window, foci live scan.ply");
  addStudyOptions(*command, *options);
  CLI::Option* source = addOption(*command, "--source", options->live.source, "NAME",
                                  "gaze source: mouse, trace:FILE, pupil:HOST:PORT, lsl[:NAME], "
                                  "socket[:RATE] or webcam[:N|FILE]");
  command
      ->add_flag("--headset", options->live.headset,
                 "a headset by OpenXR shows both eyes, and its eye tracker is the gaze; a window "
                 "shows what the left eye sees. --size is that of both eyes side by side; the "
                 "headset recommends one. A late frame repeats the last one, at its own pose")
      ->excludes(source);
  command->add_flag("--window", options->live.window, "a window instead of the full screen");
  addOption(*command, "--monitor", options->live.monitor, "N",
            "monitor, 0 for the primary one; `foci doctor` lists them");
  addOption(*command, "--record", options->record, "DIR", "record from the start, to this folder");
  command->add_flag("--latency", options->latency,
                    "print the time from gaze to screen, in its parts: tracker, foci and display");
  addOption(*command, "--socket", options->live.socket, "[ADDRESS:]PORT",
            "port for an experiment's commands; default address: this machine");
  addMarkerOptions(*command, *options);
  command->add_flag("--overwrite", options->overwrite,
                    "also replace a study that foci did not make; never a record");
  onceParsed(*command, [options, command_line] { runLiveCommand(*options, command_line); });
}

}  // namespace foci
