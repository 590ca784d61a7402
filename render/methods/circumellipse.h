// The low-pass filter of a level against the blur that is needed (Krivanek, Zara and Bouatouch
// 2003, section 6.2 and appendix A).
#pragma once

#include <algorithm>
#include <cmath>

namespace foci {

/// A symmetric 2x2 matrix, positive semidefinite.
struct Variance {
  float xx, xy, yy;
};

/// The smallest variance whose ellipse holds both that of `b` and the circle of variance `circle`
/// I: the eigenvectors of `b`, each eigenvalue max(lambda, circle). The appendix rotates, takes the
/// maxima and rotates back; this is the same without the angle. @param circle  >= 0
inline Variance circumellipse(const Variance& b, float circle) {
  const float mean = 0.5f * (b.xx + b.yy), half = 0.5f * (b.xx - b.yy);
  const float spread = std::sqrt(half * half + b.xy * b.xy);
  const float major = std::max(mean + spread, circle), minor = std::max(mean - spread, circle);
  const float scale = spread > 0.0f ? 0.5f * (major - minor) / spread : 0.0f;
  const float middle = 0.5f * (major + minor);
  return {middle + scale * half, scale * b.xy, middle - scale * half};
}

}  // namespace foci
