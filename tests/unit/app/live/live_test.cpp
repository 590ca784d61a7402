// `foci live` without its window: its frames, its record, and that a replay gives the same frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>
#include <utility>

#include "app/live/record.h"
#include "app/live/refiner.h"
#include "app/live/remote_control.h"
#include "app/live/renderer.h"
#include "app/replay/replay.h"
#include "app/study/inputs.h"
#include "app/study/load_scene.h"
#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "base/text.h"
#include "tests/temporary_folder.h"
#include "tests/unit/app/live/wall.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

/// A gaze that jumps between two places on the screen every 150 ms, at 100 Hz. After `until_s` it
/// falls silent. Its samples arrive in batches of `batch_s`.
class Jumping final : public LiveSource {
 public:
  Jumping(const Screen& screen, double until_s, double batch_s)
      : screen_(screen), until_s_(until_s), batch_s_(batch_s) {}
  void poll(double now_s, std::vector<GazeSample>& samples) override {
    if (now_s < next_s_ + batch_s_) return;
    for (; next_s_ <= std::min(now_s, until_s_); next_s_ += 0.01) {
      const bool right = std::fmod(next_s_, 0.3) > 0.15;
      samples.push_back({.time_s = next_s_,
                         .point_px = glm::dvec2(screen_.size_px) *
                                     glm::dvec2(right ? 0.7 : 0.3, 0.4 + 0.1 / 3.0)});
    }
  }
  double rate_Hz() const override { return 100.0; }
  std::string status() const override { return "jumping"; }

 private:
  Screen screen_;
  double until_s_, batch_s_, next_s_ = 0.0;
};

class Live : public testing::Test {
 protected:
  void SetUp() override {
    study.file = scratch.write("live.toml", "");
    study.scene.file = scratch.write("scene.ply", wallPly());
    study.eye.position_m = glm::dvec3(0.0);
    study.eye.look_at_m = glm::dvec3(0.0, 0.0, -1.0);
    study.output.size_px = glm::ivec2(64, 36);
    study.output.marker = true;
  }

  NamedSource jumping(double until_s, double batch_s = 0.0) const {
    const Screen screen = study.screenInForce();
    return {.source = std::make_unique<Jumping>(screen, until_s, batch_s), .screen = screen};
  }

