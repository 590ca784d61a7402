// One message of Pupil Core's network interface.
#pragma once

#include <optional>
#include <string_view>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Reads a message with a topic such as `gaze.3d.01.`, `gaze.3d.0.` or `gaze.2d.0.`. With 3D data,
/// the point is where the mean line of sight meets the screen. With 2D data, it is `norm_pos` as
/// fractions of the screen (origin bottom-left). The keys of the two eyes are "0" and "1", or the
/// same as integers; eye 0 is the right one. A sample of a confidence below 0.6 has no point.
/// @param payload  a msgpack map
/// @param screen   with known size and distance
/// @return a sample on the sender's clock; nothing if the topic is not gaze or the payload is
/// damaged
std::optional<GazeSample> parsePupilMessage(std::string_view topic, std::string_view payload,
                                            const Screen& screen);

}  // namespace foci
