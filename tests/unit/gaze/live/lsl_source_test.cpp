#include "gaze/live/lsl_source.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};

std::string refusalOf(const std::string& stream, const std::string& library) {
  try {
    const LslSource source(stream, {}, kScreen, library);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Sets a variable of the stand-in, and at the end its former value.
template <class T>
class Set {
 public:
  Set(const char* name, T value)
      : variable_(static_cast<T*>(dlsym(dlopen(FOCI_FAKE_LSL, RTLD_NOW), name))),
        before_(std::exchange(*variable_, value)) {}
  ~Set() { *variable_ = before_; }
  Set(const Set&) = delete;
  Set& operator=(const Set&) = delete;

 private:
  T* variable_;
  T before_;
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Polls the stream on a clock that is 1000 s behind the library's, until its samples have come.
struct Heard {
  std::vector<GazeSample> samples{};
  std::vector<double> age_s{};  ///< on arrival
  SenderFacts sender{};
  std::string status{};
  double longest_poll_s = 0.0;  ///< the source knows the caller's clock to this

  explicit Heard(std::size_t count) {
    LslSource source("", {}, kScreen, FOCI_FAKE_LSL);
    EXPECT_EQ(source.rate_Hz(), 100.0);
    for (const double end_s = seconds() + 5.0; seconds() < end_s;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      const double now_s = seconds();
      source.poll(now_s - 1000.0, samples);
      longest_poll_s = std::max(longest_poll_s, seconds() - now_s);
      while (age_s.size() < samples.size()) {
        age_s.push_back(seconds() - 1000.0 - samples[age_s.size()].time_s);
      }
      sender = source.sender();
      status = source.status();
      if (samples.size() + sender.dropped >= count) break;
    }
  }
};

constexpr double kBusy_s = 0.1;  // a machine with other work delays a sample by as much

TEST(LslSource, GivesTheStreamsSamplesOnTheCallersClock) {
  const Heard heard(50);
  ASSERT_EQ(heard.samples.size(), 50u);
  EXPECT_EQ(heard.status, "LSL stream \"Tracker\"");
  double last_s = 0.0;
  for (int i = 0; i < 50; ++i) {
    const GazeSample& sample = heard.samples[static_cast<std::size_t>(i)];
    EXPECT_GT(sample.time_s, last_s);
    last_s = sample.time_s;
    ASSERT_EQ(sample.point_px.has_value(), i % 10 != 9) << i;
    if (!sample.point_px) continue;
    EXPECT_NEAR(sample.point_px->x, 1000.0 * (0.25 + 0.01 * i), 1e-6);
    EXPECT_NEAR(sample.point_px->y, 250.0, 1e-6);
    EXPECT_EQ(sample.pupil_mm, 3.5);
  }
}

// The library has measured that the sender's clock is an hour ahead.
TEST(LslSource, UsesTheCorrectionThatTheLibraryMeasures) {
  const Set ahead("fake_lsl_sender_ahead_s", 3600.0), correction("fake_lsl_correction_s", -3600.0);
  const Heard heard(50);
  ASSERT_EQ(heard.samples.size(), 50u);
  for (std::size_t i = 1; i < 50; ++i) {
    EXPECT_NEAR(heard.samples[i].time_s - heard.samples[i - 1].time_s, 0.01,
                1e-4 + heard.longest_poll_s);
    EXPECT_GE(heard.age_s[i], 0.0);
    EXPECT_LT(heard.age_s[i], kBusy_s);
  }
  ASSERT_TRUE(heard.sender.clock);
  EXPECT_TRUE(heard.sender.clock->measured);
  EXPECT_NEAR(heard.sender.clock->offset_s, -4600.0, 1e-3 + heard.longest_poll_s);
}

// Its times are not those of the library's clock, or the library gets no answer.
TEST(LslSource, EstimatesAClockThatTheLibraryDoesNotKnow) {
  for (const double correction_s : {0.0, std::nan("")}) {
    for (const double ahead_s : {3600.0, -3600.0}) {
      const Set ahead("fake_lsl_sender_ahead_s", ahead_s);
      const Set correction("fake_lsl_correction_s", correction_s);
      const Heard heard(50);
      ASSERT_EQ(heard.samples.size(), 50u);
      EXPECT_LT(heard.age_s.back(), kBusy_s);
      EXPECT_FALSE(heard.sender.clock->measured);
      EXPECT_NEAR(heard.sender.clock->offset_s, -1000.0 - ahead_s, kBusy_s);
    }
  }
}

TEST(LslSource, ASampleThatIsNoGazeCostsNoOther) {
  const Set wild("fake_lsl_wild", 7);
  const Heard heard(50);
  EXPECT_EQ(heard.samples.size(), 49u);
  EXPECT_EQ(heard.sender.dropped, 1u);
}

TEST(LslSource, SaysWhyAllSamplesAreUnusable) {
  const Set wild("fake_lsl_wild", -2);
  const Heard heard(20);
  EXPECT_TRUE(heard.samples.empty());
  EXPECT_GE(heard.sender.dropped, 20u);
  EXPECT_NE(heard.sender.why.find("1e+30"), std::string::npos) << heard.sender.why;
  EXPECT_EQ(heard.status, "LSL stream \"Tracker\", no gaze yet");
}

TEST(LslSource, KeepsTheLibrarysLogOffStandardError) {
  testing::internal::CaptureStderr();
  const Heard heard(20);
  std::fprintf(stderr, "foci's own\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "foci's own\n");
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

}  // namespace FOCI_FILE
}  // namespace foci
