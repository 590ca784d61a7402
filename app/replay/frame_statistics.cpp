#include "app/replay/frame_statistics.h"

#include <algorithm>
#include <limits>

#include "base/quantile.h"

namespace foci {
namespace {

ChartRow chartRow(const FrameRecord& record) {
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  const auto& surface_m = record.eye.surface_distance_m;
  return {.time_s = record.time_s,
          .gaze_x_px = record.gaze_px ? record.gaze_px->x : kAbsent,
          .gaze_y_px = record.gaze_px ? record.gaze_px->y : kAbsent,
          .surface_D = surface_m ? 1.0 / *surface_m : kAbsent,
          .target_D = record.eye.target_D.value_or(kAbsent),
          .focus_D = record.eye.focus_D,
          .pupil_mm = record.pupil_mm,
          .render_ms = record.stats.ms,
          .state = record.eye.state,
          .vergence_D = record.eye.vergence ? record.eye.vergence->value_D : kAbsent,
          .world_from_eye = record.world_from_eye};
}

}  // namespace

void FrameStatistics::add(const FrameRecord& record) {
  if (record.stats.tolerance_met == false && frames_over_++ == 0) {
    first_over_s_ = record.time_s;
  }
  worst_error_ = std::max(worst_error_, record.stats.tolerance_error.value_or(0.0));
  frames_without_gaze_ +=
      record.eye.state == GazeState::blink || record.eye.state == GazeState::lost;
  pupil_mm_.push_back(static_cast<float>(record.pupil_mm));
  render_ms_.push_back(static_cast<float>(record.stats.ms));
  if (record.rendered) rendered_ms_.push_back(render_ms_.back());
  splats_.push_back(static_cast<std::uint32_t>(record.stats.splats));
  charts_.add(chartRow(record));
}

void FrameStatistics::fill(RunSummary& summary) {
  summary.frames = render_ms_.size();
  summary.render_ms_median = quantile(render_ms_, 0.5);
  summary.render_ms_p95 = quantile(render_ms_, 0.95);
  summary.frames_rendered = rendered_ms_.size();
  summary.rendered_ms_median = rendered_ms_.empty() ? 0.0 : quantile(rendered_ms_, 0.5);
  summary.rendered_ms_p95 = rendered_ms_.empty() ? 0.0 : quantile(rendered_ms_, 0.95);
  summary.splats = quantile(splats_, 0.5);
  summary.pupil_mm = quantile(pupil_mm_, 0.5);
}

void FrameStatistics::fill(ReportFacts& facts) const {
  facts.rows = charts_.rows();
  facts.frames_without_gaze = frames_without_gaze_;
  facts.frames_over = frames_over_;
  facts.first_over_s = first_over_s_;
  facts.worst_error = worst_error_;
  const auto [min, max] = std::minmax_element(pupil_mm_.begin(), pupil_mm_.end());
  facts.pupil_min_mm = *min;
  facts.pupil_max_mm = *max;
}

}  // namespace foci
