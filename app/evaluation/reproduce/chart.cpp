#include "app/evaluation/reproduce/chart.h"

#include <array>
#include <optional>
#include <utility>

#include "app/graphics/plot.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kPlaces = kApertures - 1, kMargin = 0.1;  // the axis of apertures and its margin

/// By aperture; absent if the method was not measured.
using Times = std::array<std::optional<double>, kApertures>;

PlotSeries lineOf(std::string name, std::string color, const Times& ms) {
  PlotSeries line{.name = std::move(name), .color = std::move(color), .width_px = 1.8};
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    if (ms[aperture]) {
      line.points.push_back({.x = static_cast<double>(aperture), .y = *ms[aperture]});
    }
  }
  return line;
}

std::vector<PlotSeries> linesOf(const ReproduceScene& scene, const std::vector<ReproduceRow>& rows,
                                unsigned threads) {
  const std::array<std::pair<const char*, const char*>, 5> methods = {
      {{"paper", "#8a8f98"},
       {"paper-lod", "#d9822b"},
       {"sweep", "#3b82c4"},
       {"sweep-lod", "#3a9d6e"},
       {"accumulate:200", "#8e6bbf"}}};
  std::vector<PlotSeries> lines;
  for (const auto& [method, color] : methods) {
    Times ms;
    for (const ReproduceRow& row : rows) {
      if (row.method == method && row.threads == threads) ms[row.aperture] = row.ms_median;
    }
    lines.push_back(lineOf(method, color, ms));
  }
  for (const bool lod : {false, true}) {
    Times ms;
    for (const PaperRow& row : scene.paper) {
      if (row.lod == lod || row.aperture == 0) ms[row.aperture] = 1000.0 * row.seconds;
    }
    lines.push_back(lineOf(lod ? "2003, with level of detail" : "2003, without",
                           lod ? "#d9822b" : "#8a8f98", ms));
    lines.back().dashed = true;
  }
  std::erase_if(lines, [](const PlotSeries& line) { return line.points.empty(); });
  return lines;
}

}  // namespace

std::string chartOf(const ReproduceScene& scene, const std::vector<ReproduceRow>& rows,
                    unsigned threads) {
  Plot plot{.name = "Time per frame against aperture: " + scene.name,
            .x = {.title = "aperture", .from = -kMargin, .to = kPlaces + kMargin},
            .series = linesOf(scene, rows, threads),
            .end_labels = true,
            .size_px = {960.0, 300.0}};
  std::vector<double> times_ms;
  for (const PlotSeries& line : plot.series) {
    for (const PlotPoint& point : line.points) times_ms.push_back(point.y);
  }
  plot.y = timeAxis("time per frame", times_ms);
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    plot.x.ticks.push_back(
        {static_cast<double>(aperture),
         aperture == 0 ? "no blur" : "aperture " + decimal(scene.apertures_m[aperture], 3) + " m"});
  }
  return svgOf(layOut(plot));
}

}  // namespace foci
