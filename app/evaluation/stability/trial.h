// One scene at one value of its dial: the methods' scores against a reference.
#pragma once

#include <string_view>
#include <vector>

#include "app/evaluation/stability/scenes.h"

namespace foci {

/// How much work a trial does.
struct StabilityEffort {
  int samples = 64;  ///< of the lens, for the reference
  int steps = 4;     ///< frames after the first one, if something moves
};

/// A trial renders its reference when it first needs it.
class StabilityTrial {
 public:
  /// @param scene  scored by images (asserted)
  StabilityTrial(const StabilityScene& scene, float value, const StabilityEffort& effort);

  /// @param method  as `makeMethod` takes it
  double score(std::string_view method);

  /// The last frame that was scored. If something moves, it is the last step.
  const Frame& rendered() const { return rendered_; }
  /// The reference of that frame.
  const Frame& reference();

  const StabilitySetup& setup() const { return setup_; }

 private:
  Frame render(std::string_view method, const SurfelCloud& cloud) const;
  double popping(std::string_view method);
  const std::vector<Frame>& references();

  StabilitySetup setup_;
  StabilityEffort effort_;
  Frame rendered_;
  std::vector<Frame> references_;  // one frame, or the first frame and one for each step
};

}  // namespace foci
