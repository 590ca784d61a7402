#include "gaze/sources/pushed_source.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/input_error.h"

namespace foci {
namespace {

constexpr double kRate_Hz = 1000.0, kPrinted_s = 1e-9;

std::vector<GazeSample> polled(PushedSource& source, double now_s) {
  std::vector<GazeSample> samples;
  source.poll(now_s, samples);
  return samples;
}

TEST(PushedSource, TakesOneSample) {
  PushedSource source(kRate_Hz);
  EXPECT_EQ(source.push("12.5 960 540.5 3.25"), 1u);
  const auto samples = polled(source, 2.0);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_DOUBLE_EQ(samples[0].time_s, 2.0);
  EXPECT_EQ(samples[0].point_px, glm::dvec2(960.0, 540.5));
  EXPECT_EQ(samples[0].pupil_mm, 3.25);
  EXPECT_EQ(source.rate_Hz(), kRate_Hz);
}

TEST(PushedSource, TakesManySamplesAtOnceWithTheirIntervals) {
  PushedSource source(kRate_Hz);
  EXPECT_EQ(source.push("5.000 1 2; 5.001 nan nan 0;5.003 3 4 ;"), 3u);
  const auto samples = polled(source, 10.0);
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_NEAR(samples[0].time_s, 9.997, kPrinted_s);
  EXPECT_NEAR(samples[1].time_s, 9.998, kPrinted_s);
  EXPECT_FALSE(samples[1].point_px);
  EXPECT_FALSE(samples[1].pupil_mm);
  EXPECT_NEAR(samples[2].time_s, 10.0, kPrinted_s);
}

// The way of a sample takes 1 to 9 ms; times here have the intervals of the sender, within the
// delay of the first sample.
TEST(PushedSource, FollowsTheClockOfTheSenderNotTheArrival) {
  PushedSource source(kRate_Hz);
  std::vector<GazeSample> all;
  for (int i = 0; i < 1000; ++i) {
    const double sent_s = 500.0 + 0.01 * i;
    source.push(std::to_string(sent_s) + " 1 2");
    source.poll(sent_s - 490.0 + 0.001 * (1 + (i * 7) % 9), all);
  }
  ASSERT_EQ(all.size(), 1000u);
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_GT(all[i].time_s, all[i - 1].time_s);
    if (i > 10) {
      EXPECT_NEAR(all[i].time_s - all[i - 1].time_s, 0.01, 1e-6) << i;
    }
  }
}

TEST(PushedSource, NoSampleIsAfterNow) {
  PushedSource source(kRate_Hz);
  std::vector<GazeSample> all;
  for (int i = 0; i < 50; ++i) {
    const double now_s = 1.0 + 0.002 * i;
    source.push(std::to_string(0.01 * i + 0.001) + " 1 2;" + std::to_string(0.01 * i + 0.002) +
                " 1 2");  // its clock is five times as fast
    all.clear();
    source.poll(now_s, all);
    for (const GazeSample& sample : all) EXPECT_LE(sample.time_s, now_s);
  }
}

TEST(PushedSource, ASenderMayStartAgainAfterAPause) {
  PushedSource source(kRate_Hz);
  source.push("100 1 2");
  polled(source, 1.0);
  EXPECT_THROW(source.push("50 1 2"), InputError);
  polled(source, 4.0);
  source.push("50 1 2");
  const auto samples = polled(source, 4.5);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_DOUBLE_EQ(samples[0].time_s, 4.5);
}

TEST(PushedSource, RefusesWhatIsNoSampleAndTakesNoneOfThatDatagram) {
  PushedSource source(kRate_Hz);
  for (const char* text :
       {"", ";", "1", "1 2", "1 2 3 4 5", "x 1 2", "nan 1 2", "inf 1 2", "1 1e9 2", "1 2 3 -1",
        "1 2 3 99", "1 2 3;2 3", "2 2 3;1 2 3", "1 2 3;1 2 3", "1 2 3;;2 2 3", "1e300 1 2"}) {
    EXPECT_THROW(source.push(text), InputError) << text;
  }
  EXPECT_TRUE(polled(source, 1.0).empty());
}

}  // namespace
}  // namespace foci
