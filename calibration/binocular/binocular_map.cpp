#include "calibration/binocular/binocular_map.h"

#include <cmath>
#include <span>

#include "base/input_error.h"
#include "calibration/calibration_file.h"
#include "gaze/geometry/cyclopean.h"

namespace foci {
namespace {

constexpr double kFarthestEye_mm = 1e5;

/// Turns a vector from the tracker's frame into the display's: x right, y up, z to the observer.
glm::dvec3 inDisplay(const BinocularMap& map, const glm::dvec3& vector, bool mirrored) {
  glm::dvec3 result = glm::transpose(map.rotation) * vector;
  if (mirrored) result.z = -result.z;
  return result;
}

}  // namespace

std::string binocularToml(const BinocularCalibration& calibration) {
  const BinocularMap& map = calibration.map;
  const glm::dvec3 position_mm = 1e3 * map.translation_m;
  return "# Binocular calibration of foci. The display in the tracker's frame: its centre in mm "
         "and "
         "its\n"
         "# rotation, column by column.\n"
         "[binocular]\nposition_mm = " +
         exactText(std::span(&position_mm.x, 3)) + "\nrotation = " + exactText(map.rotation) +
         "\n# Added to the yaw and pitch of each eye in the tracker's frame.\nleft_kappa_deg = " +
         exactText(glm::degrees(map.kappa_rad[0])) +
         "\nright_kappa_deg = " + exactText(glm::degrees(map.kappa_rad[1])) +
         "\n# 68 % of one eye's errors are smaller.\nuncertainty_deg = " +
         exactText(calibration.uncertainty_deg) + "\n";
}

bool isBinocularFile(const std::filesystem::path& file) {
  try {
    return CalibrationFile(file).has("binocular.rotation");
  } catch (const InputError&) {
    return false;
  }
}

BinocularCalibration readBinocular(const std::filesystem::path& file) {
  CalibrationFile in(file);
  BinocularCalibration calibration;
  const auto position_mm =
      in.numbers("binocular.position_mm", 3, -kFarthestEye_mm, kFarthestEye_mm);
  for (int i = 0; i < 3; ++i) {
    calibration.map.translation_m[i] = 1e-3 * position_mm[static_cast<std::size_t>(i)];
  }
  calibration.map.rotation = in.rotation("binocular.rotation");
  calibration.map.kappa_rad = {glm::radians(in.pair("binocular.left_kappa_deg", -30.0, 30.0)),
                               glm::radians(in.pair("binocular.right_kappa_deg", -30.0, 30.0))};
  calibration.uncertainty_deg = in.number("binocular.uncertainty_deg", 0.0, 180.0);
  in.refuseUnknownKeys();
  return calibration;
}

GazeTrace mapTrace(const BinocularCalibration& calibration, const Screen& screen, GazeTrace trace) {
  const BinocularMap& map = calibration.map;
  const glm::dvec2 px_per_m = glm::dvec2(screen.size_px) / screen.size_m;
  Cyclopean cyclopean;
  bool any = false;
  for (GazeSample& sample : trace.samples) {
    for (std::size_t side : {0, 1}) {
      EyeSample& eye = sample.eyes[side];
      eye.point_px.reset();
      if (!eye.origin_m || !eye.direction) continue;
      any = true;
      const auto point_m =
          pointOnDisplay(map, side, {.centre_m = *eye.origin_m, .direction = *eye.direction});
      if (point_m) {
        eye.point_px =
            0.5 * glm::dvec2(screen.size_px) + glm::dvec2(point_m->x, -point_m->y) * px_per_m;
      }
      // A tracker's frame may be left-handed: the observer must come out at z > 0.
      const glm::dvec3 from = inDisplay(map, *eye.origin_m - map.translation_m, false);
      const bool mirrored = from.z < 0.0;
      eye.direction = inDisplay(map, correctedDirection(map, side, *eye.direction), mirrored);
      eye.origin_m = glm::dvec3(from.x, from.y, std::abs(from.z) - screen.distance_m);
    }
    sample.point_px =
        cyclopean.combine(sample.time_s, sample.eyes[0].point_px, sample.eyes[1].point_px);
    if (sample.blink) sample.point_px.reset();
    if (sample.point_px) sample.uncertainty_deg = calibration.uncertainty_deg;
  }
  if (!any) {
    throw InputError("gaze.map",
                     "is binocular: expected a recording with the eyes' centres and directions");
  }
  trace.screen = screen;
  return trace;
}

}  // namespace foci
