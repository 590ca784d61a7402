#include "app/evaluation/reproduce/growth.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "app/evaluation/timed_runs.h"

namespace foci {
namespace {

std::size_t allocatedBytes() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

Growth::Size measurePlane(std::size_t surfels, const std::function<void()>& on_frame) {
  const ReproduceScene plane = planeScene(static_cast<int>(std::ceil(std::sqrt(surfels))));
  Growth::Size size{.surfels = plane.cloud.size()};
  const std::size_t before = allocatedBytes();
  const auto start = std::chrono::steady_clock::now();
  const auto method = makeMethod("sweep-lod", plane.cloud);
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
