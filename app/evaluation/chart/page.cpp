#include "app/evaluation/chart/page.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "app/evaluation/chart/panel.h"
#include "app/evaluation/chart_html.h"
#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "app/platform/machine.h"
#include "app/record/tables.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr const char* kPageScript = R"(
const dials = document.querySelectorAll('.dials input');
function show() {
  const at = {};
  for (const dial of dials) if (dial.checked) at[dial.name] = dial.value;
  for (const panel of document.querySelectorAll('.panel[data-blur]'))
    panel.hidden = panel.dataset.blur !== at.blur || panel.dataset.threads !== at.threads ||
      panel.dataset.measure !== at.measure;
}
for (const dial of dials) dial.addEventListener('change', show);
show();
)";

struct Advice {
  const char* when;
  const char* use;
  const char* why;
};

constexpr Advice kAdvice[] = {
    {"You follow a gaze, or want a good image soon", "auto",
     "the default: as coarse, and so as fast, as the tolerance allows, and it says what it errs "
     "by"},
    {"The image matters more than its time", "sweep-lod",
     "levels of detail that show nowhere, and outlines that are right where surfaces overlap"},
    {"The blur is small, or one code path without levels of detail is wanted", "sweep",
     "the same kernel without a hierarchy; as close wherever surfaces do not overlap"},
    {"Foliage, hair: things at many depths, seen around and between", "sweep-lod:19",
     "more parts of the lens, in proportion more time"},
    {"A reference to measure against", "accumulate:N",
     "N of at least pi C&sup2; for a blur of C px; it says how far to trust it. "
     "<code>raytrace:N</code> checks it by other means"},
    {"There is only a finished image with its depth", "matthews",
     "the one post-filter whose light does not leak; <code>potmesil</code> where the blur is "
     "small"},
    {"You compare with what was published", "paper, paper-lod",
     "the method of 2003 as it is described; <code>inflate</code> is what Gaussian-splat "
     "renderers do today"},
};

constexpr double kGood_dB[] = {30.0, 35.0, 40.0};

