// The ellipse about a level's low-pass filter and the blur that a splat needs (Krivanek, Zara and
// Bouatouch 2003, section 6.2 and appendix A).
#pragma once

#include <algorithm>
#include <cmath>

namespace foci {

/// A symmetric 2x2 matrix, positive semidefinite.
struct Variance {
  float xx, xy, yy;
};

/// The smallest variance whose ellipse contains the ellipse of `b` and the circle of variance
/// `circle` I. It has the eigenvectors of `b`; each eigenvalue is max(lambda, circle). The appendix
/// rotates, takes the maxima and rotates back; this code needs no angle.
/// @param circle  >= 0
inline Variance circumellipse(const Variance& b, float circle) {
  const float mean = 0.5f * (b.xx + b.yy), half = 0.5f * (b.xx - b.yy);
  const float spread = std::sqrt(half * half + b.xy * b.xy);
  const float major = std::max(mean + spread, circle), minor = std::max(mean - spread, circle);
  const float scale = spread > 0.0f ? 0.5f * (major - minor) / spread : 0.0f;
  const float middle = 0.5f * (major + minor);
  return {middle + scale * half, scale * b.xy, middle - scale * half};
}

/// A variance whose ellipse contains the ellipses of `b` and `c`. Maps space so that `c` becomes a
/// circle, and takes the circumellipse above. A line (`c` of rank 1) counts as a thousandth of a
/// unit wide, so that the map exists.
inline Variance circumellipse(const Variance& b, const Variance& c) {
  constexpr float kThinnest2 = 1e-6f;
  // c = L L', L lower triangular; L^-1 b L'^-1 and back.
  const float lxx = std::sqrt(c.xx + kThinnest2), lyx = c.xy / lxx;
  const float lyy = std::sqrt(std::max(c.yy - lyx * lyx, 0.0f) + kThinnest2);
  const float x = b.xx / lxx, y = (b.xy - lyx * x) / lyy;
  const float yy = (b.yy - 2.0f * lyx * b.xy / lxx + lyx * lyx * x / lxx) / (lyy * lyy);
  const Variance w = circumellipse({x / lxx, y / lxx, yy}, 1.0f);
  return {lxx * lxx * w.xx, lxx * (lyx * w.xx + lyy * w.xy),
          lyx * lyx * w.xx + 2.0f * lyx * lyy * w.xy + lyy * lyy * w.yy};
}

}  // namespace foci
