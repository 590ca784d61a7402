#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/cli/commands.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "app/webcam/watch.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/bids.h"
#include "gaze/sources/trace_reader.h"
#include "gaze/sources/trace_summary.h"
#include "gaze/webcam/webcam_frames.h"

namespace foci {
namespace {

struct Options : TraceOptions {
  std::string file{}, out{};
  bool json = false, overwrite = false;
  AlignmentOptions alignment{};
};

/// Without the last digits, which come from arithmetic on doubles.
double rounded(double value) { return std::round(value * 1e9) / 1e9; }

/// The quantities of the screen that nobody states.
std::vector<std::string> unknownOf(const TraceHeader& header) {
  const Screen& screen = *header.screen;
  std::vector<std::string> unknown;
  if (header.nominal_screen || screen.size_px.x <= 0) unknown.emplace_back("screen_px");
  if (header.nominal_screen || screen.size_m.x <= 0.0) unknown.emplace_back("screen_m");
  if (header.nominal_screen || screen.distance_m <= 0.0) unknown.emplace_back("distance_m");
  return unknown;
}

/// The range of the positions in the file's own unit. Along each axis
/// that unit is a monotonic function of the pixels.
void addRange(const TraceHeader& header, const TraceSummary& summary,
              nlohmann::ordered_json& json) {
  const glm::dvec2 low_px = summary.min_px(), high_px = summary.max_px();
  const Screen& screen = *header.screen;
  if (header.units == GazeUnits::deg) {
    // Degrees count upwards, pixels downwards.
    const glm::dvec2 low = eccentricity_deg(screen, {low_px.x, high_px.y});
    const glm::dvec2 high = eccentricity_deg(screen, {high_px.x, low_px.y});
    json["x_deg"] = {rounded(low.x), rounded(high.x)};
    json["y_deg"] = {rounded(low.y), rounded(high.y)};
  } else if (header.units == GazeUnits::normalised) {
    const glm::dvec2 size_px(screen.size_px);
    json["x_fraction"] = {rounded(low_px.x / size_px.x), rounded(high_px.x / size_px.x)};
    json["y_fraction"] = {rounded(low_px.y / size_px.y), rounded(high_px.y / size_px.y)};
  } else {
    json["x_px"] = {rounded(low_px.x), rounded(high_px.x)};
    json["y_px"] = {rounded(low_px.y), rounded(high_px.y)};
  }
}

/// What the tracker and the experiment state.
void addStatements(const TraceHeader& header, nlohmann::ordered_json& json) {
  for (const TrackerCalibration& calibration : header.calibrations) {
    nlohmann::ordered_json each = {{"time_s", rounded(calibration.time_s)},
                                   {"kind", calibration.kind},
                                   {"targets", calibration.targets},
                                   {"eye", calibration.eye},
                                   {"grade", calibration.grade}};
    if (calibration.mean_deg) each["mean_deg"] = *calibration.mean_deg;
    if (calibration.max_deg) each["max_deg"] = *calibration.max_deg;
    json["calibrations"].push_back(each);
  }
  for (const TraceTrial& trial : header.trials) {
    nlohmann::ordered_json each = {{"name", trial.name},
                                   {"onset_s", rounded(trial.first_s)},
                                   {"duration_s", rounded(trial.last_s - trial.first_s)},
                                   {"result", trial.result}};
    for (const auto& [name, value] : trial.variables) each["variables"][name] = value;
    json["trials"].push_back(each);
  }
  if (!header.markers.empty()) json["markers"] = header.markers.size();
}

std::string textOf(const nlohmann::ordered_json& calibration) {
  const auto text = [&](const char* key) { return calibration[key].get<std::string>(); };
  std::string line =
      text("eye").empty() ? text("targets") : text("eye") + " eye, " + text("targets");
  line += ": " + text("grade");
  for (const auto& [key, name] : {std::pair("mean_deg", "mean"), std::pair("max_deg", "max")}) {
    if (!calibration.contains(key)) continue;
    line += std::string(", ") + name + ' ' + calibration[key].dump() + " deg";
  }
  return line + ", at " + calibration["time_s"].dump() + " s";
}

nlohmann::ordered_json factsOf(const TraceHeader& header, const TraceSummary& summary) {
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) /
           static_cast<double>(std::max<std::size_t>(summary.samples(), 1));
  };
  nlohmann::ordered_json json = {{"format", header.format},
                                 {"rate_Hz", summary.rate_Hz()},
                                 {"samples", summary.samples()},
                                 {"first_s", rounded(summary.first_s())},
                                 {"span_s", rounded(summary.span_s())},
                                 {"present", share(summary.present())},
                                 {"left_eye", share(summary.eyes()[0])},
                                 {"right_eye", share(summary.eyes()[1])},
                                 {"blink", share(summary.blinks())},
                                 {"pupil", share(summary.pupils())},
                                 {"clock_jumps", summary.jumps()},
                                 {"longest_jump_s", rounded(summary.longest_jump_s())}};
  if (!header.pupil_unit.empty()) json["pupil_unit"] = header.pupil_unit;
  if (summary.pauses() > 0) json["blocks"] = summary.pauses() + 1;
  addStatements(header, json);
  if (summary.present() > 0) addRange(header, summary, json);
  const Screen& screen = *header.screen;
  if (!header.nominal_screen) {
    if (screen.size_px.x > 0) json["screen_px"] = {screen.size_px.x, screen.size_px.y};
    if (screen.size_m.x > 0.0) {
      json["screen_m"] = {rounded(screen.size_m.x), rounded(screen.size_m.y)};
    }
    if (screen.distance_m > 0.0) json["distance_m"] = rounded(screen.distance_m);
  }
  if (const auto unknown = unknownOf(header); !unknown.empty()) json["unknown"] = unknown;
  for (const ColumnReading& reading : header.columns) {
    json["columns"].push_back({{"columns", reading.columns}, {"meaning", reading.meaning}});
    if (!reading.why.empty()) json["columns"].back()["why"] = reading.why;
  }
  if (!header.assumed.empty()) json["assumed"] = header.assumed;
  if (!header.warnings.empty()) json["warnings"] = header.warnings;
  return json;
}

