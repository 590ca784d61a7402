// The halos of diffraction keep the light, and an even field even.
#include "render/methods/mean_of_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace foci {
namespace FOCI_FILE {

constexpr double kLight = 1e-3;  // the share of light that may be lost

/// 19 parts that all see the image.
Frame throughHalos(const Frame& image, float diffraction_px) {
  const Pupil pupil{.diameter_m = 3e-3, .diffraction_px = diffraction_px};
  const Defocus defocus =
      defocusOfLens(pupil.diameter_m, glm::vec2(3000.0f), 1.0, DistanceAlong::axis);
  Frame part, mean;
  mean.resize(image.size_px);
  meanOfParts(lensParts(defocus, pupil, 19), diffraction_px, part, mean,
              [&](const LensPart&, Frame& to) { to.rgba = image.rgba; });
  return mean;
}

TEST(Halos, KeepTheLightOfAPoint) {
  for (const float diffraction_px : {0.143f, 0.286f, 0.8f}) {
    Frame image;
    image.resize({259, 250});
    image.rgba[125 * 259 + 129] = glm::vec4(1.0f);
    double light = 0.0;
    for (const glm::vec4& p : throughHalos(image, diffraction_px).rgba) light += p.r;
    EXPECT_NEAR(light, 1.0, kLight) << diffraction_px;
  }
}

TEST(Halos, LeaveAnEvenFieldEven) {
  for (const glm::ivec2 size_px : {glm::ivec2(65, 50), {2, 3}}) {
    Frame image;
    image.resize(size_px);
    std::ranges::fill(image.rgba, glm::vec4(0.7f));
    for (const glm::vec4& p : throughHalos(image, 0.286f).rgba) EXPECT_NEAR(p.r, 0.7, 1e-5);
  }
}

TEST(Halos, AreLinesAlongTheRadius) {
  // All light comes through a part on the right.
  const Pupil pupil{.diameter_m = 3e-3, .diffraction_px = 0.286f};
  std::vector<LensPart> parts{{.centre = {0.8f, 0.0f}, .weight = 1.0f},
                              {.centre = {0.0f, 0.8f}, .weight = 0.0f}};
  Frame part, mean;
  mean.resize({129, 129});
  meanOfParts(parts, pupil.diffraction_px, part, mean, [&](const LensPart&, Frame& to) {
    std::ranges::fill(to.rgba, glm::vec4(0.0f));
    to.rgba[64 * 129 + 64] = glm::vec4(1.0f);
  });
  double along = 0.0, across = 0.0;
  for (int y = 0; y < 129; ++y) {
    for (int x = 0; x < 129; ++x) {
      along += mean.at(x, y).r * std::pow(x - 64, 2);
      across += mean.at(x, y).r * std::pow(y - 64, 2);
    }
  }
  EXPECT_GT(along, 20.0 * across);
}

}  // namespace FOCI_FILE
}  // namespace foci
