// The time of a fragment on the paper's plane, 262,144 surfels at 512 x 512. Fixed scenes; run with
// --benchmark_repetitions=N for medians.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <random>

#include "render/methods/method.h"

namespace foci {
namespace {

constexpr int kSide = 512;
constexpr float kDistance_m = 2.0f;

/// One surfel a pixel, facing the camera, with random colours: the time does not depend on them.
SurfelCloud benchPlane() {
  std::mt19937 random(1);
  SurfelCloud cloud;
  const float spacing_m = kDistance_m / kSide;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const glm::vec3 color = glm::vec3(random() & 255, random() & 255, random() & 255) / 255.0f;
      appendSurfel(cloud,
                   {(static_cast<float>(x) + 0.5f) * spacing_m - 0.5f * kDistance_m,
                    (static_cast<float>(y) + 0.5f) * spacing_m - 0.5f * kDistance_m, -kDistance_m},
                   {0.0f, 0.0f, 1.0f}, kSigmaPerSpacing * spacing_m, spacing_m * spacing_m, color);
    }
  }
  return cloud;
}

/// Arguments: blur radius in tenths of a pixel, threads.
void BM_SweepPlane(benchmark::State& state) {
  static const SurfelCloud cloud = benchPlane();
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(1)));
  View view = viewOfCamera(glm::mat4(1.0f), {kSide, kSide}, 2.0 * std::atan(0.5));
  RenderSettings settings;
  const float blur_px = static_cast<float>(state.range(0)) / 10.0f;
  settings.defocus = {.radius_px_per_D = glm::vec2(blur_px * kDistance_m),
                      .focus_D = 0.0f,
                      .along = DistanceAlong::axis};
  const auto method = makeMethod("sweep", cloud);
  Frame frame;
  RenderStats stats;
  for (auto _ : state) stats = method->render(view, settings, frame);
  state.counters["splats"] = static_cast<double>(stats.splats);
  state.counters["fragments"] = static_cast<double>(stats.fragments);
  state.counters["ns_per_fragment"] = benchmark::Counter(
      static_cast<double>(stats.fragments) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_SweepPlane)
    ->ArgNames({"blur_dpx", "threads"})
    ->ArgsProduct({{0, 28, 114}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MinWarmUpTime(0.2);

}  // namespace
}  // namespace foci

BENCHMARK_MAIN();
