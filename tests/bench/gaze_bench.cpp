// What a sample costs: labels offline and online. Fixed seed; the walk of an observer with a little
// noise, two minutes long. Argument: samples a second.
#include <benchmark/benchmark.h>

#include <cmath>

#include "gaze/events/gaze_events.h"
#include "gaze/events/online_events.h"
#include "gaze/sources/simulator.h"

namespace foci {
namespace {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};

GazeTrace walk(double rate_Hz) {
  std::vector<GazeTarget> targets;
  for (int i = 0; i < 170; ++i) {
    targets.push_back({{960 + 700 * std::sin(2.4 * i), 540 + 400 * std::cos(3.1 * i)}, 0.7});
  }
  return simulateGaze(targets, kScreen, rate_Hz, 1).trace;
}

void countSamples(benchmark::State& state, const GazeTrace& trace) {
  state.counters["us_per_sample"] = benchmark::Counter(
      static_cast<double>(trace.samples.size()) * 1e-6,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void BM_LabelOffline(benchmark::State& state) {
  const GazeTrace trace = walk(static_cast<double>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(labelSamples(trace, kScreen));
  countSamples(state, trace);
}
BENCHMARK(BM_LabelOffline)->Arg(60)->Arg(500)->Arg(2000)->Unit(benchmark::kMillisecond);

void BM_LabelOnline(benchmark::State& state) {
  const GazeTrace trace = walk(static_cast<double>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(labelSamplesOnline(trace, kScreen));
  countSamples(state, trace);
}
BENCHMARK(BM_LabelOnline)->Arg(60)->Arg(500)->Arg(2000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace foci
