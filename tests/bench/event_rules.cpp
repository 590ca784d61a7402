// Agreement of event detection with human coders on recordings that its constants have not seen.
//
//   foci_event_rules [SHARED_DATA]
//
// For each labelled recording, the constants of `EventRules` are chosen on all others (coordinate
// search; first those of saccades, then those of pursuit), and the recording is labelled with them.
// The table pools those held-out labels by kind of recording. Beside it stand the constants that
// all recordings together choose, and the defaults.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "gaze/events/event_labels.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/online_events.h"
#include "gaze/sources/trace_reader.h"

namespace foci {
namespace {

/// Counts of two yes-or-no labellings, which add up over recordings.
struct Counts {
  double all = 0.0, a = 0.0, b = 0.0, both = 0.0;

  void add(bool first, bool second) {
    all += 1.0;
    a += first;
    b += second;
    both += first && second;
  }
  Counts& operator+=(const Counts& other) {
    all += other.all;
    a += other.a;
    b += other.b;
    both += other.both;
    return *this;
  }
  /// Cohen's kappa; 1 without any disagreement.
  double kappa() const {
    const double chance = (a * b + (all - a) * (all - b)) / (all * all);
    return all == 0.0 || chance >= 1.0
               ? 1.0
               : ((all - a - b + 2.0 * both) / all - chance) / (1.0 - chance);
  }
};

/// Against the first and the second coder: stable gaze, saccades, pursuit.
struct Score {
  std::array<Counts, 2> stable{}, saccade{}, pursuit{};

  Score& operator+=(const Score& other) {
    for (std::size_t i : {0, 1}) {
      stable[i] += other.stable[i];
      saccade[i] += other.saccade[i];
      pursuit[i] += other.pursuit[i];
    }
    return *this;
  }
  static double mean(const std::array<Counts, 2>& counts) {
    return counts[1].all > 0.0 ? 0.5 * (counts[0].kappa() + counts[1].kappa()) : counts[0].kappa();
  }
};

constexpr std::array<const char*, 4> kKinds = {"img", "dots", "video", "S"};

struct Recording {
  std::string name;
  std::size_t kind = 0;
  LabelledTrace labelled;
};

std::vector<Recording> readAll(const std::filesystem::path& data) {
  const Screen nominal{.size_px = {1000, 1000}, .size_m = {1.0, 1.0}, .distance_m = 1.0};
  std::vector<Recording> all;
  for (const char* folder : {"andersson2017", "irf"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(data / "gaze" / "labelled" / folder)) {
      Recording recording{.name = entry.path().stem().string(),
                          .labelled = readLabelledTrace(entry.path(), nominal)};
      while (!recording.name.starts_with(kKinds[recording.kind])) ++recording.kind;
      all.push_back(std::move(recording));
    }
  }
  std::sort(all.begin(), all.end(),
            [](const Recording& a, const Recording& b) { return a.name < b.name; });
  return all;
}

/// Half of the samples, with white noise: as of another tracker.
Recording noisier(const Recording& recording) {
  constexpr double kNoise_deg = 0.25;
  Recording other{.name = recording.name, .kind = recording.kind, .labelled = {}};
  GazeTrace& trace = other.labelled.trace;
  trace = recording.labelled.trace;
  trace.rate_Hz *= 0.5;
  trace.samples.clear();
  for (const Coder& coder : recording.labelled.coders)
    other.labelled.coders.push_back({coder.name});
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise_deg(0.0, kNoise_deg);
  const double px_deg =
      trace.screen->distance_m * 0.01745 * trace.screen->size_px.x / trace.screen->size_m.x;
  for (std::size_t i = 0; i < recording.labelled.trace.samples.size(); i += 2) {
    GazeSample sample = recording.labelled.trace.samples[i];
    if (sample.point_px)
      *sample.point_px += px_deg * glm::dvec2(noise_deg(random), noise_deg(random));
    trace.samples.push_back(sample);
    for (std::size_t c = 0; c < other.labelled.coders.size(); ++c) {
      other.labelled.coders[c].labels.push_back(recording.labelled.coders[c].labels[i]);
    }
  }
  return other;
}

Score scoreOf(const LabelledTrace& labelled, const EventRules& rules, bool online) {
  EventSettings settings;
  settings.rules = rules;
  const GazeTrace& trace = labelled.trace;
  const auto states = online ? labelEvents(trace, *trace.screen, settings, true).states
                             : labelEvents(trace, *trace.screen, settings).states;
  Score score;
  for (std::size_t c = 0; c < std::min<std::size_t>(labelled.coders.size(), 2); ++c) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      const auto& label = labelled.coders[c].labels[i];
      if (!label) continue;
      score.stable[c].add(isStable(states[i]), isStable(*label));
      score.saccade[c].add(states[i] == GazeState::saccade, *label == GazeState::saccade);
      score.pursuit[c].add(states[i] == GazeState::pursuit, *label == GazeState::pursuit);
    }
  }
  return score;
}

