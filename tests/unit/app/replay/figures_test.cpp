#include "app/replay/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

namespace foci {
namespace FOCI_FILE {

TEST(GazeMap, HoldsTheTimeOfTheFixations) {
  const Screen screen{.size_px = {640, 480}, .size_m = {0.4, 0.3}, .distance_m = 0.5};
  const glm::ivec2 size(321, 241);
  // The second is off the middle, where a pixel is seen at a slant.
  const std::vector<PathPoint> path = {{{320.0, 240.0}, 2.0, 1}, {{480.0, 120.0}, 1.0, 2}};
  const std::vector<float> map = gazeMap(screen, size, path);
  const double peak = double{map[120 * 321 + 160]};
  EXPECT_NEAR(peak, 2.0 / glm::two_pi<double>(), 1e-5);  // float, and the other is far away
  double sum = 0.0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec2 share = (glm::dvec2(x, y) + 0.5) / glm::dvec2(size) - 0.5;
      const double away_m = std::hypot(share.x * 0.4, share.y * 0.3, 0.5);
      const double area_m2 = 0.4 * 0.3 / (size.x * size.y);
      const double solid_deg2 =
          area_m2 * 0.5 / std::pow(away_m, 3) * std::pow(glm::degrees(1.0), 2);
      sum += solid_deg2 * double{map[static_cast<std::size_t>(y) * size.x + x]};
    }
  }
  EXPECT_NEAR(sum, 3.0, 0.003);  // a plane instead of the sphere; 5 sigma; the midpoint rule
}

}  // namespace FOCI_FILE
}  // namespace foci
