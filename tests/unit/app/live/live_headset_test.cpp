// `foci live --headset` without its window, against a runtime of our own: what each eye sees, and
// that a record replays to the same frames.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>

#include "app/live/headset_display.h"
#include "app/live/renderer.h"
#include "app/replay/replay.h"
#include "app/study/study.h"
#include "app/window/window.h"
#include "base/input_error.h"
#include "tests/fake_openxr/environment.h"
#include "tests/fake_openxr/fake_openxr.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

const glm::dvec3 kAhead(0.0, 0.0, -1.0);

std::unique_ptr<GpuContext> softwareContext() {
  std::unique_ptr<GpuContext> found;
  openEglContexts(true, [&](std::unique_ptr<GpuContext>& context) {
    if (!context->makeCurrent()) return true;
    context->release();
    found = std::move(context);
    return false;
  });
  return found;
}

/// A square of grey points, code 128, around a place.
std::string squarePly(const glm::dvec3& at_m, double side_m, int across) {
  std::ostringstream ply;
  ply << "ply\nformat ascii 1.0\nelement vertex " << across * across
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
         "property uchar green\nproperty uchar blue\nend_header\n";
  for (int i = 0; i < across * across; ++i) {
    const double x = (i % across + 0.5) / across - 0.5, y = (i / across + 0.5) / across - 0.5;
    ply << at_m.x + side_m * x << ' ' << at_m.y + side_m * y << ' ' << at_m.z << " 128 128 128\n";
  }
  return ply.str();
}

class LiveHeadset : public testing::Test {
 protected:
  void SetUp() override {
    if (!softwareContext()) GTEST_SKIP() << "no OpenGL";
    study.file = scratch.path() / "live.toml";
    std::ofstream(study.file) << "";
    study.scene.file = scratch.path() / "scene.ply";
    study.scene.cache = false;
    study.render.device = RenderDevice::cpu;
  }

  /// The observer stands here in the scene, and faces there.
  void stand(const glm::dvec3& eye_m, const glm::dvec3& look_at_m) {
    study.eye.position_m = eye_m;
    study.eye.look_at_m = look_at_m;
  }

  /// Runs until the window has had this many frames. @return those frames
  std::vector<std::shared_ptr<LiveFrame>> run(
      std::size_t count, const fs::path& record = {},
      const std::function<void(LiveRenderer&)>& midway = [](LiveRenderer&) {}) {
    std::vector<std::shared_ptr<LiveFrame>> all;
    const LiveClock clock;
    HeadsetDisplay display(study, softwareContext(), clock, [] {});
    const Study here = display.studyHere(study);
    GazeFeed feed(display.gaze(here, here.screenInForce()), clock);
    LiveRenderer renderer(
        here, feed, clock, "foci live", 1, [] {}, {}, {},
        [&](const Study& now, double) { return display.headNext(&now); });
    std::future<std::string> begun;
    if (!record.empty()) begun = renderer.startRecord(record);
    display.start(renderer);
    const double end_s = clock.now_s() + 60.0;
    while (all.size() < count && clock.now_s() < end_s && display.ended().empty()) {
      for (auto& frame : display.takeShown()) {
        if (const auto file = frame->record_file.lock()) file->add(frame);
        all.push_back(std::move(frame));
        if (all.size() == count / 2) midway(renderer);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    display.stop();
    if (begun.valid()) {
      EXPECT_EQ(begun.get(), "");
    }
    return all;
  }

  TemporaryFolder scratch;
  Study study;
};

/// Where an eye's display has a direction of the head's frame, in shares of its width and height.
glm::dvec2 shareOfDisplay(std::size_t side, const glm::dvec3& p_head_m) {
  const auto& eye = fake_openxr::kEyes.at(side);
  const auto& deg = fake_openxr::kFields_deg[side];
  const glm::dvec3 p = glm::inverse(eye.rotation) * (p_head_m - eye.position_m);
  const auto tangent = [&](int i) { return std::tan(glm::radians(deg[i])); };
  return {(tangent(0) + p.x / -p.z) / (tangent(0) + tangent(1)),
          (tangent(2) - p.y / -p.z) / (tangent(2) + tangent(3))};
}

TEST_F(LiveHeadset, TenDegreesAreTenDegreesInEachEyeAndCodesStay) {
  const FakeOpenXr fake("real still eye=256,240");
  const auto head = fake_openxr::headAt(0.0);
  // 10 degrees to the right of the head, 7 above it, 2 m away.
  const glm::dvec3 p_head_m = 2.0 * (fake_openxr::turned(10.0, 7.0) * kAhead);
  const glm::dvec3 eye_m(0.3, 1.5, 0.2);
  scratch.write("scene.ply", squarePly(eye_m + head.rotation * p_head_m, 0.1, 30));
  stand(eye_m, eye_m + kAhead);
  study.render.method = "pinhole";
  const auto frames = run(3);
  ASSERT_GE(frames.size(), 3u) << fake.log();
  const std::string log = fake.log();
  EXPECT_EQ(log.find("VIOLATION"), std::string::npos) << log;
  const std::size_t at = log.find("frame ");
  ASSERT_NE(at, std::string::npos) << log;
  const ShownImage image(fake.read("shown-" + std::to_string(std::atoi(&log[at + 6])) + ".ppm"));
  ASSERT_EQ(image.width, 512);
  for (std::size_t side = 0; side < 2; ++side) {
    glm::dvec2 sum_px(0.0);
    int count = 0, brightest = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < 256; ++x) {
        const int code = image.at(static_cast<int>(side) * 256 + x, y, 1);
        brightest = std::max(brightest, code);
        if (code < 64) continue;
        sum_px += glm::dvec2(x + 0.5, y + 0.5);
        ++count;
      }
    }
    ASSERT_GT(count, 10) << side;
    const glm::dvec2 truth_px = shareOfDisplay(side, p_head_m) * glm::dvec2(256.0, 240.0);
    EXPECT_NEAR(sum_px.x / count, truth_px.x, 0.5) << side;
    EXPECT_NEAR(sum_px.y / count, truth_px.y, 0.5) << side;
    EXPECT_EQ(brightest, 128) << side;
  }
}