/// A constant and the values that the search tries.
struct Choice {
  const char* name;
  double EventRules::*member;
  std::vector<double> values;
};

const std::vector<Choice>& saccadeChoices() {
  static const std::vector<Choice> kChoices = {
      {"noise_span_s", &EventRules::noise_span_s, {2.0, 3.0, 4.0, 6.0, 1000.0}},
      {"peak_noise", &EventRules::peak_noise, {6.0, 7.0, 8.0, 9.0, 10.0, 11.0}},
      {"edge_deg_s", &EventRules::edge_deg_s, {14.0, 18.0, 22.0, 26.0}},
      {"edge_noise", &EventRules::edge_noise, {3.0, 4.0, 5.0, 6.0}},
      {"rest_deg_s", &EventRules::rest_deg_s, {6.0, 9.0, 12.0}},
      {"rest_noise", &EventRules::rest_noise, {3.0, 4.0, 5.0}},
      {"rest_s", &EventRules::rest_s, {0.004, 0.008, 0.012}},
      {"oscillation_s", &EventRules::oscillation_s, {0.012, 0.02, 0.03}},
      {"echo_ratio", &EventRules::echo_ratio, {0.4, 0.6, 0.8}},
      {"hidden_noise", &EventRules::hidden_noise, {4.0, 5.0, 6.5}},
      {"lid_rest_s", &EventRules::lid_rest_s, {0.02, 0.03, 0.04}},
      {"wide_noise", &EventRules::wide_noise, {3.5, 4.5, 5.5}},
  };
  return kChoices;
}

const std::vector<Choice>& pursuitChoices() {
  static const std::vector<Choice> kChoices = {
      {"pursuit_bias", &EventRules::pursuit_bias, {-0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 0.8}},
      {"pursuit_duration", &EventRules::pursuit_duration, {-1.0, -0.7, -0.4, -0.1}},
      {"pursuit_distance", &EventRules::pursuit_distance, {0.8, 1.2, 1.6, 2.0}},
      {"pursuit_spread", &EventRules::pursuit_spread, {0.4, 0.8, 1.2, 1.6}},
      {"pursuit_neighbour", &EventRules::pursuit_neighbour, {0.5, 1.0, 1.5, 2.0}},
      {"pursuit_still_deg_s", &EventRules::pursuit_still_deg_s, {1.5, 3.0, 6.0}},
  };
  return kChoices;
}

using Key = std::vector<double>;

Key keyOf(const EventRules& rules) {
  Key key;
  for (const Choice& choice : saccadeChoices()) key.push_back(rules.*choice.member);
  for (const Choice& choice : pursuitChoices()) key.push_back(rules.*choice.member);
  return key;
}

class Search {
 public:
  explicit Search(std::vector<Recording> recordings) : recordings_(std::move(recordings)) {
    for (const Recording& recording : recordings_) noisy_.push_back(noisier(recording));
  }

  const std::vector<Recording>& recordings() const { return recordings_; }

  /// The best rules for all recordings but one, by coordinate search from the defaults.
  EventRules choose(std::size_t held_out) {
    EventRules best;
    improve(best, saccadeChoices(), held_out, saccadeValue);
    improve(best, pursuitChoices(), held_out, pursuitValue);
    return best;
  }

 private:
  static constexpr double kWorthwhile = 5e-4;  // smaller gains are chance

  using Kinds = std::array<Score, kKinds.size()>;

  /// Mean over the kinds of the pooled kappas: stable gaze, and saccades at a third of its weight.
  static double saccadeValue(const Kinds& kinds) {
    double sum = 0.0;
    for (const Score& kind : kinds) {
      sum += (Score::mean(kind.stable) + Score::mean(kind.saccade) / 3.0);
    }
    return sum / 8.0;
  }

