// Live sources without a tracker: the mouse, and a recording played in real time.
#pragma once

#include <cstddef>
#include <optional>

#include "gaze/sources/live_source.h"

namespace foci {

/// The pointer replaces gaze. Each poll gives one sample.
class MouseSource : public LiveSource {
 public:
  /// @param rate_Hz  nominal number of polls per second
  explicit MouseSource(double rate_Hz = 60.0) : rate_Hz_(rate_Hz) {}

  /// @param point_px  on the screen; absent while the pointer is elsewhere (data loss)
  void moveTo(const std::optional<glm::dvec2>& point_px) { point_px_ = point_px; }

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override { return rate_Hz_; }
  std::string status() const override { return "mouse"; }

 private:
  double rate_Hz_;
  std::optional<glm::dvec2> point_px_{};
  std::optional<double> last_s_{};
};

/// Plays a recording in real time. The first poll gives the first sample.
class TraceSource : public LiveSource {
 public:
  /// @param trace  its samples and rate must be known (asserted)
  explicit TraceSource(GazeTrace trace);

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override { return trace_.rate_Hz; }
  std::string status() const override;
  bool ended() const { return next_ == trace_.samples.size(); }

 private:
  GazeTrace trace_;
  std::size_t next_ = 0;
  std::optional<double> offset_s_{};  // from the recording's clock to the caller's
};

}  // namespace foci
