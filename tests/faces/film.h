// Films of an observer.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "tests/faces/face.h"

namespace foci::faces {

/// Writes H.264 in MP4, from 0 to `to_s`.
/// @param how  its seed is replaced by the frame's number
/// @param at   the observer; absent: out of view
/// @return the truth of each frame
/// @throws std::runtime_error if the film cannot be written
std::vector<Truth> film(const std::filesystem::path& file, const Face& face, double rate_Hz,
                        double to_s, Photography how,
                        const std::function<std::optional<Moment>(double time_s)>& at);

}  // namespace foci::faces
