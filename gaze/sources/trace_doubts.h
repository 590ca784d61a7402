// What looks wrong in a recording: a wrong unit, origin, column, screen or code for data loss shows
// in its positions. A wrong one gives plausible numbers, so nobody would notice it in a result.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/geometry/sampling_rate.h"
#include "gaze/sources/space_doubts.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Gathers samples in constant memory, then names the doubts.
class TraceDoubts {
 public:
  void add(const GazeSample& sample);

  /// One sentence for each doubt, with the key to set. Positions that a gaze map will change, or
  /// fewer than a hundred of them, raise no doubt of their own.
  /// @param header  of the same recording; its screen may be unknown in part
  std::vector<std::string> sentences(const TraceHeader& header, const TraceColumns& columns) const;

 private:
  struct Kept {
    glm::dvec2 point_px{0.0};
    std::array<std::optional<glm::dvec2>, 2> eyes_px{};
  };

  void addClock(double time_s);
  void addPoint(const GazeSample& sample);
  std::vector<std::string> rowDoubts() const;
  std::vector<std::string> rateDoubts() const;
  std::vector<std::string> lossDoubts(const TraceHeader& header) const;
  std::vector<std::string> eyeDoubts(const TraceHeader& header) const;

  SpaceDoubts space_{};
  RateWatch watch_{};
  double first_rate_Hz_ = 0.0;
  std::vector<RateStretch> rates_{};  // but the first
  std::size_t samples_ = 0, present_ = 0, changes_ = 0;
  std::size_t outside_ = 0;  // gaze in space that meets no screen
  std::size_t away_ = 0;     // lines of sight that lead away from the screen
  double first_s_ = 0.0, last_s_ = 0.0, longest_gap_s_ = 0.0;
  glm::dvec2 last_px_{0.0};
  bool whole_px_ = true;  // all positions
  // Every `stride_`-th position, and as many diameters: at most kMaxKept.
  std::size_t stride_ = 1;
  std::vector<Kept> kept_{};
  std::vector<double> pupils_mm_{};
  std::size_t pupils_ = 0, pupil_stride_ = 1;
};

}  // namespace foci
