// Trains the model of the event detector `trained`, and measures it on data sets left out.
//
//   foci_train_events FOLDER --out MODEL [--json FILE]
//
// FOLDER holds the labelled recordings, one folder for each set. The same data give the same bytes,
// at any number of threads. Each set in turn is left out of the training and then labelled; so is
// each third of the observers. The table shows both beside the coders among themselves. The curve
// that turns the trees' probabilities into shares of right labels comes from the sets left out.
#include <cstdio>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "app/platform/output_files.h"
#include "app/platform/sha256.h"
#include "base/input_error.h"
#include "gaze/events/trained_events.h"
#include "gaze/geometry/line_of_sight.h"
#include "tests/bench/boosting.h"
#include "tests/bench/event_scores.h"
#include "tests/bench/packed_model.h"
#include "tests/bench/training_data.h"

namespace foci {
namespace {

constexpr unsigned kSeed = 1;
constexpr int kRevision = 3;
// Chosen on sets left out, with the other sets but hmr in the training.
constexpr std::array<double, 3> kAhead_s = {0.0, 0.02, 0.05};
constexpr double kMotionSwitch_s = 0.002, kOscillationSwitch_s = 0.001, kPursuitSwitch_s = 0.06;
constexpr BoostingSettings kMotion{.rounds = 60, .depth = 5};
constexpr BoostingSettings kOscillation{.rounds = 30, .depth = 4};
constexpr BoostingSettings kPursuit{.rounds = 40, .depth = 4};
constexpr int kCopies = 3;              // of each recording, beside itself
constexpr double kRowsOfSet = 40000.0;  // that motion is learnt from
constexpr double kPursuitRowsOfSet = 20000.0;
/// Rare classes weigh more: each class by its share to the power of this.
constexpr double kRareness = -0.15;
// The copies' rates and noise.
constexpr double kMinRate_Hz = 50.0, kMaxRate_Hz = 1000.0, kMinNoise_deg = 0.02,
                 kMaxNoise_deg = 1.0;

struct Source {
  const char *set, *licence, *paper;
  bool trained;
};
/// hmr holds pupils in an eye camera, with a guessed scale and long saccades. In the training, it
/// lowers the kappa of every other set left out, by 0.01 (gazecom, pictures) to 0.05 (dots). So it
/// is only labelled, as a tracker that the detector does not know.
constexpr std::array<Source, 4> kSources = {{
    {"andersson2017", "GPL-3.0", "Andersson et al. 2017, Behavior Research Methods 49, 616", true},
    {"gazecom", "MIT",
     "Dorr et al. 2010, Journal of Vision 10(10), 28; Startsev et al. 2019, Behavior Research "
     "Methods 51, 556; Elmadjian et al. 2022, Behavior Research Methods",
     true},
    {"hmr", "MIT", "Elmadjian et al. 2022, Behavior Research Methods", false},
    {"irf", "MIT", "Zemblys et al. 2018, Behavior Research Methods 50, 160", true},
}};

const Source& sourceOf(const std::string& set) {
  for (const Source& source : kSources) {
    if (set == source.set) return source;
  }
  throw InputError(set,
                   "set of labelled recordings: expected andersson2017, andersson2017_one_coder, "
                   "gazecom, hmr or irf");
}

int classOf(GazeState state) {
  if (isStable(state)) return static_cast<int>(Motion::stable);
  const bool moving = state == GazeState::saccade || state == GazeState::oscillation;
  return static_cast<int>(moving ? Motion::moving : Motion::gone);
}

/// A third of the observers of each set; each recording of an observer is in the same third.
int foldOf(const LabelledRecording& recording) {
  const std::string& name = recording.name;
  if (recording.set == "irf") return name.back() % 3;
  const auto part = name.find_last_of('_');
  std::string who = recording.set == "gazecom" ? name.substr(part + 1) : name;
  if (recording.set == "andersson2017") who = name.substr(name.find('_') + 1, 4);
  unsigned sum = 0;
  for (const char letter : who) sum = 31U * sum + static_cast<unsigned char>(letter);
  return static_cast<int>((sum >> 1) % 3);
}

/// Whether a recording is in the training.
using Chosen = std::function<bool(const LabelledRecording&)>;

struct Row {
  std::size_t recording = 0;
  GazeState label = GazeState::fixation;
  float weight = 0.0F;
};

/// Rows of features at each lookahead.
struct MotionRows {
  std::vector<Row> rows{};
  std::array<std::vector<float>, kAhead_s.size()> values{};
};

/// All versions of the recordings: as they are, and copies.
class Versions {
 public:
  explicit Versions(const std::vector<LabelledRecording>& recordings) : recordings_(recordings) {
    for (const LabelledRecording& each : recordings) {
      duration_s_[each.set] += durationOf_s(each);
    }
  }

