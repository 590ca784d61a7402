#include "gaze/geometry/gaze_sample.h"

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

int evenPixels(double px) { return std::max(2 * static_cast<int>(std::lround(0.5 * px)), 2); }

}  // namespace

EyeField fieldOfBothEyes(const EyeField& left_eye) {
  EyeField right_eye = left_eye;
  std::swap(right_eye.left_deg, right_eye.right_deg);
  return fieldOfBothEyes(HeadsetEyes{{{.field = left_eye}, {.field = right_eye}}});
}

EyeField fieldOfBothEyes(const HeadsetEyes& eyes) {
  const EyeField &a = eyes[0].field, &b = eyes[1].field;
  return {.left_deg = std::max(a.left_deg, b.left_deg),
          .right_deg = std::max(a.right_deg, b.right_deg),
          .up_deg = std::max(a.up_deg, b.up_deg),
          .down_deg = std::max(a.down_deg, b.down_deg)};
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
