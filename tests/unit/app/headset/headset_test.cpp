// The headset against a runtime of our own, which refuses what a client does wrong. Its clock is
// virtual: every frame takes its period.
#include "app/headset/headset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "tests/fake_openxr/environment.h"
#include "tests/fake_openxr/fake_openxr.h"

namespace foci {
namespace FOCI_FILE {

std::unique_ptr<GpuContext> anyContext() {
  std::unique_ptr<GpuContext> found;
  openEglContexts(true, [&](std::unique_ptr<GpuContext>& context) {
    if (!context->makeCurrent()) return true;
    found = std::move(context);
    return false;
  });
  return found;
}

/// Opens a headset in the current thread. @return null without OpenGL
std::unique_ptr<Headset> opened() {
  auto context = anyContext();
  return context ? std::make_unique<Headset>(std::move(context)) : nullptr;
}

HeadsetTick nextTick(Headset& headset) {
  for (;;) {
    if (const auto tick = headset.waitFrame()) return *tick;
  }
}

/// The left eye sees (128, top, 0), the right eye (0, top, 128): `top` is 200 in the upper half.
std::vector<unsigned char> testPicture(const glm::ivec2& size_px) {
  std::vector<unsigned char> rgb;
  for (int y = 0; y < size_px.y; ++y) {
    for (int x = 0; x < size_px.x; ++x) {
      const bool left = x < size_px.x / 2;
      rgb.push_back(left ? 128 : 0);
      rgb.push_back(y < size_px.y / 2 ? 200 : 10);
      rgb.push_back(left ? 0 : 128);
    }
  }
  return rgb;
}

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

/// Shows `count` pictures, each with the head that was predicted for it.
std::vector<HeadNow> show(Headset& headset, int count) {
  const glm::ivec2 size_px = headset.facts().eye_px * glm::ivec2(2, 1);
  const auto rgb = testPicture(size_px);
  std::vector<HeadNow> heads;
  for (int i = 0; i < count; ++i) {
    heads.push_back(headset.headNext().value());
    const HeadsetTick tick = nextTick(headset);
    EXPECT_NEAR(heads.back().display_s, tick.display_s, 1e-9);
    const HeadsetPicture picture{.rgb = rgb.data(),
                                 .size_px = size_px,
                                 .head = heads.back().head,
                                 .eyes = headset.facts().eyes};
    headset.submit(&picture);
  }
  return heads;
}

TEST(Headset, StatesWhatItFound) {
  const FakeOpenXr fake("eye=63,51");
  const auto headset = opened();
  if (!headset) GTEST_SKIP() << "no OpenGL";
  const HeadsetFacts& facts = headset->facts();
  EXPECT_EQ(facts.runtime, "Fake 1.2.3");
  EXPECT_EQ(facts.headset, "Fake headset");
  EXPECT_EQ(facts.no_gaze, "");
  EXPECT_EQ(facts.eye_px, glm::ivec2(64, 52));
  for (std::size_t side = 0; side < 2; ++side) {
    const HeadsetEye& eye = facts.eyes.at(side);
    const auto& truth = fake_openxr::kEyes.at(side);
    EXPECT_LT(glm::distance(eye.position_m, truth.position_m), 1e-8);
    EXPECT_GT(std::abs(glm::dot(eye.head_from_eye, truth.rotation)), 1.0 - 1e-12);
    const auto& field = fake_openxr::kFields_deg[side];
    EXPECT_NEAR(eye.field.left_deg, field[0], 1e-5);
    EXPECT_NEAR(eye.field.right_deg, field[1], 1e-5);
    EXPECT_NEAR(eye.field.up_deg, field[2], 1e-5);
    EXPECT_NEAR(eye.field.down_deg, field[3], 1e-5);
  }
  // Canted outwards: the left eye's axis points to the left.
  EXPECT_LT((facts.eyes[0].head_from_eye * glm::dvec3(0.0, 0.0, -1.0)).x, -0.017);
}

TEST(Headset, ShowsEachEyeItsOwnHalfUprightInTheSameCodes) {
  const FakeOpenXr fake;
  {
    const auto headset = opened();
    if (!headset) GTEST_SKIP() << "no OpenGL";
    show(*headset, 2);
  }
  EXPECT_EQ(fake.log().find("VIOLATION"), std::string::npos) << fake.log();
  const ShownImage image(fake.read("shown-2.ppm"));
  ASSERT_EQ(image.width, 128);
  ASSERT_EQ(image.height, 60);
  for (const int x : {0, 63, 64, 127}) {
    for (const int y : {0, 29, 30, 59}) {
      EXPECT_EQ(image.at(x, y, 0), x < 64 ? 128 : 0) << x << ' ' << y;
      EXPECT_EQ(image.at(x, y, 1), y < 30 ? 200 : 10) << x << ' ' << y;
      EXPECT_EQ(image.at(x, y, 2), x < 64 ? 0 : 128) << x << ' ' << y;
    }
  }
}

TEST(Headset, SubmitsTheHeadOfTheTimeOfDisplay) {
  const FakeOpenXr fake;
  std::vector<HeadNow> heads;
  {
    const auto headset = opened();
    if (!headset) GTEST_SKIP() << "no OpenGL";
    heads = show(*headset, 100);
  }
  std::istringstream log(fake.log());
  std::size_t frames = 0;
  for (std::string line; std::getline(log, line);) {
    double at_s = 0.0;
    int number = 0;
    glm::dvec3 p, d;
    char news[8] = "";
    if (std::sscanf(line.c_str(), "frame %d at %lf head %lf %lf %lf sight %lf %lf %lf %7s", &number,
                    &at_s, &p.x, &p.y, &p.z, &d.x, &d.y, &d.z, news) != 9) {
      EXPECT_EQ(line.find("VIOLATION"), std::string::npos) << line;
      continue;
    }
    const auto truth = fake_openxr::headAt(at_s);
    EXPECT_LT(glm::distance(p, truth.position_m), 1e-6) << line;
    EXPECT_LT(angle_deg(d, truth.rotation * glm::dvec3(0.0, 0.0, -1.0)), 1e-4) << line;
    EXPECT_STREQ(news, "new");
    EXPECT_NEAR(heads.at(frames).display_s, at_s, 1e-8);
    ++frames;
  }
  EXPECT_EQ(frames, heads.size());
}

TEST(Headset, ShowsTheLastPictureAgainWithItsOwnPose) {
  const FakeOpenXr fake;
  {
    const auto headset = opened();
    if (!headset) GTEST_SKIP() << "no OpenGL";
    show(*headset, 3);
    for (int i = 0; i < 2; ++i) {
      nextTick(*headset);
      headset->submit(nullptr);
    }
  }
  const std::string log = fake.log();
  EXPECT_EQ(log.find("VIOLATION"), std::string::npos) << log;
  const auto posed = [&](const std::string& frame) {
    const std::size_t begin = log.find("head", log.find(frame));
    return log.substr(begin, log.find('\n', begin) - begin);
  };
  const std::string shown = posed("frame 3 "), again = posed("frame 5 ");
  EXPECT_EQ(shown.substr(0, shown.rfind(' ')), again.substr(0, again.rfind(' ')));
  EXPECT_EQ(again.substr(again.rfind(' ')), " again");
}

TEST(Headset, TwoRunsShowTheSameBytes) {
  std::string logs[2], images[2];
  for (int run = 0; run < 2; ++run) {
    const FakeOpenXr fake("late=7");
    {
      const auto headset = opened();
      if (!headset) GTEST_SKIP() << "no OpenGL";
      show(*headset, 5);
    }
    logs[run] = fake.log();
    images[run] = fake.read("shown-5.ppm");
  }
  EXPECT_EQ(logs[0], logs[1]);
  EXPECT_EQ(images[0], images[1]);
  EXPECT_FALSE(images[0].empty());
}

TEST(Headset, KeepsTheTimesOfAClockWithAnotherEpoch) {
  const FakeOpenXr fake("late=4");
  const auto headset = opened();
  if (!headset) GTEST_SKIP() << "no OpenGL";
  double last_s = 0.0;
  int late = 0;
  for (int i = 0; i < 20; ++i) {
    const HeadsetTick tick = nextTick(*headset);
    headset->submit(nullptr);
    EXPECT_LT(tick.display_s, 1.0);
    EXPECT_DOUBLE_EQ(tick.period_s, fake_openxr::kPeriod_s);
    if (i > 0) late += static_cast<int>(std::lround((tick.display_s - last_s) / tick.period_s)) - 1;
    last_s = tick.display_s;
  }
  EXPECT_EQ(late, 5);
}

TEST(Headset, GazeIsADirectionInTheHeadAtItsOwnTime) {
  const FakeOpenXr fake("gaze=10,5");
  const auto headset = opened();
  if (!headset) GTEST_SKIP() << "no OpenGL";
  show(*headset, 20);
  const auto gaze = headset->gaze();
  ASSERT_TRUE(gaze && gaze->direction);
  EXPECT_TRUE(gaze->own_time);
  EXPECT_FALSE(gaze->degraded);
  EXPECT_NEAR(std::fmod(gaze->time_s * fake_openxr::kGaze_Hz + 0.5, 1.0), 0.5, 1e-5);
  const glm::dvec3 d = *gaze->direction;
  EXPECT_NEAR(glm::degrees(std::atan2(d.x, -d.z)), 10.0, 1e-4);
  EXPECT_NEAR(glm::degrees(std::asin(d.y)), 5.0, 1e-4);
  const auto head = fake_openxr::headAt(gaze->time_s);
  EXPECT_LT(glm::distance(gaze->head.position_m, head.position_m), 1e-6);
  EXPECT_GT(std::abs(glm::dot(gaze->head.world_from_head, head.rotation)), 1.0 - 1e-10);
}

TEST(Headset, GazeSaysWhatItsTimeAndQualityAre) {
  {
    const FakeOpenXr fake("sample_time_0 degraded");
    const auto headset = opened();
    if (!headset) GTEST_SKIP() << "no OpenGL";
    const HeadsetTick tick = nextTick(*headset);
    headset->submit(nullptr);
    const auto gaze = headset->gaze();
    ASSERT_TRUE(gaze && gaze->direction);
    EXPECT_FALSE(gaze->own_time);
    EXPECT_TRUE(gaze->degraded);
    EXPECT_NEAR(gaze->time_s, tick.display_s - 2.0 * tick.period_s, tick.period_s);
  }
  const FakeOpenXr fake("blinks");
  const auto headset = opened();
  for (int i = 0; i < 5; ++i) {
    nextTick(*headset);
    headset->submit(nullptr);
  }
  const auto gaze = headset->gaze();  // the first blink begins at 0
  ASSERT_TRUE(gaze);
  EXPECT_FALSE(gaze->direction);
}

/// What opening a headset says.
std::string refusalOf(const std::string& words, const std::string& loader = "") {
  const FakeOpenXr fake(words);
  try {
    const Headset headset(anyContext(), loader);
    return headset.facts().no_gaze;
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Headset, SaysWhatIsMissing) {
  if (!anyContext()) GTEST_SKIP() << "no OpenGL";
  const auto expect = [](const std::string& said, const char* part) {
    EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  };
  expect(refusalOf("", "libno_loader.so"), "no OpenXR loader: expected libno_loader.so");
  expect(refusalOf("no_headset"), "no headset at Fake 1.2.3: expected one that is connected");
  expect(refusalOf("denied"), "does not permit it: expected the permission");
  expect(refusalOf("no_gaze_extension"), "has no XR_EXT_eye_gaze_interaction");
  expect(refusalOf("no_tracker"), "says that Fake headset has no eye tracker");
}

TEST(Headset, RefusesARuntimeThatWouldShowOtherColours) {
  const FakeOpenXr fake("no_srgb");
  const auto headset = opened();
  if (!headset) GTEST_SKIP() << "no OpenGL";
  EXPECT_THROW(show(*headset, 1), InputError);
}

TEST(Headset, SaysThatThereIsNoRuntime) {
  auto context = anyContext();
  if (!context) GTEST_SKIP() << "no OpenGL";
  setenv("XR_RUNTIME_JSON", "/nowhere/runtime.json", 1);
  try {
    const Headset headset(std::move(context));
    ADD_FAILURE() << "opened";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no OpenXR runtime: expected one that is installed"),
              std::string::npos)
        << error.what();
  }
  unsetenv("XR_RUNTIME_JSON");
}

TEST(Headset, NoticesThatTheSessionEndsOrIsLost) {
  {
    const FakeOpenXr fake("exit=10");
    const auto headset = opened();
    if (!headset) GTEST_SKIP() << "no OpenGL";
    for (int i = 0; i < 50 && !headset->ended(); ++i) {
      if (headset->waitFrame()) headset->submit(nullptr);
    }
    EXPECT_TRUE(headset->ended());
  }
  const FakeOpenXr fake("lost=10");
  const auto headset = opened();
  show(*headset, 5);
  try {
    show(*headset, 50);
    ADD_FAILURE() << "not lost";
  } catch (const HeadsetLost& error) {
    EXPECT_STREQ(error.what(),
                 "the headset's session is lost, as if it was unplugged (XR_ERROR_SESSION_LOST)");
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
