#include "render/methods/post_filter.h"

#include <gtest/gtest.h>

#include <limits>

namespace foci {
namespace FOCI_FILE {

// Sums of weights are interpolated in a table with 32 entries a pixel; beyond it they are an
// integral.
constexpr double kSumTolerance = 1e-3;
// The bounds that post_filter.h states for a disc on the grid of pixels, from 1 and from 3 px on.
constexpr double kSmallVarianceTolerance = 0.15, kVarianceTolerance = 0.01;

/// A black image with one white pixel. The blur radius is `radius_px` everywhere.
std::vector<glm::vec4> spreadPoint(const glm::ivec2& size, const glm::ivec2& point,
                                   const glm::vec2& radius_px) {
  std::vector<glm::vec4> image(static_cast<std::size_t>(size.x) * size.y, glm::vec4(0.0f));
  image[static_cast<std::size_t>(point.y) * size.x + point.x] = glm::vec4(1.0f);
  const std::vector<float> point_D(image.size(), 1.0f);
  DiscImage discs;
  discs.set(size, image, point_D, {.radius_px_per_D = radius_px, .focus_D = 0.0f});
  for (int tile = 0; tile < discs.tileCount(); ++tile) discs.spreadOnto(tile, image);
  return image;
}

TEST(DiscImage, DiscsHaveWeightOneAndAQuarterOfTheSquaredRadiusAsVariance) {
  const glm::ivec2 size(150, 150), middle(70, 75);
  for (float radius_px : {0.0f, 0.3f, 0.5f, 1.0f, 1.7f, 3.0f, 7.9f, 23.9f, 24.1f, 60.0f}) {
    const auto image = spreadPoint(size, middle, glm::vec2(radius_px));
    double sum = 0.0, xx = 0.0, yy = 0.0;
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const double w = image[static_cast<std::size_t>(y) * size.x + x].r;
        sum += w;
        xx += w * (x - middle.x) * (x - middle.x);
        yy += w * (y - middle.y) * (y - middle.y);
      }
    }
    EXPECT_NEAR(sum, 1.0, kSumTolerance) << radius_px;
    const double expected_px2 = radius_px > 0.5f ? radius_px * radius_px / 4.0 + 5.0 / 48.0 : 0.0;
    const double tolerance = radius_px < 3.0f ? kSmallVarianceTolerance : kVarianceTolerance;
    EXPECT_NEAR(xx, expected_px2, tolerance * expected_px2) << radius_px;
    EXPECT_NEAR(yy, expected_px2, tolerance * expected_px2) << radius_px;
  }
}

TEST(DiscImage, DiscsAreEllipsesOnOblongPixels) {
  const glm::ivec2 size(100, 100), middle(50, 50);
  const auto image = spreadPoint(size, middle, {20.0f, 10.0f});
  const auto lit = [&](int x, int y) {
    return image[static_cast<std::size_t>(y) * size.x + x].r > 0.0f;
  };
  EXPECT_TRUE(lit(70, 50));
  EXPECT_FALSE(lit(71, 50));
  EXPECT_TRUE(lit(50, 60));
  EXPECT_FALSE(lit(50, 61));
}

TEST(DiscImage, ImagesAreMirroredBeyondTheirBorders) {
  EXPECT_EQ(mirrored(-1, 5), 0);
  EXPECT_EQ(mirrored(-5, 5), 4);
  EXPECT_EQ(mirrored(-6, 5), 4);
  EXPECT_EQ(mirrored(5, 5), 4);
  EXPECT_EQ(mirrored(9, 5), 0);
  EXPECT_EQ(mirrored(10, 5), 0);
  // So the light at a corner stays in the image.
  double sum = 0.0;
  for (const glm::vec4& pixel : spreadPoint({40, 70}, {0, 69}, glm::vec2(12.0f))) sum += pixel.r;
  EXPECT_NEAR(sum, 1.0, kSumTolerance);
}

TEST(DiscImage, WidestDiscIsCapped) {
  const std::vector<glm::vec4> image(64, glm::vec4(0.5f));
  DiscImage discs;
  for (const float per_D : {1e5f, std::numeric_limits<float>::infinity()}) {
    discs.set({8, 8}, image, std::vector<float>(64, 3.0f),
              {.radius_px_per_D = glm::vec2(per_D), .focus_D = 1.0f});
    EXPECT_NEAR(discs.radius_px(discs.defocus_D(4, 4)).x, kMaxRadius_px, 0.01f);
  }
}

TEST(Vergences, OutlinesBelongToTheSurfaceThatCoversMore) {
  // A soft outline from 1 m to 2 m over three pixels, and an empty pixel at the right end.
  Frame image{.size_px = {12, 1}, .rgba = std::vector<glm::vec4>(12), .depth_m = {}};
  image.depth_m = {1.0f, 1.0f, 1.0f, 1.2f, 1.45f, 1.55f, 1.8f, 2.0f, 2.0f, 2.0f, 0.0f, 0.0f};
  const Defocus wide{.radius_px_per_D = glm::vec2(10.0f), .focus_D = 1.0f};
  const std::vector<float> expected = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 0.5f,
                                       0.5f, 0.5f, 0.5f, 0.5f, 0.0f, 0.0f};
  EXPECT_EQ(vergences_D(image, wide), expected);
  // Without blur, distances stay the same.
  const Defocus narrow{.radius_px_per_D = glm::vec2(1.0f), .focus_D = 1.0f};
  EXPECT_FLOAT_EQ(vergences_D(image, narrow)[4], 1.0f / 1.45f);
}

TEST(Vergences, SlantedSurfacesKeepTheirDistances) {
  Frame image{.size_px = {40, 1}, .rgba = std::vector<glm::vec4>(40), .depth_m = {}};
  for (int x = 0; x < 40; ++x) image.depth_m.push_back(1.0f + 0.01f * static_cast<float>(x));
  const Defocus defocus{.radius_px_per_D = glm::vec2(10.0f), .focus_D = 1.0f};
  const std::vector<float> point_D = vergences_D(image, defocus);
  for (int x = 0; x < 40; ++x) EXPECT_FLOAT_EQ(point_D[x], 1.0f / image.depth_m[x]);
}

}  // namespace FOCI_FILE
}  // namespace foci
