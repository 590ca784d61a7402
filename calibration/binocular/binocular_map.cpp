#include "calibration/binocular/binocular_map.h"

#include <algorithm>
#include <cmath>

#include "base/input_error.h"
#include "calibration/calibration_file.h"
#include "gaze/focus/vergence.h"
#include "gaze/geometry/line_of_sight.h"

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
  glm::dvec3 position_mm;
  in.read("binocular.position_mm", std::span(&position_mm.x, 3), -kFarthestEye_mm, kFarthestEye_mm);
  calibration.map.translation_m = 1e-3 * position_mm;
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

glm::dvec3 correctedDirection(const BinocularMap& map, std::size_t eye,
                              const glm::dvec3& direction) {
  const glm::dvec3 d = glm::normalize(direction);
  const double yaw = std::atan2(d.x, d.z) + map.kappa_rad[eye].x;
  const double pitch = std::asin(std::clamp(d.y, -1.0, 1.0)) + map.kappa_rad[eye].y;
  return {std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
}

std::optional<glm::dvec2> pointOnDisplay(const BinocularMap& map, std::size_t eye,
                                         const BinocularSample::Eye& measured) {
  const glm::dmat3 display_from_tracker = glm::transpose(map.rotation);
  const glm::dvec3 from = display_from_tracker * (measured.centre_m - map.translation_m);
  const glm::dvec3 along = display_from_tracker * correctedDirection(map, eye, measured.direction);
  if (along.z == 0.0 || -from.z / along.z <= 0.0) return std::nullopt;
  return glm::dvec2(from - from.z / along.z * along);
}

std::optional<double> vergence_D(const BinocularMap& map, const BinocularSample& sample) {
  if (!sample.eyes[0] || !sample.eyes[1]) return std::nullopt;
  const glm::dvec3 left = correctedDirection(map, 0, sample.eyes[0]->direction);
  const glm::dvec3 right = correctedDirection(map, 1, sample.eyes[1]->direction);
  return vergence_D(EyeRay{.origin_m = sample.eyes[0]->centre_m, .direction = left},
                    EyeRay{.origin_m = sample.eyes[1]->centre_m, .direction = right});
}

std::vector<double> errorsOf_deg(const BinocularMap& map,
                                 std::span<const BinocularSample> samples) {
  std::vector<double> errors;
  for (const BinocularSample& sample : samples) {
    const glm::dvec3 target = map.rotation * glm::dvec3(sample.target_m, 0.0) + map.translation_m;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (!sample.eyes[eye]) continue;
      const glm::dvec3 to = target - sample.eyes[eye]->centre_m;
      const glm::dvec3 sight = correctedDirection(map, eye, sample.eyes[eye]->direction);
      errors.push_back(
          glm::degrees(std::atan2(glm::length(glm::cross(to, sight)), glm::dot(to, sight))));
    }
  }
  return errors;
}

}  // namespace foci
