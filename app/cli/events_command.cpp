#include "app/cli/events_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/cli/screen_options.h"
#include "app/platform/output_folder.h"
#include "app/record/tables.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/events/agreement.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/online_events.h"
#include "gaze/sources/labelled.h"
#include "gaze/sources/trace_reader.h"

namespace foci {
namespace {

constexpr GazeState kStates[] = {GazeState::fixation, GazeState::saccade, GazeState::oscillation,
                                 GazeState::pursuit,  GazeState::blink,   GazeState::lost};

struct EventsOptions {
  std::vector<std::string> traces{};
  std::string out{}, samples{}, physioevents{};
  ScreenOptions screen{};
  bool online = false, score = false, json = false;
};

std::vector<GazeState> labelsOf(const GazeTrace& trace, bool online) {
  return online ? labelSamplesOnline(trace, *trace.screen) : labelSamples(trace, *trace.screen);
}

/// Writes aside and renames.
void writeWhole(const std::string& file, const std::string& text) {
  const std::filesystem::path path(file);
  OutputFolder folder(path.has_parent_path() ? path.parent_path() : ".");
  writeText(folder.stage(path.filename().string()), text);
  folder.commit();
}

std::string sampleTable(const GazeTrace& trace, const std::vector<GazeState>& states) {
  constexpr int kDigits = 6;
  std::string table = "time_s\tlabel\n";
  for (std::size_t i = 0; i < states.size(); ++i) {
    table +=
        decimal(trace.samples[i].time_s, kDigits) + '\t' + std::string(nameOf(states[i])) + '\n';
  }
  return table;
}

/// BIDS: onset and duration in seconds, no header; the columns are named beside it.
void writePhysioevents(const std::string& file, const std::vector<GazeEvent>& events) {
  constexpr std::string_view kEnding = "_physioevents.tsv";
  if (!file.ends_with(kEnding)) {
    throw InputError("--physioevents " + file, "expected a name that ends in _physioevents.tsv");
  }
  constexpr int kDigits = 6;
  std::string table;
  for (const GazeEvent& event : events) {
    table += decimal(event.onset_s, kDigits) + '\t' + decimal(event.duration_s, kDigits) + '\t' +
             std::string(nameOf(event.kind)) + '\n';
  }
  const nlohmann::ordered_json sidecar = {
      {"Columns", {"onset", "duration", "trial_type"}},
      {"Description", "Eye movements, detected by foci"},
      {"OnsetSource", "timestamp"},
      {"trial_type",
       {{"Description",
         "fixation, saccade, pso (post-saccadic oscillation), pursuit, blink, lost"}}}};
  writeWhole(file, table);
  writeWhole(file.substr(0, file.size() - 4) + ".json", sidecar.dump(2) + '\n');
}

void detect(const EventsOptions& options) {
  const GazeTrace trace = readTrace(options.traces[0], {}, screenOf(options.screen));
  requireWholeScreen(*trace.screen, options.traces[0]);
  const auto states = labelsOf(trace, options.online);
  const auto events = eventsOf(states, trace, *trace.screen);
  if (!options.out.empty()) writeWhole(options.out, eventTable(events));
  if (!options.samples.empty()) writeWhole(options.samples, sampleTable(trace, states));
  if (!options.physioevents.empty()) writePhysioevents(options.physioevents, events);

  const double delay_s =
      options.online ? OnlineEvents(*trace.screen, trace.rate_Hz).delay_s() : 0.0;
  nlohmann::ordered_json summary = {{"format", trace.format},
                                    {"rate_Hz", trace.rate_Hz},
                                    {"samples", states.size()},
                                    {"online", options.online},
                                    {"delay_s", delay_s}};
  std::string text;
  for (const GazeState kind : kStates) {
    const auto samples = std::count(states.begin(), states.end(), kind);
    const auto count = std::count_if(events.begin(), events.end(),
                                     [&](const GazeEvent& event) { return event.kind == kind; });
    const double share = static_cast<double>(samples) / static_cast<double>(states.size());
    summary["events"][nameOf(kind)] = {{"count", count}, {"share", share}};
    char line[80];
    std::snprintf(line, sizeof line, "%-9s %5ld events  %5.1f %% of the samples\n",
                  std::string(nameOf(kind)).c_str(), static_cast<long>(count), 100.0 * share);
    text += line;
  }
  if (options.json) {
    std::puts(summary.dump().c_str());
  } else {
    std::printf("%s, %g Hz, %zu samples", trace.format.c_str(), trace.rate_Hz, states.size());
    if (options.online) std::printf(", online with a delay of %g ms", 1e3 * delay_s);
    std::printf("\n%s", text.c_str());
  }
}

/// Every labelling of the pooled recordings against every other: "foci" first, then the coders.
struct Scores {
  static constexpr std::size_t kStable = 6;  // after the six states: fixation or pursuit

  std::map<std::pair<std::string, std::string>, std::array<CohensKappa, 7>> kappas{};
  std::map<std::string, std::array<double, 6>> counts{};
  double samples = 0.0;