std::string threadsText(unsigned threads) {
  return std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

std::string orInfinite(double value, int digits) {
  return std::isfinite(value) ? decimal(value, digits) : "&infin;";
}

/// What reaches a given accuracy first, by scene and blur.
std::string fastestTable(const ChartPlan& plan, const std::vector<ChartPoint>& points) {
  std::string html =
      "<div class=\"scroll\"><table class=\"figures\"><tr><th>scene</th><th>at least</th>";
  for (const double blur_px : plan.blurs_px) {
    html += "<th>blur up to " + decimal(blur_px, 0) + " px</th>";
  }
  html += "</tr>\n";
  for (const ChartScene& scene : plan.scenes) {
    for (const double good_dB : kGood_dB) {
      html += "<tr>" + cell(good_dB == kGood_dB[0] ? escaped(scene.id) : "") +
              cell(decimal(good_dB, 0) + " dB");
      for (const double blur_px : plan.blurs_px) {
        const ChartPoint* best = nullptr;
        const auto members = pointsOf(points, scene.id, blur_px, plan.threads.back());
        for (const ChartPoint& one : members) {
          if (one.psnr_dB >= good_dB && (!best || one.ms_median < best->ms_median)) best = &one;
        }
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

std::string dial(const char* name, const char* title,
                 const std::vector<std::pair<std::string, std::string>>& choices,
                 const std::string& chosen) {
  std::string html = std::string("<fieldset><legend>") + title + "</legend>";
  for (const auto& [value, text] : choices) {
    html.append("<label><input type=\"radio\" name=\"").append(name);
    html.append("\" value=\"").append(value).append(value == chosen ? "\" checked> " : "\"> ");
    html.append(text).append("</label>");
  }
  return html + "</fieldset>\n";
}

std::string dials(const ChartPlan& plan, double blur_px) {
  std::vector<std::pair<std::string, std::string>> blurs, threads;
  for (const double one : plan.blurs_px)
    blurs.emplace_back(decimal(one, 0), decimal(one, 0) + " px");
  for (const unsigned one : plan.threads)
    threads.emplace_back(std::to_string(one), threadsText(one));
  return "<div class=\"dials\">" + dial("blur", "blur up to", blurs, decimal(blur_px, 0)) +
         dial("threads", "on", threads, std::to_string(plan.threads.back())) +
         dial("measure", "accuracy of",
              {{"psnr", "the whole image"}, {"silhouette", "silhouettes"}}, "psnr") +
         "</div>\n";
}

void writePanels(std::ostream& out, const ChartPlan& plan, const std::vector<ChartPoint>& points,
                 double shown_px) {
  out << "<div class=\"panels\">\n";
  for (const ChartScene& scene : plan.scenes) {
    for (const double blur_px : plan.blurs_px) {
      for (const unsigned threads : plan.threads) {
        const auto members = pointsOf(points, scene.id, blur_px, threads);
        for (const ChartMeasure measure : {ChartMeasure::psnr, ChartMeasure::silhouette}) {
          const bool is_psnr = measure == ChartMeasure::psnr;
          const bool shown = blur_px == shown_px && threads == plan.threads.back() && is_psnr;
          out << "<div class=\"panel\" data-blur=\"" << decimal(blur_px, 0) << "\" data-threads=\""
              << threads << "\" data-measure=\"" << (is_psnr ? "psnr" : "silhouette") << "\""
              << (shown ? "" : " hidden") << ">\n";
          const bool has =
              is_psnr || std::any_of(members.begin(), members.end(), [](const auto& m) {
                return m.silhouette_psnr_dB.has_value();
              });
          if (has) {
            out << svgOf(layOut(panelOf(members, measure, scene.title)));
          } else {
            out << "<p>" << escaped(scene.title) << ": no silhouette is in view.</p>\n";
          }
          out << "</div>\n";
        }
      }
    }
  }
  out << "<div class=\"panel\"><p>Up is closer to the reference, left is faster. Full points are "
         "on the frontier, the black line: nothing is both faster and closer. A line joins the "
         "settings of one method. Above the dashed line points count as equally close: the "
         "reference itself is not known any better.</p><p class=\"legend\">";
  writeFamilies(out);
  out << "</p><p class=\"quiet\">Click a point for its image, the reference and their "
         "difference, "
      << decimal(kDifferenceGain, 0) << " times.</p></div>\n</div>\n";
}

void writeTable(std::ostream& out, const std::vector<ChartPoint>& points) {
  out << "<details><summary>Every figure</summary>\n<div class=\"scroll\"><table class=\"figures\">"
         "<tr><th>scene</th><th>blur up to, px</th><th>method</th><th>threads</th>"
         "<th>ms, median (least)</th><th>PSNR, dB</th><th>SSIM</th><th>at silhouettes, dB</th>"
         "<th>coverage off by</th><th>95 % of the pixels within, just noticeable</th><th>the "
         "reference's own, dB</th><th>on the frontier</th></tr>\n";
  for (const ChartPoint& one : points) {
    const std::string image = imageFile(one.scene, one.blur_px, one.method);
    out << "<tr>" << cell(escaped(one.scene)) << cell(decimal(one.blur_px, 0))
        << cell("<a href=\"" + escaped(image) + "\">" + escaped(one.method.spec()) + "</a>")
        << cell(std::to_string(one.threads))
        << cell(milliseconds(one.ms_median) + " <span class=\"quiet\">(" +
                milliseconds(one.ms_min) + ")</span>")
        << cell(orInfinite(one.psnr_dB, 2)) << cell(decimal(one.ssim, 4))
        << cell(one.silhouette_psnr_dB ? orInfinite(*one.silhouette_psnr_dB, 2) : "n/a")
        << cell(decimal(100.0 * one.coverage_error, 3) + "&thinsp;%")
        << cell(decimal(one.visible_error, 2) +
                (one.expected_error ? " (expected " + decimal(*one.expected_error, 2) + ")" : ""))
        << cell(orInfinite(one.reference_psnr_dB, 2)) << cell(one.on_frontier ? "yes" : "", "yes")
        << "</tr>\n";
  }
  out << "</table></div></details>\n";
}

}  // namespace

void writeChartPage(const std::filesystem::path& file, const ChartPlan& plan,
                    const std::vector<ChartPoint>& points) {
  const Machine machine = describeMachine();
  const double shown_px = plan.blurs_px[plan.blurs_px.size() / 2];
  std::ofstream out(file, std::ios::binary);
  out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width\">\n<title>foci chart</title>\n"
         "<style>"
      << kPageStyle << kChartStyle
      << "</style><noscript><style>.panel[hidden] { display: block; }</style></noscript></head>"
         "<body><main>\n<h1>Depth of field: speed against accuracy</h1>\n<p "
         "class=\"quiet\">foci " FOCI_VERSION " &middot; "
      << escaped(machine.cpu) << ", " << machine.simd << ", " << threadsText(plan.threads.back())
      << " &middot; images " << plan.size_px << " px wide"
      << (plan.quick ? " &middot; a quick look: few runs" : "") << "</p>\n<h2>Use this when</h2>\n"
      << adviceTable() << "<h2>What gets there first</h2>\n"
      << "<p>The fastest method that comes within so many decibels of the reference, on "
      << threadsText(plan.threads.back())
      << ". At 30 dB differences are easily seen, at 40 dB hardly.</p>\n"
      << fastestTable(plan, points) << "<h2>Time against accuracy</h2>\n"
      << dials(plan, shown_px);
  writePanels(out, plan, points, shown_px);
  out << "<h2>How it was measured</h2>\n<ul>\n"
         "<li>Blur is the radius of the largest circle of confusion in view, pixels; most of a "
         "image has less.</li>\n"
         "<li>Time is that of a frame, scene in memory, hierarchies built: the median of up to "
      << plan.max_runs
      << " runs, all methods taking turns, so that whatever else the machine did met all alike. "
         "What takes longer than "
      << decimal(plan.timing_ms / 1000.0, 2)
      << " s a frame was timed once. The aperture differs by a thousandth from run to run, so that "
         "no method can show its last frame again.</li>\n"
         "<li>Accuracy is the distance from <code>accumulate:N</code>, "
      << plan.views(plan.blurs_px.front()) << " to " << plan.views(plan.blurs_px.back())
      << " pinhole views averaged, in linear light, peak 1: PSNR over the image, and over the "
         "pixels that a step in depth blurs into (silhouettes); SSIM; mean difference of coverage. "
         "The dashed line is one half of the reference's views against the other.</li>\n"
         "<li><code>chart.csv</code> holds every figure; <code>images/</code> every image; "
         "<code>cells/</code> what a later run need not measure again, and may be removed.</li>\n"
         "</ul>\n";
  writeTable(out, points);
  out << "<script>" << kPageScript << "</script>\n";
  writeImageDialog(out);
  out << "</main></body></html>\n";
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace foci
