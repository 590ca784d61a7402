// `foci live` on a GPU: frames stay there until they are shown, records are read back, and the CPU
// goes on where the GPU fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/live/renderer.h"
#include "app/replay/replay.h"
#include "app/study/inputs.h"
#include "base/text.h"
#include "render/splat/sweep.h"
#include "tests/temporary_folder.h"
#include "tests/unit/app/live/wall.h"
#include "tests/unit/render/gl/lost_context.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

/// Looks to the left for half a second, then to the right, in turn, at 100 Hz.
class Alternating final : public LiveSource {
 public:
  explicit Alternating(const Screen& screen) : screen_(screen) {}
  void poll(double now_s, std::vector<GazeSample>& samples) override {
    for (; next_s_ <= now_s; next_s_ += 0.01) {
      const double x = std::fmod(next_s_, 1.0) > 0.5 ? 0.7 : 0.3;
      samples.push_back(
          {.time_s = next_s_, .point_px = glm::dvec2(screen_.size_px) * glm::dvec2(x, 0.45)});
    }
  }
  double rate_Hz() const override { return 100.0; }
  std::string status() const override { return "alternating"; }

 private:
  Screen screen_;
  double next_s_ = 0.0;
};

class LiveGpu : public testing::Test {
 protected:
  void SetUp() override {
    if (!device.gpu) GTEST_SKIP() << "no OpenGL 4.5 on this machine";
    study.file = scratch.write("live.toml", "");
    study.scene.file = scratch.write("scene.ply", wallPly());
    study.eye.position_m = glm::dvec3(0.0);
    study.eye.look_at_m = glm::dvec3(0.0, 0.0, -1.0);
    study.output.size_px = glm::ivec2(64, 36);
    study.output.marker = true;
    study.render.device = RenderDevice::gpu;
    const Screen screen = study.screenInForce();
    feed.emplace(NamedSource{.source = std::make_unique<Alternating>(screen), .screen = screen},
                 clock);
    std::promise<SharedGpu> gpu;
    gpu.set_value(device.gpu);
    renderer.emplace(
        study, *feed, clock, "foci live", 1, [] {}, std::nullopt, gpu.get_future());
  }