  /// Takes frames as a window would. @return the record of the last one
  FrameRecord watch(LiveRenderer& renderer, const LiveClock& clock, double seconds) {
    FrameRecord last;
    for (const double end_s = clock.now_s() + seconds; clock.now_s() < end_s;) {
      if (auto frame = renderer.take(clock.now_s())) {
        frame->timing.swap_s = clock.now_s();
        last = frame->record;
        if (const auto record = frame->record_file.lock()) {
          record->add(frame);
          ++recorded;
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return last;
  }

  TemporaryFolder scratch;
  Study study;
  int recorded = 0;  // frames that `watch` gave to a record
};

TEST_F(Live, SaysWhetherTheSceneIsInViewAndHowLargeItIs) {
  const LiveClock clock;
  GazeFeed feed(jumping(100.0), clock);
  LiveRenderer renderer(study, feed, clock, "foci live", 1, [] {});
  const auto inViewAfter = [&](const std::string& look_at_m) {
    auto changed = renderer.change("eye.look_at_m", look_at_m);
    while (changed.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) {
      renderer.take(clock.now_s());
    }
    EXPECT_EQ(changed.get(), "");
    return renderer.state().in_view;
  };
  EXPECT_TRUE(inViewAfter("[0, 0, -2]"));
  EXPECT_NEAR(renderer.state().scene_m, 1.95, 1e-3);  // 40 columns
  EXPECT_FALSE(inViewAfter("[0, 0, 1]"));
  EXPECT_TRUE(inViewAfter("[0.1, 0, -1]"));
}

TEST_F(Live, RecordReplaysToTheSameImagesAndEvents) {
  const fs::path folder = scratch.path() / "record";
  const LiveClock clock;
  {
    GazeFeed feed(jumping(100.0), clock);
    LiveRenderer renderer(study, feed, clock, "foci live", 1, [] {});
    watch(renderer, clock, 0.2);  // what happens before the record does not count
    auto begun = renderer.startRecord(folder);
    watch(renderer, clock, 0.3);
    EXPECT_EQ(begun.get(), "");
    renderer.change("observer.pupil_mm", "7");
    renderer.change("observer.field", "\"typical\"");
    watch(renderer, clock, 0.2);
    renderer.change("observer.field", "\"none\"");
    renderer.change("output.view", "\"side-by-side\"");
    renderer.change("eye.position_m", "[0.1, 0, 0.1]");
    watch(renderer, clock, 0.3);
    renderer.change("quality.foveated", "true");
    watch(renderer, clock, 0.3);
    renderer.addMarker("half");
    renderer.change("focus.fixed_D", "1.5");
    renderer.change("render.method", "\"pinhole\"");
    watch(renderer, clock, 0.2);
    renderer.change("focus.fixed_D", "null");
    watch(renderer, clock, 0.3);
    renderer.stopRecord();
    watch(renderer, clock, 0.05);
  }
  EXPECT_NE(textOf(folder / "event_markers.tsv").find("\thalf\n"), std::string::npos);

  const fs::path out = scratch.path() / "replay";
  replay(readStudy(folder / "study.toml"), out, "", 1);
  const auto live = nlohmann::json::parse(textOf(folder / "manifest.json"));
  const auto again = nlohmann::json::parse(textOf(out / "manifest.json"));
  EXPECT_GT(live["summary"]["frames"], 10);
  EXPECT_EQ(live["summary"]["frames_rendered"], again["summary"]["frames_rendered"]);
  EXPECT_NEAR(live["summary"]["pupil_mm"], again["summary"]["pupil_mm"], 0.01);
  EXPECT_EQ(live["frames_sha256"], again["frames_sha256"]);
  EXPECT_EQ(textOf(folder / "events.tsv"), textOf(out / "events.tsv"));
  const auto untimed = [](const std::string& table) {
    std::istringstream lines(table);
    std::string kept;
    for (std::string line; std::getline(lines, line);) kept += line.substr(0, line.rfind('\t'));
    return kept;
  };
  EXPECT_EQ(untimed(textOf(folder / "frames.tsv")), untimed(textOf(out / "frames.tsv")));
}

/// A frame does not know a sample that was measured before it and arrives after it. The record
/// keeps the time of the tracker all the same, and the replay shows each frame what it knew.
TEST_F(Live, ARecordKeepsTheTimesOfSamplesThatArriveLate) {
  const fs::path folder = scratch.path() / "record", out = scratch.path() / "replay";
  const LiveClock clock;
  {
    GazeFeed feed(jumping(100.0, 0.06), clock);
    LiveRenderer renderer(study, feed, clock, "foci live", 1, [] {});
    EXPECT_EQ(renderer.startRecord(folder).get(), "");  // loads the scene first
    watch(renderer, clock, 1.5);
    renderer.stopRecord();
    watch(renderer, clock, 0.05);
  }
  Warnings warnings;
  const auto samples = loadGaze(readStudy(folder / "study.toml"), warnings).samples;
  ASSERT_GT(samples.size(), 50u);
  for (std::size_t i = 3; i < samples.size(); ++i) {  // the first marks the record's begin
    ASSERT_NEAR(samples[i].time_s - samples[i - 1].time_s, 0.01, 1e-5) << i;
  }
  int late = 0;
  for (const RecordedFrame& frame : readFrames(folder / "frames.tsv")) {
    late += std::ranges::any_of(samples, [&](const GazeSample& sample) {
      return sample.time_s > frame.known_s && sample.time_s <= frame.time_s;
    });
  }
  EXPECT_GT(late, 0);
  replay(readStudy(folder / "study.toml"), out, "", 1);
  EXPECT_EQ(nlohmann::json::parse(textOf(folder / "manifest.json"))["frames_sha256"],
            nlohmann::json::parse(textOf(out / "manifest.json"))["frames_sha256"]);
}

TEST_F(Live, ARecordThatCannotBeginOrEndSaysWhy) {
  const LiveClock clock;
  GazeFeed feed(jumping(100.0), clock);
  LiveRenderer renderer(study, feed, clock, "foci live", 1, [] {});
  std::ofstream(scratch.path() / "file") << "";
  EXPECT_THROW(makeRecordFolder(scratch.path() / "file"), InputError);
  EXPECT_THROW(makeRecordFolder(scratch.path() / "file/below/record"), InputError);
  auto begun = renderer.startRecord(scratch.path() / "file");
  watch(renderer, clock, 0.3);
  EXPECT_NE(begun.get().find("expected a folder"), std::string::npos);

  EXPECT_EQ(renderer.startRecord(scratch.path() / "good").get(), "");
  watch(renderer, clock, 0.2);
  EXPECT_EQ(renderer.stopRecord().get(), "");
  EXPECT_EQ(renderer.startRecord(scratch.path() / "bad").get(), "");
  watch(renderer, clock, 0.2);
  fs::remove_all(scratch.path() / "bad");  // events.tsv cannot be written there
  std::vector<fs::path> records;
  std::vector<std::string> failed;
  renderer.finish(records, failed);
  EXPECT_EQ(records, std::vector{scratch.path() / "good"});
  ASSERT_EQ(failed.size(), 1u);
  EXPECT_NE(failed[0].find("bad is incomplete: "), std::string::npos) << failed[0];
}

TEST_F(Live, DoubtsAStudysScreenOfOblongPixels) {
  std::swap(study.screen.size_px.x, study.screen.size_px.y);
  for (const char* source : {"mouse", "socket", "trace:simulated"}) {
    const NamedSource named = openLiveSource(source, study);
    ASSERT_EQ(named.warnings.all().size(), 1u) << source;
    EXPECT_NE(named.warnings.all()[0].find("times as wide as high"), std::string::npos);
  }
}

#ifdef FOCI_PUPIL
TEST_F(Live, SaysThatPupilCoreLooksFromTheHead) {
  const NamedSource named = openLiveSource("pupil:127.0.0.1:50020", study);
  ASSERT_EQ(named.warnings.all().size(), 1u);
  EXPECT_EQ(named.warnings.all()[0].find("pupil:127.0.0.1:50020: positions are those of a scene"),
            0u);
}
#endif

TEST_F(Live, ARecordHoldsEverySampleThatWasPushedBeforeItsEnd) {
  const fs::path folder = scratch.path() / "record";
  constexpr int kSamples = 500;
  {
    const LiveClock clock;
    GazeFeed feed(openLiveSource("socket:1000", study), clock);
    LiveRenderer renderer(study, feed, clock, "foci live", 1, [] {});
    ASSERT_EQ(renderer.startRecord(folder).get(), "");
    watch(renderer, clock, 0.6);  // samples from before the record do not count
    std::string samples;
    for (int i = 0; i < kSamples; ++i) samples += std::to_string(5.0 + 0.001 * i) + " 500 400;";
    EXPECT_EQ(feed.push(samples), "ok 500");
    EXPECT_EQ(renderer.stopRecord().get(), "");
  }
  const std::string table = textOf(folder / "gaze.tsv");
  int points = 0;
  for (std::size_t at = 0; (at = table.find("\t500\t400", at)) != std::string::npos; ++at) ++points;
  EXPECT_EQ(points, kSamples);
}

/// A sender whose clock is set back by 20 s after 1 s, and whose tracker sees no eyes after 2 s.
/// Answers, record and log say all of it.
TEST_F(Live, SaysWhatHappensToTheGaze) {
  const fs::path folder = scratch.path() / "record";
  testing::internal::CaptureStderr();
  std::string last_answer, state;
  {
    const LiveClock clock;
    GazeFeed feed(openLiveSource("socket:100", study), clock);
    LiveRenderer renderer(study, feed, clock, "foci live", 1, [] {});
    ASSERT_EQ(renderer.startRecord(folder).get(), "");
    watch(renderer, clock, 0.2);
    const double begin_s = clock.now_s();
    for (int i = 0; clock.now_s() < begin_s + 4.5; ++i) {
      const double now_s = clock.now_s() - begin_s;
      const std::string point = now_s < 2.0 ? " 500 400" : " nan nan";
      last_answer = feed.push(std::to_string(now_s + (now_s < 1.0 ? 500.0 : 480.0)) + point);
      if (now_s < 2.0) {
        EXPECT_EQ(last_answer, "ok 1") << now_s;
      }
      watch(renderer, clock, 0.005);
    }
    state = answerTo("state", renderer);
    EXPECT_EQ(renderer.stopRecord().get(), "");
  }
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_TRUE(last_answer.starts_with("ok 1 unused: gaze arrives, but none")) << last_answer;
  EXPECT_NE(last_answer.find("without a gaze point"), std::string::npos) << last_answer;
  EXPECT_NE(state.find("\"gaze_remark\":\"gaze arrives"), std::string::npos) << state;
  EXPECT_NE(log.find("the clock of the gaze's sender has stepped by -20.0"), std::string::npos)
      << log;
  EXPECT_NE(log.find("foci: gaze arrives, but none of it"), std::string::npos) << log;
  const auto gaze = nlohmann::json::parse(textOf(folder / "manifest.json"))["gaze"];
  EXPECT_EQ(gaze["dropped"], 0);
  EXPECT_EQ(gaze["clock"]["steps"], 1);
  EXPECT_NEAR(gaze["clock"]["latest_steps"][0]["ahead_s"], -20.0, 0.05);
  EXPECT_TRUE(gaze["clock"].contains("offset_s") && gaze["clock"].contains("drift_ppm"));
  ASSERT_EQ(gaze["unused"].size(), 1u);
  EXPECT_GT(gaze["unused"][0]["to_s"].get<double>() - gaze["unused"][0]["from_s"].get<double>(),
            1.0);
}

/// A sender of fractions, of degrees and of millimetres is told while it sends; one of px is not,
/// though gaze rests, or once it has looked right stays in a corner.
TEST_F(Live, SaysThatPushedGazeIsInAnotherUnit) {
  const glm::dvec2 size_px(study.screenInForce().size_px);
  const LiveClock clock;
  const std::pair<const char*, std::function<glm::dvec2(const glm::dvec2&)>> units[] = {
      {"hardly moves", [](const glm::dvec2& part) { return part; }},
      {"off the screen", [](const glm::dvec2& part) { return 30.0 * (part - 0.5); }},
      {"upper left quarter", [&](const glm::dvec2& part) { return 0.25 * size_px * part; }},
      {"", [&](const glm::dvec2& part) { return 0.5 * size_px + part; }},
      {"", [&](const glm::dvec2& part) {
         return clock.now_s() < 10.2 ? size_px * part : 99.0 * part;
       }}};
  std::vector<std::unique_ptr<GazeFeed>> feeds;
  testing::internal::CaptureStderr();
  for (std::size_t i = 0; i < std::size(units); ++i) {
    feeds.push_back(std::make_unique<GazeFeed>(openLiveSource("socket:100", study), clock));
  }
  std::vector<GazeSample> taken;
  for (int i = 0; clock.now_s() < 20.5; ++i) {
    const glm::dvec2 part(0.1 + 0.1 * (i / 30 % 9), 0.15 + 0.07 * (i / 50 % 11));
    const glm::dvec2 noise(1e-4 * (i % 7), 1e-4 * (i % 5));
    for (std::size_t k = 0; k < std::size(units); ++k) {
      const glm::dvec2 point = units[k].second(part + noise);
      feeds[k]->push(printed("%.6f %.6f %.6f", 100.0 + clock.now_s(), point.x, point.y));
      feeds[k]->take(taken);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  for (std::size_t k = 0; k < std::size(units); ++k) {
    const std::string doubt = feeds[k]->reception().doubt;
    EXPECT_NE(doubt.find(units[k].first), std::string::npos) << doubt;
    EXPECT_EQ(doubt.empty(), *units[k].first == '\0') << doubt;
  }
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_NE(log.find("foci: gaze may be wrong: "), std::string::npos) << log;
}

TEST_F(Live, KeepsEverySampleThatItAnswersWithOk) {
  const LiveClock clock;
  GazeFeed feed(openLiveSource("socket:1000", study), clock);
  feed.look(true);
  std::size_t kept = 0, dropped = 0;
  constexpr int kAtOnce = 3000;
  for (int datagram = 0; datagram < 100; ++datagram) {
    std::string samples;
    for (int i = 0; i < kAtOnce; ++i) {
      samples += std::to_string(1e-5 * (datagram * kAtOnce + i)) + " 500 400;";
    }
    const std::string answer = feed.push(samples);
    (answer.starts_with("ok 3000") ? kept : dropped) += kAtOnce;
    if (!answer.starts_with("ok 3000")) {
      EXPECT_TRUE(answer.starts_with("error gaze: 3,000 samples dropped")) << answer;
    }
    feed.waitForPoll();
  }
  EXPECT_GT(dropped, 0u);
  std::vector<GazeSample> samples;
  feed.take(samples);
  EXPECT_EQ(samples.size(), kept);
  EXPECT_EQ(feed.reception().dropped, dropped);
}

TEST_F(Live, RemoteControlNamesFilesInTheStudysFolderAlone) {
  const fs::path inside = scratch.path() / "wavefronts";
  fs::create_directories(inside);
  std::ofstream(scratch.path() / "secret.csv") << "root:x:0\n";
  std::ofstream(inside / "eye.csv") << "no wavefront\n";
  fs::create_symlink(scratch.path() / "secret.csv", inside / "link.csv");
  const LiveClock clock;
  for (const bool allowed : {false, true}) {
    if (allowed) study.remote.folder = inside;
    GazeFeed feed(jumping(100.0), clock);
    LiveRenderer renderer(study, feed, clock, "foci live", 1, [] {});
    for (const std::string& name :
         std::vector<std::string>{"/etc/passwd", "../secret.csv", "link.csv", ".", "none.csv",
                                  (scratch.path() / "secret.csv").string()}) {
      const std::string answer = answerTo("set observer.wavefront \"" + name + "\"", renderer);
      EXPECT_NE(answer.find("remote.folder"), std::string::npos) << answer;
      EXPECT_EQ(answer.find("root:"), std::string::npos) << answer;
    }
    const std::string answer = answerTo("set observer.wavefront \"eye.csv\"", renderer);
    EXPECT_EQ(answer.find("remote.folder") == std::string::npos, allowed) << answer;
    EXPECT_EQ(answerTo("set observer.wavefront null", renderer), "ok");
    // No other key opens a file.
    for (const ResolvedKey& key : resolvedKeys(study)) {
      if (!changesLive(key.name) || key.name == "observer.wavefront") continue;
      const std::string other =
          answerTo("set " + std::string(key.name) + " \"/etc/passwd\"", renderer);
      EXPECT_TRUE(other.starts_with("error")) << key.name << ": " << other;
      EXPECT_EQ(other.find("root:"), std::string::npos) << other;
    }
  }
}

TEST_F(Live, RecordUnderABudgetReplaysToTheSameImages) {
  study.quality.frame_ms = 1.0;
  study.observer.pupil_mm = 7.0;
  const fs::path folder = scratch.path() / "record";
  const LiveClock clock;
  {
    GazeFeed feed(jumping(100.0), clock);
    LiveRenderer renderer(study, feed, clock, "foci live", 2, [] {});
    EXPECT_EQ(renderer.startRecord(folder).get(), "");
    watch(renderer, clock, 0.4);
    renderer.change("output.split", "true");
    watch(renderer, clock, 0.2);
    renderer.change("output.view", "\"top-bottom\"");
    watch(renderer, clock, 0.2);
    renderer.change("observer.chromatic", "true");
    watch(renderer, clock, 0.2);
    renderer.change("quality.foveated", "true");
    watch(renderer, clock, 0.2);
    // At rest the frame gets full quality: fine, as the first of a run.
    renderer.change("quality.foveated", "false");
    renderer.change("output.split", "false");
    renderer.change("focus.fixed_D", "1.5");
    renderer.change("quality.tolerance", "0.3");  // too strict for the cheapest levels
    FrameRecord last;
    for (int i = 0; i < 100 && last.method != "auto:5"; ++i) {
      last = watch(renderer, clock, 0.05);
    }
    EXPECT_EQ(last.method, "auto:5");
  }
  const fs::path out = scratch.path() / "replay";
  replay(readStudy(folder / "study.toml"), out, "", 1);
  const auto live = nlohmann::json::parse(textOf(folder / "manifest.json"));
  const auto again = nlohmann::json::parse(textOf(out / "manifest.json"));
  EXPECT_EQ(live["frames_sha256"], again["frames_sha256"]);
}

TEST_F(Live, ARefinerCancelsWhatIsNoLongerWanted) {
  study.output.size_px = glm::ivec2(640, 360);
  study.observer.pupil_mm = 8.0;
  study.render.method = "auto";
  study.quality.frame_ms = 5.0;
  Warnings warnings;
  const Scene scene = loadScene(study, warnings);
  Session session(sessionSettingsOf(study), scene, study.screenInForce(), 100.0, 0.0);
  const FrameRecord record = session.look(0.0);
  const RenderRequest request = session.requestOf("auto", record);
  Refiner refiner(session.cloneRenderer(), 1);
  RenderRequest other = request;
  for (int i = 0; i < 20; ++i) {  // each cancels the one before
    other.eyes[0].settings.defocus.focus_D = 0.1f * static_cast<float>(i);
    refiner.want({other});
    std::this_thread::sleep_for(std::chrono::milliseconds(i));
  }
  refiner.want({});
  refiner.want({other, request});
  const auto take = [&](const RenderRequest& wanted) {
    std::optional<RenderedFrame> rendered;
    for (int i = 0; i < 12000 && !rendered; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      rendered = refiner.take(wanted);
    }
    return rendered;
  };
  auto rendered = take(request);
  ASSERT_TRUE(rendered.has_value());
  RenderedFrame alone;
  FrameRenderer(scene).render(request.withoutTimeBudget(), alone);
  EXPECT_EQ(rendered->frame.rgba, alone.frame.rgba);
  for (int i = 0; i < 4; ++i) {  // the memory of other frames leaves nothing in the next
    const RenderRequest& wanted = i % 2 == 0 ? other : request;
    refiner.reuse(std::move(*rendered));
    refiner.want({wanted});
    rendered = take(wanted);
    ASSERT_TRUE(rendered.has_value());
  }
  EXPECT_EQ(rendered->frame.rgba, alone.frame.rgba);
}

std::size_t rowsOf(const fs::path& table) {
  const std::string text = textOf(table);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(Live, TheFrameRenderedAheadIsTheOneAtRest) {
  study.observer.pupil_mm = 8.0;
  study.render.method = "auto";
  study.quality.frame_ms = 5.0;
  study.quality.foveated = true;
  Warnings warnings;
  const Scene scene = loadScene(study, warnings);
  const Screen screen = study.screenInForce();
  Session session(sessionSettingsOf(study), scene, screen, 250.0, 0.0);
  std::optional<RenderRequest> ahead, last;
  int changes = 0;
  double sample_s = 0.0;
  for (int frame = 0; frame < 240; ++frame) {  // the far wall for a second, then the near one
    const double time_s = frame / 60.0;
    for (; sample_s <= time_s; sample_s += 0.004) {
      const double noise_px = 2.0 * std::sin(1e3 * sample_s);
      const double x = sample_s < 1.0 ? 0.3 : 0.7;
      session.push({.time_s = sample_s,
                    .point_px = glm::dvec2(x, 0.45) * glm::dvec2(screen.size_px) + noise_px});
    }
    const FrameRecord record = session.look(time_s);
    const RenderRequest request = session.requestOf("auto", record);
    // The surface is known, but focus only moves after its latency.
    if (time_s > 1.2 && !ahead) ahead = session.requestAtRest("auto", record);
    if (time_s > 1.2 && time_s < 1.25) {
      EXPECT_NE(request, *ahead);
    }
    if (time_s > 3.0) changes += request != last;
    last = request;
  }
  EXPECT_EQ(*last, *ahead);
  EXPECT_EQ(changes, 0);
}

TEST_F(Live, ARecordWithoutGazeSaysSo) {
  const fs::path folder = scratch.path() / "record";
  const LiveClock clock;
  {
    GazeFeed feed(jumping(-1.0), clock);
    LiveRenderer renderer(study, feed, clock, "", 1, [] {});
    EXPECT_EQ(renderer.startRecord(folder).get(), "");
    watch(renderer, clock, 0.2);
  }
  const auto manifest = nlohmann::json::parse(textOf(folder / "manifest.json"));
  EXPECT_EQ(manifest["gaze"]["format"], "no gaze");
  EXPECT_EQ(manifest["summary"]["gaze_valid"], 0.0);
  EXPECT_GT(manifest["summary"]["frames"], 0);
  EXPECT_EQ(rowsOf(folder / "events.tsv"), 1u);
}

/// Memory of the program, bytes.
double residentBytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  file >> all >> resident;
  return resident * 4096.0;
}

#ifdef FOCI_SANITIZED
// Sanitizers keep freed memory, and slow the frame loop: with a faster clock every frame would have
// more samples to take than the one before.
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

/// Hours in seconds, on a clock that is faster than real time. FOCI_SOAK_HOURS sets how many.
TEST_F(Live, LongRunsLoseNoRowAndNoMemory) {
  const char* asked = std::getenv("FOCI_SOAK_HOURS");
  const double faster = kSanitized ? 12.0 : 120.0;
  const double hours = asked ? std::atof(asked) : faster * 2.1 / 3600.0;
  study.quality.frame_ms = 1.0;
  const fs::path folder = scratch.path() / "record";
  const LiveClock clock(faster);
  std::size_t taken = 0;
  double early_bytes = 0.0;
  {
    GazeFeed feed(jumping(1e9), clock);
    LiveRenderer renderer(study, feed, clock, "", 1, [] {});
    EXPECT_EQ(renderer.startRecord(folder).get(), "");
    const double end_s = clock.now_s() + 3600.0 * hours;
    const double warm_s = clock.now_s() + 0.3 * 3600.0 * hours;
    // A slow machine gets the time for a few frames.
    constexpr std::size_t kFew = 3;
    const auto patience = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    const auto waits = [&] { return taken < kFew && std::chrono::steady_clock::now() < patience; };
    while (clock.now_s() < end_s || waits()) {
      if (auto frame = renderer.take(clock.now_s())) {
        frame->timing.swap_s = clock.now_s();
        if (const auto record = frame->record_file.lock()) {
          record->add(frame);
          ++taken;
        }
      }
      if (early_bytes == 0.0 && clock.now_s() > warm_s) early_bytes = residentBytes();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    const double late_bytes = residentBytes();
    std::printf("%.2f h: %zu frames, %.1f MB, before %.1f MB\n", hours, taken, late_bytes / 1e6,
                early_bytes / 1e6);
    constexpr double kGrowth = 1.05;  // bound for eight hours
    if (!kSanitized) {
      EXPECT_LE(late_bytes, kGrowth * early_bytes);
    }
  }
  EXPECT_GT(taken, 1u);
  EXPECT_EQ(rowsOf(folder / "frames.tsv"), taken + 1);
  EXPECT_EQ(rowsOf(folder / "timing.tsv"), taken + 1);
  EXPECT_TRUE(textOf(folder / "timing.tsv").ends_with("\tn/a\tn/a\tn/a\n"));  // of a GPU
  const auto manifest = nlohmann::json::parse(textOf(folder / "manifest.json"));
  EXPECT_EQ(manifest["summary"]["frames"], taken);
  constexpr std::size_t kHead = 2;  // lines of gaze.tsv before the samples
  EXPECT_EQ(manifest["gaze"]["samples"], rowsOf(folder / "gaze.tsv") - kHead);
}

TEST_F(Live, RecordIsCompleteIfTheProgramEndsFirst) {
  const LiveClock clock;
  {
    GazeFeed feed(jumping(100.0), clock);
    LiveRenderer renderer(study, feed, clock, "", 1, [] {});
    renderer.startRecord(scratch.path() / "record");
    // A slow machine gets the time for one frame.
    for (int i = 0; i < 600 && recorded == 0; ++i) watch(renderer, clock, 0.1);
  }
  ASSERT_GT(recorded, 0);
  const auto manifest = nlohmann::json::parse(textOf(scratch.path() / "record/manifest.json"));
  EXPECT_EQ(manifest["summary"]["frames"], recorded);
}

TEST_F(Live, KeepsTheFocusWhenTheSourceFallsSilent) {
  const LiveClock clock;
  GazeFeed feed(jumping(1.0), clock);
  LiveRenderer renderer(study, feed, clock, "", 1, [] {});
  const FrameRecord last = watch(renderer, clock, 2.5);
  EXPECT_EQ(last.eye.state, GazeState::lost);
  EXPECT_TRUE(last.fixation_px.has_value());
  ASSERT_TRUE(last.eye.target_D.has_value());
  EXPECT_GT(*last.eye.target_D, 0.4);
  EXPECT_GT(last.time_s, 1.5);  // rendering goes on
}

TEST_F(Live, RefusesAChangeAndGoesOn) {
  const LiveClock clock;
  GazeFeed feed(jumping(100.0), clock);
  LiveRenderer renderer(study, feed, clock, "", 1, [] {});
  EXPECT_NE(answerTo("set output.size_px [8, 8]", renderer).find("does not change"),
            std::string::npos);
  EXPECT_EQ(answerTo("set observer.pupl 3", renderer),
            "error change: unknown key observer.pupl: did you mean observer.pupil?");
  EXPECT_NE(answerTo("set observer.pupil_mm 99", renderer).find("0.5 to 12"), std::string::npos);
  EXPECT_EQ(answerTo("set observer.pupil_mm 6", renderer), "ok");
  EXPECT_TRUE(answerTo("stop", renderer).starts_with("error"));
  EXPECT_TRUE(answerTo("record ../elsewhere", renderer).starts_with("error"));
  EXPECT_TRUE(answerTo("dance", renderer).starts_with("error"));
  EXPECT_TRUE(answerTo("mark a b", renderer).starts_with("ok "));
  EXPECT_EQ(answerTo("mark ", renderer), "error mark: expected mark TEXT");
  EXPECT_EQ(answerTo("gaze", renderer), "error gaze: expected gaze TIME X Y [PUPIL]");
  EXPECT_EQ(watch(renderer, clock, 0.5).pupil_mm, 6.0);
}

TEST_F(Live, SaysWhenTheSceneCannotBeOpened) {
  study.scene.file = scratch.path() / "none.ply";
  const LiveClock clock;
  GazeFeed feed(jumping(1.0), clock);
  LiveRenderer renderer(study, feed, clock, "", 1, [] {});
  EXPECT_THROW(watch(renderer, clock, 5.0), InputError);
}

TEST(MethodOfFrame, IsTheFastestInASaccadeExceptForAuto) {
  Study study;
  study.render.method = "sweep-lod";
  FrameRecord record;
  record.eye.state = GazeState::saccade;
  EXPECT_EQ(methodOfFrame(study, record), "pinhole");
  study.render.method = "auto:4";
  EXPECT_EQ(methodOfFrame(study, record), "pinhole");
  study.render.method = "auto";  // it reuses its frame
  EXPECT_EQ(methodOfFrame(study, record), "auto");
  study.quality.frame_ms = 10.0;
  EXPECT_EQ(methodOfFrame(study, record), "auto");
  study.render.method = "sweep-lod";
  for (const GazeState state : {GazeState::fixation, GazeState::pursuit, GazeState::lost}) {
    record.eye.state = state;
    EXPECT_EQ(methodOfFrame(study, record), "sweep-lod");
  }
}

TEST(LiveRecord, ReplacesNoFile) {
  for (const char* name : {"study.toml", "frames.tsv", "manifest.json"}) {
    const TemporaryFolder folder;
    folder.write(name, "mine");
    EXPECT_THROW(LiveRecord(folder.path(), Study{}, defaultScreen(), 250.0, "", 1, ""), InputError);
    EXPECT_EQ(folder.read(name), "mine");
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
