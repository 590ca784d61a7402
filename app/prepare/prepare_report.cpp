#include "app/prepare/prepare_report.h"

#include <algorithm>
#include <cstdio>

#include "app/graphics/html.h"
#include "app/prepare/fidelity_section.h"

namespace foci {
namespace {

constexpr const char* kReportStyle = R"(
:root { --bar: #3d7ea6; --rest: #c3d3de; }
@media (prefers-color-scheme: dark) { :root { --bar: #6db3dc; --rest: #37505f; } }
main { max-width: 860px; }
table { margin-top: .75rem; width: auto; font-size: .92rem; font-variant-numeric: tabular-nums; }
td, th { border-top: 1px solid var(--line); padding: .3rem 1.5rem .3rem 0; text-align: left; font-weight: normal; }
svg text { fill: var(--quiet); font: 12px system-ui, sans-serif; }
)";

constexpr double kChartWidth = 800.0, kChartHeight = 140.0, kAxisHeight = 22.0;

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), pattern, values...);
  return text;
}

/// Histogram of the whole surface, and in front of it the histogram of the smooth parts.
std::string histogramSvg(const Normalisation& n) {
  const double highest = static_cast<double>(
      std::max<std::size_t>(*std::max_element(n.histogram.begin(), n.histogram.end()), 1));
  const double step = kChartWidth / static_cast<double>(n.histogram.size());
  std::string svg =
      format("<svg viewBox=\"0 0 %g %g\" role=\"img\" aria-label=\"Histogram of the kernel sums\">",
             kChartWidth, kChartHeight + kAxisHeight);
  svg += "<title>Histogram of the kernel sums</title>\n<desc>" +
         format(
             "Whole surface: mean %.4f, %.1f %% within 0.05 of one. Smooth parts: mean %.4f, "
             "%.1f %% within 0.05 of one.",
             n.mean, 100.0 * n.within_5, n.smooth_mean, 100.0 * n.smooth_within_5) +
         "</desc>\n";
  const auto bars = [&](const std::vector<std::size_t>& bins, const char* color) {
    for (std::size_t i = 0; i < bins.size(); ++i) {
      if (bins[i] == 0) continue;
      const double height = kChartHeight * static_cast<double>(bins[i]) / highest;
      svg +=
          format("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>",
                 static_cast<double>(i) * step, kChartHeight - height, 0.85 * step, height, color);
    }
  };
  bars(n.histogram, "var(--rest)");
  bars(n.smooth_histogram, "var(--bar)");
  for (int tick = 0; tick <= 10; ++tick) {
    const char* anchor = tick == 0 ? "start" : tick == 10 ? "end" : "middle";
    svg += format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%.1f</text>",
                  0.1 * tick * kChartWidth, kChartHeight + 16.0, anchor, 0.5 + 0.1 * tick);
  }
  return svg + "</svg>\n";
}

constexpr const char* kTableHead =
    "<table><tr><th></th><th>mean</th><th>1 &plusmn; 0.02</th><th>1 &plusmn; 0.05</th>"
    "<th>1 &plusmn; 0.1</th></tr>\n";

std::string tableRow(const std::string& what, double mean, double within_2, double within_5,
                     double within_10) {
  return "<tr><td>" + what + "</td>" +
         format("<td>%.4f</td><td>%.1f %%</td><td>%.1f %%</td><td>%.1f %%</td></tr>\n", mean,
                100.0 * within_2, 100.0 * within_5, 100.0 * within_10);
}

std::string tableRows(const std::string& when, const Normalisation& n) {
  std::string rows = tableRow("whole surface" + when, n.mean, n.within_2, n.within_5, n.within_10);
  if (n.smooth_share > 0.0) {
    rows += tableRow("smooth parts" + when + format(" (%.1f %% of it)", 100.0 * n.smooth_share),
                     n.smooth_mean, n.smooth_within_2, n.smooth_within_5, n.smooth_within_10);
  }
  return rows;
}

