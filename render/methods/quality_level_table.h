// What each quality level of method `auto` renders, the error that was measured for it, and how
// long it takes.
#pragma once

#include <array>
#include <span>

#include "render/methods/lod_splats.h"
#include "render/methods/quality_level.h"

namespace foci {

/// The renderer's settings for a quality level.
struct LevelSettings {
  /// Largest blur radii in view, px, at which the errors of the levels were measured.
  static constexpr std::array<float, 6> kBlurs_px{0.0f, 1.0f, 4.0f, 12.0f, 16.0f, 40.0f};

  LodSettings lod;
  std::array<float, kBlurs_px.size()> error_at;  ///< by blur radius: the upper bound below

  /// Upper bound of the error of 95 % of the pixels, in just-noticeable differences at 40 pixels a
  /// degree. The bound holds on every scene of the measurement. It is linear between the blur
  /// radii, and grows in proportion to the blur beyond the last one, where nothing was measured.
  /// @param blur_px  the largest blur radius in view, >= 0
  float error(float blur_px) const;
};

const LevelSettings& settingsOf(QualityLevel level);

/// Relative times of the levels, in the order of `QualityLevel`: the first guess before any level
/// was timed. Measured on the gallery at 1280 x 720.
std::span<const float> relativeTimes();

}  // namespace foci
