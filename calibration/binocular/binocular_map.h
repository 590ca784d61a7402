// A binocular calibration in use: its file, and recordings mapped by it.
#pragma once

#include <filesystem>
#include <string>

#include "calibration/binocular/binocular.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct BinocularCalibration {
  BinocularMap map;
  double uncertainty_deg = 0.0;  ///< 68.27 % of one eye's errors are smaller
};

/// The calibration as commented TOML, every digit kept.
std::string binocularToml(const BinocularCalibration& calibration);

/// Whether a file is a binocular calibration. Never throws.
bool isBinocularFile(const std::filesystem::path& file);

/// @throws InputError by file and key
BinocularCalibration readBinocular(const std::filesystem::path& file);

/// The recording with points on `screen`: where each corrected line of sight meets it, and the
/// `Cyclopean` point of both. Eyes' centres and directions come out in the frame of an eye that
/// faces the screen's centre, which vergence needs.
/// @param screen  with resolution, size and distance known
/// @throws InputError where no sample has an eye's centre and direction
GazeTrace mapTrace(const BinocularCalibration& calibration, const Screen& screen, GazeTrace trace);

}  // namespace foci