  static double durationOf_s(const LabelledRecording& recording) {
    const GazeTrace& trace = recording.labelled.trace;
    return static_cast<double>(trace.samples.size()) / trace.rate_Hz;
  }
  /// Share of the recording in its set.
  double shareOf(std::size_t recording) const {
    return durationOf_s(recordings_[recording]) / duration_s_.at(recordings_[recording].set);
  }
  /// @param copy  0: the recording itself
  LabelledTrace version(std::size_t recording, int copy, Random& random) const {
    const LabelledTrace& original = recordings_[recording].labelled;
    if (copy == 0) return original;
    CopySettings settings{.rate_Hz =
                              kMinRate_Hz * std::pow(kMaxRate_Hz / kMinRate_Hz, random.uniform())};
    if (random.uniform() < 0.65) {
      settings.noise_deg =
          kMinNoise_deg * std::pow(kMaxNoise_deg / kMinNoise_deg, random.uniform());
    }
    if (random.uniform() < 0.1) settings.rounding_deg = 0.1;
    if (random.uniform() < 0.1) settings.lost = 0.2 * random.uniform();
    return copyOf(original, settings, random);
  }
  Random randomOf(std::size_t recording, int copy) const {
    return Random(kSeed * 1000003ULL + recording * 101ULL + static_cast<std::uint64_t>(copy));
  }
  const std::vector<LabelledRecording>& recordings() const { return recordings_; }

 private:
  const std::vector<LabelledRecording>& recordings_;
  std::map<std::string, double> duration_s_{};
};

/// Features of the chosen samples of one version at every lookahead.
void addFeatures(const GazeTrace& trace, const std::vector<std::size_t>& samples,
                 MotionRows& rows) {
  constexpr double kNoise_s = 3.0;  // as in trained_events.cpp
  GazeFeatures features(trace.rate_Hz, kNoise_s);
  std::size_t next = 0;
  const auto take = [&] {
    const std::size_t sample = samples[next++];
    for (std::size_t level = 0; level < kAhead_s.size(); ++level) {
      const GazeFeatureVector values = features.of(sample, kAhead_s[level]);
      rows.values[level].insert(rows.values[level].end(), values.begin(), values.end());
    }
  };
  for (const GazeSample& sample : trace.samples) {
    const auto sight = sightInWorld(sample, *trace.screen);
    features.push({sample.time_s, sight}, sight);
    while (next < samples.size() && samples[next] < features.pushed() &&
           sample.time_s - trace.samples[samples[next]].time_s >= kAhead_s.back() - 1e-6) {
      take();
    }
    if (next < samples.size()) features.forgetBefore(samples[next]);
  }
  while (next < samples.size()) take();
}

/// Rows of one version: the classes in fixed shares, so that short events are seen, with weights
/// that undo it.
void addMotionRows(const LabelledTrace& labelled, std::size_t recording, double rows_wanted,
                   Random& random, MotionRows& rows) {
  constexpr double kShares[] = {0.5, 0.35, 0.15};  // of the rows, for each class
  std::vector<std::size_t> samples;
  for (const Coder& coder : labelled.coders) {
    std::array<double, 3> counts{};
    for (const auto& label : coder.labels) {
      if (label) counts[classOf(*label)] += 1.0;
    }
    const double wanted = rows_wanted / static_cast<double>(labelled.coders.size());
    const double all = static_cast<double>(coder.labels.size());
    for (std::size_t i = 0; i < coder.labels.size(); ++i) {
      if (!coder.labels[i]) continue;
      const int k = classOf(*coder.labels[i]);
      const double chance = std::min(kShares[k] * wanted / counts[k], 1.0);
      if (random.uniform() >= chance) continue;
      samples.push_back(i);
      rows.rows.push_back(
          {recording, *coder.labels[i], static_cast<float>(wanted / (chance * all))});
    }
    addFeatures(labelled.trace, samples, rows);
    samples.clear();
  }
}

MotionRows collectMotionRows(const Versions& versions) {
  const std::size_t count = versions.recordings().size();
  std::vector<MotionRows> parts(count);
  parallelFor(count, [&](std::size_t r) {
    for (int copy = 0; copy <= kCopies; ++copy) {
      Random random = versions.randomOf(r, copy);
      const LabelledTrace labelled = versions.version(r, copy, random);
      addMotionRows(labelled, r, kRowsOfSet * versions.shareOf(r) / (kCopies + 1), random,
                    parts[r]);
    }
  });
  MotionRows all;
  for (MotionRows& part : parts) {
    all.rows.insert(all.rows.end(), part.rows.begin(), part.rows.end());
    for (std::size_t level = 0; level < kAhead_s.size(); ++level) {
      all.values[level].insert(all.values[level].end(), part.values[level].begin(),
                               part.values[level].end());
      part.values[level] = {};
    }
  }
  return all;
}

/// Equal weight for each set, more for rare classes, and a mean weight of 1.
void balance(TrainingRows& rows, const std::vector<std::string>& sets, std::size_t classes) {
  std::map<std::string, double> of_set;
  for (std::size_t i = 0; i < rows.size(); ++i) of_set[sets[i]] += rows.weights[i];
  std::vector<double> of_class(classes, 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows.weights[i] /= static_cast<float>(of_set[sets[i]]);
    of_class[rows.classes[i]] += rows.weights[i];
    sum += rows.weights[i];
  }
  double balanced = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows.weights[i] *= static_cast<float>(std::pow(of_class[rows.classes[i]] / sum, kRareness));
    balanced += rows.weights[i];
  }
  for (float& weight : rows.weights)
    weight *= static_cast<float>(static_cast<double>(rows.size()) / balanced);
}

class Trainer {
 public:
  explicit Trainer(const std::vector<LabelledRecording>& recordings)
      : versions_(recordings), rows_(collectMotionRows(versions_)) {}

