#include "app/study/gaze_calibration.h"

#include <optional>

#include "calibration/camera/camera.h"

namespace foci {

GazeCalibration readGazeCalibration(const std::filesystem::path& file, bool webcam) {
  if (webcam) return readWebcamCalibration(file);
  if (isBinocularFile(file)) return readBinocular(file);
  return readGazeMap(file);
}

WebcamCalibration webcamCalibrationOf(const Study& study) {
  auto calibration =
      std::get<WebcamCalibration>(readGazeCalibration(*study.gaze.map, /*webcam=*/true));
  std::optional<Lens> camera;
  if (study.gaze.camera) camera = lensOf(readCamera(*study.gaze.camera));
  requireSame(calibration, study.screenInForce(), camera);
  return calibration;
}

}  // namespace foci
