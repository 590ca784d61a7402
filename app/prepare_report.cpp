#include "app/prepare_report.h"

#include <algorithm>
#include <cstdio>

#include "app/html.h"

namespace foci {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --ground: #fbfbfa; --ink: #1d2127; --quiet: #626a75; --line: #e3e4e6; --bar: #3d7ea6; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #14161a; --ink: #e4e6ea; --quiet: #9aa2ad; --line: #2d3138; --bar: #6db3dc; } }
body { margin: 0; background: var(--ground); color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
main { max-width: 860px; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.5rem; margin: 0 0 .25rem; } h2 { font-size: 1.1rem; margin: 2.5rem 0 .75rem; }
p { margin: .5rem 0; max-width: 72ch; } .quiet { color: var(--quiet); }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; }
td, th { border-top: 1px solid var(--line); padding: .3rem 1.5rem .3rem 0; text-align: left; font-weight: normal; }
svg { width: 100%; height: auto; } svg text { fill: var(--quiet); font: 12px system-ui, sans-serif; }
)";

constexpr double kChartWidth = 800.0, kChartHeight = 180.0, kAxisHeight = 22.0;

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), pattern, values...);
  return text;
}

std::string histogramSvg(const std::vector<std::size_t>& bins) {
  const double highest =
      static_cast<double>(std::max<std::size_t>(*std::max_element(bins.begin(), bins.end()), 1));
  const double step = kChartWidth / static_cast<double>(bins.size());
  std::string svg =
      format("<svg viewBox=\"0 0 %g %g\" role=\"img\">", kChartWidth, kChartHeight + kAxisHeight);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double height = kChartHeight * static_cast<double>(bins[i]) / highest;
    svg +=
        format("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"var(--bar)\"/>",
               static_cast<double>(i) * step, kChartHeight - height, 0.85 * step, height);
  }
  for (int tick = 0; tick <= 10; ++tick) {
    const char* anchor = tick == 0 ? "start" : tick == 10 ? "end" : "middle";
    svg += format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%.1f</text>",
                  0.1 * tick * kChartWidth, kChartHeight + 16.0, anchor, 0.5 + 0.1 * tick);
  }
  return svg + "</svg>";
}

std::string tableRow(const char* what, double within_2, double within_5, double within_10) {
  return format("<tr><td>%s</td><td>%.1f %%</td><td>%.1f %%</td><td>%.1f %%</td></tr>\n", what,
                100.0 * within_2, 100.0 * within_5, 100.0 * within_10);
}

}  // namespace

std::string prepareReport(const PrepareRequest& request, const PrepareSummary& summary) {
  const std::string name = escaped(summary.out.filename().string());
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>" +
                     name + "</title><style>" + kStyle + "</style></head><body><main>\n<h1>" +
                     name + "</h1>\n<p class=\"quiet\">from " + escaped(request.input.string()) +
                     "</p>\n";
  page += format("<p>%zu surfels on %.4g m<sup>2</sup>, one every %.3g mm. ", summary.surfels,
                 summary.area_m2, 1000.0 * summary.spacing_m);
  page += summary.oriented ? "Their normals tell the outside from the inside.</p>\n"
                           : "Their normals do not tell the outside from the inside.</p>\n";
  if (summary.dropped > 0) {
    page +=
        format("<p>%zu points were left out: their position is not finite.</p>\n", summary.dropped);
  }
  page += format(
      "<p>The kernels of a whole surface sum to one at every pixel. Below, their sums over this "
      "surface, at points spread by area. Smooth parts, %.0f %% of it, have agreeing normals, lie "
      "in one plane and have no border near.</p>\n",
      100.0 * summary.smooth_share);
  for (const Normalisation& n : summary.normalisation) {
    page += format("<h2>A pixel as wide as %g of the spacing (mean %.4f)</h2>\n", n.pixel_spacings,
                   n.mean);
    page += histogramSvg(n.histogram);
    page +=
        "<table><tr><th></th><th>1 &plusmn; 0.02</th><th>1 &plusmn; 0.05</th>"
        "<th>1 &plusmn; 0.1</th></tr>\n";
    page += tableRow("whole surface", n.within_2, n.within_5, n.within_10);
    page += tableRow("smooth parts", n.smooth_within_2, n.smooth_within_5, n.smooth_within_10);
    page += "</table>\n";
  }
  return page + "</main></body></html>\n";
}

}  // namespace foci
