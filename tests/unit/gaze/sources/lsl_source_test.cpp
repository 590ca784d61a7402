#include "gaze/sources/lsl_source.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "base/input_error.h"

namespace foci {
namespace {

const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};

std::string refusalOf(const std::string& stream, const std::string& library) {
  try {
    const LslSource source(stream, {}, kScreen, library);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LslSource, GivesTheStreamsSamplesOnTheCallersClock) {
  LslSource source("", {}, kScreen, FOCI_FAKE_LSL);
  EXPECT_EQ(source.rate_Hz(), 100.0);
  std::vector<GazeSample> samples;
  double now_s = 5.0;
  for (int i = 0; i < 500 && samples.size() < 50; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    now_s += 0.01;
    source.poll(now_s, samples);
  }
  ASSERT_EQ(samples.size(), 50u);
  EXPECT_EQ(source.status(), "LSL stream \"Tracker\"");
  double last_s = 0.0;
  for (int i = 0; i < 50; ++i) {
    const GazeSample& sample = samples[static_cast<std::size_t>(i)];
    EXPECT_LE(sample.time_s, now_s);
    EXPECT_GT(sample.time_s, last_s);
    last_s = sample.time_s;
    ASSERT_EQ(sample.point_px.has_value(), i % 10 != 9) << i;
    if (!sample.point_px) continue;
    EXPECT_NEAR(sample.point_px->x, 1000.0 * (0.25 + 0.01 * i), 1e-6);
    EXPECT_NEAR(sample.point_px->y, 250.0, 1e-6);
    EXPECT_EQ(sample.pupil_mm, 3.5);
  }
}

TEST(LslSource, FindsAStreamByItsName) { EXPECT_EQ(refusalOf("Tracker", FOCI_FAKE_LSL), ""); }

TEST(LslSource, NamesTheStreamsThatThereAre) {
  const std::string refusal = refusalOf("Eyelink", FOCI_FAKE_LSL);
  EXPECT_NE(refusal.find("no stream of gaze"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("\"Tracker\", \"Markers\""), std::string::npos) << refusal;
  // Markers are texts.
  EXPECT_NE(refusalOf("Markers", FOCI_FAKE_LSL), "");
}

TEST(LslSource, SaysWhereTheLibraryIs) {
  const std::string refusal = refusalOf("", "liblsl-that-is-not-there.so");
  EXPECT_NE(refusal.find("liblsl is not installed"), std::string::npos) << refusal;
}

}  // namespace
}  // namespace foci
