// What the frames of a run add up to.
#pragma once

#include <cstdint>
#include <vector>

#include "app/record/manifest.h"
#include "app/replay/report.h"
#include "app/replay/report_charts.h"
#include "app/session/frame_record.h"

namespace foci {

class FrameStatistics {
 public:
  void add(const FrameRecord& record);

  void fill(RunSummary& summary);
  void fill(ReportFacts& facts) const;

 private:
  ChartSeries charts_{};
  std::vector<float> render_ms_{}, rendered_ms_{}, pupil_mm_{};
  std::vector<std::uint32_t> splats_{};
  std::size_t frames_without_gaze_ = 0, frames_over_ = 0;
  double first_over_s_ = 0.0, worst_error_ = 0.0;
};

}  // namespace foci
