#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "app/record/manifest.h"
#include "app/record/tables.h"
#include "app/study/study_words.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/events/event_labels.h"
#include "gaze/events/online_events.h"
#include "gaze/events/recording_quality.h"
#include "gaze/sources/bids.h"
#include "gaze/sources/trace_reader.h"

namespace foci {
namespace {

constexpr GazeState kStates[] = {GazeState::fixation, GazeState::saccade, GazeState::oscillation,
                                 GazeState::pursuit,  GazeState::blink,   GazeState::lost,
                                 GazeState::unjudged};

struct EventsOptions : TraceOptions {
  std::vector<std::string> traces{};
  std::string out{}, samples{}, physioevents{};
  std::string detector{};
  std::optional<bool> pursuit{};
  bool online = false, score = false, compare = false, json = false, overwrite = false;
};

/// Time and label of each sample, the probability of each label, and the detector.
std::string sampleTable(const GazeTrace& trace, const EventLabels& labels, Detector detector) {
  constexpr int kDigits = 6, kProbabilityDigits = 4;
  const std::string end = '\t' + labelOf(detector) + '\n';
  std::string table = "time_s\tlabel";
  for (const GazeState state : kStates) table += "\tp_" + std::string(nameOf(state));
  table += "\tdetector\n";
  for (std::size_t i = 0; i < labels.states.size(); ++i) {
    table += decimal(trace.samples[i].time_s, kDigits) + '\t';
    table += nameOf(labels.states[i]);
    for (const GazeState state : kStates) {
      table += '\t';
      table += labels.probabilities.empty()
                   ? "n/a"
                   : decimal(labels.probabilities[i][static_cast<std::size_t>(state)],
                             kProbabilityDigits);
    }
    table += end;
  }
  return table;
}

/// The JSON beside a BIDS table of events; empty without a table. @throws InputError
std::string sidecarOf(const std::string& physioevents) {
  constexpr std::string_view kEnding = "_physioevents.tsv.gz";
  if (physioevents.empty()) return {};
  if (!physioevents.ends_with(kEnding)) {
    throw InputError("--physioevents " + physioevents,
                     "expected a name that ends in _physioevents.tsv.gz");
  }
  return physioevents.substr(0, physioevents.size() - 7) + ".json";
}

/// BIDS: onset and duration in seconds, packed, no header. The JSON sidecar names the columns.
void writePhysioevents(const std::string& file, const std::vector<GazeEvent>& events,
                       OutputFiles& files) {
  constexpr int kDigits = 6;
  std::string table;
  for (const GazeEvent& event : events) {
    table += decimal(event.onset_s, kDigits) + '\t' + decimal(event.duration_s, kDigits) + '\t' +
             std::string(nameOf(event.kind)) + '\n';
  }
  files.write(file, [&](const auto& path) { writePacked(path, table); });
  files.write(
      sidecarOf(file),
      bidsTableJson(
          "trial_type", "Eye movements, detected by foci",
          "fixation, saccade, pso (post-saccadic oscillation), pursuit, blink, lost, unjudged"));
}

/// How often each kind of event occurs, and its share of the samples: as text and in `json`.
std::string countsOf(const std::vector<GazeState>& states, const std::vector<GazeEvent>& events,
                     nlohmann::ordered_json& json) {
  std::string text;
  for (const GazeState kind : kStates) {
    const auto samples = std::ranges::count(states, kind);
    const auto count = countOf(events, kind);
    const double share = static_cast<double>(samples) / static_cast<double>(states.size());
    json["events"][nameOf(kind)] = {{"count", count}, {"share", share}};
    text += printed("%-9s %5ld events  %5.1f %% of the samples\n",
                    std::string(nameOf(kind)).c_str(), static_cast<long>(count), 100.0 * share);
  }
  return text;
}

/// @throws InputError if an output must not be written
OutputGuard guardOf(const EventsOptions& options) {
  const std::string& trace = options.traces[0];
  std::vector<std::filesystem::path> inputs = companionsOf(trace);
  inputs.emplace_back(trace);
  inputs.emplace_back(options.study);
  return {{options.out, options.samples, options.physioevents, sidecarOf(options.physioevents)},
          inputs,
          options.overwrite};
}

TraceDescription unmappedDescriptionOf(const EventsOptions& options) {
  TraceDescription description = descriptionOf(options);
  if (description.columns.mapped_later) {
    throw InputError(options.study, "gaze.map: foci events applies no gaze map; expected none");
  }
  if (const auto detector = detectorNamed(options.detector)) {
    description.events.detector = *detector;
  }
  if (options.pursuit) description.events.pursuit = options.pursuit;
  return description;
}

Warnings warningsOf(const std::string& file, const GazeTrace& trace) {
  Warnings warnings;
  const std::string before = file + ": assumed: ";
  for (const std::string& assumption : trace.assumed) say(before + assumption);
  warnings.addAll(file, trace.warnings);
  return warnings;
}

/// @throws InputError if no sample can be judged
EventLabels judgedLabels(const std::string& file, const GazeTrace& trace,
                         const EventSettings& settings, bool online) {
  EventLabels labels = labelEvents(trace, *trace.screen, settings, online);
  if (labels.any_judged) return labels;
  const std::string reasons = listed(labels.warnings, "; ");
  throw InputError(file,
                   "no sample can be judged: " + (reasons.empty() ? "all gaze is lost" : reasons));
}

void detectEvents(const EventsOptions& options) {
  OutputFiles files(guardOf(options));
  const TraceDescription description = unmappedDescriptionOf(options);
  const GazeTrace trace = readTrace(options.traces[0], description.columns, description.screen);
  requireWholeScreen(*trace.screen, options.traces[0]);
  Warnings warnings = warningsOf(options.traces[0], trace);
  const EventSettings& settings = description.events;
  const EventLabels labels = judgedLabels(options.traces[0], trace, settings, options.online);
  const auto events = eventsOf(labels, trace, *trace.screen, settings);
  const RecordingQuality quality = qualityOf(trace, *trace.screen, labels.states, events);
  warnings.addAll(options.traces[0], eventWarnings(trace, labels, quality, settings));
  if (!options.out.empty())
    files.write(options.out, eventTable(events, trace.trials, settings.detector));
  if (!options.samples.empty()) {
    files.write(options.samples, sampleTable(trace, labels, settings.detector));
  }
  if (!options.physioevents.empty()) writePhysioevents(options.physioevents, events, files);
  files.commit();

  const double delay_s =
      options.online ? OnlineEvents(*trace.screen, trace.rate_Hz, settings).delay_s() : 0.0;
  nlohmann::ordered_json summary = {{"format", trace.format},
                                    {"rate_Hz", trace.rate_Hz},
                                    {"samples", labels.states.size()},
                                    {"detector", nameOf(settings.detector)},
                                    {"detector_version", versionOf(settings.detector)},
                                    {"online", options.online},
                                    {"delay_s", delay_s},
                                    {"warnings", warnings.all()},
                                    {"quality", toJson(quality)}};
  const std::string text = countsOf(labels.states, events, summary) + qualityText(quality) + '\n';
  if (options.json) {
    std::puts(jsonText(summary).c_str());
    return;
  }
  std::printf("%s, %g Hz, %zu samples, detector %s", visible(trace.format).c_str(), trace.rate_Hz,
              labels.states.size(), labelOf(settings.detector).c_str());
  if (options.online) std::printf(", online with a delay of %g ms", 1e3 * delay_s);
  std::printf("\n%s", text.c_str());
}

/// Agreement of every labeller with every other, over all recordings. The labellers are detectors,
/// or "foci" and the human coders.
struct Scores {
  /// After the states: fixation and pursuit in one.
  static constexpr std::size_t kStable = kGazeStates;

