// The time of a gaze sample, labelled offline and online: two minutes of a simulated observer with
// a little noise and a fixed seed. Argument: samples a second. And the time of a webcam frame of
// 640x480 on one core: a rendered face that is tracked, and one that is searched for.
#include <benchmark/benchmark.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "gaze/events/event_labels.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/online_events.h"
#include "gaze/live/simulator.h"
#include "gaze/webcam/webcam_source.h"
#include "tests/faces/observer.h"

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
  for (auto _ : state) benchmark::DoNotOptimize(labelEvents(trace, kScreen).states);
  countSamples(state, trace);
}
BENCHMARK(BM_LabelOffline)->Arg(60)->Arg(500)->Arg(2000)->Unit(benchmark::kMillisecond);

void BM_LabelOnline(benchmark::State& state) {
  const GazeTrace trace = walk(static_cast<double>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(labelEvents(trace, kScreen, {}, true).states);
  countSamples(state, trace);
}
BENCHMARK(BM_LabelOnline)->Arg(60)->Arg(500)->Arg(2000)->Unit(benchmark::kMillisecond);

/// Frames that can be played forwards and backwards without a jump.
std::vector<cv::Mat> film() {
  const faces::Face face(faces::somebody(0));
  const faces::Observer observer({}, {{0.0, 0.2, {0.1, 0.0}}, {0.2, 1.0, {-0.1, 0.05}}});
  std::vector<cv::Mat> frames(12);
  faces::Photography how;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    how.seed = static_cast<std::uint32_t>(i);
    cv::cvtColor(face.photograph(observer.at(static_cast<double>(i) / 15.0), how), frames[i],
                 cv::COLOR_BGR2GRAY);
  }
  for (std::size_t i = frames.size(); i-- > 0;) frames.push_back(frames[i]);
  return frames;
}

void BM_WebcamFrame(benchmark::State& state) {
  cv::setNumThreads(1);
  const std::vector<cv::Mat> frames = film();
  WebcamTracker tracker;
  for (const cv::Mat& frame : frames) tracker.push(frame);
  std::size_t next = 0;
  for (auto _ : state) benchmark::DoNotOptimize(tracker.push(frames[next++ % frames.size()]));
  cv::setNumThreads(-1);
}
BENCHMARK(BM_WebcamFrame)->Unit(benchmark::kMillisecond);

void BM_FindFace(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat frame = film().front();
  FaceFinder finder;
  for (auto _ : state) benchmark::DoNotOptimize(finder.find(frame));
  cv::setNumThreads(-1);
}
BENCHMARK(BM_FindFace)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace foci