void printFacts(const TraceHeader& header, const TraceSummary& summary, bool json) {
  const auto facts = factsOf(header, summary);
  if (json) {
    std::puts(jsonText(facts).c_str());
    return;
  }
  for (const auto& [key, value] : facts.items()) {
    if (key == "columns") continue;
    if (key == "calibrations") {
      for (const auto& each : value) {
        std::printf("%-15s %s\n", each["kind"].get<std::string>().c_str(), textOf(each).c_str());
      }
      continue;
    }
    if (key == "trials") {
      std::printf("%-15s %zu\n", key.c_str(), value.size());
      continue;
    }
    if (key == "unknown" || key == "assumed" || key == "warnings") {
      for (const auto& line : value) {
        std::printf("%-15s %s\n", key.c_str(), visible(line.get<std::string>()).c_str());
      }
      continue;
    }
    const std::string text = value.is_string() ? visible(value.get<std::string>()) : value.dump();
    std::printf("%-15s %s\n", key.c_str(), text.c_str());
  }
  for (const ColumnReading& reading : header.columns) {
    const std::string why = reading.why.empty() ? "" : " (" + reading.why + ")";
    std::printf("column          %s\n",
                visible(reading.columns + ": " + reading.meaning + why).c_str());
  }
}

void requireSamples(const Options& options, const TraceSummary& summary) {
  if (summary.samples() < 2) {
    throw InputError(options.file, counted(summary.samples(), "sample") + ": expected at least 2");
  }
}

void showTrace(const Options& options) {
  if (webcamPlaceOf(options.file)) {
    watchWebcam({.source = options.file, .table = false, .json = options.json});
    return;
  }
  TraceSummary summary;
  const TraceDescription description = descriptionOf(options);
  const TraceHeader header = streamTrace(options.file, description.columns, description.screen,
                                         [&](const GazeSample& sample) { summary.add(sample); });
  requireSamples(options, summary);
  if (options.alignment.scene.empty()) {
    printFacts(header, summary, options.json);
  } else {
    showAlignment(options.file, options, options.alignment, options.json);
  }
}