std::string levelSection(const PrepareSummary& summary, const LevelNormalisation& level) {
  std::string section =
      format("<h2>Level of %zu nodes, %.1f surfels in each</h2>\n", level.nodes,
             static_cast<double>(summary.surfels) / static_cast<double>(level.nodes));
  section += format("<p class=\"quiet\">in focus; a pixel is %.2f of the nodes' spacing wide</p>\n",
                    level.sharp.pixel_spacings);
  section += histogramSvg(level.sharp);
  section +=
      format("<p class=\"quiet\">blurred; the blur radius is %.2f of the nodes' spacing</p>\n",
             level.blurred.blur_spacings);
  section += histogramSvg(level.blurred);
  return section + kTableHead + tableRows(", in focus", level.sharp) +
         tableRows(", blurred", level.blurred) + "</table>\n";
}

std::string gaussianSection(const PrepareSummary& summary) {
  std::string section =
      format("<p>%zu Gaussians, with harmonics of degree %d, and a tree of %zu nodes.</p>\n",
             summary.gaussians, summary.facts.harmonics_degree, summary.nodes);
  return section +
         "<p>Each node merges the Gaussians below it into one, which covers the same area. foci "
         "renders nodes in place of their Gaussians where blur allows.</p>\n";
}

}  // namespace

std::string prepareReport(const PrepareRequest& request, const PrepareSummary& summary) {
  const std::string name = summary.out.filename().string();
  std::string page =
      pageStart(name + " - foci prepare", std::string(kReportStyle) + kFidelityStyle) + "<h1>" +
      escaped(name) + "</h1>\n<p class=\"quiet\">from " + escaped(request.input.string()) +
      "</p>\n" + noticesOf(summary.warnings);
  if (summary.gaussians > 0) return page + gaussianSection(summary) + kPageEnd;
  page += format("<p>%zu surfels on %.4g m<sup>2</sup>, one every %.3g mm. ", summary.surfels,
                 summary.area_m2, 1000.0 * summary.spacing_m);
  page += summary.oriented ? "Their normals tell the outside from the inside.</p>\n"
                           : "Their normals do not tell the outside from the inside.</p>\n";
  page += fidelitySection(summary);
  page +=
      "<h2>Sums of the kernels</h2>\n<p>The kernels of a surface without holes sum to one at every "
      "pixel. The histograms show "
      "the "
      "sums of the kernels as foci renders them, at points spread evenly over this surface. Smooth "
      "parts, in the stronger colour, have agreeing normals, lie in one plane and have no border "
      "within the reach of a kernel.</p>\n";
  for (std::size_t i = 0; i < summary.normalisation.size(); ++i) {
    const Normalisation &before = summary.before[i], &after = summary.normalisation[i];
    page +=
        after.pixel_spacings > 0.0f
            ? format("<h2>A pixel of %g times the surfels' spacing</h2>\n", after.pixel_spacings)
            : "<h2>Magnified: pixels much smaller than the surfels' spacing</h2>\n";
    page += "<p class=\"quiet\">before foci solved weights and sizes</p>\n" + histogramSvg(before) +
            "<p class=\"quiet\">after</p>\n" + histogramSvg(after) + kTableHead +
            tableRows(", before", before) + tableRows(", after", after) + "</table>\n";
  }
  if (!summary.levels.empty()) {
    page +=
        "<h2>Levels of detail</h2>\n<p>foci renders blurred and distant parts from nodes. Each "
        "node "
        "stands for several surfels and has the sum of their areas as its weight. Each level is "
        "shown where foci renders it at its coarsest. On coarser levels fewer places are smooth "
        "within the reach of a node's kernel.</p>\n";
  }
  for (const LevelNormalisation& level : summary.levels) page += levelSection(summary, level);
  return page + kPageEnd;
}

}  // namespace foci
