#include "app/replay/recordings_page.h"

#include <algorithm>
#include <sstream>

#include "app/graphics/html.h"
#include "base/base64.h"
#include "base/text.h"

namespace foci {
namespace {

void writeCard(std::ostream& out, const BatchResult& result) {
  const RunSummary& run = result.run.summary;
  out << "<figure><a href=\"" << hrefOf(result.recording.name)
      << "/report.html\"><img alt=\"frame at " << decimal(result.run.image.time_s, 2)
      << " s\" src=\"data:image/jpeg;base64,";
  Base64 base64(out);
  base64.add(result.run.image.jpeg.data(), result.run.image.jpeg.size());
  base64.finish();
  out << "\"></a><figcaption><a href=\"" << hrefOf(result.recording.name) << "/report.html\">"
      << escaped(result.recording.name) << "</a><br>" << decimal(run.duration_s, 1)
      << " s &middot; " << run.fixations << " fixations &middot; " << run.saccades
      << " saccades &middot; " << decimal(100.0 * run.gaze_valid, 1)
      << "&thinsp;% valid</figcaption></figure>\n";
}

void writeProblems(std::ostream& out, const std::vector<BatchResult>& results) {
  out << "<h2>Recordings without a run</h2>\n<table><tr><th>recording</th><th>problem</th></tr>\n";
  for (const BatchResult& result : results) {
    if (result.problem.empty()) continue;
    out << "<tr><td>" << escaped(result.recording.trace) << "</td><td>" << escaped(result.problem)
        << "</td></tr>\n";
  }
  out << "</table>\n";
}

}  // namespace

std::string recordingsTable(const std::vector<BatchResult>& results) {
  std::string table =
      "recording\tfolder\tframes\tduration_s\tgaze_valid\tfixations\tsaccades\tpupil_mm\t"
      "frames_rendered\trendered_ms\tproblem\n";
  for (const BatchResult& result : results) {
    const RunSummary& run = result.run.summary;
    table += visible(result.recording.trace) + "\t" + visible(result.recording.name) + "\t";
    if (!result.problem.empty()) {
      for (int column = 2; column < 10; ++column) table += "n/a\t";
      table += visible(result.problem) + "\n";
      continue;
    }
    table += std::to_string(run.frames) + "\t" + decimal(run.duration_s, 3) + "\t" +
             decimal(run.gaze_valid, 4) + "\t" + std::to_string(run.fixations) + "\t" +
             std::to_string(run.saccades) + "\t" + decimal(run.pupil_mm, 3) + "\t" +
             std::to_string(run.frames_rendered) + "\t" + decimal(run.rendered_ms_median, 3) +
             "\tn/a\n";
  }
  return table;
}

std::string recordingsPage(const Study& study, const std::vector<BatchResult>& results) {
  const auto failed = static_cast<std::size_t>(
      std::ranges::count_if(results, [](const BatchResult& r) { return !r.problem.empty(); }));
  double duration_s = 0.0;
  std::size_t fixations = 0, saccades = 0;
  for (const BatchResult& result : results) {
    duration_s += result.run.summary.duration_s;
    fixations += result.run.summary.fixations;
    saccades += result.run.summary.saccades;
  }
  std::ostringstream out;
  const std::string title = std::to_string(results.size()) + " recordings";
  out << pageStart(title + " - foci replay", "") << "<h1>" << title
      << "</h1>\n<p class=\"quiet\">foci " FOCI_VERSION " &middot; study "
      << escaped(study.file.string()) << " &middot; the same figures in recordings.tsv</p>\n"
      << "<div class=\"numbers\">\n"
      << numberCell(std::to_string(results.size() - failed), "recordings with a run")
      << numberCell(std::to_string(failed), "without a run")
      << numberCell(decimal(duration_s, 1) + " s", "of all runs")
      << numberCell(std::to_string(fixations), "fixations")
      << numberCell(std::to_string(saccades), "saccades") << "</div>\n";
  if (failed > 0) writeProblems(out, results);
  out << "<h2>Runs</h2>\n<p class=\"quiet\">A frame from the middle of each run, at which a "
         "fixation "
         "had lasted longest. It links to the report.</p>\n<div class=\"sheet\">\n";
  for (const BatchResult& result : results) {
    if (result.problem.empty()) writeCard(out, result);
  }
  out << "</div>\n" << kPageEnd;
  return out.str();
}

}  // namespace foci
