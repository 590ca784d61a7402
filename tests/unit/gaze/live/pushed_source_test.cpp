#include "gaze/live/live_source.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRate_Hz = 1000.0, kPrinted_s = 1e-9;

std::vector<GazeSample> polled(PushedSource& source, double now_s) {
  std::vector<GazeSample> samples;
  source.poll(now_s, samples);
  return samples;
}

TEST(PushedSource, TakesOneSample) {
  PushedSource source(kRate_Hz);
  EXPECT_EQ(source.push(samplesOfText("12.5 960 540.5 3.25"), 2.0), 0u);
  const auto samples = polled(source, 2.1);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_DOUBLE_EQ(samples[0].time_s, 2.0);
  EXPECT_EQ(samples[0].point_px, glm::dvec2(960.0, 540.5));
  EXPECT_EQ(samples[0].pupil_mm, 3.25);
  EXPECT_EQ(source.rate_Hz(), kRate_Hz);
}

TEST(PushedSource, TakesManySamplesAtOnceWithTheirIntervals) {
  PushedSource source(kRate_Hz);
  const auto sent = samplesOfText("5.000 1 2; 5.001 nan nan 0;5.003 3 4 ;");
  ASSERT_EQ(sent.size(), 3u);
  source.push(sent, 10.0);
  const auto samples = polled(source, 10.0);
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_NEAR(samples[0].time_s, 9.997, kPrinted_s);
  EXPECT_NEAR(samples[1].time_s, 9.998, kPrinted_s);
  EXPECT_FALSE(samples[1].point_px);
  EXPECT_FALSE(samples[1].pupil_mm);
  EXPECT_NEAR(samples[2].time_s, 10.0, kPrinted_s);
}

TEST(PushedSource, SaysWhetherGazeComes) {
  PushedSource source(kRate_Hz);
  polled(source, 1.0);
  EXPECT_EQ(source.status(), "gaze from the socket, none yet");
  source.push(samplesOfText("1 1 2"), 1.5);
  polled(source, 2.0);
  EXPECT_EQ(source.status(), "gaze from the socket");
  for (int i = 0; i < 40; ++i) source.push(samplesOfText("1 1 2"), 2.0 + 0.1 * i);  // repeated
  polled(source, 6.0);
  EXPECT_EQ(source.status(), "gaze from the socket, none yet");
  EXPECT_GE(source.sender().dropped, 39u);
}

TEST(PushedSource, CountsWhatItDrops) {
  PushedSource source(kRate_Hz);
  EXPECT_EQ(source.push(samplesOfText("5 1 2"), 1.0), 0u);
  EXPECT_EQ(source.push(samplesOfText("5 1 2"), 1.001), 1u);
  EXPECT_EQ(source.push(samplesOfText("6.5 1 2"), 2.5), 0u);
  EXPECT_EQ(source.push(samplesOfText("9e9 1 2"), 2.6), 0u);  // in doubt
  EXPECT_EQ(source.push(samplesOfText("6.7 1 2"), 2.7), 1u);
  EXPECT_EQ(polled(source, 3.0).size(), 3u);
  EXPECT_EQ(source.sender().dropped, 2u);
}

TEST(PushedSource, RefusesATextThatHoldsWhatIsNoSample) {
  for (const char* text :
       {"", ";", "1", "1 2", "1 2 3 4 5", "x 1 2", "nan 1 2", "inf 1 2", "1 1e9 2", "1 2 3 -1",
        "1 2 3 99", "1 2 3;2 3", "2 2 3;1 2 3", "1 2 3;1 2 3", "1 2 3;;2 2 3", "1e300 1 2"}) {
    EXPECT_THROW(samplesOfText(text), InputError) << text;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
