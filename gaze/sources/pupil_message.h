// One message of Pupil's network interface.
#pragma once

#include <optional>
#include <string_view>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// A datum of topic `gaze.3d.01.`, `gaze.3d.0.`, `gaze.2d.0.` and the like. Of 3D data the point is
/// where the mean line of sight meets the screen; of 2D data it is `norm_pos` (origin bottom-left)
/// as fractions of the screen. Senders use "0" and "1" or integers for the eyes; eye 0 is the right
/// one. Below a confidence of 0.6 the sample has no point.
/// @param payload  a msgpack map
/// @param screen   with all of its quantities known
/// @return time on the sender's clock; nothing where the topic is no gaze or the payload is damaged
std::optional<GazeSample> parsePupilMessage(std::string_view topic, std::string_view payload,
                                            const Screen& screen);

}  // namespace foci
