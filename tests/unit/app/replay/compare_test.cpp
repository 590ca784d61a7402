#include "app/replay/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/graphics/image.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kDistance_m = 0.8, kSigma_m = 0.8 * 0.017455064928;  // tan(1 deg)

RunFixation at(double x_m, double duration_s) {
  return {.duration_s = duration_s,
          .point_m = glm::dvec3(x_m, 0.0, -kDistance_m),
          .surface_D = 1.0 / kDistance_m};
}

ComparedRun runOf(std::vector<RunFixation> fixations) {
  return {.folder = "a", .name = "a", .scene = "s", .fixations = std::move(fixations)};
}

std::optional<double> gazeOverlap(const ComparedRun& a, const ComparedRun& b) {
  return gazeOverlaps({a, b})[0][1];
}

TEST(GazeOverlap, OfTwoFixationsIsAGaussianOfTheirDistance) {
  const ComparedRun a = runOf({at(0.0, 0.3)});
  for (const double x_m : {0.0, 0.01, 0.03, 0.2}) {
    const double expected = std::exp(-0.25 * x_m * x_m / (kSigma_m * kSigma_m));
    EXPECT_NEAR(*gazeOverlap(a, runOf({at(x_m, 2.0)})), expected, 1e-9) << x_m;
  }
}

TEST(GazeOverlap, OfPlacesFarApartIsTheCosineOfTheirTimes) {
  const ComparedRun a = runOf({at(0.0, 3.0), at(1.0, 4.0)}), b = runOf({at(0.0, 1.0)});
  EXPECT_NEAR(*gazeOverlap(a, b), 0.6, 1e-9);
  EXPECT_NEAR(*gazeOverlap(b, a), 0.6, 1e-9);
  EXPECT_NEAR(*gazeOverlap(a, a), 1.0, 1e-12);
}

TEST(GazeOverlap, IsAbsentWithoutSurfacesAndAcrossScenes) {
  const ComparedRun a = runOf({at(0.0, 1.0)});
  ComparedRun nothing = runOf({{.duration_s = 1.0, .surface_D = NAN}}), other = a;
  other.scene = "t";
  EXPECT_FALSE(gazeOverlap(a, nothing));
  EXPECT_FALSE(gazeOverlap(a, other));
}

TEST(PictureDifference, HasNoRings) {
  ComparedRun a, b;
  const std::vector<glm::dvec2> points_px{{60.3, 40.8}, {200.5, 120.0}};
  for (auto& [run, point_px] : {std::pair{&a, points_px[0]}, std::pair{&b, points_px[1]}}) {
    Image image{.size_px = {640, 360}, .rgb = std::vector<std::uint8_t>(640 * 360 * 3, 90)};
    drawMarker(image, point_px, run == &b);
    run->pictures = {image};
    run->markers_px = {point_px};
  }
  const auto brightest = [&] { return std::ranges::max(pictureDifference(a, b, 0).rgb); };
  EXPECT_EQ(brightest(), 0);
  b.pictures[0].rgb[0] += 3;
  EXPECT_EQ(brightest(), 24);
  b.markers_px = {std::nullopt};
  EXPECT_GT(brightest(), 200) << "a ring that is not known stays";
}

}  // namespace FOCI_FILE
}  // namespace foci
