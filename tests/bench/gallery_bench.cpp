// The time of a gaze study with method `auto`: a gaze recording is replayed in the gallery of two
// million surfels. The screen has 1920 x 1080 pixels at 96 dpi and is 0.6 m away; the pupil is 4
// mm.
//     foci_bench --benchmark_filter=GalleryReplay
// prints the times of all frames, and those of the rendered frames. The other frames reuse the
// previous frame and take no time.
#include <benchmark/benchmark.h>

#include <vector>

#include "app/session/session.h"
#include "app/study/inputs.h"
#include "app/study/session_settings_of.h"
#include "app/study/study.h"
#include "base/quantile.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

constexpr double kSeconds = 6.0, kFps = 30.0;

/// Arguments: 1 with foveation, 0 without; frame-time budget in ms, 0 without a budget.
void BM_GalleryReplay(benchmark::State& state) {
  Study study;
  study.seed = 7;
  study.screen.size_px = {1920, 1080};
  study.screen.size_m = glm::dvec2(study.screen.size_px) * 0.0254 / 96.0;
  study.screen.distance_m = 0.6;
  study.output.seconds = {0.0, kSeconds};
  study.quality.foveated = state.range(0) != 0;
  if (state.range(1) != 0) study.quality.frame_ms = static_cast<double>(state.range(1));
  static const Scene scene{makeGallery(0.9f)};
  Warnings warnings;
  const GazeTrace trace = loadGaze(study, warnings);

  std::vector<double> all_ms, rendered_ms, splats, errors;
  for (auto _ : state) {
    const double start_s = trace.samples.front().time_s;
    Session session(sessionSettingsOf(study), scene, *trace.screen, trace.rate_Hz, start_s);
    auto sample = trace.samples.begin();
    for (int i = 0; i < static_cast<int>(kSeconds * kFps); ++i) {
      const double time_s = start_s + i / kFps;
      for (; sample != trace.samples.end() && sample->time_s <= time_s; ++sample) {
        session.push(*sample);
      }
      FrameRecord record = session.look(time_s);
      session.render(study.render.method, record);
      all_ms.push_back(record.stats.ms);
      if (record.rendered) rendered_ms.push_back(record.stats.ms);
      splats.push_back(static_cast<double>(record.stats.splats));
      errors.push_back(record.stats.tolerance_error.value_or(0.0));
    }
  }
  state.counters["surfels"] = static_cast<double>(scene.size());
  state.counters["splats"] = quantile(splats, 0.5);
  state.counters["error"] =
      quantile(errors, 0.5);  // just-noticeable differences, predicted by auto
  state.counters["rendered"] =
      static_cast<double>(rendered_ms.size()) / static_cast<double>(all_ms.size());
  state.counters["median_rendered_ms"] = quantile(rendered_ms, 0.5);
  state.counters["p95_rendered_ms"] = quantile(rendered_ms, 0.95);
  state.counters["median_ms"] = quantile(all_ms, 0.5);
  state.counters["p95_ms"] = quantile(all_ms, 0.95);
  state.counters["max_ms"] = quantile(all_ms, 1.0);
}
BENCHMARK(BM_GalleryReplay)
    ->ArgNames({"foveated", "budget_ms"})
    ->ArgsProduct({{1, 0}, {0, 16}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace foci
