// The screen that foci assumes if none is stated.
#pragma once

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// 24 inches, 16:9, 1920 x 1080 px, seen from 0.6 m: 92 px an inch, 38 px a degree.
inline Screen defaultScreen() {
  return {.size_px = {1920, 1080}, .size_m = {0.5313, 0.2989}, .distance_m = 0.6};
}

}  // namespace foci
