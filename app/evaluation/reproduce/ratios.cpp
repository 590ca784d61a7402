#include <malloc.h>
#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <string_view>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/reproduce/reproduce.h"

namespace foci {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kLargest = kApertures - 1;

/// The row of `method` at `aperture` with the threads of `row`.
const ReproduceRow& beside(const std::vector<ReproduceRow>& rows, const ReproduceRow& row,
                           std::string_view method, std::size_t aperture) {
  const auto found = std::ranges::find_if(rows, [&](const ReproduceRow& one) {
    return one.method == method && one.aperture == aperture && one.threads == row.threads;
  });
  assert(found != rows.end());
  return *found;
}

}  // namespace

std::vector<ReproduceRatio> ratiosOf(const std::vector<ReproduceRow>& rows, bool is_plane) {
  double growth = 0.0, over_paper = kInfinity, over_accumulate = kInfinity, psnr_dB = kInfinity,
         gap_dB = kInfinity;
  for (const ReproduceRow& ours : rows) {
    if (ours.method != kOurs) continue;
    const ReproduceRow& paper = beside(rows, ours, "paper-lod", ours.aperture);
    over_paper = std::min(over_paper, paper.ms_median / ours.ms_median);
    psnr_dB = std::min(psnr_dB, ours.psnr_dB);
    if (ours.psnr_dB < kInfinity) gap_dB = std::min(gap_dB, ours.psnr_dB - paper.psnr_dB);
    if (ours.aperture != kLargest) continue;
    growth = std::max(growth, ours.ms_median / beside(rows, ours, kOurs, 0).ms_median);
    over_accumulate = std::min(
        over_accumulate, beside(rows, ours, "accumulate:200", kLargest).ms_median / ours.ms_median);
  }

  const std::string scene = rows.front().scene;
  return {{"sweep_lod_largest_over_unblurred",
           "time of sweep-lod at the largest aperture over its time without blur", scene,
           is_plane ? "0.99" : "1.30", growth, is_plane ? 0.5 : 0.7, true, 2},
          {"paper_lod_over_sweep_lod",
           "time of paper-lod over time of sweep-lod, same threads, every aperture", scene, "1",
           over_paper, 8.0, false, 1},
          {"accumulate_200_over_sweep_lod",
           "time of accumulate:200 over time of sweep-lod, largest aperture", scene,
           is_plane ? "196" : "148", over_accumulate, 400.0, false, 0},
          {"sweep_lod_psnr_dB", "PSNR of sweep-lod, every aperture, dB", scene,
           is_plane ? "“hardly perceptible”" : "“some artifacts”", psnr_dB, 42.0, false, 1},
          {"sweep_lod_over_paper_lod_dB", "PSNR of sweep-lod above that of paper-lod, dB", scene,
           "", gap_dB, is_plane ? 6.0 : 10.0, false, 1}};
}

std::vector<ReproduceRatio> ratiosOf(const Growth& growth) {
  const std::string scene = std::to_string(growth.after.surfels / 1'000'000) + " million surfels";
  return {
      {"hierarchy_build_s", "time to build the hierarchy of sweep-lod, s", scene, "",
       growth.after.build_s, 10.0, true, 1},
      {"hierarchy_bytes_per_surfel", "memory of the hierarchy, bytes per surfel", scene, "",
       growth.after.bytes_per_surfel, 100.0, true, 0},
      {"frame_time_over_a_tenth_of_the_surfels",
       "frame time of sweep-lod over its frame time with a tenth of the surfels, every aperture",
       scene, "", growth.frameTime(), 1.3, true, 2}};
}

namespace {

std::size_t allocatedBytes() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

Growth::Size measurePlane(std::size_t surfels, const std::function<void()>& on_frame) {
  const ReproduceScene plane = planeScene(static_cast<int>(std::ceil(std::sqrt(surfels))));
  Growth::Size size{.surfels = plane.scene.size()};
  const std::size_t before = allocatedBytes();
  const auto start = std::chrono::steady_clock::now();
  const auto method = makeMethod("sweep-lod", plane.scene);
  size.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  size.bytes_per_surfel =
      static_cast<double>(allocatedBytes() - before) / static_cast<double>(size.surfels);

  Frame frame;
  std::vector<TimedRun> runs;
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    method->render(plane.view, plane.settingsAt(aperture), frame);
    on_frame();
    runs.push_back({.run_ms =
                        [&, aperture] {
                          const double ms =
                              method->render(plane.view, plane.settingsAt(aperture), frame).ms;
                          on_frame();
                          return ms;
                        },
                    .runs = kGrowthRuns});
  }
  runInTurn(runs);
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    size.ms_median[aperture] = median(runs[aperture].ms);
  }
  return size;
}

}  // namespace

double Growth::frameTime() const {
  double max = 0.0;
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    max = std::max(max, after.ms_median[aperture] / before.ms_median[aperture]);
  }
  return max;
}

Growth measureGrowth(std::size_t surfels, const std::function<void()>& on_frame) {
  Growth growth;
  growth.before = measurePlane(surfels / 10, on_frame);
  growth.after = measurePlane(surfels, on_frame);
  return growth;
}

}  // namespace foci
