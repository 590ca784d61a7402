// The time of a frame of the gallery, of the statue and of the garden, which is a scene of
// Gaussians, by method, size of the image, focus and pupil. Fixed scenes and steps. The screen is
// the demo's, 0.53 m wide and 0.6 m away.
//     foci_bench --benchmark_filter='Frame'
// prints the time of frames after the first, `BM_GpuFrame` the same on a GPU, and `BM_FirstFrame`
// the time of the first frame of a new method. The counter `cpu_ms` is the median of the time of
// all threads together, which other programs disturb less than `median_ms` and `min_ms`.
#include <benchmark/benchmark.h>

#include <array>
#include <chrono>
#include <ctime>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/quantile.h"
#include "render/methods/method.h"
#include "render/optics/defocus.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

struct BenchScene {
  const char* name;
  Scene (*make)();
  EyePose (*eye)();
};

constexpr BenchScene kGallery{"gallery", [] { return Scene{makeGallery()}; }, galleryEyePose};
constexpr BenchScene kStatue{"statue", [] { return Scene{makeStatue()}; }, statueEyePose};
constexpr BenchScene kGarden{"garden", [] { return Scene{makeGarden()}; }, gardenEyePose};

/// One frame: width of the image, focus and pupil.
struct Case {
  const char* method;
  int width_px;
  float focus_m, pupil_mm;
  const BenchScene& scene = kGallery;
};

constexpr glm::dvec2 kScreen_m(0.5313, 0.2989);
constexpr double kDistance_m = 0.6;

/// Made once.
const Scene& sceneOf(const BenchScene& scene) {
  static std::map<const BenchScene*, Scene> made;
  const auto found = made.find(&scene);
  return found != made.end() ? found->second : made.emplace(&scene, scene.make()).first->second;
}

class FrameOf {
 public:
  explicit FrameOf(const Case& of) : scene_(sceneOf(of.scene)) {
    const EyePose pose = of.scene.eye();
    const glm::ivec2 size_px(of.width_px, of.width_px * 9 / 16);
    view_ = viewThroughScreen(eyeFromWorld(pose.position_m, pose.target_m, pose.up), size_px,
                              kScreen_m, kDistance_m);
    settings_.lighting.background = {0.012f, 0.013f, 0.016f};
    settings_.defocus = {.radius_px_per_D = 0.5e-3f * of.pupil_mm * view_.focal_px,
                         .focus_D = 1.0f / of.focus_m};
    view_.principal_px.x -= 1e-3f;
  }

  std::unique_ptr<Method> method(const char* name, const SharedGpu& gpu = nullptr) const {
    return makeMethod(name, scene_, gpu);
  }