TEST_F(LiveHeadset, ARecordReplaysToTheSameFrames) {
  const FakeOpenXr fake("real jumps late=7");
  scratch.write("scene.ply", squarePly({0.0, 0.0, -2.0}, 3.0, 40));
  stand({0.0, 0.0, 0.0}, kAhead);
  study.output.marker = true;
  const fs::path folder = scratch.path() / "record";
  std::string refused;
  const auto frames = run(40, folder, [&](LiveRenderer& renderer) {
    EXPECT_EQ(renderer.change("eye.position_m", "[0.5, 0.0, 0.0]").get(), "");
    refused = renderer.change("output.view", "\"mono\"").get();
  });
  ASSERT_GE(frames.size(), 40u) << fake.log();
  EXPECT_EQ(fake.log().find("VIOLATION"), std::string::npos) << fake.log();
  EXPECT_NE(refused.find("does not change in a headset"), std::string::npos) << refused;
  double last_s = 0.0;
  for (const auto& frame : frames) {
    ASSERT_TRUE(frame->timing.display_s && frame->timing.swap_s);
    EXPECT_GT(*frame->timing.display_s, frame->timing.render_start_s);
    // Each period of the display shows this frame or repeats the last one.
    const double periods = (*frame->timing.display_s - last_s) / fake_openxr::kPeriod_s;
    if (last_s > 0.0) {
      EXPECT_EQ(std::lround(periods), frame->timing.repeats + 1);
    }
    last_s = *frame->timing.display_s;
  }
  // The eyes see the gaze marker, in its own colour. (A period that repeats a frame writes none.)
  const std::string log = fake.log();
  const std::size_t is_new = log.rfind(" new\n");
  ASSERT_NE(is_new, std::string::npos) << log;
  const int last = std::atoi(&log[log.rfind("frame ", is_new) + 6]);
  const ShownImage image(fake.read("shown-" + std::to_string(last) + ".ppm"));
  int ring = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      ring += image.at(x, y, 0) == 255 && std::abs(image.at(x, y, 1) - 214) < 2 &&
              image.at(x, y, 2) == 10;
    }
  }
  EXPECT_GT(ring, 100);
  // The head stays within 0.1 m of its centre.
  EXPECT_NEAR(frames.front()->record.eye_m.x, 0.0, 0.2);
  EXPECT_NEAR(frames.back()->record.eye_m.x, 0.5, 0.2);
  EXPECT_TRUE(frames.back()->record.gaze_px);
  EXPECT_NE(frames.front()->record.eye_m, frames.back()->record.eye_m);

  const fs::path out = scratch.path() / "replay";
  replay(readStudy(folder / "study.toml"), out, "", 1);
  const auto live = nlohmann::json::parse(textOf(folder / "manifest.json"));
  const auto again = nlohmann::json::parse(textOf(out / "manifest.json"));
  EXPECT_EQ(live.at("frames_sha256"), again.at("frames_sha256"));
  std::ifstream a(folder / "frames.tsv"), b(out / "frames.tsv");
  std::string of_live, of_replay;
  while (std::getline(a, of_live) && std::getline(b, of_replay)) {
    EXPECT_EQ(of_live.substr(0, of_live.rfind('\t')), of_replay.substr(0, of_replay.rfind('\t')));
  }
}

