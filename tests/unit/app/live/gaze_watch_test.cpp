#include "app/live/gaze_feed.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace foci {
namespace FOCI_FILE {

/// Gaze that arrives at 50 Hz for five seconds before 25 frames per second.
struct Arrival {
  std::function<std::vector<GazeSample>(double now_s)> samples;
  std::size_t dropped = 0;  ///< each time
  std::function<bool(double now_s)> uses_gaze;
};

struct Told {
  std::vector<std::string> log{};
  std::string remark_at_3_s{};
  GazeWatch watch{};
};

Told play(const Arrival& arrival) {
  Told told;
  for (int i = 0; i < 250; ++i) {
    const double now_s = 0.02 * i;
    for (const std::string& line :
         {told.watch.arrive(now_s, arrival.samples(now_s), arrival.dropped, "they are odd"),
          i % 2 == 0 ? told.watch.look(now_s, arrival.uses_gaze(now_s)) : ""}) {
      if (!line.empty()) told.log.push_back(line);
    }
    if (i == 150) told.remark_at_3_s = told.watch.remark();
  }
  return told;
}

std::vector<GazeSample> gaze(double now_s) {
  return {{.time_s = now_s, .point_px = glm::dvec2(5.0)}};
}
std::vector<GazeSample> loss(double now_s) { return {{.time_s = now_s}}; }
std::vector<GazeSample> none(double) { return {}; }
bool never(double) { return false; }

TEST(GazeWatch, IsSilentWhileGazeIsUsed) {
  for (const Arrival& arrival :
       {Arrival{.samples = gaze, .uses_gaze = [](double) { return true; }},
        // Blinks of 0.8 s.
        Arrival{.samples = loss, .uses_gaze = [](double s) { return s - int(s) < 0.2; }}}) {
    const Told told = play(arrival);
    EXPECT_TRUE(told.log.empty());
    EXPECT_EQ(told.watch.remark(), "");
    EXPECT_TRUE(told.watch.unused().empty());
  }
}

TEST(GazeWatch, SaysAfterASecondThatNoneIsUsedAndWhy) {
  const Told lost = play({.samples = loss, .uses_gaze = never});
  ASSERT_EQ(lost.log.size(), 1u);
  EXPECT_EQ(lost.log[0],
            "gaze arrives, but none of it has been used for 1 s: 52 samples without a gaze point");
  EXPECT_EQ(lost.remark_at_3_s,
            "gaze arrives, but none of it has been used for 3 s: 150 samples without a gaze point");
  ASSERT_EQ(lost.watch.unused().size(), 1u);
  EXPECT_EQ(lost.watch.unused()[0].from_s, 0.02);
  EXPECT_EQ(lost.watch.unused()[0].to_s, 4.98);

  const Told dropped = play({.samples = none, .dropped = 2, .uses_gaze = never});
  ASSERT_EQ(dropped.log.size(), 1u);
  EXPECT_NE(dropped.log[0].find("104 samples dropped, because they are odd"), std::string::npos)
      << dropped.log[0];
  EXPECT_EQ(dropped.watch.dropped(), 500u);

  const Told silent = play({.samples = none, .uses_gaze = never});
  ASSERT_EQ(silent.log.size(), 1u);
  EXPECT_EQ(silent.remark_at_3_s, "gaze has not been used for 3 s: none arrives (they are odd)");
  EXPECT_EQ(silent.watch.unused().size(), 1u);

  // A tracker that loses the eyes before it ends.
  const Told ended =
      play({.samples = [](double now_s) { return now_s < 0.5 ? loss(now_s) : none(now_s); },
            .uses_gaze = never});
  EXPECT_EQ(ended.remark_at_3_s, silent.remark_at_3_s);

  const Told old =
      play({.samples = [](double now_s) { return gaze(now_s - 2.5); }, .uses_gaze = never});
  EXPECT_NE(old.remark_at_3_s.find("150 samples up to 2.5 s old"), std::string::npos)
      << old.remark_at_3_s;
}

TEST(GazeWatch, SaysThatNoFrameComes) {
  GazeWatch watch;
  watch.look(10.0, true);
  EXPECT_EQ(watch.arrive(10.5, gaze(10.5), 0, ""), "");
  EXPECT_NE(watch.arrive(13.0, gaze(13.0), 0, "").find("no frame for 3 s"), std::string::npos);
}

TEST(GazeWatch, SaysWhenGazeIsUsedAgainAndDoesNotFillTheLog) {
  const Told told = play({.samples = gaze, .uses_gaze = [](double now_s) {
                            return now_s < 0.5 || (now_s > 2.0 && now_s < 2.5);
                          }});
  ASSERT_EQ(told.log.size(), 2u);
  EXPECT_EQ(told.log[1].find("gaze is used again, after 1.5"), 0u) << told.log[1];
  EXPECT_EQ(told.watch.unused().size(), 2u);
  EXPECT_FALSE(told.watch.remark().empty());
}

// Nothing is said while the scene loads.
TEST(GazeWatch, BeginsWithTheFirstFrame) {
  GazeWatch watch;
  for (int i = 0; i < 500; ++i) EXPECT_EQ(watch.arrive(0.02 * i, gaze(0.02 * i), 0, ""), "");
  EXPECT_EQ(watch.remark(), "");
}

}  // namespace FOCI_FILE
}  // namespace foci