/// The files that describe the whole task: those that are not there yet, and so cannot state
/// another screen. @throws InputError if they do
void stageTask(const Options& options, const BidsNames& names, const TraceHeader& header,
               OutputFiles& files) {
  const std::filesystem::path json = names.ofTask("events.json"), tsv = names.ofTask("events.tsv");
  const std::string text = bidsEventsJson(*header.screen);
  const bool has_json = std::filesystem::exists(json);
  if (has_json && !options.overwrite && !statesScreen(json, *header.screen)) {
    throw InputError(json.string(),
                     "states another screen than the recording: --overwrite replaces it");
  }
  if (!has_json || options.overwrite) files.write(json, text);
  if (!std::filesystem::exists(tsv)) files.write(tsv, "onset\tduration\n");
}

void convertTrace(const Options& options) {
  const BidsNames names(options.out);
  const TraceDescription description = descriptionOf(options);
  TraceSummary summary;
  BidsContents contents;
  std::size_t heads = 0;
  TraceHeader header = streamTrace(options.file, description.columns, description.screen,
                                   [&](const GazeSample& sample) {
                                     summary.add(sample);
                                     contents.add(sample);
                                     heads += sample.head.has_value();
                                   });
  requireSamples(options, summary);
  if (heads > 0) {
    header.warnings.push_back(
        "the head's poses and the directions are left out: BIDS has the points on the headset's "
        "screen");
  }
  const auto sides = contents.recordings();
  std::vector<std::filesystem::path> outputs, inputs = companionsOf(options.file);
  for (const auto& side : sides) {
    for (const char* suffix : {"physio.tsv.gz", "physio.json"}) {
      outputs.push_back(names.ofEye(side, suffix));
    }
    if (header.markers.empty()) continue;
    for (const char* suffix : {"physioevents.tsv.gz", "physioevents.json"}) {
      outputs.push_back(names.ofEye(side, suffix));
    }
  }
  inputs.emplace_back(options.file);
  inputs.emplace_back(options.study);
  OutputFiles files(OutputGuard(outputs, inputs, options.overwrite));
  std::vector<BidsTable> tables;
  tables.reserve(sides.size());
  for (const auto& side : sides) {
    tables.emplace_back(files.stage(names.ofEye(side, "physio.tsv.gz")), contents, side);
  }
  streamTrace(options.file, description.columns, description.screen, [&](const GazeSample& sample) {
    for (BidsTable& table : tables) table.add(sample);
  });
  for (std::size_t i = 0; i < sides.size(); ++i) {
    tables[i].finish();
    files.write(names.ofEye(sides[i], "physio.json"),
                bidsPhysioJson(header, contents, sides[i], summary.rate_Hz()));
    if (header.markers.empty()) continue;
    files.write(names.ofEye(sides[i], "physioevents.tsv.gz"),
                [&](const auto& path) { writePacked(path, bidsMessages(header.markers)); });
    files.write(names.ofEye(sides[i], "physioevents.json"), bidsMessagesJson());
  }
  stageTask(options, names, header, files);
  files.commit();
  printFacts(header, summary, options.json);
}

void addOptions(CLI::App& command, Options& options) {
  command.add_option("FILE", options.file, "gaze recording")->required();
  addTraceOptions(command, options);
  command.add_flag("--json", options.json, "print the facts as JSON");
}

}  // namespace

void addTraceCommand(CLI::App& app) {
  CLI::App* trace = app.add_subcommand("trace",
                                       "Show facts about a gaze recording, or convert it to BIDS.\n"
                                       "Example: foci trace info gaze.asc")
                        ->require_subcommand(1);
  const auto options = std::make_shared<Options>();
  CLI::App* facts =
      trace
          ->add_subcommand(
              "info",
              "Show format, rate, duration, eyes, data loss and clock jumps, and what was assumed.")
          ->alias("INFO");
  addOptions(*facts, *options);
  addAlignmentOptions(*facts, options->alignment);
  facts->callback([options] { withTraceHints(*options, [&] { showTrace(*options); }); });
  CLI::App* conversion = trace->add_subcommand(
      "convert",
      "Write the recording as BIDS 1.11: a table and its JSON for each eye, messages, the screen.");
  addOptions(*conversion, *options);
  addOption(*conversion, "--out", options->out, "FILE_physio.tsv.gz",
            "table of an eye; foci adds recording-eye1 and recording-eye2 to the name, and writes "
            "the JSON files beside it")
      ->required();
  addOverwriteFlag(*conversion, options->overwrite);
  conversion->callback([options] { withTraceHints(*options, [&] { convertTrace(*options); }); });
}

}  // namespace foci
