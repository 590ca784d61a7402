#include "calibration/binocular/binocular_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/input_error.h"
#include "calibration/calibration_file.h"
#include "gaze/geometry/cyclopean.h"

namespace foci {
namespace {

constexpr double kFarthestEye_mm = 1e5;
constexpr double kRounding = 1e-6;

std::string list(const std::vector<double>& values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) text += (i ? ", " : "") + exactText(values[i]);
  return text + "]";
}

/// A vector of the tracker's frame in the display's: x right, y up, z towards the observer.
glm::dvec3 inDisplay(const BinocularMap& map, const glm::dvec3& vector, bool mirrored) {
  glm::dvec3 result = glm::transpose(map.rotation) * vector;
  if (mirrored) result.z = -result.z;
  return result;
}

}  // namespace

std::string binocularToml(const BinocularCalibration& calibration) {
  const BinocularMap& map = calibration.map;
  std::vector<double> rotation, position_mm;
  for (int i = 0; i < 3; ++i) {
    position_mm.push_back(1e3 * map.translation_m[i]);
    for (int k = 0; k < 3; ++k) rotation.push_back(map.rotation[i][k]);
  }
  return "# Binocular calibration of foci: where the display's centre is in the tracker's frame, "
         "mm,\n"
         "# and how the display is turned there, column by column.\n"
         "[binocular]\nposition_mm = " +
         list(position_mm) + "\nrotation = " + list(rotation) +
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
  const auto rotation = in.numbers("binocular.rotation", 9, -1.0 - kRounding, 1.0 + kRounding);
  glm::dmat3& r = calibration.map.rotation;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    calibration.map.translation_m[i] = 1e-3 * position_mm[at];
    for (int k = 0; k < 3; ++k) r[i][k] = rotation[3 * at + static_cast<std::size_t>(k)];
  }
  if (std::abs(glm::determinant(r) - 1.0) > kRounding ||
      std::abs(glm::dot(r[0], r[1])) > kRounding || std::abs(glm::length(r[2]) - 1.0) > kRounding) {
    in.refuse("binocular.rotation", "a rotation");
  }
  calibration.map.kappa_rad = {glm::radians(in.pair("binocular.left_kappa_deg", -30.0, 30.0)),
                               glm::radians(in.pair("binocular.right_kappa_deg", -30.0, 30.0))};
  calibration.uncertainty_deg = in.number("binocular.uncertainty_deg", 0.0, 180.0);
  in.refuseRest();
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
      // A tracker's frame may be left-handed: the observer is where z is above 0.
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
                     "a binocular map: expected a recording with the eyes' centres and directions");
  }
  trace.screen = screen;
  return trace;
}

}  // namespace foci