  std::map<std::pair<std::string, std::string>, std::array<CohensKappa, kStable + 1>> kappas{};
  std::map<std::string, std::array<double, kGazeStates>> counts{};
  double samples = 0.0;

  void compare(const std::string& a, const std::string& b, GazeState x, GazeState y) {
    auto& all = kappas[{a, b}];
    for (std::size_t i = 0; i < kStable; ++i) all[i].add(x == kStates[i], y == kStates[i]);
    all[kStable].add(isStable(x), isStable(y));
  }

  /// @param all  labels of one recording
  void add(const std::vector<Coder>& all) {
    samples += static_cast<double>(all.front().labels.size());
    for (std::size_t a = 0; a < all.size(); ++a) {
      for (std::size_t i = 0; i < all[a].labels.size(); ++i) {
        const auto& label = all[a].labels[i];
        if (!label) continue;
        ++counts[all[a].name][static_cast<std::size_t>(*label)];
        for (std::size_t b = a + 1; b < all.size(); ++b) {
          if (const auto& other = all[b].labels[i]) {
            compare(all[a].name, all[b].name, *label, *other);
          }
        }
      }
    }
  }
};

std::string wordOf(std::size_t kind) {
  return kind == Scores::kStable ? "stable" : std::string(nameOf(kStates[kind]));
}

/// A table with a row for each kind of event: as text and in `json`.
/// @param columns  values by name  @param valueOf  of a column's values and a kind
template <class Columns, class ValueOf>
std::string kindTable(const std::string& title, std::size_t kinds, const Columns& columns,
                      const ValueOf& valueOf, nlohmann::ordered_json& json) {
  const auto padded = [](const std::string& text, std::size_t width) {
    return std::string(width - std::min(width, text.size()), ' ');
  };
  std::string text = title + padded(title, 9);
  for (const auto& [name, values] : columns) text += "  " + name;
  text += '\n';
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    const std::string word = wordOf(kind);
    text += word + padded(word, 9);
    for (const auto& [name, values] : columns) {
      const std::optional<double> value = valueOf(values, kind);
      const std::string cell = value ? decimal(*value, 3) : "n/a";
      text += padded(cell, name.size() + 2) + cell;
      auto& entry = json[title][name][word];
      if (value) entry = *value;
    }
    text += '\n';
  }
  return text;
}

/// Cohen's kappa of each pair of labellers, and the share of the samples that each labeller gave to
/// each kind of event.
std::string scoreTables(const Scores& scores, nlohmann::ordered_json& json) {
  std::vector<std::pair<std::string, std::array<CohensKappa, Scores::kStable + 1>>> kappas;
  for (const auto& [pair, all] : scores.kappas) {
    kappas.emplace_back(pair.first + ":" + pair.second, all);
  }
  const auto kappaOf = [](const auto& all, std::size_t kind) { return all[kind].value(); };
  const auto shareOf = [&](const auto& counts, std::size_t kind) {
    return counts[static_cast<std::size_t>(kStates[kind])] / scores.samples;
  };
  return kindTable("kappa", Scores::kStable + 1, kappas, kappaOf, json) +
         kindTable("share", Scores::kStable, scores.counts, shareOf, json);
}

/// Agreement on the same recordings: of every detector with every other, or of one with the coders.
void scoreEvents(const EventsOptions& options) {
  TraceDescription description = unmappedDescriptionOf(options);
  std::vector<Detector> detectors{description.events.detector};
  if (options.compare) detectors.assign(kDetectors.begin(), kDetectors.end());
  Scores scores;
  Warnings warnings;
  for (const std::string& file : options.traces) {
    LabelledTrace labelled;
    if (options.compare) {
      labelled.trace = readTrace(file, description.columns, description.screen);
    } else {
      labelled = readLabelledTrace(file, description.screen, description.columns);
    }
    requireWholeScreen(*labelled.trace.screen, file);
    warnings.include(warningsOf(file, labelled.trace).all());
    std::vector<Coder> all;
    for (const Detector detector : detectors) {
      description.events.detector = detector;
      const EventLabels labels =
          judgedLabels(file, labelled.trace, description.events, options.online);
      if (all.empty()) warnings.addAll(file, labels.warnings);
      all.push_back({.name = options.compare ? labelOf(detector) : "foci",
                     .labels = {labels.states.begin(), labels.states.end()}});
    }
    all.insert(all.end(), labelled.coders.begin(), labelled.coders.end());
    scores.add(all);
  }
  nlohmann::ordered_json json = {{"recordings", options.traces.size()},
                                 {"samples", scores.samples}};
  if (!options.compare) {
    json["detector"] = nameOf(detectors[0]);
    json["detector_version"] = versionOf(detectors[0]);
  }
  json["online"] = options.online;
  json["warnings"] = warnings.all();
  const std::string text = scoreTables(scores, json);
  if (options.json) {
    std::puts(jsonText(json).c_str());
    return;
  }
  if (!options.compare) {
    std::printf("%s, %.0f samples, detector %s, %s\n",
                counted(options.traces.size(), "recording").c_str(), scores.samples,
                labelOf(detectors[0]).c_str(), options.online ? "online" : "offline");
  }
  std::printf("%s", text.c_str());
}

}  // namespace

