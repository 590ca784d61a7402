#pragma once

namespace foci {

/// Of a screen from the eye, as files, studies and options may state it; 60 is in cm.
inline constexpr double kNearestScreen_m = 0.01, kFarthestScreen_m = 20.0;

}  // namespace foci
