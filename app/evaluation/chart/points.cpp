#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <tuple>

#include "app/evaluation/chart/chart.h"
#include "app/record/tables.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "base/text.h"
#include "render/image/flip.h"
#include "render/image/metrics.h"

namespace foci {
namespace {

std::string panelName(const std::string& scene, double blur_px) {
  return scene + "_" + decimal(blur_px, 0) + "px_";
}

}  // namespace

double worthOf_dB(const ChartPoint& point) {
  return std::min(point.psnr_dB, point.reference_psnr_dB);
}

void markFrontiers(std::vector<ChartPoint>& points) {
  std::map<std::tuple<std::string, double, unsigned>, std::vector<ChartPoint*>> panels;
  for (ChartPoint& one : points) panels[{one.scene, one.blur_px, one.threads}].push_back(&one);
  for (auto& [panel, members] : panels) {
    std::vector<double> ms, dB;
    for (const ChartPoint* one : members) {
      ms.push_back(one->ms_median);
      dB.push_back(worthOf_dB(*one));
    }
    const std::vector<bool> on = paretoFrontier(ms, dB);
    for (std::size_t i = 0; i < members.size(); ++i) members[i]->on_frontier = on[i];
  }
}

bool hasImported(const std::vector<ChartPoint>& points) {
  return std::ranges::any_of(points, [](const ChartPoint& one) { return !one.renderer.empty(); });
}

std::vector<ChartPoint> pointsOf(const std::vector<ChartPoint>& points, const std::string& scene,
                                 double blur_px, unsigned threads) {
  std::vector<ChartPoint> chosen;
  std::ranges::copy_if(points, std::back_inserter(chosen), [&](const ChartPoint& one) {
    return one.scene == scene && one.blur_px == blur_px && one.threads == threads;
  });
  return chosen;
}

std::string csvOf(const std::vector<ChartPoint>& points) {
  std::string csv =
      "scene,blur_px,method,setting,threads,ms_median,ms_min,psnr_dB,ssim,silhouette_psnr_dB,"
      "coverage_error,reference_psnr_dB,on_frontier,visible_error,expected_error,"
      "tolerance_met,quality_level,flip,renderer\n";
  for (const ChartPoint& one : points) {
    const auto& silhouette_dB = one.silhouette_psnr_dB;
    csv +=
        rowOf<','>(csvField(one.scene), decimal(one.blur_px, 0), one.method.name,
                   one.method.setting ? std::to_string(*one.method.setting) : "n/a", one.threads,
                   decimal(one.ms_median, 4), decimal(one.ms_min, 4), decimalOrInf(one.psnr_dB, 3),
                   decimal(one.ssim, 6), silhouette_dB ? decimalOrInf(*silhouette_dB, 3) : "n/a",
                   orAbsent(one.coverage_error, 6), decimalOrInf(one.reference_psnr_dB, 3),
                   one.on_frontier ? "yes" : "no", decimal(one.visible_error, 3),
                   orAbsent(one.expected_error, 3),
                   one.tolerance_met ? *one.tolerance_met ? "yes" : "no" : "n/a",
                   one.quality_level ? textOf(*one.quality_level) : "n/a", decimal(one.flip, 4),
                   one.renderer.empty() ? "n/a" : csvField(one.renderer));
  }
  return csv;
}

std::string imageFile(const std::string& scene, double blur_px, const EvaluatedMethod& method) {
  return "images/" + panelName(scene, blur_px) + method.fileName() + ".png";
}

std::string imageFile(const ChartPoint& point) {
  const EvaluatedMethod by{"by-" + point.method.name, point.method.setting};
  return imageFile(point.scene, point.blur_px, point.renderer.empty() ? point.method : by);
}

std::string referenceFile(const std::string& scene, double blur_px) {
  return "images/" + panelName(scene, blur_px) + "reference.png";
}

std::vector<bool> paretoFrontier(const std::vector<double>& cost,
                                 const std::vector<double>& worth) {
  assert(cost.size() == worth.size());
  std::vector<bool> on(cost.size(), true);
  for (std::size_t i = 0; i < cost.size(); ++i) {
    assert(!std::isnan(cost[i]) && !std::isnan(worth[i]));
    for (std::size_t j = 0; j < cost.size() && on[i]; ++j) {
      const bool no_worse = cost[j] <= cost[i] && worth[j] >= worth[i];
      on[i] = !(no_worse && (cost[j] < cost[i] || worth[j] > worth[i]));
    }
  }
  return on;
}

Compared comparedWith(const Frame& reference, const Frame& pinhole, const Defocus& lens) {
  return {.reference = &reference,
          .lab = labOf(reference, kUsualPx_per_deg),
          .band = silhouetteBand(pinhole, lens)};
}

ChartErrors scoresOf(const Frame& frame, const Compared& with) {
  constexpr double kShareOfPixels = 0.95;  // as `Quality::tolerance` counts errors
  const Frame& reference = *with.reference;
  ChartErrors errors;
  const std::array<std::function<void()>, 4> tasks{
      [&] {
        auto visible = visibleDifference(frame, with.lab, kUsualPx_per_deg);
        errors.visible_error = quantile(visible, kShareOfPixels);
      },
      [&] { errors.ssim = ssim(frame, reference); },
      [&] {
        errors.psnr_dB = psnr_dB(frame, reference);
        errors.silhouette_psnr_dB = silhouettePsnr_dB(frame, reference, with.band);
        errors.coverage_error = coverageError(frame, reference);
      },
      [&] {
        const std::vector<float> flip = flipOf(frame, reference, kUsualPx_per_deg);
        errors.flip =
            std::accumulate(flip.begin(), flip.end(), 0.0) / static_cast<double>(flip.size());
      }};
  parallelFor(tasks.size(), [&](std::size_t i) { tasks.at(i)(); });
  return errors;
}

}  // namespace foci
