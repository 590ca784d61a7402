// Merges two Gaussians of a captured scene into one by their moments.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

#include "render/scene/gaussian_cloud.h"

namespace foci {

/// A Gaussian's covered area is the integral of its alpha over the plane across a direction, up to
/// where it ends (kMinAlpha):
///   (opacity - kMinAlpha) 2 pi sqrt(|V_d|),   V_d the 2x2 covariance across the direction d.
/// This is the mean over directions of 2 pi sqrt(|V_d|): 7 axes that integrate polynomials up to
/// degree 5 exactly over the sphere (McLaren 1963).
double meanArea_m2(const Covariance3& covariance_m2);

/// sRGB (IEC 61966-2-1), continued beyond 0 and 1.
float displayOfLinear(float light);

/// Peak of the alpha min(1, peak G) whose covered area is `opacity` times that of G: exp(opacity -
/// 1) above 1. Merged Gaussians that lie behind each other cover an area with a flat top.
float peakOf(float opacity);

/// `opacity` of merged Gaussians after a low-pass that keeps the opacities of the single ones, so
/// that each of them, alone, covers `growth` times its area.
/// @param shrinkage  sqrt(|V| / |V + low-pass|) of the merged Gaussian: its area grows, too
/// @return with o = opacity - kMinAlpha, kMinAlpha + log(1 + growth shrinkage (exp(o) - 1)): areas
///         add where little is covered, and a single Gaussian, with growth = 1 / shrinkage, keeps
///         its opacity
float opacityAfterLowPass(float opacity, float growth, float shrinkage);

/// The mean colour of Gaussians.
struct MeanColor {
  glm::vec3 color{0.0f};  ///< of degree 0
  /// Of degree 1 and more, as in GaussianCloud, in units of `color`: to first order around it.
  std::array<float, 3 * std::size_t{harmonicsOf(kMaxHarmonicsDegree)}> harmonics{};
};

/// Moments of one or more Gaussians.
///
/// Two Gaussians cover together M_a + M_b - overlap: 1 - (1 - alpha_a)(1 - alpha_b). The overlap of
/// two Gaussians at the distance D across a direction has a closed form,
///   opacity_a opacity_b 2 pi sqrt(|A| |B| / |A + B|) exp(-D' (A + B)^-1 D / 2).
/// So light that passes between two Gaussians, or is hidden twice, stays what it is in the mean
/// over directions. A flat top (opacity > 1) is replaced by the Gaussian of opacity 1 and of the
/// same area; the overlap of two equal ones is exact.
///
/// Position and covariance are means weighted by covered area. Colours have two means, because a
/// lens averages linear light, and a renderer composites display values. Opaque Gaussians side by
/// side show linear light, weighted by covered area. Faint ones, and those that overlap or share a
/// pixel, show display values, weighted by opacity.
struct GaussianMoments {
  double covered_m2 = 0.0;  ///< area, mean over directions
  /// Covered area over `meanArea_m2`: kMinAlpha less than the Gaussian's; above 1: a flat top.
  double opacity = 0.0;
  /// Sums over the Gaussians alone: their covered areas, the same times their opacities, and how
  /// the areas grow by the variance of a low-pass that keeps opacities, 2 pi opacity.
  double alone_m2 = 0.0, opaque_m2 = 0.0, growth = 0.0;
  glm::dvec3 mean_m{0.0};
  Covariance3 covariance_m2{};
  MeanColor side_by_side;  ///< in linear light
  MeanColor blended;       ///< in display values
  /// Mean variance along an axis by which merging displaced or widened the Gaussians, m^2.
  double spread_m2 = 0.0;
  double radius_m = 0.0;  ///< about the mean: holds all Gaussians to 3 sigma
};

/// The moments of Gaussian `i`.
GaussianMoments momentsOf(const GaussianCloud& cloud, std::size_t i);

GaussianMoments merged(const GaussianMoments& a, const GaussianMoments& b);

/// Writes a merged Gaussian. Let A be the covered areas of its Gaussians, G their growth, M what
/// they cover together, and o their mean opacity. The share o M / (A + s G) of its colour is that
/// of Gaussians side by side: a light and a dark crowd then keep their light within 8 %
/// (GaussianCut tests). Here s is the variance of the low-pass where `spread_m2` is 1 px^2, which
/// is between the limits of `auto` and `sweep-lod`.
/// @param i  exists in the cloud
void store(const GaussianMoments& moments, GaussianCloud& cloud, std::size_t i);

}  // namespace foci
