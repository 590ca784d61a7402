// A recording that `foci live` plays, without its window: what the eye sees, and that a record of
// it replays to the same frames.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/live/record.h"
#include "app/live/remote_control.h"
#include "app/live/renderer.h"
#include "app/live/sources.h"
#include "app/live/words.h"
#include "app/replay/replay.h"
#include "base/input_error.h"
#include "tests/temporary_folder.h"
#include "tests/unit/app/live/wall.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

class Playing : public testing::Test {
 protected:
  void SetUp() override {
    study.scene.file = scratch.write("scene.ply", wallPly());
    study.scene.cache = false;
    study.file = scratch.write("live.toml", "");
    study.eye.position_m = glm::dvec3(0.0);
    study.eye.look_at_m = glm::dvec3(0.0, 0.0, -1.0);
    study.output.size_px = glm::ivec2(64, 36);
  }

  /// Gaze at the far part, and from 5 s to 10 s at the near one, at 100 Hz.
  fs::path farAndNear() const {
    std::string table = "time_s\tx_px\ty_px\n";
    for (int i = 0; i <= 1000; ++i) {
      const double noise_px = std::sin(37.0 * i);
      table += std::to_string(0.01 * i) + '\t' + std::to_string((i < 500 ? 600 : 1300) + noise_px) +
               '\t' + std::to_string(540 - noise_px) + '\n';
    }
    return scratch.write("gaze.tsv", table);
  }

