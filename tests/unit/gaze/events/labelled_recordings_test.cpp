// The detectors on recordings that human coders have labelled. They are absent on most machines.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "gaze/events/event_labels.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/online_events.h"
#include "gaze/sources/trace_reader.h"
#include "tests/bench/training_data.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

/// Cohen's kappa of stable gaze, mean over two coders at most.
double kappaOf(const std::vector<GazeState>& states, const std::vector<Coder>& coders) {
  const std::size_t count = std::min<std::size_t>(coders.size(), 2);
  double sum = 0.0;
  for (std::size_t c = 0; c < count; ++c) {
    CohensKappa stable;
    for (std::size_t i = 0; i < states.size(); ++i) {
      const auto& label = coders[c].labels[i];
      if (label) stable.add(isStable(states[i]), isStable(*label));
    }
    sum += stable.value().value_or(1.0);
  }
  return sum / static_cast<double>(count);
}

LabelledTrace readNominal(const std::filesystem::path& file) {
  const Screen nominal{.size_px = {1000, 1000}, .size_m = {1.0, 1.0}, .distance_m = 1.0};
  return readLabelledTrace(file, nominal);
}

// The offline detector sees all that the online detector sees, and more.
TEST(LabelByRules, IsNotWorseThanOnlineOnAnyLabelledRecording) {
  const EventSettings rules{.detector = Detector::rules};
  for (const char* folder : {"andersson2017", "irf"}) {
    const auto recordings = gazeData() / "labelled" / folder;
    if (!std::filesystem::exists(recordings)) GTEST_SKIP() << recordings << " is absent";
    for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
      const LabelledTrace labelled = readNominal(entry.path());
      const GazeTrace& trace = labelled.trace;
      EXPECT_GE(kappaOf(labelEvents(trace, *trace.screen, rules).states, labelled.coders),
                kappaOf(labelEvents(trace, *trace.screen, rules, true).states, labelled.coders))
          << entry.path().filename();
    }
  }
}

// The trained detector has seen these recordings; docs/results.md has the figures without them.
TEST(LabelTrained, IsNotWorseThanOnlineOnAnySetOfRecordings) {
  const auto folder = gazeData() / "labelled" / "andersson2017";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  std::map<std::string, double> offline, online;
  for (const LabelledRecording& each : readRecordings(folder)) {
    const GazeTrace& trace = each.labelled.trace;
    offline[each.kind] += kappaOf(labelEvents(trace, *trace.screen).states, each.labelled.coders);
    online[each.kind] +=
        kappaOf(labelEvents(trace, *trace.screen, {}, true).states, each.labelled.coders);
  }
  EXPECT_EQ(offline.size(), 3u);
  for (const auto& [kind, sum] : offline) EXPECT_GE(sum, online[kind]) << kind;
}

}  // namespace FOCI_FILE
}  // namespace foci
