// The eye's aberrations beside its line of sight, as smooth functions of the direction.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace foci {

/// A polynomial without a constant: the terms x^(n-b) y^b, by n from 1 to `degree`, then by b from
/// 0 to n, with x and y in units of `kFieldUnit_deg`.
inline constexpr double kFieldUnit_deg = 40.0;
inline constexpr std::size_t fieldTerms(int degree) {
  return static_cast<std::size_t>(degree * (degree + 3) / 2);
}

/// What the eye adds in a direction to its optics at the fovea. Axes are the image's, x right and
/// y down.
struct LocalAberration {
  glm::dvec3 power_D{0.0};  ///< as `power_D` (wavefront.h): how much stronger the eye is
  /// Coma along x and y: the Zernike coefficients 8 and 7 at a pupil of 4 mm, with the signs of the
  /// image's axes.
  glm::dvec2 coma_um{0.0};
};

/// The aberrations of a right eye relative to its fovea, from coefficients for a pupil of 4 mm.
/// Defocus and astigmatism are dioptres (`power_D`), coma micrometres (coefficients 7 and 8, OSA).
/// x and y are degrees in the visual field: x towards the temple, y upwards.
///
/// The degrees are the lowest within 1 % of the best mean absolute error of an eye that the fit
/// left out (tests/field/fit_field.py).
struct FieldAberrations {
  static constexpr int kPowerDegree = 4, kJ0Degree = 2, kJ45Degree = 3, kComa7Degree = 2,
                       kComa8Degree = 1;
  std::array<double, fieldTerms(kPowerDegree)> power_D{};
  std::array<double, fieldTerms(kJ0Degree)> j0_D{};
  std::array<double, fieldTerms(kJ45Degree)> j45_D{};
  std::array<double, fieldTerms(kComa7Degree)> coma7_um{};
  std::array<double, fieldTerms(kComa8Degree)> coma8_um{};
  bool operator==(const FieldAberrations&) const = default;

  /// Directions that were measured, degrees. Beyond them, the value at the border holds.
  static constexpr double kMaxX_deg = 40.0, kMaxY_deg = 25.0;

  /// @param from_gaze_deg  of the direction from the line of sight: x right, y down
  LocalAberration at(const glm::dvec2& from_gaze_deg, bool left) const;
};

/// One measurement: a right eye in one direction, coefficients 3 to 8 for a pupil of 4 mm.
struct FieldSample {
  int eye = 0;
  glm::dvec2 field_deg{0.0};  ///< in the visual field: x towards the temple, y upwards
  std::array<double, 6> z_um{};
};

/// Least squares on the median of all eyes in each direction, each eye relative to its own median
/// within 5 degrees of the fovea. The medians bear outliers. Directions on the optic disc, 10 to 18
/// degrees temporal in the field within 5 degrees of the horizontal, do not count.
/// @return false if the directions do not determine the polynomials
bool fitField(std::span<const FieldSample> samples, FieldAberrations& field);

/// The mean of ten normal eyes: `fitField` of the measurements of Polans, Jaeken, McNabb, Artal and
/// Izatt, Wide-field optical model of the human eye with asymmetrically tilted and decentered lens
/// that reproduces measured ocular aberrations, Optica 2(2), 2015. The root mean square of model
/// less median is 0.10 D (defocus), 0.08 D (J0), 0.04 D (J45) and 0.02 um (coma). A single eye
/// differs by 0.7, 0.2, 0.2 D and 0.05 um in the mean.
const FieldAberrations& typicalField();

/// The pupil's disc as a direction sees it, an ellipse: narrower along the meridian by
/// cos(angle / 1.121), the angle from 5.3 degrees temporal in the field, where it is roundest
/// (Mathur, Gehrmann and Atchison, Pupil shape as viewed along the horizontal visual field, Journal
/// of Vision 13(6), 2013). Relative to the pupil that the line of sight sees.
/// @return maps the disc to the ellipse; image axes
glm::dmat2 pupilShape(const glm::dvec2& from_gaze_deg, bool left);

}  // namespace foci
