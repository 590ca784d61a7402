#include "gaze/geometry/gaze_sample.h"

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

int evenPixels(double px) { return std::max(2 * static_cast<int>(std::lround(0.5 * px)), 2); }

}  // namespace

EyeField fieldOfBothEyes(const EyeField& left_eye) {
  const double side_deg = std::max(left_eye.left_deg, left_eye.right_deg);
  return {.left_deg = side_deg,
          .right_deg = side_deg,
          .up_deg = left_eye.up_deg,
          .down_deg = left_eye.down_deg};
}

Screen headsetScreen(const EyeField& field, double pixels_per_degree) {
  const auto tangent = [](double deg) { return std::tan(glm::radians(deg)); };
  const double left = tangent(field.left_deg), right = tangent(field.right_deg);
  const double up = tangent(field.up_deg), down = tangent(field.down_deg);
  const double focal_px = glm::degrees(pixels_per_degree);
  Screen screen{
      .size_px = {evenPixels(focal_px * (left + right)), evenPixels(focal_px * (up + down))},
      .distance_m = 1.0};
  // Whole pixels come first, so that pixels stay square.
  screen.size_m = glm::dvec2(screen.size_px) / focal_px;
  screen.faced_m = 0.5 * glm::dvec2(left - right, down - up);
  return screen;
}

}  // namespace foci
