// Gaze maps on disk.
#pragma once

#include <filesystem>
#include <string>

#include "calibration/gaze_map/gaze_map.h"

namespace foci {

/// The map as commented TOML, every digit kept.
std::string gazeMapToml(const GazeMap& map);

/// @throws InputError by file and key
GazeMap readGazeMap(const std::filesystem::path& file);

}  // namespace foci