  /// @param levels  whose trees are needed; the others stay empty
  EventModel train(const Chosen& chosen, const std::vector<std::size_t>& levels) const {
    EventModel model{.revision = kRevision,
                     .seed = kSeed,
                     .rate_Hz = {kMinRate_Hz, kMaxRate_Hz},
                     .noise_deg = {0.0, kMaxNoise_deg},
                     .motion_switch_s = kMotionSwitch_s,
                     .oscillation_switch_s = kOscillationSwitch_s,
                     .pursuit_switch_s = kPursuitSwitch_s};
    for (const std::size_t level : levels) {
      ModelLevel each{.ahead_s = kAhead_s[level]};
      each.motion = trainMotion(chosen, level);
      each.oscillation = trainOscillation(chosen, level);
      model.levels.push_back(std::move(each));
    }
    for (ModelMode* mode : {&model.online, &model.offline}) {
      mode->pursuit = {.classes = 2, .features = kPursuitFeatures, .priors = {0.7F, 0.3F}};
      mode->pursuit = trainPursuit(chosen, model, mode == &model.offline);
    }
    return model;
  }

 private:
  BoostedTrees trainMotion(const Chosen& chosen, std::size_t level) const {
    TrainingRows rows{.features = kGazeFeatures};
    std::vector<std::string> sets;
    for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
      add(chosen, level, i, classOf(rows_.rows[i].label), rows, sets);
    }
    balance(rows, sets, 3);
    return Boosting(rows, 3, kMotion).train();
  }

