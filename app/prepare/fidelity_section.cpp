#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "app/prepare/prepare.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr int kColumns = 8, kGap_px = 2;

constexpr const char* kNoTruth =
    "The input has points only. Nothing tells where the surface between them is, so foci cannot "
    "state how far the surfels are from it.";
constexpr const char* kNoRays =
    "This foci was built without ray tracing (FOCI_RAYTRACE), so the surfels were not held against "
    "the triangles.";

/// The tiles of all views in rows, on black.
Image mapOf(const std::vector<FidelityView>& views) {
  const int tile_px = views.front().tile.size_px.x, step_px = tile_px + kGap_px;
  const int rows = (static_cast<int>(views.size()) + kColumns - 1) / kColumns;
  Image map = filledImage(glm::ivec2(kColumns, rows) * step_px - kGap_px, 0);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::size_t left = i % kColumns * step_px, top = i / kColumns * step_px;
    const Image& tile = views[i].tile;
    for (std::size_t y = 0; y < static_cast<std::size_t>(tile.size_px.y); ++y) {
      const auto* from = tile.rgb.data() + 3 * y * tile_px;
      std::copy(
          from, from + std::ptrdiff_t{3} * tile_px,
          map.rgb.begin() + static_cast<std::ptrdiff_t>(3 * ((top + y) * map.size_px.x + left)));
    }
  }
  return map;
}

std::string figure(const Image& image, const std::string& words, const std::string& caption) {
  return "<figure><img alt=\"" + escaped(words) + "\" src=\"" + imageUri(pngOf(image), "png") +
         "\"><figcaption>" + caption + "</figcaption></figure>\n";
}

std::string legend() {
  std::string stops;
  constexpr int kStops = 8;
  for (int i = 0; i <= kStops; ++i) {
    const auto color = leakColor(kLeak + (kWorstLeak - kLeak) * static_cast<float>(i) /
                                             static_cast<float>(kStops));
    stops += printed("%srgb(%d %d %d)", i == 0 ? "" : ", ", color[0], color[1], color[2]);
  }
  return "<p class=\"leaks\">leak of " + decimal(100.0 * kLeak, 0) +
         " % <span style=\"background: linear-gradient(to right, " + stops + ")\"></span> " +
         decimal(100.0 * kWorstLeak, 0) + " % and more</p>\n";
}

std::string percent(double share, int digits) { return decimal(100.0 * share, digits) + " %"; }

std::string orNone(const std::optional<double>& value, int digits, const char* unit) {
  return value ? decimal(*value, digits) + unit : "none";
}

std::string numbers(const Fidelity& all) {
  return "<div class=\"numbers\">\n" +
         numberCell(all.interior > 0 ? percent(all.leakShare(), 3) : "none",
                    "of the surface leaks") +
         numberCell(all.interior > 0 ? percent(all.largest_leak, 1) : "none", "largest leak") +
         numberCell(orNone(all.color_mean, 2, ""), "mean colour error, of 255") +
         numberCell(orNone(all.color_99, 1, ""), "colour error of 99 % of the pixels") +
         numberCell(orNone(all.outline_px, 2, " px"), "error of the outlines") + "</div>\n";
}

std::string definitions(const FidelityReport& report) {
  const Fidelity& all = report.all;
  std::string html =
      "<p>The input's triangles and the surfels, seen from " + std::to_string(report.views.size()) +
      " directions spread evenly over the sphere. The views are as sharp as a screen of 1080 rows "
      "that the object fills by 80 %: its bounding sphere is " +
      std::to_string(kObject_px) + " px wide. A window of " + std::to_string(kFidelity_px) +
      " px of each view is measured. A pixel is " + decimal(report.pixelSpacings(), 2) +
      " times as wide as the surfels' spacing. Rays through the triangles give the truth, "
      "filtered as the surfels are.</p>\n<ul>\n"
      "<li><b>Leak</b>: the background's share of a pixel, where all rays within 3 px end on "
      "opaque triangles. A pixel leaks if its share is over " +
      decimal(100.0 * kLeak, 0) + " %. The goal: at most " + percent(kMaxLeakShare, 2) +
      " of these pixels leak, and none more than " + decimal(100.0 * kWorstLeak, 0) +
      " %. A hole that shows another part of the object counts as an error of colour.</li>\n"
      "<li><b>Colour error</b>: difference of the same pixels' 8-bit sRGB values, the mean of R, G "
      "and B, before black or white, whichever is worse.</li>\n"
      "<li><b>Error of the outlines</b>: area between the outlines of surfels and triangles, over "
      "the outlines' length.";
  if (all.outline_shift_px) {
    html += " The surfels reach " + decimal(std::abs(*all.outline_shift_px), 2) + " px too far " +
            (*all.outline_shift_px < 0.0 ? "in" : "out") + " on average.";
  }
  html += "</li>\n</ul>\n";
  if (all.interior == 0) {
    html += "<p>No part of the object is opaque and wide enough to have an interior.</p>\n";
  }
  if (report.transparent_share > 0.0005) {
    html += "<p>" + percent(report.transparent_share, 1) +
            " of the pixels inside the outlines are transparent. They are not measured.</p>\n";
  }
  return html;
}

