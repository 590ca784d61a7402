// The calibration that `gaze.map` names.
#pragma once

#include <filesystem>
#include <variant>

#include "app/study/study.h"
#include "calibration/binocular/binocular_map.h"
#include "calibration/gaze_map/gaze_map.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {

/// A map of gaze points, a correction of both eyes' lines of sight, or the calibration of a webcam.
using GazeCalibration = std::variant<GazeMap, BinocularCalibration, WebcamCalibration>;

/// @param webcam  the gaze comes from a webcam; else the file says which of the others it holds
/// @throws InputError
GazeCalibration readGazeCalibration(const std::filesystem::path& file, bool webcam);

/// The webcam calibration that a study names, which must be made for its screen and its camera.
/// @throws InputError
WebcamCalibration webcamCalibrationOf(const Study& study);

}  // namespace foci
