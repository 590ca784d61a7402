#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "app/evaluation/evaluation_page.h"
#include "app/evaluation/reproduce/reproduce.h"
#include "app/graphics/html.h"
#include "app/graphics/plot.h"
#include "app/platform/machine.h"
#include "base/text.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"
#include "render/optics/view.h"

namespace foci {
namespace {

constexpr const char* kReproduceStyle = R"(
td { white-space: nowrap; font-variant-numeric: tabular-nums; }
td.theirs, th.theirs { color: var(--quiet); } tr.first td { border-top-width: 2px; }
.grid3 { display: grid; grid-template-columns: repeat(3, 1fr); gap: .9rem; }
.yes { color: #2f8f5b; } .no { color: #c94a4a; }
)";

/// The paper's row for a row of foci; null if there is none.
const PaperRow* paperRowOf(const ReproduceScene& scene, const ReproduceRow& row) {
  if (row.method != "paper" && row.method != "paper-lod") return nullptr;
  for (const PaperRow& one : scene.paper) {
    if (one.aperture == row.aperture && one.lod == row.lod) return &one;
  }
  return nullptr;
}

std::string theirCells(const ReproduceScene& scene, const ReproduceRow& row) {
  if (const PaperRow* theirs = paperRowOf(scene, row)) {
    return cell(theirs->aperture_as, "theirs") + cell(thousands(theirs->kfragments), "theirs") +
           cell(thousands(theirs->points), "theirs") +
           cell(thousands(1000.0 * theirs->seconds), "theirs");
  }
  const bool views = row.method.starts_with("accumulate") && row.aperture + 1 == kApertures;
  return cell("", "theirs") + cell("", "theirs") + cell("", "theirs") +
         cell(views ? thousands(1000.0 * scene.paper_reference_s) : "", "theirs");
}

std::string tableHtml(const ReproducedScene& one, const std::vector<unsigned>& threads) {
  std::string html =
      "<div class=\"scroll\"><table>\n<tr><th>aperture, m</th><th>blur radius up to, px</th>"
      "<th>method</th><th>K fragments</th><th>points</th>";
  for (const unsigned count : threads) {
    html += "<th>ms, " + threadsText(count) + "<br>median (min)</th>";
  }
  html +=
      "<th>PSNR, dB</th><th>SSIM</th><th>PSNR at<br>silhouettes</th><th class=\"theirs\">"
      "the paper's<br>aperture</th><th class=\"theirs\">K fragments</th><th class=\"theirs\">"
      "points</th><th class=\"theirs\">ms</th></tr>\n";
  const std::vector<ReproduceRow>& rows = one.result.rows;
  std::optional<std::size_t> aperture;
  for (std::size_t i = 0; i < rows.size(); i += threads.size()) {
    const ReproduceRow& row = rows[i];
    const bool first = aperture != row.aperture;
    aperture = row.aperture;
    html += first ? "<tr class=\"first\">" : "<tr>";
    html += cell(first ? decimal(row.aperture_m, 4) : "") +
            cell(first ? decimal(row.blur_px_max, 1) : "") + cell(escaped(row.method)) +
            cell(thousands(row.kfragments)) + cell(thousands(static_cast<double>(row.points)));
    for (std::size_t t = 0; t < threads.size(); ++t) {
      html += cell(milliseconds(rows[i + t].ms_median) + " <span class=\"quiet\">(" +
                   milliseconds(rows[i + t].ms_min) + ")</span>");
    }
    html += cell(numberHtml(row.psnr_dB, 1)) + cell(decimal(row.ssim, 4)) +
            cell(row.silhouette_psnr_dB ? numberHtml(*row.silhouette_psnr_dB, 1) : "n/a") +
            theirCells(one.scene, row) + "</tr>\n";
  }
  return html + "</table></div>\n";
}

/// A figure; a full run says whether it was reached.
std::string judged(const ReproduceRatio& ratio, bool quick) {
  std::string number = numberHtml(ratio.value, ratio.digits);
  if (quick) return number;
  return ratio.reached() ? "<b class=\"yes\">" + number + "</b>"
                         : "<b class=\"no\">" + number + " (not reached)</b>";
}

std::string ratioTable(const ReproduceFacts& facts) {
  std::string html =
      "<div class=\"scroll\"><table><tr><th></th><th>scene</th><th class=\"theirs\">the paper's "
      "own</th><th>wanted</th><th>here</th></tr>\n";
  for (const ReproduceRatio& ratio : facts.ratios) {
    html += "<tr>" + cell(escaped(ratio.what), "wraps") + cell(escaped(ratio.scene)) +
            cell(escaped(ratio.paper), "theirs") +
            cell((ratio.at_most ? "at most " : "at least ") +
                 decimal(ratio.wanted, ratio.wanted < 2.0 ? 1 : 0)) +
            cell(judged(ratio, facts.quick)) + "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string ratioText(const ReproduceFacts& facts) {
  std::string html = "<p class=\"quiet\">Times are medians. Each figure is the worst of its rows. ";
  html += facts.quick
              ? "This is a quick run: " + std::to_string(facts.effort.runs) +
                    " timed repetitions, and references of fewer views. It shows that everything "
                    "runs. Its figures scatter too much to be judged; leave out "
                    "<code>--quick</code> for that."
              : std::string("Red: not reached on this machine.");
  return html + "</p>\n";
}

void writeFigurePanels(std::ostream& out, const std::vector<PaperFigure>& row) {
  for (const PaperFigure& panel : row) {
    out << "<figure><img alt=\"" << escaped(panel.caption) << "\" src=\""
        << imageUri(jpegOf(panel.image)) << "\"><figcaption>" << escaped(panel.caption)
        << "</figcaption></figure>\n";
  }
}

std::string referenceText(const ReproducedScene& one) {
  std::string text = "<p class=\"quiet\">References: ";
  for (std::size_t aperture = 1; aperture < kApertures; ++aperture) {
    const ReproduceReference& reference = one.result.reference[aperture];
    text += std::string(aperture > 1 ? "; " : "") + "at " +
            decimal(one.scene.apertures_m[aperture], 4) +
            " m accumulate:" + std::to_string(reference.views) +
            ", one half of its views against the other " +
            numberHtml(reference.split_half_psnr_dB.value_or(INFINITY), 1) + " dB";
  }
  return text + "; without blur a single view, which equals <i>sweep</i>.</p>\n";
}

std::string growthText(const Growth& growth) {
  const auto size = [](const Growth::Size& one) {
    return thousands(static_cast<double>(one.surfels)) + " surfels: hierarchy built in " +
           decimal(one.build_s, 1) + " s, " + decimal(one.bytes_per_surfel, 0) +
           " bytes per surfel, " + milliseconds(one.ms_median[0]) + ", " +
           milliseconds(one.ms_median[1]) + ", " + milliseconds(one.ms_median[2]) +
           " ms per frame at the three apertures";
  };
  return "<h2>Ten times the surfels</h2>\n<p>" + size(growth.before) + ".<br>" +
         size(growth.after) + ".<br>A frame takes at most " + decimal(growth.frameTime(), 2) +
         " times as long.</p>\n";
}

void writeMethodology(std::ostream& out, const ReproduceFacts& facts) {
  out << "<h2>How the figures were measured</h2>\n"
         "<p>Each method first rendered each row once without being timed. Then the rows of a "
         "scene took turns, "
      << facts.effort.runs << " times (accumulate:200: " << facts.effort.accumulate_runs
      << " times). The paper measured on a Pentium 4 at 1.4 GHz, so only ratios of times compare. "
         "<i>paper</i> and <i>paper-lod</i> are the paper's method, written and compiled like "
         "foci's own. Fragments are pixels inside a splat's footprint. The fragments of accumulate "
         "are those of all its views, its points those of one view.</p>\n"
         "<p>PSNR and SSIM compare linear light with the reference. The reference uses foci's "
         "kernel, which has compact support; the paper truncates a Gaussian. Without blur, "
         "<i>paper</i> differs from the reference by this alone. Silhouettes are the pixels that a "
         "step in depth blurs into.</p>\n"
         "<p>The plane's size and tilt and the lion's apertures are chosen so that <i>paper</i> "
         "renders the paper's fragments: the same numbers on the plane, the same ratios on the "
         "lion.</p>\n";
}

}  // namespace

std::string reproducePage(const ReproduceFacts& facts) {
  const Machine machine = describeMachine();
  std::ostringstream out;
  const std::string scenes =
      listed(facts.scenes, ", ", [](const ReproducedScene& one) { return one.scene.name; });
  out << pageStart("foci reproduce: " + scenes + (facts.quick ? " (quick)" : ""),
                   std::string(kEvaluationStyle) + kReproduceStyle)
      << "<h1>Fast depth of field with surface splatting, measured again</h1>\n"
         "<p class=\"quiet\">K&#345;iv&aacute;nek, &#381;&aacute;ra and Bouatouch 2003: Table 1, "
         "Figure 1, Figure 6 &middot; foci " FOCI_VERSION " &middot; "
      << escaped(machine.cpu) << ", " << machine.simd << ", up to "
      << threadsText(facts.threads.back()) << "</p>\n";
  for (const ReproducedScene& one : facts.scenes) out << noticesOf(one.scene.warnings);
  out << "<h2>The figures to reach</h2>\n" << ratioTable(facts) << ratioText(facts);
  for (const ReproducedScene& one : facts.scenes) {
    out << "<h2>Table 1: " << escaped(one.scene.name) << ", "
        << thousands(static_cast<double>(one.scene.scene.size())) << " surfels, 512 &times; 512 px"
        << "</h2>\n"
        << chartOf(one.scene, one.result.rows, facts.threads.back())
        << tableHtml(one, facts.threads) << referenceText(one);
  }
  if (facts.growth) out << growthText(*facts.growth);
  out << "<h2>Figure 1: a transparent surface out of focus</h2>\n<div class=\"grid3\">\n";
  writeFigurePanels(out, facts.figure1);
  out << "</div>\n<p class=\"quiet\">Rendered by " << kOurs
      << "; the reference is accumulate:" << facts.effort.figure1_views << ".</p>\n";
  for (const ReproducedScene& one : facts.scenes) {
    out << "<h2>Figure 6: " << escaped(one.scene.name) << "</h2>\n<div class=\"grid3\">\n";
    for (const auto& row : one.figure6) writeFigurePanels(out, row);
    out << "</div>\n";
  }
  writeMethodology(out, facts);
  out << "<p class=\"quiet\">Total time: " << decimal(facts.seconds, 0) << " s.</p>\n" << kPageEnd;
  return out.str();
}

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

namespace {

constexpr int kFigure_px = 512;
constexpr double kLens_m = 0.03;  // chosen by eye: blurs by about a tenth of a face

}  // namespace

std::vector<PaperFigure> figure1(const SurfelCloud& gallery, int views,
                                 const std::function<void(std::size_t)>& on_frames) {
  const View view = maskView(kFigure_px);
  const auto ours = makeMethod(kOurs, gallery);
  const auto reference = makeMethod("accumulate:" + std::to_string(views), gallery);
  const double mask_m = galleryDepth_m(view, "mask"), bust_m = galleryDepth_m(view, "bust");
  // Between the two in dioptres, where both have the same blur.
  const std::array<double, 3> focus_D = {1.0 / mask_m, 0.5 / mask_m + 0.5 / bust_m, 1.0 / bust_m};
  const std::array<const char*, 3> names = {"the mask in focus", "between the two",
                                            "the bust in focus"};
  std::vector<PaperFigure> panels;
  for (std::size_t i = 0; i < focus_D.size(); ++i) {
    RenderSettings settings;
    settings.defocus = defocusOfLens(kLens_m, view.focal_px, focus_D[i], DistanceAlong::axis);
    Frame frame, exact;
    ours->render(view, settings, frame);
    reference->render(view, settings, exact);
    on_frames(1 + static_cast<std::size_t>(views));
    panels.push_back({imageOf(frame), std::string(names[i]) + ", " + decimal(1.0 / focus_D[i], 2) +
                                          " m; " + decibels(psnr_dB(frame, exact)) +
                                          " against the reference"});
  }
  return panels;
}

std::vector<std::vector<PaperFigure>> figure6(const ReproduceScene& scene,
                                              const SceneResult& result) {
  std::vector<std::vector<PaperFigure>> rows;
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    const Frame& ours = result.frames.at(kOurs)[aperture];
    const ReproduceReference& reference = result.reference[aperture];
    const auto row = std::ranges::find_if(result.rows, [&](const ReproduceRow& one) {
      return one.method == kOurs && one.aperture == aperture;
    });
    const std::string blur = "aperture " + decimal(scene.apertures_m[aperture], 3) +
                             " m, blur radius up to " + decimal(row->blur_px_max, 1) + " px";
    const std::string views =
        aperture == 0 ? std::string("one view")
                      : std::to_string(reference.views) + " views, one half against the other " +
                            decibels(reference.split_half_psnr_dB.value_or(INFINITY));
    rows.push_back(
        {{imageOf(ours), std::string(kOurs) + ": " + blur},
         {imageOf(reference.frame), "reference: " + views},
         {differenceOf(ours, reference.frame, kDifferenceGain),
          "difference times " + decimal(kDifferenceGain, 0) + ": PSNR " + decibels(row->psnr_dB)}});
  }
  return rows;
}

}  // namespace foci
