#include "app/cli/summary_text.h"

#include "base/text.h"

namespace foci {

std::string summaryText(const RunSummary& summary) {
  const auto frames = [](std::size_t count) {
    return std::to_string(count) + (count == 1 ? " frame" : " frames");
  };
  return frames(summary.frames) + ", " + decimal(summary.duration_s, 2) + " s; " +
         decimal(100.0 * summary.gaze_valid, 0) + " % of the gaze samples valid; " +
         std::to_string(summary.fixations) + " fixations, " + std::to_string(summary.saccades) +
         " saccades\n" + frames(summary.frames_rendered) + " rendered, " +
         decimal(summary.rendered_ms_median, 1) +
         " ms each (median; 95 %: " + decimal(summary.rendered_ms_p95, 1) + " ms), " +
         std::to_string(summary.splats) + " splats; the other frames reuse the one before, " +
         decimal(summary.render_ms_median, 1) +
         " ms over all frames (95 %: " + decimal(summary.render_ms_p95, 1) +
         " ms)\nreport: " + (summary.out / "report.html").string();
}

}  // namespace foci
