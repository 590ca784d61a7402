// The ways in which method `auto` renders, and what each gets wrong.
#pragma once

#include <array>
#include <cstddef>

#include "render/methods/lod_splats.h"

namespace foci {

/// A way to render.
struct Way {
  /// Largest radii of blur in view, px, at which the errors of the ways were measured.
  static constexpr std::array<float, 6> kBlurs_px{0.0f, 1.0f, 4.0f, 12.0f, 16.0f, 40.0f};

  LodSettings lod;
  std::array<float, kBlurs_px.size()> error_at;
  bool sharp = false;  ///< without blur

  /// That of 95 % of the pixels, in just noticeable differences at 40 pixels a degree, on the
  /// hardest of the scenes that it was measured on. Between the blurs it is interpolated; beyond
  /// the last, where nothing was measured, it counts as growing with the blur.
  /// @param blur_px  the largest radius in view, >= 0
  float error(float blur_px) const;
};

/// What the tolerance chooses from, from the cheapest on.
inline constexpr std::size_t kWays = 5;
inline constexpr std::size_t kSharp = 0, kCoarse = 1;

/// The best of those that render the lens as a whole.
inline constexpr std::size_t kWhole = 2;

/// What time leaves where it does not suffice for the ways above, from the best on: of an eye that
/// stands still the sharp image, blurred afterwards; everything through a Gaussian of so many
/// pixels. Numbered behind the ways.
inline constexpr std::size_t kStanding = kWays, kSoft = kStanding + 1, kSofter = kSoft + 1;
inline constexpr std::size_t kNumbers = kSofter + 1;

/// @param i  < kNumbers
const Way& wayNumbered(std::size_t i);

/// What squares of a frame are held against: closer than all of the ways, and too slow for whole
/// frames. Its error is what the squares do not show.
const Way& finestWay();

/// Relative times of all of them, of the gallery at 1280 x 720, to begin with.
inline constexpr std::array<float, kNumbers> kLikely{13.0f, 14.0f, 16.0f, 32.0f,
                                                     35.0f, 1.1f,  3.0f,  1.0f};

}  // namespace foci