  BoostedTrees trainOscillation(const Chosen& chosen, std::size_t level) const {
    TrainingRows rows{.features = kGazeFeatures};
    std::vector<std::string> sets;
    for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
      const GazeState label = rows_.rows[i].label;
      // The coders of gazecom and hmr label no oscillations.
      const std::string& set = versions_.recordings()[rows_.rows[i].recording].set;
      if (set != "andersson2017" && set != "irf") continue;
      if (label != GazeState::saccade && label != GazeState::oscillation) continue;
      add(chosen, level, i, label == GazeState::oscillation ? 1 : 0, rows, sets);
    }
    balance(rows, sets, 2);
    return Boosting(rows, 2, kOscillation).train();
  }

  void add(const Chosen& chosen, std::size_t level, std::size_t row, int class_of,
           TrainingRows& rows, std::vector<std::string>& sets) const {
    const LabelledRecording& recording = versions_.recordings()[rows_.rows[row].recording];
    if (!chosen(recording)) return;
    const float* values = &rows_.values[level][row * kGazeFeatures];
    rows.values.insert(rows.values.end(), values, values + kGazeFeatures);
    rows.classes.push_back(static_cast<std::uint8_t>(class_of));
    rows.weights.push_back(rows_.rows[row].weight);
    sets.push_back(recording.set);
  }

  /// Rows from stable gaze as the first step finds it, in the recordings and one copy of each.
  BoostedTrees trainPursuit(const Chosen& chosen, const EventModel& model, bool offline) const {
    const auto& recordings = versions_.recordings();
    std::vector<TrainingRows> parts(recordings.size());
    parallelFor(recordings.size(), [&](std::size_t r) {
      if (!chosen(recordings[r])) return;
      for (int copy = 0; copy <= 1; ++copy) {
        Random random = versions_.randomOf(r, copy);
        const LabelledTrace labelled = versions_.version(r, copy, random);
        addPursuitRows(labelled, 0.5 * kPursuitRowsOfSet * versions_.shareOf(r), model, offline,
                       random, parts[r]);
      }
    });
    TrainingRows all{.features = kPursuitFeatures};
    std::vector<std::string> sets;
    for (std::size_t r = 0; r < parts.size(); ++r) {
      all.values.insert(all.values.end(), parts[r].values.begin(), parts[r].values.end());
      all.classes.insert(all.classes.end(), parts[r].classes.begin(), parts[r].classes.end());
      all.weights.insert(all.weights.end(), parts[r].weights.begin(), parts[r].weights.end());
      sets.insert(sets.end(), parts[r].size(), recordings[r].set);
    }
    balance(all, sets, 2);
    return Boosting(all, 2, kPursuit).train();
  }

  static void addPursuitRows(const LabelledTrace& labelled, double wanted, const EventModel& model,
                             bool offline, Random& random, TrainingRows& rows) {
    const double chance =
        std::min(wanted / static_cast<double>(labelled.trace.samples.size()), 1.0);
    const TakePursuit take = [&](std::size_t sample, const PursuitFeatureVector& features) {
      if (random.uniform() >= chance) return;
      for (const Coder& coder : labelled.coders) {
        const auto& label = coder.labels[sample];
        if (!label || !isStable(*label)) continue;
        rows.values.insert(rows.values.end(), features.begin(), features.end());
        rows.classes.push_back(*label == GazeState::pursuit ? 1 : 0);
        rows.weights.push_back(1.0F / static_cast<float>(labelled.coders.size()));
      }
    };
    const EventSettings settings;
    (offline ? labelTrained : labelTrainedOnline)(labelled.trace, *labelled.trace.screen, settings,
                                                  model, take);
  }

  Versions versions_;
  MotionRows rows_;
};

/// Known without the trees: gaze is missing, or the tracker reports a blink.
bool isCertain(const SampleLabel& label) { return label.confidence() > 1.0 - 1e-9; }

/// How often labels of a stated probability are right, for each set.
struct Calibration {
  static constexpr std::size_t kBins = 20;
  struct Bin {
    double count = 0.0, stated = 0.0, right = 0.0;
  };
  std::map<std::string, std::array<Bin, kBins>> sets{};

  void add(const std::string& set, double stated, bool right) {
    Bin& bin = sets[set][std::min(static_cast<std::size_t>(stated * kBins), kBins - 1)];
    bin.count += 1.0;
    bin.stated += stated;
    bin.right += right;
  }

  static double countOf(const std::array<Bin, kBins>& bins) {
    double all = 0.0;
    for (const Bin& each : bins) all += each.count;
    return all;
  }

  /// With equal weight for each set but one, and never falling (pool adjacent violators).
  std::vector<CalibrationKnot> knots(const std::string& without = {}) const {
    std::vector<Bin> pooled;
    for (std::size_t b = 0; b < kBins; ++b) {
      Bin bin;
      for (const auto& [set, bins] : sets) {
        if (set == without) continue;
        const double all = countOf(bins);
        bin.count += bins[b].count / all;
        bin.stated += bins[b].stated / all;
        bin.right += bins[b].right / all;
      }
      if (bin.count < 1e-4) continue;
      pooled.push_back(bin);
      while (pooled.size() > 1 &&
             pooled.back().right / pooled.back().count <
                 pooled[pooled.size() - 2].right / pooled[pooled.size() - 2].count) {
        const Bin last = pooled.back();
        pooled.pop_back();
        pooled.back().count += last.count;
        pooled.back().stated += last.stated;
        pooled.back().right += last.right;
      }
    }
    std::vector<CalibrationKnot> result;
    result.reserve(pooled.size());
    for (const Bin& bin : pooled) result.push_back({bin.stated / bin.count, bin.right / bin.count});
    return result;
  }

