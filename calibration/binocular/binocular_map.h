// A binocular calibration in use: its file, and recordings seen through it.
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

/// Commented TOML, every digit kept.
std::string binocularToml(const BinocularCalibration& calibration);

/// Whether a file is one, and no gaze map of another kind. Never throws.
bool isBinocularFile(const std::filesystem::path& file);

/// @throws InputError by file and key
BinocularCalibration readBinocular(const std::filesystem::path& file);

/// The recording with points on `screen` where the corrected lines of sight meet it (of both eyes
/// `Cyclopean`), and these lines in the frame of an eye before the middle of the screen, which
/// vergence needs.
/// @param screen  with all of its quantities known
/// @throws InputError where no sample has an eye's centre and direction
GazeTrace mapTrace(const BinocularCalibration& calibration, const Screen& screen, GazeTrace trace);

}  // namespace foci
