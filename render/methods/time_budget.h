// How long each quality level of method `auto` takes, learnt from the frames that it rendered: to
// meet a frame-time budget, the time must be known before the frame is rendered.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/methods/quality_level.h"

namespace foci {

class TimeBudget {
 public:
  /// @param relative  times of the levels in any unit: the first guess of one from another
  /// @param hopeful   while nothing has been timed, every level is expected to fit: a GPU is fast
  explicit TimeBudget(std::span<const float> relative, bool hopeful = false);

  /// The time that a level is expected to take. While nothing has been timed, infinite, or 0 for
  /// the hopeful.
  float expected_ms(QualityLevel level) const;

  /// Whether the level is expected to meet the budget. The level of the last frame may use all of
  /// it; other levels need a reserve, so that the level does not flicker.
  bool fits(QualityLevel level, float budget_ms) const;

  /// Records the time of a frame. The times of the other levels decay, so that these levels are
  /// tried again. They decay faster where the view has `moved`, because its cost has changed too.
  void took(QualityLevel level, float ms, bool moved);

 private:
  struct Timing {
    float relative = 1.0f;
    float ms = 0.0f;  // 0: never timed
  };
  Timing& of(QualityLevel level) { return timings_[static_cast<std::size_t>(level)]; }
  const Timing& of(QualityLevel level) const { return timings_[static_cast<std::size_t>(level)]; }

  std::vector<Timing> timings_;
  std::optional<QualityLevel> last_;
  bool hopeful_;
};

}  // namespace foci