  /// How often labels are right, by the probability that the curve of the other sets gives them.
  nlohmann::ordered_json leftOut() const {
    std::array<Bin, kBins> all{};
    for (const auto& [set, bins] : sets) {
      const auto curve = knots(set);
      for (const Bin& bin : bins) {
        if (bin.count == 0.0) continue;
        const double stated = calibrated(bin.stated / bin.count, curve);
        const double share = bin.count / countOf(bins);
        Bin& into = all[std::min(static_cast<std::size_t>(stated * kBins), kBins - 1)];
        into.count += share;
        into.stated += share * stated;
        into.right += bin.right / countOf(bins);
      }
    }
    auto curve = nlohmann::ordered_json::array();
    for (const Bin& bin : all) {
      if (bin.count > 0.0) curve.push_back({bin.stated / bin.count, bin.right / bin.count});
    }
    return curve;
  }
};

/// Agreement with each coder, for each kind of recording, rate and detector.
struct Validation {
  std::map<std::string, std::map<std::string, std::map<std::string, LabelAgreement>>> table{};
  std::array<Calibration, 2> calibration{};  ///< online, offline

  void addLabels(const LabelledRecording& recording, const EventModel& model) {
    for (const double rate_Hz : {0.0, 60.0, 120.0}) {
      Random random(kSeed);
      const LabelledTrace labelled = rate_Hz > 0.0
                                         ? copyOf(recording.labelled, {.rate_Hz = rate_Hz}, random)
                                         : recording.labelled;
      for (const bool online : {false, true}) {
        if (online && rate_Hz > 0.0) continue;
        std::string column = online ? "online" : "offline";
        if (rate_Hz > 0.0) column = std::to_string(static_cast<int>(rate_Hz)) + " Hz";
        add(recording, labelled, model, online, column);
      }
    }
  }

  void add(const LabelledRecording& recording, const LabelledTrace& labelled,
           const EventModel& model, bool online, const std::string& column) {
    const GazeTrace& trace = labelled.trace;
    const EventSettings settings;
    const auto found =
        (online ? labelTrainedOnline : labelTrained)(trace, *trace.screen, settings, model, {});
    std::vector<GazeState> states;
    LabelAgreement::Labels labels;
    for (const SampleLabel& label : found) {
      states.push_back(label.state);
      labels.emplace_back(label.state);
    }
    for (const Coder& coder : labelled.coders) {
      LabelAgreement& agreement = table[recording.kind][column][coder.name];
      agreement.addSamples(labels, coder.labels);
      agreement.addEvents(labels, coder.labels, trace);
      if (column != "online" && column != "offline") continue;
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (!coder.labels[i] || isCertain(found[i])) continue;
        calibration[online ? 0 : 1].add(recording.set, found[i].confidence(),
                                        states[i] == *coder.labels[i]);
      }
    }
  }
};