  /// Pooled over all recordings, since pictures hold little pursuit.
  static double pursuitValue(const Kinds& kinds) {
    Score all;
    for (const Score& kind : kinds) all += kind;
    return Score::mean(all.pursuit);
  }

  void improve(EventRules& best, const std::vector<Choice>& choices, std::size_t held_out,
               double (*valueOf)(const Kinds&)) {
    double best_value = value(best, held_out, valueOf);
    for (bool better = true; better;) {
      better = false;
      for (const Choice& choice : choices) {
        for (const double candidate : choice.values) {
          EventRules rules = best;
          rules.*choice.member = candidate;
          const double found = value(rules, held_out, valueOf);
          if (found <= best_value + kWorthwhile) continue;
          best = rules;
          best_value = found;
          better = true;
        }
      }
    }
  }

  /// As recorded, and noisier at half of that weight.
  double value(const EventRules& rules, std::size_t held_out, double (*valueOf)(const Kinds&)) {
    const auto& scores = scoresOf(rules);
    double sum = 0.0;
    for (std::size_t version : {0, 1}) {
      Kinds kinds{};
      for (std::size_t i = 0; i < recordings_.size(); ++i) {
        if (i != held_out) kinds[recordings_[i].kind] += scores[version][i];
      }
      sum += (version == 0 ? 1.0 : 0.5) * valueOf(kinds);
    }
    return sum;
  }

  const std::array<std::vector<Score>, 2>& scoresOf(const EventRules& rules) {
    auto [at, is_new] = cache_.try_emplace(keyOf(rules));
    if (!is_new) return at->second;
    for (std::size_t i = 0; i < recordings_.size(); ++i) {
      at->second[0].push_back(scoreOf(recordings_[i].labelled, rules, false));
      at->second[1].push_back(scoreOf(noisy_[i].labelled, rules, false));
    }
    return at->second;
  }

  std::vector<Recording> recordings_, noisy_{};
  std::map<Key, std::array<std::vector<Score>, 2>> cache_{};
};

void print(const char* title, const std::array<Score, kKinds.size()>& kinds) {
  std::printf("%-34s", title);
  for (const Score& kind : kinds) std::printf("  %.3f", Score::mean(kind.stable));
  for (const Score& kind : kinds) std::printf("  %.3f", Score::mean(kind.saccade));
  Score all;
  for (const Score& kind : kinds) all += kind;
  std::printf("  %.3f\n", Score::mean(all.pursuit));
}

}  // namespace
}  // namespace foci

int main(int count, char** words) {
  using namespace foci;
  Search search(readAll(count > 1 ? words[1] : "../shared/data"));
  const auto& recordings = search.recordings();
  std::printf(
      "kappa                               stable gaze                 saccades                    "
      "pursuit\n%-34s",
      "");
  for (int i = 0; i < 2; ++i) std::printf("  images dots   video  irf  ");
  std::printf("  all\n");
  for (const bool online : {false, true}) {
    std::array<Score, kKinds.size()> kinds{};
    for (const Recording& r : recordings) {
      const Score score = scoreOf(r.labelled, {}, online);
      kinds[r.kind] += score;
      if (count > 2) std::printf("%-34s %.3f\n", r.name.c_str(), Score::mean(score.stable));
    }
    print(online ? "defaults, online" : "defaults, offline", kinds);
  }
  if (count > 2) return 0;
  const auto show = [](const char* who, const EventRules& rules) {
    std::printf("%-34s", who);
    for (const double constant : keyOf(rules)) std::printf(" %g", constant);
    std::printf("\n");
  };
  std::printf("\nrules chosen without");
  for (const auto* choices : {&saccadeChoices(), &pursuitChoices()}) {
    for (const Choice& choice : *choices) std::printf(" %s", choice.name);
  }
  std::printf("\n");
  show("none", search.choose(recordings.size()));
  std::array<Score, kKinds.size()> offline{}, online{};
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const EventRules rules = search.choose(i);
    show(recordings[i].name.c_str(), rules);
    offline[recordings[i].kind] += scoreOf(recordings[i].labelled, rules, false);
    online[recordings[i].kind] += scoreOf(recordings[i].labelled, rules, true);
  }
  std::printf("\n");
  print("held out, offline", offline);
  print("held out, online", online);
}
