// The scene from outside: where lines show, what the trail keeps, and that frames and records do
// not depend on it.
#include "app/live/outside.h"

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/replay/replay.h"
#include "app/study/inputs.h"
#include "base/file.h"
#include "tests/temporary_folder.h"
#include "tests/unit/app/live/wall.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;
constexpr float kPixelRounding = 1e-2f;

const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.4, 0.2}, .distance_m = 0.5};

/// A fixation of the screen's middle, on a surface 2 m away.
FrameRecord fixating(double time_s, const glm::dvec3& eye_m = glm::dvec3(0.0)) {
  FrameRecord record;
  record.time_s = time_s;
  record.eye_m = eye_m;
  record.eye.state = GazeState::fixation;
  record.eye.surface_distance_m = 2.0;
  record.eye.focus_D = 0.25;
  record.gaze_px = record.fixation_px = glm::dvec2(500.0, 250.0);
  return record;
}

TEST(ObserverTrail, HasAFixationForEachPointOnTheSurface) {
  ObserverTrail trail;
  trail.add(fixating(1.0), kScreen);
  trail.add(fixating(1.5), kScreen);
  ASSERT_TRUE(trail.looksAt_m());
  EXPECT_NEAR(glm::distance(*trail.looksAt_m(), glm::dvec3(0.0, 0.0, -2.0)), 0.0, kRounding);
  FrameRecord jump = fixating(1.6);
  jump.eye.state = GazeState::saccade;
  trail.add(jump, kScreen);  // the line of sight ends where the eye focuses
  EXPECT_NEAR(glm::length(*trail.looksAt_m()), 4.0, kRounding);
  FrameRecord aside = fixating(1.7);
  aside.fixation_px = glm::dvec2(1000.0, 250.0);  // 0.2 m aside at 0.5 m
  trail.add(aside, kScreen);
  FrameRecord blink = fixating(1.8);
  blink.eye.state = GazeState::blink;
  blink.gaze_px.reset();
  trail.add(blink, kScreen);
  EXPECT_FALSE(trail.looksAt_m());
  ASSERT_EQ(trail.fixations().size(), 2u);
  EXPECT_NEAR(trail.fixations()[0].to_s - trail.fixations()[0].from_s, 0.5, kRounding);
  EXPECT_NEAR(trail.fixations()[1].point_m.x / trail.fixations()[1].point_m.z, -0.4, kRounding);
  EXPECT_EQ(trail.path_m().size(), 1u);  // the eye has rested
  trail.add(fixating(1.9, {0.5, 0.0, 0.0}), kScreen);
  EXPECT_EQ(trail.path_m().size(), 2u);
}

TEST(LineInView, IsCutAtTheCamera) {
  const View view = viewOfCamera(glm::mat4(1.0f), {200, 100}, glm::radians(90.0));
  const auto seen = lineInView_px(view, {0.0, 0.0, -1.0}, {1.0, 0.0, -2.0});
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->first.x, 100.0f, kPixelRounding);
  EXPECT_NEAR(seen->second.x, 125.0f, kPixelRounding);  // 50 px for a tangent of 1
  EXPECT_FALSE(lineInView_px(view, {0.0, 0.0, 1.0}, {1.0, 0.0, 2.0}));
  // A line through the camera's plane leaves the image on the side where it passes.
  const auto passing = lineInView_px(view, {1.0, 0.0, 3.0}, {1.0, 0.0, -1.0});
  ASSERT_TRUE(passing);
  EXPECT_GT(passing->first.x, 200.0f);
  EXPECT_NEAR(passing->second.x, 150.0f, kPixelRounding);
}

TEST(CameraBehind, SeesTheObserverAndTheSurface) {
  const FrameRecord record = fixating(0.0, {1.0, 2.0, 3.0});
  const LivePose pose = cameraBehind(record, {0.0, 1.0, 0.0});
  const View view = viewOfCamera(eyeFromWorld(pose.position_m(), pose.look_at_m(), pose.up()),
                                 {200, 200}, glm::radians(55.0));
  const auto sight = lineInView_px(view, record.eye_m, record.eye_m + glm::dvec3(0.0, 0.0, -2.0));
  ASSERT_TRUE(sight);
  for (const glm::vec2 end : {sight->first, sight->second}) {
    EXPECT_TRUE(glm::all(glm::greaterThan(end, glm::vec2(10.0f)))) << end.x << ' ' << end.y;
    EXPECT_TRUE(glm::all(glm::lessThan(end, glm::vec2(190.0f)))) << end.x << ' ' << end.y;
  }
}

/// A gaze that rests.
class Resting final : public LiveSource {
 public:
  void poll(double now_s, std::vector<GazeSample>& samples) override {
    samples.push_back({.time_s = now_s, .point_px = glm::dvec2(960.0, 540.0)});
  }
  double rate_Hz() const override { return 250.0; }
  std::string status() const override { return "resting"; }
};

TEST(OutsideView, ShowsTheSceneAndLeavesTheRecordAsItIs) {
  const TemporaryFolder scratch;
  Study study;
  study.file = scratch.write("live.toml", "");
  study.scene.file = scratch.write("scene.ply", wallPly());
  study.eye.position_m = glm::dvec3(0.0);
  study.eye.look_at_m = glm::dvec3(0.0, 0.0, -1.0);
  study.output.size_px = glm::ivec2(64, 36);
  const auto folder = scratch.path() / "record", out = scratch.path() / "replay";
  {
    const LiveClock clock;
    GazeFeed feed({.source = std::make_unique<Resting>(), .screen = study.screenInForce()}, clock);
    LiveRenderer renderer(study, feed, clock, "foci live", 1, [] {});
    EXPECT_EQ(renderer.startRecord(folder).get(), "");
    std::unique_ptr<OutsideView> outside;
    const auto watch = [&](const auto& wanted) {
      for (const double end_s = clock.now_s() + 20.0; clock.now_s() < end_s && !wanted();) {
        if (auto frame = renderer.take(clock.now_s())) {
          frame->timing.swap_s = clock.now_s();
          if (const auto record = frame->record_file.lock()) record->add(frame);
        }
        if (outside) outside->update({40, 40});
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      return wanted();
    };
    auto scene = renderer.outside();
    ASSERT_TRUE(watch(
        [&] { return scene.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }));
    outside = std::make_unique<OutsideView>(
        scene.get(), LivePose({0.0, 0.0, 1.0}, {0.5, 0.0, -1.0}, {0.0, 1.0, 0.0}));
    ASSERT_TRUE(watch([&] { return outside->image() != nullptr; }));
    const auto first = outside->image();
    EXPECT_EQ(first->size_px, glm::ivec2(40, 40));
    outside->camera().steer({.drag = Drag::orbit, .drag_px = {300.0, 0.0}}, 2.0, clock.now_s());
    ASSERT_TRUE(watch([&] { return outside->image() != first; }));
    EXPECT_NE(outside->image()->rgb, first->rgb);
    const double at_s = clock.now_s();
    watch([&] { return clock.now_s() > at_s + 0.1; });
    renderer.stopRecord();
    watch([&] { return clock.now_s() > at_s + 0.2; });
  }
  replay(readStudy(folder / "study.toml"), out, "", 1);
  const auto shaOf = [](const std::filesystem::path& run) {
    const auto manifest = nlohmann::json::parse(textOf(run / "manifest.json"));
    EXPECT_GT(manifest["summary"]["frames"], 4);
    return manifest["frames_sha256"];
  };
  EXPECT_EQ(shaOf(folder), shaOf(out));
}

}  // namespace FOCI_FILE
}  // namespace foci
