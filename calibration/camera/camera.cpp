#include "calibration/camera/camera.h"

#include "calibration/calibration_file.h"

namespace foci {

std::string cameraToml(const CameraModel& camera) {
  std::string text = "# Camera calibrated by foci; pixel centres at +0.5.\n[camera]\n";
  text += "size_px = " + exactText(camera.size_px) + "\n";
  text += "focal_px = " + exactText(camera.focal_px) + "\n";
  text += "principal_px = " + exactText(camera.principal_px) + "\n";
  text += "distortion = " + exactText(camera.distortion) + "  # k1, k2, p1, p2, k3\n";
  text += "focal_sd_px = " + exactText(camera.focal_sd_px) + "\n";
  text += "rms_px = " + exactText(camera.rms_px) + "\n";
  return text;
}

CameraModel readCamera(const std::filesystem::path& file) {
  CalibrationFile in(file);
  CameraModel camera;
  camera.size_px = in.size_px("camera.size_px");
  camera.focal_px = in.pair("camera.focal_px", 1.0, 1e6);
  camera.principal_px = in.pair("camera.principal_px", -1e6, 1e6);
  in.read("camera.distortion", camera.distortion, -100.0, 100.0);
  if (in.has("camera.focal_sd_px")) camera.focal_sd_px = in.pair("camera.focal_sd_px", 0.0, 1e6);
  if (in.has("camera.rms_px")) camera.rms_px = in.number("camera.rms_px", 0.0, 1e6);
  in.refuseUnknownKeys();
  return camera;
}

}  // namespace foci