TEST_F(LiveHeadset, SaysThatThereIsNoGazeUnlessTheHeadReplacesIt) {
  const FakeOpenXr fake("no_gaze_extension");
  const LiveClock clock;
  HeadsetDisplay display(study, softwareContext(), clock, [] {});
  const Study here = display.studyHere(study);
  try {
    display.gaze(here, here.screenInForce());
    ADD_FAILURE() << "gaze";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("gaze.from_head=true"), std::string::npos);
  }
  Study from_head = here;
  from_head.gaze.columns.space.from_head = true;
  NamedSource source = display.gaze(from_head, here.screenInForce());
  std::vector<GazeSample> samples;
  source.source->poll(1.0, samples);
  ASSERT_EQ(samples.size(), 1u);
  const Screen& screen = source.screen;
  const glm::dvec2 share = *samples[0].point_px / glm::dvec2(screen.size_px);
  EXPECT_NEAR(share.x, 0.5, 0.02);  // its fields are 50 and 51 degrees
}

TEST(Area, AHeadsViewKeepsItsShapeInTheMiddleOfAnyWindow) {
  const Area wide = Area::inside({1920, 1080}, {400, 300});
  EXPECT_EQ(wide.size_px, glm::ivec2(1440, 1080));
  EXPECT_EQ(wide.corner_px, glm::ivec2(240, 0));
  const Area high = Area::inside({600, 900}, {400, 300});
  EXPECT_EQ(high.size_px, glm::ivec2(600, 450));
  EXPECT_EQ(high.corner_px, glm::ivec2(0, 225));
}

TEST(HeadInScene, TheCentredHeadStandsAtTheStudysEyeAndFacesWhereItLooks) {
  Study study;
  study.eye.position_m = glm::dvec3(1.0, 2.0, 3.0);
  study.eye.look_at_m = glm::dvec3(5.0, 2.5, 3.0);  // along x, and a little up
  HeadInScene in_scene(study);
  const HeadInWorld head{.position_m = {0.2, 0.1, -0.4},
                         .world_from_head = fake_openxr::turned(30.0, 10.0)};
  in_scene.centre(head);
  const HeadInWorld seen = in_scene.inScene(head);
  EXPECT_LT(glm::distance(seen.position_m, *study.eye.position_m), 1e-12);
  const glm::dvec3 sight = seen.world_from_head * kAhead;
  EXPECT_NEAR(sight.x, std::cos(glm::radians(10.0)), 1e-12);
  EXPECT_NEAR(sight.y, std::sin(glm::radians(10.0)), 1e-12);
  EXPECT_NEAR(sight.z, 0.0, 1e-12);
  // A step to the observer's left is one towards -z in the scene.
  const glm::dvec3 left =
      head.position_m + fake_openxr::turned(30.0, 0.0) * glm::dvec3(-1.0, 0.0, 0.0);
  const HeadInWorld moved =
      in_scene.inScene({.position_m = left, .world_from_head = head.world_from_head});
  EXPECT_LT(glm::distance(moved.position_m, glm::dvec3(1.0, 2.0, 2.0)), 1e-12);
}

}  // namespace FOCI_FILE
}  // namespace foci
