// A frame of a run without its pixels: the record, and what the settings of the moment add.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "app/session/frame_record.h"

namespace foci {

struct SeenFrame {
  FrameRecord record{};
  std::vector<glm::dvec2> gaze_px{};  ///< in the image, one for each view
  bool marker = false;                ///< the image shows where the observer looks
};

}  // namespace foci
