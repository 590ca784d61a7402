#include <algorithm>
#include <cmath>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/evaluation_page.h"
#include "app/evaluation/growth/growth.h"
#include "app/graphics/html.h"
#include "app/graphics/plot.h"
#include "app/platform/machine.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kFps = 30.0;

struct ShownAxis {
  GrowthAxis axis;
  const char* title;
  double unit = 1.0;  // of the axis of the plot
  bool memory = false;
};
constexpr ShownAxis kShownAxes[] = {
    {GrowthAxis::splats, "splats of the scene, million", 1e6},
    {GrowthAxis::splats, "splats of the scene, million", 1e6, true},
    {GrowthAxis::pixels, "pixels, million", 1e6},
    {GrowthAxis::blur, "largest blur radius on the plane, px; 0 at the left end"},
    {GrowthAxis::views, "N: views of accumulate, sub-apertures of sweep-lod"},
    {GrowthAxis::threads, "threads"}};

Plot growthPlot(const ShownAxis& shown, const std::vector<const GrowthCurve*>& curves) {
  const bool wall = shown.axis == GrowthAxis::threads;
  const std::string what = shown.memory ? "memory"
                           : wall       ? "time of a frame"
                                        : "CPU time of a frame";
  Plot plot{.title = (curves[0]->points[0].gaussians ? "Gaussians: " : "Surfels: ") + what,
            .end_labels = true,
            .size_px = {760.0, 300.0}};
  std::vector<double> sizes, costs;
  for (const GrowthCurve* curve : curves) {
    PlotSeries line{.name = curve->method + ": " +
                            growthText(shown.memory ? curve->memory : curve->time, shown.unit),
                    .color = curve->method == kPrepare ? kQuiet : familyOf(curve->method).color,
                    .dashed = curve->method.starts_with("sweep-lod")};
    for (const GrowthPoint& point : curve->points) {
      sizes.push_back(point.size / shown.unit);
      costs.push_back(shown.memory ? point.leastMemory_GB() : point.time_ms());
      const auto& level = point.quality_level;
      line.points.push_back({.x = sizes.back(),
                             .y = costs.back(),
                             .title = (level ? textOf(*level) : point.method) + ": " +
                                      milliseconds(point.cpu_ms) + " ms of CPU time, " +
                                      milliseconds(point.ms) + " ms, " +
                                      decimal(point.memory_GB, 2) + " GB"});
    }
    plot.series.push_back(std::move(line));
  }
  plot.x = logarithmicAxis(shown.title, sizes, shown.axis == GrowthAxis::blur ? 0.1 : 1e-6);
  plot.y = shown.memory ? logarithmicAxis("GB", costs, 1e-3) : timeAxis("", costs);
  return plot;
}

std::vector<Plot> growthPlots(const std::vector<GrowthCurve>& curves) {
  std::vector<Plot> plots;
  for (const ShownAxis& shown : kShownAxes) {
    for (const bool gaussians : {false, true}) {
      std::vector<const GrowthCurve*> some;
      for (const GrowthCurve& one : curves) {
        const GrowthPoint& point = one.points.front();
        if (point.axis == shown.axis && point.gaussians == gaussians) some.push_back(&one);
      }
      if (!some.empty()) plots.push_back(growthPlot(shown, some));
    }
  }
  return plots;
}

std::string needsTable(const std::vector<GrowthCurve>& curves) {
  std::string html =
      "<div class=\"scroll\"><table class=\"figures\"><tr><th>scene</th><th>memory, GB</th>"
      "<th>CPU time of a frame, ms</th><th>cores for 30 frames a second</th><th>batch, core hours"
      "</th><th>batch on 64 cores, hours</th></tr>\n";
  for (const bool gaussians : {false, true}) {
    for (const double splats : {1e6, 1e7, 1e8}) {
      const auto needs = needsOf(splats, gaussians, curves);
      if (!needs) continue;
      html +=
          "<tr>" +
          cell(decimal(splats / 1e6, 0) + (gaussians ? " million Gaussians" : " million surfels")) +
          cell(significant(needs->memory_GB, 2)) + cell(milliseconds(1e3 * needs->frame_cpu_s)) +
          cell(decimal(std::ceil(kFps * needs->frame_cpu_s), 0)) +
          cell(thousands(needs->batch_core_h)) + cell(decimal(needs->batch_core_h / 64.0, 1)) +
          "</tr>\n";
    }
  }
  return html + "</table></div>\n";
}

}  // namespace

