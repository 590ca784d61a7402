// What the eye adds beside its line of sight: the wide-angle schematic eye of Escudero-Sanz and
// Navarro (JOSA A 16, 1999), by exact ray tracing.
#pragma once

#include "render/optics/wavefront.h"

namespace foci {

/// Angles beside the line of sight that the schematic eye was compared with people for, degrees.
inline constexpr double kMostField_deg = 60.0;

/// The wavefront that the schematic eye has for a point `field_deg` to the right of the line of
/// sight (below 0: to the left), less that on the axis: orders 2 to 4 by least squares on the
/// slopes of rays that leave the eye from one point of the retina. Axes and signs are those of
/// `Wavefront`, in the plane across the direction of the point, and the circle around the pupil.
Wavefront fieldWavefront(double field_deg, double pupil_m);

/// Width over height of the pupil that a point `field_deg` beside the line of sight sees, from the
/// same rays.
double pupilAspect(double field_deg, double pupil_m);

}  // namespace foci
