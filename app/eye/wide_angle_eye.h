// What the eye adds beside its line of sight: the wide-angle schematic eye of Escudero-Sanz and
// Navarro (JOSA A 16, 1999), by exact ray tracing.
#pragma once

#include "render/optics/wavefront.h"

namespace foci {

/// Angles beside the line of sight that the schematic eye was compared with people for, degrees.
inline constexpr double kMostField_deg = 60.0;

/// What the schematic eye has for a point beside the line of sight.
struct FieldOfEye {
  /// Its wavefront less that on the axis: orders 2 to 4 by least squares on the slopes of rays that
  /// leave the eye from one point of the retina. Axes and signs are those of `Wavefront`, in the
  /// plane across the direction of the point, and the circle around the pupil.
  Wavefront added;
  double pupil_aspect = 1.0;  ///< width over height of the pupil that the point sees
};

/// @param field_deg  to the right of the line of sight; below 0: to the left
FieldOfEye fieldOfEye(double field_deg, double pupil_m);

}  // namespace foci
