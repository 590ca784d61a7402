// Files of calibrations: gaze maps, cameras, webcam maps.
#include "calibration/binocular/binocular_map.h"
#include "calibration/camera/camera.h"
#include "calibration/gaze_map/gaze_map.h"
#include "calibration/webcam/webcam_calibration.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(calibration) {
  const auto file = foci::fuzz::asFile("map.toml", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readGazeMap(file); });
  foci::fuzz::readWithinLimits(size, [&] { foci::readCamera(file); });
  foci::fuzz::readWithinLimits(size, [&] { foci::readWebcamCalibration(file); });
  foci::fuzz::readWithinLimits(size, [&] { foci::readBinocular(file); });
  return 0;
}