  /// Takes frames as a window would, until one is as wanted. @return that one; null: none was
  template <class Wanted>
  std::shared_ptr<LiveFrame> watch(LiveRenderer& renderer, const Wanted& wanted,
                                   double patience_s = 30.0) {
    for (const double end_s = clock.now_s() + patience_s; clock.now_s() < end_s;) {
      if (auto frame = renderer.take(clock.now_s())) {
        frame->timing.swap_s = clock.now_s();
        if (const auto record = frame->record_file.lock()) record->add(frame);
        ++frames;
        if (wanted(frame->record)) return frame;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return nullptr;
  }
  void watchFor(LiveRenderer& renderer, double seconds) {
    watch(
        renderer, [](const FrameRecord&) { return false; }, seconds);
  }

  void expectSameReplay(const fs::path& record) {
    const fs::path out = scratch.path() / "replay";
    replay(readStudy(record / "study.toml"), out, "", 1);
    const auto live = nlohmann::json::parse(textOf(record / "manifest.json"));
    const auto again = nlohmann::json::parse(textOf(out / "manifest.json"));
    EXPECT_GT(live["summary"]["frames"], 4);
    EXPECT_EQ(live["frames_sha256"], again["frames_sha256"]);
    EXPECT_EQ(textOf(record / "events.tsv"), textOf(out / "events.tsv"));
  }

  TemporaryFolder scratch;
  Study study;
  LiveClock clock;
  int frames = 0;  // that `watch` took
};

TEST_F(Playing, ASeekShowsTheFocusOfThatMomentAndARecordOfItReplays) {
  const fs::path folder = scratch.path() / "record";
  {
    GazeFeed feed(openLiveSource("trace:" + farAndNear().string(), study), clock);
    const std::vector<GazeEvent>& events = feed.playback().events;
    LiveRenderer renderer(study, feed, clock, "", 1, [] {});
    TracePlayer& player = *feed.player();
    ASSERT_EQ(renderer.startRecord(folder).get(), "");
    EXPECT_NEAR(player.state().recording_s, 0.0, 1e-9);  // it waits for the first frame
    EXPECT_TRUE(watch(renderer, [](const FrameRecord& frame) { return frame.time_s > 0.1; }));
    EXPECT_GT(player.state().recording_s, 0.1);
    EXPECT_EQ(carryOut(PlayerStep::toggle, player, events), "paused");
    watchFor(renderer, 0.1);
    frames = 0;
    watchFor(renderer, 0.1);
    EXPECT_EQ(frames, 0);  // nothing new to see
    const auto focusesAt = [](double focus_D) {
      return [focus_D](const FrameRecord& frame) {
        return frame.eye.state == GazeState::fixation &&
               std::abs(frame.eye.focus_D - focus_D) < 0.02;
      };
    };
    EXPECT_EQ(carryOut(PlayerStep::fixation_after, player, events), "fixation 2 of 2");
    EXPECT_TRUE(watch(renderer, focusesAt(1.0)));  // while it pauses
    EXPECT_EQ(carryOut(PlayerStep::fixation_before, player, events), "fixation 1 of 2");
    EXPECT_TRUE(watch(renderer, focusesAt(0.5)));
    EXPECT_NE(answerTo("state", renderer).find("\"speed\":0.0"), std::string::npos);
    EXPECT_EQ(carryOut(PlayerStep::slower, player, events), "speed 1/2");
    player.play(true);
    EXPECT_EQ(renderer.change("observer.pupil_mm", "6").get(), "");
    watchFor(renderer, 0.3);
    EXPECT_EQ(renderer.stopRecord().get(), "");
    EXPECT_TRUE(feed.reception().unused.empty());  // although seeks brought old gaze
  }
  const std::string playback = textOf(folder / "playback.tsv");
  EXPECT_TRUE(playback.starts_with("# recording=")) << playback;
  EXPECT_NE(playback.find("\t0.500\n"), std::string::npos) << playback;
  expectSameReplay(folder);
}

TEST_F(Playing, ARecordedHeadMovesTheViewAndARecordOfItReplays) {
  const fs::path folder = scratch.path() / "record";
  std::string table = "time_s,dx,dy,dz,hx,hy,hz,qx,qy,qz,qw\n";
  for (int i = 0; i <= 200; ++i) {  // 0.1 m/s to the right, and a slow turn to the left
    const double half_rad = 0.0005 * i;
    table += std::to_string(0.01 * i) + ',' + std::to_string(0.05 + 3e-4 * std::sin(37.0 * i)) +
             ",0,-0.99875," + std::to_string(0.001 * i) + ",0,0,0," +
             std::to_string(std::sin(half_rad)) + ",0," + std::to_string(std::cos(half_rad)) + "\n";
  }
  SpaceColumns& space = study.gaze.columns.space;
  space.both.direction = {"dx", "dy", "dz"};
  space.head_position = {"hx", "hy", "hz"};
  space.head_quaternion = {"qx", "qy", "qz", "qw"};
  space.frame = SightFrame::head;
  space.axes = "right-up-back";
  study.observer.pupil_mm = 6.0;
  {
    NamedSource source =
        openLiveSource("trace:" + scratch.write("head.csv", table).string(), study);
    ASSERT_TRUE(source.study);
    const Study moved = *source.study;
    GazeFeed feed(std::move(source), clock);
    LiveRenderer renderer(
        moved, feed, clock, "", 1, [] {}, {}, {},
        [&](const Study&, double time_s) {
          return LiveHead{.in_scene = feed.playback().head(time_s)};
        });
    ASSERT_EQ(renderer.startRecord(folder).get(), "");
    const auto early = watch(renderer, [](const FrameRecord& frame) { return frame.time_s > 0.1; });
    // While it pauses, the head rests: a frame may be rendered again at full quality.
    feed.player()->play(false);
    watchFor(renderer, 0.1);
    std::vector<glm::dvec3> eyes_m;
    for (const char* pupil_mm : {"5", "6"}) {
      EXPECT_EQ(renderer.change("observer.pupil_mm", pupil_mm).get(), "");
      const auto frame = watch(
          renderer, [&](const FrameRecord& now) { return now.pupil_mm == pupil_mm[0] - '0'; });
      ASSERT_TRUE(frame);
      eyes_m.push_back(frame->record.eye_m);
    }
    EXPECT_EQ(eyes_m[0], eyes_m[1]);
    feed.player()->play(true);
    EXPECT_EQ(renderer.change("output.view", "\"side-by-side\"").get(), "");
    feed.player()->seek(1.9);
    const auto late =
        watch(renderer, [](const FrameRecord& frame) { return frame.eye_m.x > 0.189; });
    ASSERT_TRUE(early && late);
    EXPECT_LT(early->record.eye_m.x, 0.1);
    EXPECT_LT(late->record.eye_m.x, 0.201);
    watchFor(renderer, 0.2);
    EXPECT_EQ(renderer.stopRecord().get(), "");
  }
  expectSameReplay(folder);
}

TEST_F(Playing, APathOfTheStudyPausesAndSeeksWithTheRecording) {
  const fs::path folder = scratch.path() / "record";
  study.eye.position_m.reset();
  study.eye.look_at_m.reset();
  study.eye.path = {{.time_s = 0.0, .position_m = {0, 0, 0}, .look_at_m = {0, 0, -1}, .up = {}},
                    {.time_s = 10.0, .position_m = {1, 0, 0}, .look_at_m = {1, 0, -1}, .up = {}}};
  {
    NamedSource source = openLiveSource("trace:" + farAndNear().string(), study);
    ASSERT_TRUE(source.study);
    EXPECT_GT(source.playback.path_m.back().x, 0.99);
    const Study moved = *source.study;
    GazeFeed feed(std::move(source), clock);
    LiveRenderer renderer(
        moved, feed, clock, "", 1, [] {}, {}, {},
        [&](const Study&, double time_s) {
          return LiveHead{.in_scene = feed.playback().head(time_s)};
        });
    ASSERT_EQ(renderer.startRecord(folder).get(), "");
    const auto isAt = [](double x_m) {
      return [x_m](const FrameRecord& now) { return std::abs(now.eye_m.x - x_m) < 0.02; };
    };
    EXPECT_TRUE(watch(renderer, isAt(0.01)));
    feed.player()->seek(8.0);
    EXPECT_TRUE(watch(renderer, isAt(0.8)));
    feed.player()->play(false);
    feed.player()->seek(2.0);
    EXPECT_TRUE(watch(renderer, isAt(0.2)));
    watchFor(renderer, 0.1);
    EXPECT_EQ(renderer.change("observer.pupil_mm", "6").get(), "");
    const auto later =
        watch(renderer, [](const FrameRecord& frame) { return frame.pupil_mm == 6.0; });
    ASSERT_TRUE(later);
    EXPECT_NEAR(later->record.eye_m.x, 0.2, 1e-6);  // it has rested
    EXPECT_EQ(renderer.stopRecord().get(), "");
  }
  expectSameReplay(folder);
}

TEST_F(Playing, AFileThatIsDroppedIsASceneAStudyOrARecordingInTheStudy) {
  study.observer.pupil_mm = 5.0;
  const fs::path recording = farAndNear();
  LiveNext next = openedFile(recording, {}, "mouse", study);
  EXPECT_EQ(next.source, "trace:" + recording.string());
  EXPECT_EQ(next.study.observer.pupil_mm, 5.0);
  EXPECT_EQ(next.title, "live.toml, gaze.tsv");
  next = openedFile(*study.scene.file, {}, next.source, study);
  EXPECT_EQ(next.source, "mouse");
  EXPECT_EQ(next.study.scene.file, study.scene.file);
  EXPECT_NE(next.study.observer.pupil_mm, 5.0);
  EXPECT_TRUE(next.scene);
  next = openedFile(scratch.write("other.toml", "[observer]\npupil_mm = 3\n"), {}, "lsl", study);
  EXPECT_EQ(next.source, "lsl");
  EXPECT_EQ(next.study.observer.pupil_mm, 3.0);
  EXPECT_THROW(openedFile(scratch.write("junk.txt", "junk"), {}, "mouse", study), InputError);
}

TEST(CarryOut, SaysWhatItDidToThePlayer) {
  GazeTrace trace{{.format = "TSV"}, 100.0};
  for (int i = 0; i <= 2000; ++i) trace.samples.push_back({.time_s = 0.01 * i});
  TracePlayer player(trace);
  const auto does = [&](PlayerStep step) { return carryOut(step, player, {}); };
  EXPECT_EQ(does(PlayerStep::toggle), "plays");
  EXPECT_EQ(does(PlayerStep::forward), "at 5.00 s");
  EXPECT_EQ(does(PlayerStep::back), "at 0.00 s");
  EXPECT_EQ(does(PlayerStep::end), "at 20.00 s");
  EXPECT_EQ(does(PlayerStep::frame_forward), "at the end");
  EXPECT_EQ(does(PlayerStep::frame_back), "at 19.97 s");
  EXPECT_FALSE(player.state().plays);
  EXPECT_EQ(does(PlayerStep::faster), "speed 2");
  for (int i = 0; i < 9; ++i) does(PlayerStep::slower);
  EXPECT_EQ(does(PlayerStep::slower), "speed 1/8");
  EXPECT_EQ(does(PlayerStep::loop), "plays in a loop");
  EXPECT_EQ(does(PlayerStep::fixation_after), "no later fixation");
}

TEST(ChangeInWords, NamesTheNewValue) {
  EXPECT_EQ(changeInWords("observer.pupil_mm", "6"), "pupil 6 mm");
  EXPECT_EQ(changeInWords("focus.fixed_D", "null"), "focus follows the gaze");
  EXPECT_EQ(changeInWords("focus.fixed_D", "1.25"), "focus fixed at 1.25 D, 0.80 m");
  EXPECT_EQ(changeInWords("focus.fixed_D", "0"), "focus fixed at 0.00 D, infinity");
  EXPECT_EQ(changeInWords("output.view", "\"anaglyph\""), "view: anaglyph");
  EXPECT_TRUE(changeInWords("render.method", "\"sweep\"").starts_with("method sweep: "));
  EXPECT_EQ(changeInWords("seed", "3"), "seed = 3");
}

}  // namespace FOCI_FILE
}  // namespace foci
