#include <gtest/gtest.h>

#include <cmath>

#include "app/graphics/figure.h"

namespace foci {
namespace FOCI_FILE {

/// CIE lightness of sRGB codes over 255, white 100 (IEC 61966-2-1).
double lightnessOf(const glm::vec3& code) {
  double y = 0.0;
  const glm::dvec3 weights(0.2126, 0.7152, 0.0722);
  for (int c = 0; c < 3; ++c) {
    const double v = double{code[c]};
    y += weights[c] * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

TEST(ColorMaps, RiseInEvenStepsOfLightness) {
  constexpr double kUneven = 0.35;  // of the mean step; the published maps keep this in 9 steps
  for (std::size_t map = 0; map < kColorMaps.size(); ++map) {
    const auto lightness = [&](double share) {
      return lightnessOf(colorAt(static_cast<ColorMap>(map), static_cast<float>(share)));
    };
    const double mean = (lightness(1.0) - lightness(0.0)) / 9.0;
    EXPECT_GT(mean, 6.0) << kColorMaps[map];
    for (int i = 0; i < 9; ++i) {
      const double step = lightness((i + 1) / 9.0) - lightness(i / 9.0);
      EXPECT_NEAR(step, mean, kUneven * mean) << kColorMaps[map] << ' ' << i;
    }
  }
}

TEST(ColorMaps, HeatLeavesTheGroundWhereThereIsNone) {
  EXPECT_EQ(heatAt(ColorMap::viridis, 0.0f, 0.3f), glm::vec3(0.3f));
  EXPECT_EQ(heatAt(ColorMap::viridis, 1.0f, 0.3f), colorAt(ColorMap::viridis, 1.0f));
  EXPECT_EQ(hexOf(glm::vec3(1.0f, 0.5f, 0.0f)), "#ff8000");
}

}  // namespace FOCI_FILE
}  // namespace foci
