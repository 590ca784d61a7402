#include "app/cli/summary_text.h"

#include "base/text.h"

namespace foci {

std::string summaryText(const RunSummary& summary) {
  std::string text = counted(summary.frames, "frame") + ", " + decimal(summary.duration_s, 2) +
                     " s; " + decimal(100.0 * summary.gaze_valid, 0) +
                     " % of the gaze samples valid; " + counted(summary.fixations, "fixation") +
                     ", " + counted(summary.saccades, "saccade") + "\n" +
                     counted(summary.frames_rendered, "frame") + " rendered, " +
                     decimal(summary.rendered_ms_median, 1) +
                     " ms each (median; 95 %: " + decimal(summary.rendered_ms_p95, 1) + " ms), " +
                     std::to_string(summary.splats) + " splats";
  if (summary.frames_rendered < summary.frames) {
    text += "; the other frames reuse the previous one; " + decimal(summary.render_ms_median, 1) +
            " ms over all frames (median; 95 %: " + decimal(summary.render_ms_p95, 1) + " ms)";
  }
  return text + "\nreport: " + visible((summary.out / "report.html").string());
}

}  // namespace foci