  /// Renders one frame. Each call moves the image by a thousandth of a pixel,
  /// so that no frame can be reused.
  void render(Method& method) {
    view_.principal_px.x += 1e-3f;
    const std::clock_t cpu = std::clock();
    const auto start = std::chrono::steady_clock::now();
    stats_ = method.render(view_, settings_, frame_);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    ms_.push_back(took.count());
    cpu_ms_.push_back(1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
    if (!stats_.gpu) return;
    for (std::size_t stage = 0; stage < kGpuStages.size(); ++stage) {
      stage_ms_.at(stage).push_back(stats_.gpu->stage_ms.at(stage));
    }
  }

  void forgetTimes() {
    ms_.clear();
    cpu_ms_.clear();
    for (auto& stage : stage_ms_) stage.clear();
  }

  void count(benchmark::State& state) {
    const double pixels = static_cast<double>(view_.size_px.x) * view_.size_px.y;
    state.counters["splats_per_px"] = static_cast<double>(stats_.splats) / pixels;
    state.counters["fragments_per_px"] = static_cast<double>(stats_.fragments) / pixels;
    state.counters["cpu_ms"] = quantile(cpu_ms_, 0.5);
    state.counters["median_ms"] = quantile(ms_, 0.5);
    state.counters["min_ms"] = quantile(ms_, 0.0);
    for (std::size_t stage = 0; stage < kGpuStages.size() && stats_.gpu; ++stage) {
      state.counters[std::string(kGpuStages.at(stage)) + "_ms"] =
          quantile(stage_ms_.at(stage), 0.5);
    }
  }

 private:
  const Scene& scene_;
  View view_;
  RenderSettings settings_;
  Frame frame_;
  RenderStats stats_;
  std::vector<double> ms_, cpu_ms_;
  std::array<std::vector<double>, kGpuStages.size()> stage_ms_;
};

/// Frames after the first.
void BM_Frame(benchmark::State& state, const Case& of) {
  FrameOf frame(of);
  const auto method = frame.method(of.method);
  frame.render(*method);
  frame.render(*method);
  frame.forgetTimes();
  for (auto _ : state) frame.render(*method);
  frame.count(state);
}

/// The same on the GPU, with the median of each stage's time on the device.
void BM_GpuFrame(benchmark::State& state, const Case& of) {
  SharedGpu gpu;
  try {
    gpu = GpuDevice::open(GpuDevice::Kind::hardware);
  } catch (const GpuError& error) {
    state.SkipWithError(error.what());
    return;
  }
  FrameOf frame(of);
  const auto method = frame.method(of.method, gpu);
  frame.render(*method);
  frame.render(*method);
  frame.forgetTimes();
  for (auto _ : state) frame.render(*method);
  frame.count(state);
}

/// First frames, each of a new method on a scene that is loaded.
void BM_FirstFrame(benchmark::State& state, const Case& of) {
  FrameOf frame(of);
  const auto loaded = frame.method(of.method);
  for (auto _ : state) frame.render(*loaded->cloneSharingScene());
  frame.count(state);
}

const std::vector<Case> kCases{{"pinhole", 256, 0.5f, 4.0f},
                               {"pinhole", 1280, 0.5f, 4.0f},
                               {"auto", 1280, 0.5f, 4.0f},
                               {"auto", 1280, 0.5f, 8.0f},
                               {"auto", 1280, 0.25f, 8.0f},
                               {"sweep-lod", 1280, 0.5f, 4.0f},
                               {"sweep-lod", 1920, 0.5f, 4.0f},
                               {"pinhole", 1280, 0.25f, 8.0f},
                               {"sweep-lod", 1280, 0.25f, 8.0f},
                               {"pinhole", 1280, 0.5f, 8.0f, kStatue},
                               {"sweep-lod", 1280, 0.5f, 8.0f, kStatue},
                               {"pinhole", 1280, 0.95f, 4.0f, kGarden},
                               {"sweep-lod", 1280, 0.95f, 4.0f, kGarden},
                               {"auto", 1280, 0.95f, 4.0f, kGarden},
                               {"auto", 1280, 0.95f, 8.0f, kGarden}};

void add(const char* name, void (*run)(benchmark::State&, const Case&), const Case& of) {
  benchmark::RegisterBenchmark(
      (std::string(name) + '/' + of.scene.name + '/' + of.method + '/' +
       std::to_string(of.width_px) + "px/" + std::to_string(static_cast<int>(100 * of.focus_m)) +
       "cm/" + std::to_string(static_cast<int>(of.pupil_mm)) + "mm")
          .c_str(),
      [run, of](benchmark::State& state) { run(state, of); })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime()
      ->Iterations(12);
}

[[maybe_unused]] const bool kRegistered = [] {
  for (const Case& of : kCases) add("BM_Frame", BM_Frame, of);
  for (const Case& of : kCases) add("BM_GpuFrame", BM_GpuFrame, of);
  for (const Case& of : kCases) {
    if (std::string(of.method) == "auto") add("BM_FirstFrame", BM_FirstFrame, of);
  }
  return true;
}();

}  // namespace
}  // namespace foci
