// How much more frames change than their references do: flicker from frame to frame, and false
// disparity from one eye to the other.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/image/frame.h"

namespace foci {

/// A frame, and how an eye sees it.
struct FrameInLab {
  explicit FrameInLab(Frame rendered);

  Frame frame;
  std::vector<glm::vec3> lab;  ///< `labOf` the frame at `kUsualPx_per_deg`
};

/// The excess change (to - from) - (exact_to - exact_from) that 99.9 % of the pixels stay below.
struct ExcessChange {
  double light = 0.0;  ///< of the channel of linear RGB that changes most
  double jnd = 0.0;    ///< of L*a*b*, in just-noticeable differences
};

/// The frames have one size (asserted).
ExcessChange excessChange(const FrameInLab& from, const FrameInLab& to,
                          const FrameInLab& exact_from, const FrameInLab& exact_to);

/// The frame less another one of its size (asserted).
Frame minus(Frame frame, const Frame& without);

}  // namespace foci
