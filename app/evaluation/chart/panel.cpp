#include <algorithm>
#include <map>

#include "app/evaluation/chart/chart.h"
#include "app/evaluation/evaluation_page.h"
#include "app/platform/machine.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr glm::dvec2 kPanel_px{620.0, 400.0};
constexpr double kHead_px = 30.0;

/// A point of a panel: its height, and its worth for the frontier.
struct ShownPoint {
  const ChartPoint* point;
  double height_dB, worth_dB;
};

std::vector<ShownPoint> shownOf(const std::vector<ChartPoint>& points, ChartMeasure measure) {
  std::vector<ShownPoint> shown;
  for (const ChartPoint& point : points) {
    if (measure == ChartMeasure::psnr) {
      shown.push_back({&point, point.psnr_dB, worthOf_dB(point)});
    } else if (const auto& silhouette = point.silhouette_psnr_dB) {
      shown.push_back({&point, *silhouette, *silhouette});
    }
  }
  return shown;
}

std::string pointTitleOf(const ChartPoint& point) {
  return point.method.spec() + ": " + milliseconds(point.ms_median) + " ms, " +
         decibels(point.psnr_dB) +
         (point.silhouette_psnr_dB ? " (at silhouettes " + decibels(*point.silhouette_psnr_dB) + ")"
                                   : "") +
         ", SSIM " + decimal(point.ssim, 4) + ", FLIP " + decimal(point.flip, 3) +
         (point.coverage_error
              ? ", coverage error " + decimal(100.0 * *point.coverage_error, 2) + " %"
              : "") +
         (point.renderer.empty() ? "" : "; " + point.renderer);
}

/// The frontier as a line: from below the fastest method up to it, in steps to the slowest, and on
/// to the right.
PlotSeries staircase(std::vector<glm::dvec2> corners, const Plot& plot) {
  std::ranges::sort(corners, [](const auto& a, const auto& b) { return a.x < b.x; });
  PlotSeries line{.name = "frontier", .color = kInk, .discs = false, .width_px = 1.2};
  double y = plot.y.from;
  for (const glm::dvec2& corner : corners) {
    line.points.push_back({.x = corner.x, .y = y});
    line.points.push_back({.x = corner.x, .y = y = std::max(y, corner.y)});
  }
  line.points.push_back({.x = plot.x.to, .y = y});
  return line;
}

/// The text beside the panels of the overview.
Drawing overviewKey(const ChartPlan& plan, bool imported) {
  const Machine machine = describeMachine();
  const unsigned threads = plan.threads.back();
  Drawing key{.size_px = kPanel_px};
  double y = 60.0;
  const auto entry = [&](const std::string& name, const std::string& color) {
    key.discs.push_back({{70.0, y}, 5.0, color});
    key.texts.push_back({{84.0, y + 4.5}, name, Anchor::start, kInk, 13.0});
    y += 24.0;
  };
  for (const FamilyStyle& family : methodFamilies()) entry(family.name, family.color);
  if (imported) entry(kImportedName, kImportedColor);
  y += 10.0;
  for (const std::string& line :
       {std::string("Up is more accurate, left is faster."),
        std::string("Full points lie on the frontier (black line): no other method"),
        std::string("is both faster and more accurate. Points above the dashed line"),
        std::string("count as equal: the reference itself is no more accurate."),
        "Images " + std::to_string(plan.size_px) +
            " px wide; medians of runs that took turns; linear light.",
        "Measured by foci " FOCI_VERSION " on " + machine.cpu + ",",
        machine.simd + ", " + threadsText(threads) + "."}) {
    key.texts.push_back({{64.0, y}, line, Anchor::start, kQuiet, 13.0});
    y += 22.0;
  }
  return key;
}

}  // namespace

Plot panelOf(const std::vector<ChartPoint>& points, ChartMeasure measure,
             const std::string& title) {
  const std::vector<ShownPoint> shown = shownOf(points, measure);
  std::vector<double> ms, heights_dB, worth_dB;
  for (const ShownPoint& one : shown) {
    ms.push_back(one.point->ms_median);
    heights_dB.push_back(one.height_dB);
    worth_dB.push_back(one.worth_dB);
  }
  Plot plot{.title = title, .size_px = kPanel_px};
  plot.x = timeAxis("time per frame, logarithmic", ms);
  if (measure == ChartMeasure::psnr) {
    const double ceiling_dB = points.front().reference_psnr_dB;
    heights_dB.push_back(ceiling_dB);
    plot.levels.push_back({ceiling_dB, "the reference's own accuracy: " + decibels(ceiling_dB)});
  }
  plot.y = linearAxis(
      measure == ChartMeasure::psnr ? "PSNR against the reference, dB" : "PSNR at silhouettes, dB",
      heights_dB);

  const std::vector<bool> on = paretoFrontier(ms, worth_dB);
  std::vector<glm::dvec2> corners;
  std::map<std::string, int> settings;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (on[i]) corners.emplace_back(ms[i], heights_dB[i]);
    ++settings[shown[i].point->method.name];
  }
  plot.series.push_back(staircase(corners, plot));
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const ChartPoint& point = *shown[i].point;
    const std::string& name = point.method.name;
    if (plot.series.back().name != name) {
      plot.series.push_back(
          {.name = name,
           .color = point.renderer.empty() ? familyOf(name).color : kImportedColor,
           .width_px = 1.0});
    }
    plot.series.back().points.push_back({.x = ms[i],
                                         .y = heights_dB[i],
                                         .label = settings[name] > 1 ? point.method.spec() : name,
                                         .hollow = !on[i],
                                         .title = pointTitleOf(point),
                                         .link = imageFile(point),
                                         .data = referenceFile(point.scene, point.blur_px)});
  }
  return plot;
}

Drawing overviewOf(const ChartPlan& plan, const std::vector<ChartPoint>& points, double blur_px) {
  constexpr int kColumns = 2;
  const auto cells = static_cast<int>(plan.scenes.size()) + 1;
  Drawing all{.size_px = {kColumns * kPanel_px.x,
                          kHead_px + (cells + kColumns - 1) / kColumns * kPanel_px.y}};
  all.texts.push_back(
      {{8.0, 20.0},
       "Time per frame against accuracy; blur radius up to " + decimal(blur_px, 0) + " px",
       Anchor::start,
       kInk,
       16.0,
       true});
  const auto place = [&](int cell) {
    return glm::dvec2(cell % kColumns * kPanel_px.x, kHead_px + cell / kColumns * kPanel_px.y);
  };
  int cell = 0;
  for (const ChartScene& scene : plan.scenes) {
    all.add(layOut(panelOf(pointsOf(points, scene.id, blur_px, plan.threads.back()),
                           ChartMeasure::psnr, scene.title)),
            place(cell++));
  }
  all.add(overviewKey(plan, hasImported(points)), place(cell));
  return all;
}

}  // namespace foci