  void compare(const std::string& a, const std::string& b, GazeState x, GazeState y) {
    auto& all = kappas[{a, b}];
    for (std::size_t i = 0; i < kStable; ++i) all[i].add(x == kStates[i], y == kStates[i]);
    all[kStable].add(isStable(x), isStable(y));
  }

  void add(const LabelledTrace& labelled, const std::vector<GazeState>& states) {
    samples += static_cast<double>(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) {
      ++counts["foci"][static_cast<std::size_t>(states[i])];
      for (std::size_t a = 0; a < labelled.coders.size(); ++a) {
        const auto& label = labelled.coders[a].labels[i];
        if (!label) continue;
        const std::string& name = labelled.coders[a].name;
        ++counts[name][static_cast<std::size_t>(*label)];
        compare("foci", name, states[i], *label);
        for (std::size_t b = a + 1; b < labelled.coders.size(); ++b) {
          const auto& other = labelled.coders[b].labels[i];
          if (other) compare(name, labelled.coders[b].name, *label, *other);
        }
      }
    }
  }
};

std::string wordOf(std::size_t kind) {
  return kind == Scores::kStable ? "stable" : std::string(nameOf(kStates[kind]));
}

void score(const EventsOptions& options) {
  Scores scores;
  for (const std::string& file : options.traces) {
    const LabelledTrace labelled = readLabelledTrace(file, screenOf(options.screen));
    requireWholeScreen(*labelled.trace.screen, file);
    scores.add(labelled, labelsOf(labelled.trace, options.online));
  }
  nlohmann::ordered_json json = {{"recordings", options.traces.size()},
                                 {"samples", scores.samples},
                                 {"online", options.online}};
  std::string text = "kappa    ";
  for (const auto& [pair, kappas] : scores.kappas) text += "  " + pair.first + ":" + pair.second;
  text += '\n';
  for (std::size_t kind = 0; kind <= Scores::kStable; ++kind) {
    text += wordOf(kind) + std::string(9 - wordOf(kind).size(), ' ');
    for (const auto& [pair, kappas] : scores.kappas) {
      const auto value = kappas[kind].value();
      const std::size_t width = pair.first.size() + pair.second.size() + 3;
      std::string cell = value ? decimal(*value, 3) : "n/a";
      text += std::string(width - std::min(width, cell.size()), ' ') + cell;
      auto& entry = json["kappa"][pair.first + ":" + pair.second][wordOf(kind)];
      if (value) entry = *value;
    }
    text += '\n';
  }
  text += "share    ";
  for (const auto& [name, counts] : scores.counts) text += "  " + name;
  text += '\n';
  for (std::size_t kind = 0; kind < Scores::kStable; ++kind) {
    text += wordOf(kind) + std::string(9 - wordOf(kind).size(), ' ');
    for (const auto& [name, counts] : scores.counts) {
      const double share = counts[static_cast<std::size_t>(kStates[kind])] / scores.samples;
      const std::string cell = decimal(share, 3);
      const std::size_t width = name.size() + 2;
      text += std::string(width - std::min(width, cell.size()), ' ') + cell;
      json["share"][name][wordOf(kind)] = share;
    }
    text += '\n';
  }
  if (options.json) {
    std::puts(json.dump().c_str());
  } else {
    std::printf("%zu recordings, %.0f samples, %s\n%s", options.traces.size(), scores.samples,
                options.online ? "online" : "offline", text.c_str());
  }
}

}  // namespace

void addEventsCommand(CLI::App& app) {
  const auto options = std::make_shared<EventsOptions>();
  CLI::App* events = app.add_subcommand(
      "events",
      "Fixations, saccades, oscillations, pursuit, blinks and losses of a recording.\n"
      "Example: foci events gaze.tsv --out events.tsv --samples samples.tsv");
  EventsOptions& o = *options;
  events->add_option("TRACE", o.traces, "recording of gaze; with --score one or more")->required();
  events->add_flag("--online", o.online, "as a live tracker would say it, with its delay");
  events->add_option("--out", o.out, "the events, one a row")->type_name("FILE.tsv");
  events->add_option("--samples", o.samples, "the label of every sample")->type_name("FILE.tsv");
  events->add_option("--physioevents", o.physioevents, "the events as BIDS has them")
      ->type_name("FILE_physioevents.tsv");
  events->add_flag("--score", o.score,
                   "agreement (Cohen's kappa) with the recordings' columns coder_NAME");
  addScreenOptions(*events, o.screen);
  events->add_flag("--json", o.json, "print the summary as JSON");
  events->callback([options, events] {
    for (const CLI::Option* option : events->get_options()) {
      if (option->count() > 0 && option->get_type_size() > 0 && option->as<std::string>().empty()) {
        throw InputError(option->get_name(), "expected a value that is not empty");
      }
    }
    if (options->score) return score(*options);
    if (options->traces.size() > 1) throw InputError("TRACE: expected one, or --score");
    detect(*options);
  });
}

}  // namespace foci
