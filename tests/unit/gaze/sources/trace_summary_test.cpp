#include "gaze/sources/trace_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace foci {
namespace FOCI_FILE {

TEST(TraceSummary, CountsPresentAndMissingSamples) {
  TraceSummary summary;
  for (int i = 0; i < 1000; ++i) {
    GazeSample sample{.time_s = 7.0 + 0.004 * i + (i >= 500 ? 2.0 : 0.0)};
    if (i % 4 != 0) sample.point_px = glm::dvec2(i, -i);
    if (i % 5 == 0) sample.eyes[1].point_px = glm::dvec2(1, 1);
    if (i % 10 == 0) sample.pupil_mm = 3.0;
    sample.blink = i < 20;
    summary.add(sample);
  }
  EXPECT_EQ(summary.samples(), 1000u);
  EXPECT_EQ(summary.rate_Hz(), 250.0);
  EXPECT_NEAR(summary.span_s(), 5.996, 1e-9);
  EXPECT_EQ(summary.present(), 750u);
  EXPECT_EQ(summary.eyes()[0], 0u);
  EXPECT_EQ(summary.eyes()[1], 200u);
  EXPECT_EQ(summary.pupils(), 100u);
  EXPECT_EQ(summary.blinks(), 20u);
  EXPECT_EQ(summary.jumps(), 1u);
  EXPECT_NEAR(summary.longest_jump_s(), 2.004, 1e-9);
  EXPECT_EQ(summary.min_px(), glm::dvec2(1, -999));
  EXPECT_EQ(summary.max_px(), glm::dvec2(999, -1));
}

TEST(TraceSummary, CountsAJumpAmongTheFirstSamples) {
  TraceSummary summary;
  for (int i = 0; i < 200; ++i) summary.add({.time_s = 0.001 * i + (i >= 5 ? 3.0 : 0.0)});
  EXPECT_EQ(summary.jumps(), 1u);
  EXPECT_NEAR(summary.longest_jump_s(), 3.001, 1e-9);
}

TEST(TraceSummary, RoundedTimesHaveTheirMeanRate) {
  for (const double step_s : {0.01, 0.001, 0.0001, 0.00001}) {
    for (const double rate_Hz : {30.0, 60.0, 75.0, 120.0, 800.0}) {
      if (step_s > 0.005 && rate_Hz > 60.0) continue;  // taken for lost samples
      TraceSummary summary;
      std::vector<GazeSample> samples;
      for (int i = 0; i < 600; ++i) {
        const double gap_s = i < 300 ? 0.0 : 2.0;
        samples.push_back({.time_s = step_s * std::round(i / rate_Hz / step_s) + gap_s});
        summary.add(samples.back());
      }
      // The median would give 58.8 Hz for 60 in whole milliseconds.
      // The ends of both halves are rounded, and the rate to a thousandth.
      EXPECT_NEAR(summary.rate_Hz(), rate_Hz, 2.0 * rate_Hz * rate_Hz * step_s / 600.0 + 1e-3)
          << step_s;
    }
  }
}

TEST(TraceSummary, ALostSampleIsNoSlowerRate) {
  TraceSummary summary;  // 100 Hz in steps of 10 ms, an eighth of the samples lost
  for (int i = 0; i < 800; ++i) {
    if (i % 8 != 0) summary.add({.time_s = 0.01 * i});
  }
  EXPECT_NEAR(summary.rate_Hz(), 100.0, 1e-3);
}

}  // namespace FOCI_FILE
}  // namespace foci
