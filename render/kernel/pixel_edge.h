// Two surfaces that each cover a part of a pixel's footprint: the same part, or different ones?
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "render/kernel/kernel.h"

namespace foci {

/// Share of the light below which a partial coverage is ignored. Chosen by hand.
inline constexpr float kPartial = 0.02f;

/// The coefficients of the two fits below.
inline constexpr float kDensityPeak = 0.399f, kDensityBend = 0.35f;
inline constexpr float kArcSine = 0.6366f;

/// A layer that covers a part of a footprint, up to an edge.
struct PixelEdge {
  float share;          ///< that it covers, 0 to 1
  glm::vec2 direction;  ///< to the covered side; length 0 to 1: how straight the edge is
};

/// How straight the edge of a layer is, 0 to 1. Its kernels sum to `weight` and lie at the mean
/// offset `mean` from the pixel's centre, in radii of their supports.
///
/// Seen through a Gaussian footprint of standard deviation s, a half-plane that covers the share
/// A = Phi(t) has the mean offset s phi(t) / A. The measured offset over that one is the part of
/// the layer that is such a half-plane; the rest covers the footprint evenly. phi(t) is within 0.01
/// of 0.399 u (1.35 - 0.35 u) with u = 4 A (1 - A).
inline float straightness(float weight, float length_of_mean) {
  const float area = std::min(weight, 1.0f), u = 4.0f * area * (1.0f - area);
  const float density = kDensityPeak * u * (1.0f + kDensityBend - kDensityBend * u);
  const float measured = std::sqrt(kWidestSupport2) * length_of_mean * area;
  return std::min(measured / std::max(density, 1e-6f), 1.0f);
}

/// @param share  that the layer covers
inline PixelEdge pixelEdgeOf(float weight, const glm::vec2& mean, float share) {
  const float length = glm::length(mean);
  return {share, mean * (straightness(weight, length) / std::max(length, 1e-6f))};
}

/// Coverage, 0 to 1, of an unblurred layer: up to an edge, or with a hole that is closed.
inline float pixelCoverageOf(float weight, const glm::vec2& mean) {
  const float straight = straightness(weight, glm::length(mean)), square = straight * straight;
  return glm::mix(coverageOf(weight, kHoleRamp), coverageOf(weight, kSharpRamp), square * square);
}

/// How far two edges lie on opposite sides, 0 to 1: -2/pi asin(r), within 0.06, for the cosine r
/// between their directions, where it is negative.
inline float apart(const PixelEdge& a, const PixelEdge& b) {
  const float r = -std::min(glm::dot(a.direction, b.direction), 0.0f), r4 = r * r * r * r;
  return r * (kArcSine + (1.0f - kArcSine) * r4 * r4);
}

/// The least share of the footprint that two layers can both cover.
inline float leastShared(const PixelEdge& a, const PixelEdge& b) {
  return std::max(a.share + b.share - 1.0f, 0.0f);
}

/// Share of the footprint that both layers cover.
///
/// Let r be the cosine between two straight edges' directions. At r = 0 the layers are independent
/// and share the product of their shares; at r = -1 they share as little as they can. Two
/// half-planes that cover one half each share 1/4 + asin(r) / (2 pi). Other shares interpolate by
/// the same function. Edges on the same side (r > 0) count as independent: thin places of two
/// closed surfaces would else let light through together.
inline float sharedBy(const PixelEdge& a, const PixelEdge& b) {
  const float independent = a.share * b.share;
  return independent + apart(a, b) * (leastShared(a, b) - independent);
}

/// Share of the footprint that the back of a surface covers beside its front. At the outline of a
/// solid both lie on one side, and the back is hidden as far as it can be. On opposite sides they
/// are parts of one sheet, whose triangles disagree which side is the front.
inline float besideFront(const PixelEdge& front, const PixelEdge& back) {
  const float hidden = std::min(front.share, back.share);
  return back.share - (hidden + apart(front, back) * (leastShared(front, back) - hidden));
}

/// How much more of a layer is seen than if it and the layer in front were independent.
/// @param opacity  of the layer in front, 0 to 1
inline float seenOverIndependent(const PixelEdge& front, float opacity, const PixelEdge& behind) {
  const float seen = behind.share - opacity * sharedBy(front, behind);
  const float passes = 1.0f - opacity * front.share;
  return seen / std::max(passes * behind.share, 1e-6f);
}

}  // namespace foci