std::optional<StudyNeeds> needsOf(double splats, bool gaussians,
                                  const std::vector<GrowthCurve>& curves) {
  constexpr double kPixels = 1280.0 * 720.0, kRecordings = 1000.0, kRecording_s = 600.0;
  constexpr double kWorkflow_s = 3.7;  // of a core for each recording (docs/batch.md)
  std::optional<StudyNeeds> needs;
  for (const GrowthCurve& curve : curves) {
    const GrowthPoint& first = curve.points.front();
    if (first.axis != GrowthAxis::splats || first.gaussians != gaussians) continue;
    if (curve.method != kAutoMethod && curve.method != kPrepare) continue;
    std::vector<glm::dvec2> time;
    for (const GrowthPoint& point : curve.points) {
      time.emplace_back(point.size, 1e-3 * point.time_ms());
    }
    if (!needs) needs.emplace();
    const GrowthPoint& last = curve.points.back();
    const double share = (splats - first.size) / (last.size - first.size);  // memory is a line
    needs->memory_GB =
        std::max(needs->memory_GB, std::lerp(first.memory_GB, last.memory_GB, share));
    if (curve.method == kPrepare) continue;
    const double images = kPixels / first.pixels;
    needs->frame_cpu_s = images * costAt(time, splats / images);
    needs->batch_core_h =
        kRecordings * (kRecording_s * kFps * needs->frame_cpu_s + kWorkflow_s) / 3600.0;
  }
  return needs;
}

std::string growthPage(bool quick, const std::vector<GrowthCurve>& curves,
                       const std::string& notice) {
  const Machine machine = describeMachine();
  const GrowthPoint& first = curves.front().points.front();
  std::string html =
      pageStart(std::string("foci chart --growth") + (quick ? " (quick)" : ""),
                std::string(kEvaluationStyle) + kChartStyle) +
      "<h1>Depth of field: how cost grows</h1>\n<p class=\"quiet\">foci " FOCI_VERSION
      " &middot; " +
      escaped(machine.cpu) + ", " + machine.simd + ", " + threadsText(first.threads) + "</p>\n";
  if (!notice.empty()) html += noticesOf({notice});
  html +=
      "<h2>Which machine a study needs</h2>\n<p>With <code>auto</code>, frames of 1280 x 720 px "
      "and a blur of at most 16 px. A batch is a thousand recordings of ten minutes, 30 frames a "
      "second, in the workflow for clusters. Every frame is rendered; frames that foci reuses "
      "while the eye rests take no time. Beyond the largest scene measured, figures are "
      "extrapolated.</p>\n" +
      needsTable(curves) +
      "<h2>Time and memory</h2>\n<p>A cost grows with the size to the power of the exponent, which "
      "follows the method's name: 0 is constant, 1 linear. Where a curve bends, its exponents "
      "before and after the bend follow.</p>\n<div class=\"panels\">\n";
  for (const Plot& plot : growthPlots(curves)) {
    html += "<div class=\"panel\">" + svgOf(layOut(plot)) + "</div>\n";
  }
  return html +
         "</div>\n<p>The scene is the built-in gallery, sampled more and more densely, and for "
         "blur the paper's plane. Gaussians lie on the same surfels. Unless they grow, there are " +
         thousands(first.pixels) +
         " pixels, and blur is at most 16 px. <code>prepare</code> makes the level of detail. CPU "
         "time is that of all threads together: other programs disturb it least. Times are medians "
         "of frames after the first; a slow frame is timed once. Memory is the peak of the "
         "process. <code>growth.csv</code> holds all figures.</p>\n" +
         kPageEnd;
}

Drawing growthOverview(const std::vector<GrowthCurve>& curves) {
  return layOut(growthPlots(curves), 2);
}

}  // namespace foci