void addEventsCommand(CLI::App& app) {
  const auto options = std::make_shared<EventsOptions>();
  CLI::App* events =
      app.add_subcommand("events",
                         "Detect eye movements in a recording. Types of events:\n"
                         "  fixation  the eye rests\n"
                         "  saccade   the eye jumps\n"
                         "  pso       post-saccadic oscillation: the eye swings after a saccade\n"
                         "  pursuit   smooth pursuit: the eye follows a moving target\n"
                         "  blink     the lid is closed\n"
                         "  lost      data loss without a blink\n"
                         "  unjudged  the signal does not tell\n"
                         "Example: foci events gaze.tsv --out events.tsv --samples samples.tsv");
  EventsOptions& o = *options;
  std::vector<std::string> detectors;
  detectors.reserve(kDetectors.size());
  for (const Detector detector : kDetectors) detectors.emplace_back(nameOf(detector));
  events->add_option("TRACE", o.traces, "gaze recording; several with --score, --compare-detectors")
      ->required();
  addOption(*events, "--detector", o.detector, "NAME",
            "trained (default), rules, ivt or idt; overrides the study's gaze.detector")
      ->check(CLI::IsMember(detectors));
  addOption(*events, "--pursuit", o.pursuit, "true|false",
            "false: pursuit counts as fixation; overrides the study's gaze.pursuit");
  events->add_flag("--online", o.online, "use the online detector of foci live, which has a delay");
  addOption(*events, "--out", o.out, "FILE.tsv", "table of the events");
  addOption(*events, "--samples", o.samples, "FILE.tsv", "table of the label of every sample");
  addOption(*events, "--physioevents", o.physioevents, "FILE_physioevents.tsv.gz",
            "the events as a BIDS table with a JSON sidecar");
  events->add_flag("--score", o.score,
                   "agreement (Cohen's kappa) with the human coders in the columns coder_NAME");
  events->add_flag("--compare-detectors", o.compare,
                   "agreement (Cohen's kappa) of the detectors with each other");
  addTraceOptions(*events, o);
  addOverwriteFlag(*events, o.overwrite);
  events->add_flag("--json", o.json, "print the summary as JSON");
  onceParsed(*events, [options] {
    if (!options->score && !options->compare && options->traces.size() > 1) {
      throw InputError("TRACE: expected one recording, --score or --compare-detectors");
    }
    const bool scores = options->score || options->compare;
    withTraceHints(*options, [&] { scores ? scoreEvents(*options) : detectEvents(*options); });
  });
}

}  // namespace foci