std::string figuresOf(const Fidelity& view) {
  return percent(view.leakShare(), 2) + " leaks, at most " + percent(view.largest_leak, 0) +
         ", colour error " + orNone(view.color_mean, 2, "") + ", outlines " +
         orNone(view.outline_px, 2, " px");
}

std::string pictures(const FidelityReport& report) {
  const FidelityView& worst = report.views[report.worst];
  const std::string which =
      "view " + std::to_string(report.worst + 1) + ": " + figuresOf(worst.figures);
  const auto leaking = std::ranges::count_if(
      report.views, [](const auto& view) { return view.figures.leaking > 0; });
  const std::string map_alt = "Map of " + std::to_string(report.views.size()) + " views in rows; " +
                              std::to_string(leaking) + " of them have leaks.";
  return "<h3>All views</h3>\n" +
         figure(mapOf(report.views), map_alt,
                "From above (first) to below (last); y is up. The triangles in grey, leaks in "
                "colour. " +
                    std::to_string(leaking) + " views have leaks.") +
         legend() + "<h3>The worst view</h3>\n<p class=\"quiet\">" + which +
         "</p>\n<div class=\"worst\">\n" +
         figure(report.triangles, "Triangles of the worst view, before white", "triangles") +
         figure(report.surfels, "Surfels of the worst view, before white", "surfels") +
         figure(report.difference, "Difference of the worst view",
                "difference, " + decimal(kDifferenceGain, 0) + " times, before black or white") +
         "</div>\n";
}

}  // namespace

const char* const kFidelityStyle = R"(
h3 { font-size: 1rem; margin: 1.5rem 0 .5rem; }
.worst { display: grid; grid-template-columns: repeat(auto-fit, minmax(240px, 1fr)); gap: .9rem; }
figure img { border: 1px solid var(--line); }
.leaks { font-size: .85rem; color: var(--quiet); }
.leaks span { display: inline-block; width: 9rem; height: .8em; vertical-align: baseline; }
)";

std::string fidelitySection(const PrepareSummary& summary) {
  std::string html = "<h2>Surfels against triangles</h2>\n";
  if (!summary.fidelity) {
    return html + "<p>" + (summary.of_mesh ? kNoRays : kNoTruth) + "</p>\n";
  }
  html += numbers(summary.fidelity->all);
  return html + definitions(*summary.fidelity) + pictures(*summary.fidelity);
}

std::string fidelityText(const PrepareSummary& summary) {
  if (!summary.fidelity) return summary.of_mesh ? kNoRays : kNoTruth;
  const Fidelity& all = summary.fidelity->all;
  return "against the triangles, from " + std::to_string(summary.fidelity->views.size()) +
         " sides: " +
         (all.interior > 0 ? percent(all.leakShare(), 3) + " of the surface leaks, at most " +
                                 percent(all.largest_leak, 0) + "; colours are off by " +
                                 orNone(all.color_mean, 1, "") + " of 255 (99 % by less than " +
                                 orNone(all.color_99, 0, "") + "); "
                           : std::string("no opaque interior; ")) +
         "outlines are off by " + orNone(all.outline_px, 2, " px") + " of a screen with 1080 rows";
}

}  // namespace foci
