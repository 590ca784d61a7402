#include <algorithm>
#include <sstream>
#include <utility>

#include "app/evaluation/chart/chart.h"
#include "app/evaluation/evaluation_page.h"
#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "app/platform/machine.h"
#include "base/text.h"
#include "render/image/metrics.h"

namespace foci {
namespace {

struct Advice {
  const char* when;
  const char* use;
  const char* why;
};

constexpr Advice kAdvice[] = {
    {"You follow a gaze, or want a good image soon", "auto",
     "the default: picks the cheapest quality level whose predicted error stays below the "
     "tolerance, and states that error"},
    {"Accuracy matters more than time", "sweep-lod",
     "invisible levels of detail, and correct outlines where surfaces overlap"},
    {"The blur is small, or you want one code path without levels of detail", "sweep",
     "the same kernel without a hierarchy; equally accurate where surfaces do not overlap"},
    {"Foliage or hair: things at many depths, seen around and between each other", "sweep-lod:19",
     "more sub-apertures, in proportion more time"},
    {"You need a reference", "accumulate:N",
     "choose N of at least pi C&sup2; for a blur radius of C px; the method states its own "
     "accuracy. <code>raytrace:N</code> checks it independently"},
    {"You have only a finished image with its depth", "matthews",
     "the one post-filter without light leaks; <code>potmesil</code> for small blur"},
    {"You compare with published work", "paper, paper-lod",
     "the method of 2003 as published; <code>inflate</code> is the usual method of today's "
     "Gaussian-splat renderers"},
};

/// Accuracies that the table lists. At 30 dB differences are easy to see, at 40 dB hardly.
constexpr double kGood_dB[] = {30.0, 35.0, 40.0};

/// The fastest point of at least `good_dB`; null if there is none.
const ChartPoint* fastestOf(const std::vector<ChartPoint>& points, double good_dB) {
  const ChartPoint* best = nullptr;
  for (const ChartPoint& one : points) {
    if (one.psnr_dB >= good_dB && (!best || one.ms_median < best->ms_median)) best = &one;
  }
  return best;
}

/// The fastest method that reaches a given accuracy, by scene and blur.
std::string fastestTable(const ChartPlan& plan, const std::vector<ChartPoint>& points) {
  std::string html =
      "<div class=\"scroll\"><table class=\"figures\"><tr><th>scene</th><th>at least</th>";
  for (const double blur_px : plan.blurs_px) {
    html += "<th>blur radius up to " + decimal(blur_px, 0) + " px</th>";
  }
  html += "</tr>\n";
  for (const ChartScene& scene : plan.scenes) {
    for (const double good_dB : kGood_dB) {
      html += "<tr>" + cell(good_dB == kGood_dB[0] ? escaped(scene.id) : "") +
              cell(decimal(good_dB, 0) + " dB");
      for (const double blur_px : plan.blurs_px) {
        const auto members = pointsOf(points, scene.id, blur_px, plan.threads.back());
        const ChartPoint* best = fastestOf(members, good_dB);
        html += cell(best ? escaped(best->method.spec()) + " <span class=\"quiet\">" +
                                milliseconds(best->ms_median) + " ms</span>"
                          : "<span class=\"quiet\">none</span>");
      }
      html += "</tr>\n";
    }
  }
  return html + "</table></div>\n";
}

std::string adviceTable() {
  std::string html = "<table><tr><th>when</th><th>use</th><th>because</th></tr>\n";
  for (const Advice& one : kAdvice) {
    html += "<tr>" + cell(one.when, "wraps") + cell(std::string("<code>") + one.use + "</code>") +
            cell(one.why, "wraps") + "</tr>\n";
  }
  return html + "</table>\n";
}

std::string dials(const ChartPlan& plan, double blur_px) {
  std::vector<std::pair<std::string, std::string>> blurs, threads;
  for (const double one : plan.blurs_px)
    blurs.emplace_back(decimal(one, 0), decimal(one, 0) + " px");
  for (const unsigned one : plan.threads)
    threads.emplace_back(std::to_string(one), threadsText(one));
  return "<div class=\"dials\">" +
         dialHtml("blur", "blur radius up to", blurs, decimal(blur_px, 0)) +
         dialHtml("threads", "with", threads, std::to_string(plan.threads.back())) +
         dialHtml("measure", "accuracy of",
                  {{"psnr", "the whole image"}, {"silhouette", "silhouettes"}}, "psnr") +
         "</div>\n";
}

/// One panel; the page's script shows the panels of the chosen blur, threads and measure.
void writePanel(std::ostream& out, const ChartPlan& plan, const ChartScene& scene,
                const std::vector<ChartPoint>& points, ChartMeasure measure, bool shown) {
  const bool is_psnr = measure == ChartMeasure::psnr;
  out << "<div class=\"panel\" data-blur=\"" << decimal(points.front().blur_px, 0)
      << "\" data-threads=\"" << points.front().threads << "\" data-measure=\""
      << (is_psnr ? "psnr" : "silhouette") << "\"" << (shown ? "" : " hidden") << ">\n";
  const bool has_points = is_psnr || std::ranges::any_of(points, [](const ChartPoint& one) {
                            return one.silhouette_psnr_dB.has_value();
                          });
  if (has_points) {
    out << svgOf(layOut(panelOf(points, measure, scene.title)));
  } else {
    out << "<p>" << escaped(scene.title) << ": no silhouette is in view.</p>\n";
  }
  out << "<p class=\"quiet\">reference: <code>" << plan.reference(scene, points.front().blur_px)
      << "</code>"
      << (scene.truth == ChartTruth::triangles ? ", the mesh's triangles"
                                               : ", views of the same surfels")
      << "</p>\n";
  out << "</div>\n";
}

void writePanels(std::ostream& out, const ChartPlan& plan, const std::vector<ChartPoint>& points,
                 double shown_px) {
  out << "<div class=\"panels\">\n";
  for (const ChartScene& scene : plan.scenes) {
    for (const double blur_px : plan.blurs_px) {
      for (const unsigned threads : plan.threads) {
        const auto members = pointsOf(points, scene.id, blur_px, threads);
        const bool shown = blur_px == shown_px && threads == plan.threads.back();
        writePanel(out, plan, scene, members, ChartMeasure::psnr, shown);
        writePanel(out, plan, scene, members, ChartMeasure::silhouette, false);
      }
    }
  }
  out << "<div class=\"panel\"><p>Up is more accurate, left is faster. Full points lie on the "
         "frontier, the black line: no other method is both faster and more accurate. A line joins "
         "the settings of one method. Points above the dashed line count as equal: the reference "
         "itself is no more accurate.</p><p class=\"legend\">";
  writeFamilies(out, hasImported(points));
  out << "</p><p class=\"quiet\">Click a point for its image, the reference and their "
         "difference times "
      << decimal(kDifferenceGain, 0) << ".</p></div>\n</div>\n";
}

void writeTable(std::ostream& out, const std::vector<ChartPoint>& points) {
  out << "<details><summary>All figures</summary>\n<div class=\"scroll\"><table class=\"figures\">"
         "<tr><th>scene</th><th>blur radius up to, px</th><th>method</th><th>threads</th>"
         "<th>ms, median (min)</th><th>PSNR, dB</th><th>SSIM</th><th>PSNR at silhouettes, dB</th>"
         "<th>coverage error</th><th>visible error, JND</th><th>FLIP</th>"
         "<th>PSNR of the reference, dB</th><th>on the frontier</th></tr>\n";
  for (const ChartPoint& one : points) {
    const std::string image = imageFile(one);
    out << "<tr>" << cell(escaped(one.scene)) << cell(decimal(one.blur_px, 0))
        << cell("<a href=\"" + hrefOf(image) + "\">" + escaped(one.method.spec()) + "</a>" +
                (one.renderer.empty()
                     ? ""
                     : " <span class=\"quiet\">" + escaped(one.renderer) + "</span>"))
        << cell(std::to_string(one.threads))
        << cell(milliseconds(one.ms_median) + " <span class=\"quiet\">(" +
                milliseconds(one.ms_min) + ")</span>")
        << cell(numberHtml(one.psnr_dB, 2)) << cell(decimal(one.ssim, 4))
        << cell(one.silhouette_psnr_dB ? numberHtml(*one.silhouette_psnr_dB, 2) : "n/a")
        << cell(one.coverage_error ? decimal(100.0 * *one.coverage_error, 3) + "&thinsp;%" : "n/a")
        << cell(decimal(one.visible_error, 2) +
                (one.expected_error ? " (predicted " + decimal(*one.expected_error, 2) : "") +
                (one.quality_level ? ", " + textOf(*one.quality_level) : "") +
                (one.tolerance_met == false ? ", beyond the tolerance" : "") +
                (one.expected_error ? ")" : ""))
        << cell(decimal(one.flip, 3)) << cell(numberHtml(one.reference_psnr_dB, 2))
        << cell(one.on_frontier ? "yes" : "", "yes") << "</tr>\n";
  }
  out << "</table></div></details>\n";
}

void writeMethodology(std::ostream& out, const ChartPlan& plan) {
  out << "<h2>How the figures were measured</h2>\n<ul>\n"
         "<li>Blur is the largest blur radius in view, in pixels. Most of an image has less.</li>\n"
         "<li>Time is the time of one frame, with the scene in memory and hierarchies built: the "
         "median of up to "
      << plan.max_runs
      << " runs. The methods took turns, so that other load on the machine slowed all of them "
         "alike. A method slower than "
      << decimal(plan.timing_ms / 1000.0, 2)
      << " s per frame was timed once. Consecutive runs differ in aperture by a thousandth, so "
         "that no method can reuse its previous frame.</li>\n"
         "<li>Accuracy is measured against <code>accumulate:N</code>, the mean of "
      << plan.views(plan.blurs_px.front()) << " to " << plan.views(plan.blurs_px.back())
      << " pinhole views of the same surfels. This shows errors of blur and visibility. Scene "
         "<code>ball</code> is a mesh: its methods are compared with <code>raytrace:N</code>, rays "
         "to the mesh's triangles. This shows errors of the surfels too, which the prediction of "
         "<code>auto</code> does not include. Its background is light, so that leaks in dark parts "
         "show. Figures are in linear light with peak 1: PSNR over the image, PSNR over the pixels "
         "that a step in depth blurs into (silhouettes), SSIM, and the mean difference of "
         "coverage. 95 % of the pixels stay below the visible error, in just-noticeable "
         "differences (JND). FLIP is that of Andersson and others (2020), the mean over the image, "
         "0 to 1. Both hold at "
      << decimal(kUsualPx_per_deg, 0)
      << " pixels per degree. Points of other renderers have the times and machines that their "
         "<code>times.json</code> states. The dashed line compares one half of the reference's "
         "views with the other half.</li>\n"
         "<li><code>chart.csv</code> holds all figures and <code>images/</code> all images. A "
         "later run continues from <code>cells/</code>, which you may remove.</li>\n</ul>\n";
}

}  // namespace

std::string chartPage(const ChartPlan& plan, const Measured<ChartPoint>& measured) {
  const std::vector<ChartPoint>& points = measured.rows;
  const Machine machine = describeMachine();
  const double shown_px = plan.blurs_px[plan.blurs_px.size() / 2];
  std::ostringstream out;
  out << pageStart("foci chart: " + listed(plan.scenes, ", ", &ChartScene::id) +
                       (plan.quick ? " (quick)" : ""),
                   std::string(kEvaluationStyle) + kChartStyle,
                   "<noscript><style>.panel[hidden] { display: block; }</style></noscript>")
      << "<h1>Depth of field: speed against accuracy</h1>\n<p class=\"quiet\">foci " FOCI_VERSION
         " &middot; "
      << escaped(machine.cpu) << ", " << machine.simd << ", " << threadsText(plan.threads.back())
      << " &middot; images " << plan.size_px << " px wide"
      << (plan.quick ? " &middot; a quick look: few runs" : "") << "</p>\n"
      << noticesOf(measured.warnings) << "<h2>Which method to use</h2>\n"
      << adviceTable() << "<h2>The fastest method for an accuracy</h2>\n"
      << "<p>The fastest method whose PSNR against the reference is at least this high, with "
      << threadsText(plan.threads.back())
      << ". At 30 dB differences are easy to see, at 40 dB hardly.</p>\n"
      << fastestTable(plan, points) << "<h2>Time against accuracy</h2>\n"
      << dials(plan, shown_px);
  writePanels(out, plan, points, shown_px);
  writeMethodology(out, plan);
  writeTable(out, points);
  out << "<script>" << kPanelScript << "</script>\n";
  writeImageDialog(out);
  out << kPageEnd;
  return out.str();
}

}  // namespace foci