template <typename Value>
std::optional<double> meanOf(const std::map<std::string, LabelAgreement>& coders,
                             const Value& value) {
  double sum = 0.0, count = 0.0;
  for (const auto& [name, agreement] : coders) {
    if (const std::optional<double> each = value(agreement)) {
      sum += *each;
      count += 1.0;
    }
  }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

nlohmann::ordered_json jsonOf(const Validation& validation) {
  nlohmann::ordered_json json;
  for (const auto& [kind, columns] : validation.table) {
    for (const auto& column : columns) {
      auto& cell = json[kind][column.first];
      const auto put = [&](const std::string& key, const auto& value) {
        const auto mean = meanOf(column.second, value);
        if (mean) cell[key] = std::round(*mean * 1e3) / 1e3;
      };
      put("stable", [](const LabelAgreement& a) { return a.stable.value(); });
      for (std::size_t k = 0; k < LabelAgreement::kKinds.size(); ++k) {
        const std::string name(nameOf(LabelAgreement::kKinds[k]));
        put(name, [&](const LabelAgreement& a) { return a.kinds[k].value(); });
        put(name + "_f1", [&](const LabelAgreement& a) { return a.events[k].f1(); });
      }
    }
  }
  return json;
}

std::vector<ModelSet> setsOf(const std::vector<LabelledRecording>& recordings) {
  std::map<std::string, std::pair<int, Sha256>> hashes;
  for (const LabelledRecording& recording : recordings) {
    const std::string hex = sha256OfFile(recording.file);
    auto& [files, hash] = hashes[recording.set];
    ++files;
    hash.add({reinterpret_cast<const unsigned char*>(hex.data()), hex.size()});
  }
  std::vector<ModelSet> sets;
  for (auto& [name, entry] : hashes) {
    const Source& source = sourceOf(name);
    if (!source.trained) continue;
    sets.push_back({.name = name,
                    .licence = source.licence,
                    .source = source.paper,
                    .sha256 = entry.second.hex(),
                    .files = entry.first});
  }
  return sets;
}

bool isTrained(const LabelledRecording& recording) { return sourceOf(recording.set).trained; }

int run(const std::string& folder, const std::string& out, const std::string& json_file,
        bool validate) {
  const auto recordings = readRecordings(folder);
  for (const LabelledRecording& recording : recordings) sourceOf(recording.set);
  const Trainer trainer(recordings);
  const std::vector<std::size_t> validated = {1, 2};  // of the default delay, and offline
  nlohmann::ordered_json json;
  std::array<std::vector<CalibrationKnot>, 2> knots{};
  if (validate) {
    Validation sets, observers;
    for (const Source& source : kSources) {
      const EventModel model = trainer.train(
          [&](const auto& each) { return isTrained(each) && each.set != source.set; }, validated);
      for (const LabelledRecording& each : recordings) {
        if (each.set == source.set) sets.addLabels(each, model);
      }
      std::fprintf(stderr, "left out %s\n", source.set);
    }
    for (int fold = 0; fold < 3; ++fold) {
      const EventModel model = trainer.train(
          [&](const auto& each) { return isTrained(each) && foldOf(each) != fold; }, validated);
      for (const LabelledRecording& each : recordings) {
        if (isTrained(each) && foldOf(each) == fold) observers.addLabels(each, model);
      }
      std::fprintf(stderr, "left out a third of the observers\n");
    }
    Validation coders;
    for (const LabelledRecording& each : recordings) {
      const auto& labels = each.labelled.coders;
      if (labels.size() == 2) {
        coders.table[each.kind]["coders"]["both"].addSamples(labels[0].labels, labels[1].labels);
      }
    }
    json = {{"set_left_out", jsonOf(sets)},
            {"observers_left_out", jsonOf(observers)},
            {"coders", jsonOf(coders)}};
    for (const bool offline : {false, true}) {
      knots[offline] = sets.calibration[offline].knots();
      json["calibration"][offline ? "offline" : "online"] = sets.calibration[offline].leftOut();
    }
    std::printf("%s\n", json.dump(1).c_str());
  }
  EventModel model = trainer.train(isTrained, {0, 1, 2});
  model.sets = setsOf(recordings);
  model.online.calibration = knots[0];
  model.offline.calibration = knots[1];
  OutputFiles files(OutputGuard({out, json_file}, {}, true));
  files.write(out, packedModel(model));
  if (!json_file.empty()) files.write(json_file, json.dump(1) + '\n');
  files.commit();
  return 0;
}

}  // namespace
}  // namespace foci

int main(int count, char** words) {
  std::string folder, out, json;
  bool validate = true;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--out" && i + 1 < count) {
      out = words[++i];
    } else if (word == "--json" && i + 1 < count) {
      json = words[++i];
    } else if (word == "--no-calibration") {
      validate = false;
    } else if (folder.empty() && !word.starts_with("-")) {
      folder = word;
    } else {
      folder.clear();
      break;
    }
  }
  if (folder.empty() || out.empty()) {
    std::fprintf(stderr, "usage: foci_train_events FOLDER --out MODEL [--json FILE]\n");
    return 2;
  }
  try {
    return foci::run(folder, out, json, validate);
  } catch (const foci::InputError& error) {
    std::fprintf(stderr, "foci_train_events: %s\n", error.what());
    return 2;
  }
}
