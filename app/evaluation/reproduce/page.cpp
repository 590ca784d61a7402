#include "app/evaluation/reproduce/page.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "app/evaluation/reproduce/chart.h"
#include "app/graphics/html.h"
#include "app/platform/machine.h"
#include "app/record/tables.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr const char* kMoreStyle = R"(
main { max-width: 1240px; }
th { text-align: left; font-weight: 600; padding: .25rem .75rem .25rem 0; vertical-align: bottom; }
td { white-space: nowrap; font-variant-numeric: tabular-nums; } td.wraps { white-space: normal; }
td.theirs, th.theirs { color: var(--quiet); } tr.first td { border-top-width: 2px; }
.scroll { overflow-x: auto; } .grid3 { display: grid; grid-template-columns: repeat(3, 1fr); gap: .9rem; }
.yes { color: #2f8f5b; } .no { color: #c94a4a; }
)";

std::string cell(const std::string& text, const char* kind = "") {
  return std::string("<td") + (*kind ? std::string(" class=\"") + kind + "\"" : "") + ">" + text +
         "</td>";
}

std::string finite(double value, int digits) {
  return std::isfinite(value) ? decimal(value, digits) : "&infin;";
}

/// What the paper has beside a row of ours, if anything.
const PaperRow* theirsOf(const ReproduceScene& scene, const ReproduceRow& row) {
  if (row.method != "paper" && row.method != "paper-lod") return nullptr;
  for (const PaperRow& one : scene.paper) {
    if (one.aperture == row.aperture && one.lod == row.lod) return &one;
  }
  return nullptr;
}

std::string theirCells(const ReproduceScene& scene, const ReproduceRow& row) {
  if (const PaperRow* theirs = theirsOf(scene, row)) {
    return cell(theirs->aperture_as, "theirs") + cell(thousands(theirs->kfragments), "theirs") +
           cell(thousands(theirs->points), "theirs") +
           cell(thousands(1000.0 * theirs->seconds), "theirs");
  }
  const bool views = row.method.starts_with("accumulate") && row.aperture + 1 == kApertures;
  return cell("", "theirs") + cell("", "theirs") + cell("", "theirs") +
         cell(views ? thousands(1000.0 * scene.paper_reference_s) : "", "theirs");
}

std::string table(const ReproducedScene& one, const std::vector<unsigned>& threads) {
  std::string html =
      "<div class=\"scroll\"><table>\n<tr><th>aperture, m</th><th>blur up to, px</th>"
      "<th>method</th><th>K fragments</th><th>points</th>";
  for (const unsigned count : threads) {
    html += "<th>ms, " + std::to_string(count) + (count == 1 ? " thread" : " threads") +
            "<br>median (least)</th>";
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
    html += cell(finite(row.psnr_dB, 1)) + cell(decimal(row.ssim, 4)) +
            cell(row.silhouette_psnr_dB ? finite(*row.silhouette_psnr_dB, 1) : "n/a") +
            theirCells(one.scene, row) + "</tr>\n";
  }
  return html + "</table></div>\n";
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
            cell(std::string("<b class=\"") + (ratio.reached() ? "yes" : "no") + "\">" +
                 finite(ratio.value, ratio.digits) + "</b>") +
            "</tr>\n";
  }
  return html + "</table></div>\n";
}

void panels(std::ostream& out, const std::vector<FigurePanel>& row) {
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
            " m accumulate:" + std::to_string(reference.views) + ", its two halves " +
            finite(reference.split_half_psnr_dB.value_or(INFINITY), 1) + " dB apart";
  }
  return text + "; without blur one view, which <i>sweep</i> then draws itself.</p>\n";
}

std::string growthText(const Growth& growth) {
  const auto size = [](const Growth::Size& one) {
    return thousands(static_cast<double>(one.surfels)) + " surfels: hierarchy built in " +
           decimal(one.build_s, 1) + " s, " + decimal(one.bytes_per_surfel, 0) +
           " bytes a surfel, " + milliseconds(one.ms_median[0]) + ", " +
           milliseconds(one.ms_median[1]) + ", " + milliseconds(one.ms_median[2]) +
           " ms a frame at the three apertures";
  };
  return "<h2>Ten times the surfels</h2>\n<p>" + size(growth.before) + ".<br>" +
         size(growth.after) + ".<br>At most " + decimal(growth.frameTime(), 2) +
         " times as long a frame.</p>\n";
}

}  // namespace

void writeReproducePage(const std::filesystem::path& file, const ReproduceFacts& facts) {
  const Machine machine = describeMachine();
  std::ofstream out(file, std::ios::binary);
  out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width\">\n<title>foci reproduce</title>\n"
         "<style>"
      << kPageStyle << kMoreStyle << "</style></head><body><main>\n"
      << "<h1>Fast depth of field with surface splatting, measured again</h1>\n"
         "<p class=\"quiet\">K&#345;iv&aacute;nek, &#381;&aacute;ra and Bouatouch 2003: Table 1, "
         "Figure 1, Figure 6 &middot; foci " FOCI_VERSION " &middot; "
      << escaped(machine.cpu) << ", " << machine.simd << ", up to " << facts.threads.back()
      << (facts.threads.back() == 1 ? " thread" : " threads") << "</p>\n";
  out << "<h2>What is wanted of it</h2>\n"
      << ratioTable(facts)
      << "<p class=\"quiet\">Of times the medians; of several rows the worst.</p>\n";
  for (const ReproducedScene& one : facts.scenes) {
    out << "<h2>Table 1: " << escaped(one.scene.name) << ", "
        << thousands(static_cast<double>(one.scene.cloud.size())) << " surfels, 512 &times; 512 px"
        << "</h2>\n"
        << chartOf(one.scene, one.result.rows, facts.threads.back()) << table(one, facts.threads)
        << referenceText(one);
  }
  if (facts.growth) out << growthText(*facts.growth);
  out << "<h2>Figure 1: a transparent surface out of focus</h2>\n<div class=\"grid3\">\n";
  panels(out, facts.figure1);
  out << "</div>\n<p class=\"quiet\">Drawn by " << kOurs
      << "; the reference is accumulate:" << facts.effort.figure1_views << ".</p>\n";
  for (const ReproducedScene& one : facts.scenes) {
    out << "<h2>Figure 6: " << escaped(one.scene.name) << "</h2>\n<div class=\"grid3\">\n";
    for (const auto& row : one.figure6) panels(out, row);
    out << "</div>\n";
  }
  out << "<h2>How it was measured</h2>\n"
         "<p>Each method drew each row once without being timed, then every row of a scene in "
         "turn, "
      << facts.effort.runs << " times over (accumulate:200: " << facts.effort.accumulate_runs
      << "). The paper's numbers are of a Pentium 4 at 1.4 GHz; theirs and ours compare by ratios "
         "alone. <i>paper</i> and <i>paper-lod</i> are its method, written and compiled as ours "
         "is. Fragments are pixels inside a splat's footprint; accumulate's are of all its views, "
         "its points of one.</p>\n"
         "<p>PSNR and SSIM are in linear light against the reference. That is drawn with "
         "our kernel, of compact support, where the paper cuts a Gaussian off: without blur this "
         "is all that <i>paper</i> differs by. Silhouettes are the pixels within the blur's reach "
         "of a step in depth.</p>\n"
         "<p>The plane's size and tilt, and the lion's apertures, are chosen so that <i>paper</i> "
         "draws the paper's fragments: its own numbers on the plane, its own ratios on the "
         "lion.</p>\n<p class=\"quiet\">"
      << decimal(facts.seconds, 0) << " s in all.</p>\n</main></body></html>\n";
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace foci
