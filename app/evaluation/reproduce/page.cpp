#include "app/evaluation/reproduce/page.h"

#include <cmath>
#include <optional>
#include <sstream>

#include "app/evaluation/evaluation_page.h"
#include "app/evaluation/reproduce/chart.h"
#include "app/graphics/html.h"
#include "app/platform/machine.h"
#include "base/base64.h"
#include "base/text.h"

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

void writeFigurePanels(std::ostream& out, const std::vector<FigurePanel>& row) {
  for (const FigurePanel& panel : row) {
    out << "<figure><img alt=\"" << escaped(panel.caption) << "\" src=\"data:image/jpeg;base64,";
    Base64 base64(out);
    const auto jpeg = jpegOf(panel.image);
    base64.add(jpeg.data(), jpeg.size());
    base64.finish();
    out << "\"><figcaption>" << escaped(panel.caption) << "</figcaption></figure>\n";
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
         "scene "
         "took turns, "
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
  std::string scenes;
  for (const ReproducedScene& one : facts.scenes) {
    scenes += (scenes.empty() ? "" : ", ") + one.scene.name;
  }
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
        << thousands(static_cast<double>(one.scene.cloud.size())) << " surfels, 512 &times; 512 px"
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

}  // namespace foci