  /// Takes frames as a window would, until there are so many. @return the last one
  std::shared_ptr<LiveFrame> watch(int frames) {
    std::shared_ptr<LiveFrame> last;
    while (frames > 0) {
      if (auto frame = renderer->take(clock.now_s())) {
        frame->timing.swap_s = clock.now_s();
        by_texture += frame->texture != nullptr;
        images += frame->image.valid();
        if (const auto record = frame->record_file.lock()) record->add(frame);
        last = std::move(frame);
        --frames;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return last;
  }

  void expectReplayIsTheSame(const fs::path& record) const {
    const fs::path out = scratch.path() / "replay";
    replay(readStudy(record / "study.toml"), out, "", 2);
    const auto live = nlohmann::json::parse(textOf(record / "manifest.json"));
    const auto again = nlohmann::json::parse(textOf(out / "manifest.json"));
    EXPECT_GE(live["summary"]["frames"], 15);
    EXPECT_EQ(live["summary"]["frames"], again["summary"]["frames"]);
    EXPECT_EQ(live["frames_sha256"], again["frames_sha256"]);
    EXPECT_EQ(live["device"], device.gpu->text());
    EXPECT_EQ(again["device"], device.gpu->text());
    EXPECT_EQ(readStudy(record / "study.toml").record.device, device.gpu->text());
  }

  TemporaryFolder scratch;
  Study study;
  LosableDevice device = losableDevice();
  LiveClock clock;
  std::optional<GazeFeed> feed;
  std::optional<LiveRenderer> renderer;
  int by_texture = 0, images = 0;
};

TEST_F(LiveGpu, OnlyWhatNeedsPixelsReadsFrames) {
  const auto shown = watch(10);
  EXPECT_EQ(by_texture, 10);
  EXPECT_EQ(images, 0);
  EXPECT_FALSE(shown->markers_px.empty());
  auto asked = renderer->pixelsOf(shown);
  watch(5);  // a screenshot reads the frame, though others came after it
  const auto image = asked.get().get();
  EXPECT_EQ(image->size_px, glm::ivec2(64, 36));
  EXPECT_EQ(image->rgb.size(), 3u * 64u * 36u);
  EXPECT_EQ(images, 0);
}

TEST_F(LiveGpu, ARecordReplaysToTheSameBytes) {
  const fs::path folder = scratch.path() / "record";
  watch(3);
  auto begun = renderer->startRecord(folder);
  watch(8);
  EXPECT_EQ(begun.get(), "");
  renderer->change("observer.pupil_mm", "7");
  watch(4);
  renderer->change("output.view", "\"anaglyph\"");
  watch(6);
  renderer->change("output.split", "true");
  watch(6);
  auto ended = renderer->stopRecord();
  watch(3);
  EXPECT_EQ(ended.get(), "");
  renderer.reset();
  EXPECT_GT(by_texture, 20);  // while it records, too
  expectReplayIsTheSame(folder);
}

TEST_F(LiveGpu, ARecordEndsWithTheRunAndHasTheLastFrame) {
  const fs::path folder = scratch.path() / "record";
  auto begun = renderer->startRecord(folder);
  watch(20);
  EXPECT_EQ(begun.get(), "");
  renderer.reset();
  expectReplayIsTheSame(folder);
}

TEST_F(LiveGpu, ARecordNamesEachDeviceOnce) {
  const auto changeTo = [&](const char* method) {
    auto changed = renderer->change("render.method", method);
    watch(4);
    EXPECT_EQ(changed.get(), "");
  };
  const fs::path first = scratch.path() / "first", second = scratch.path() / "second";
  const auto record = [&](const fs::path& folder, const auto& action) {
    auto begun = renderer->startRecord(folder);
    watch(4);
    EXPECT_EQ(begun.get(), "");
    watch(2);  // with the record, however late it began
    action();
    auto ended = renderer->stopRecord();
    watch(3);
    EXPECT_EQ(ended.get(), "");
  };
  // The method changes with the start of the record, before a frame.
  renderer->change("render.method", "\"potmesil\"");
  record(first, [] {});
  record(second, [&] {
    changeTo("\"sweep\"");
    changeTo("\"potmesil\"");
  });
  renderer.reset();
  const std::string cpu = std::string("the CPU, ") + simdTarget(), gpu = device.gpu->text();
  for (const fs::path& folder : {first, second}) {
    const auto manifest = nlohmann::json::parse(textOf(folder / "manifest.json"));
    const std::string devices = manifest["device"];
    // Under potmesil, frames in saccades are pinhole images, which the GPU renders.
    std::vector<std::string> allowed = {cpu + ", then " + gpu, gpu + ", then " + cpu};
    if (folder == first) allowed.push_back(cpu);
    EXPECT_NE(std::ranges::find(allowed, devices), allowed.end()) << devices;
    const fs::path out = scratch.path() / "replay" / folder.filename();
    replay(readStudy(folder / "study.toml"), out, "", 2);
    const auto again = nlohmann::json::parse(textOf(out / "manifest.json"));
    EXPECT_EQ(again["device"], devices);
    EXPECT_EQ(again["frames_sha256"], manifest["frames_sha256"]);
  }
}

TEST_F(LiveGpu, TheCpuGoesOnWithTheRecord) {
  const fs::path folder = scratch.path() / "record";
  auto begun = renderer->startRecord(folder);
  watch(10);
  EXPECT_EQ(begun.get(), "");
  *device.lost = true;
  renderer->change("observer.pupil_mm", "7");
  watch(3);  // some were rendered before
  by_texture = 0;
  const auto last = watch(10);
  EXPECT_EQ(by_texture, 0);
  EXPECT_FALSE(last->record.stats.gpu);
  const std::string notice = renderer->state().notice;
  EXPECT_NE(notice.find("its OpenGL context is lost"), std::string::npos) << notice;
  EXPECT_NE(notice.find("; the CPU renders"), std::string::npos) << notice;
  const auto record = renderer->state().record;
  renderer.reset();
  EXPECT_FALSE(record->failure()) << *record->failure();
  record->close();
  while (!record->finished()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const auto manifest = nlohmann::json::parse(textOf(folder / "manifest.json"));
  EXPECT_GE(manifest["summary"]["frames"], 20);
  EXPECT_EQ(std::string(manifest["device"]).find(device.gpu->text() + ", then the CPU"), 0u)
      << manifest["device"];
}

}  // namespace FOCI_FILE
}  // namespace foci
