// The strength and the known failure of each method that filters a finished pinhole image.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kVarianceTolerance = 0.02;  // sampling at pixel centres, mean of 16 places
// Variance of small discs on the grid of pixels: see DiscImage.
constexpr double kSmallDiscTolerance = 0.05;
constexpr double kMassTolerance = 0.01;  // likewise
constexpr float kClean = 0.02f;          // a colour that is not there, or light that is all there

bool sameBytes(const Frame& a, const Frame& b) {
  return a.size_px == b.size_px &&
         std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(a.rgba[0])) == 0;
}

/// A grey sheet 1 m away, with and without a brighter red dot of one pixel's area.
struct DotScene {
  SurfelCloud with, without;
  View view = squareView(97, 100.0f);

  DotScene() {
    addSheet(without, 1.0f, 1.4f, 210, glm::vec3(0.2f));
    with = without;
    // Surfels are 2/3 px apart.
    for (std::size_t i = 0; i < with.size(); ++i) {
      if (glm::length(glm::vec2(with.position_m[i])) < 0.009f) with.color[i].r = 1.0f;
    }
  }
  /// Moments of the dot's light under a blur radius of `radius_px`.
  Moments moments(std::string_view method, float radius_px) const {
    const RenderSettings settings = lens(radius_px, 0.0f);
    const Frame dark = render(method, without, view, settings);
    return momentsOf(render(method, with, view, settings), &dark);
  }
};

/// The edge scene in peripheral vision, 15 degrees off the gaze.
View besideTheGaze() {
  View view = EdgeScene().view;
  view.principal_px.x -= 0.27f * view.focal_px.x;
  return view;
}

/// The edge scene, shifted so that it stays in the image.
SurfelCloud edgeBesideTheGaze() {
  SurfelCloud cloud = EdgeScene().cloud;
  for (glm::vec3& position : cloud.position_m) position.x -= 0.27f * position.z;
  return cloud;
}

TEST(Pinhole, IsTheSweepThroughAPinhole) {
  const EdgeScene scene;
  RenderSettings settings = EdgeScene::nearInFocus();
  const Frame pinhole = render("pinhole", scene.cloud, scene.view, settings);
  settings.defocus.radius_px_per_D = glm::vec2(0.0f);
  EXPECT_TRUE(sameBytes(pinhole, render("sweep", scene.cloud, scene.view, settings)));
  EXPECT_TRUE(pinhole.depth_m.empty());
}

TEST(Pinhole, FailureNothingIsBlurred) {
  const EdgeScene scene;
  const Frame near = render("pinhole", scene.cloud, scene.view, EdgeScene::nearInFocus());
  EXPECT_TRUE(sameBytes(near, render("pinhole", scene.cloud, scene.view, EdgeScene::farInFocus())));
  EXPECT_GT(EdgeScene::at(near, -6).r, 1.0f - kClean);  // blurred: 0.89
}

TEST(Potmesil, PointOfLightHasTheVarianceOfTheDisc) {
  for (float radius_px : {0.0f, 1.0f, 2.0f, 5.0f, 10.0f, 20.0f, 40.0f}) {
    const Moments m = momentsOfPoint("potmesil", radius_px);
    const double disc_px2 = radius_px > 0.0f ? radius_px * radius_px / 4.0 + 5.0 / 48.0 : 0.0;
    const double expected_px2 = kPointVariance_px2 + disc_px2;
    const bool small = radius_px > 0.0f && radius_px < 3.0f;
    const double tolerance = small ? kSmallDiscTolerance : kVarianceTolerance;
    EXPECT_NEAR(m.mass, kPointMass, kPointMass * kMassTolerance) << radius_px;
    EXPECT_NEAR(m.variance_x_px2 / expected_px2, 1.0, tolerance) << radius_px;
    EXPECT_NEAR(m.variance_y_px2 / expected_px2, 1.0, tolerance) << radius_px;
  }
}

TEST(Potmesil, FailureLeaksOverSharpEdgesAndIsTooDarkBesideThem) {
  const EdgeScene scene;
  const Frame frame = render("potmesil", scene.cloud, scene.view, EdgeScene::nearInFocus());
  // Green light from behind leaks onto the sharp red side, where there should be none.
  EXPECT_GT(EdgeScene::at(frame, -4).g, 0.15f);
  // Beside the edge, all surfaces have a brightness of 1.
  const glm::vec3 beside = EdgeScene::at(frame, 4);
  EXPECT_LT(beside.r + beside.g, 0.9f);
}

TEST(Potmesil, SpreadsEquallyEverywhere) {
  const Frame frame =
      render("potmesil", edgeBesideTheGaze(), besideTheGaze(), EdgeScene::farInFocus());
  EXPECT_GT(EdgeScene::at(frame, 4).r, 0.1f);
}

TEST(Rokita, PassesAddUpToTheVarianceOfTheDisc) {
  const DotScene scene;
  const double sharp_px2 = scene.moments("pinhole", 0.0f).variance_x_px2;
  for (float radius_px : {0.5f, 1.0f, 2.0f, 5.0f, 10.0f}) {
    const Moments m = scene.moments("rokita", radius_px);
    const double expected_px2 = sharp_px2 + radius_px * radius_px / 4.0;
    EXPECT_NEAR(m.variance_x_px2 / expected_px2, 1.0, kVarianceTolerance) << radius_px;
    EXPECT_NEAR(m.variance_y_px2 / expected_px2, 1.0, kVarianceTolerance) << radius_px;
  }
}

TEST(Rokita, FailureBlurredSurfacesKeepTheirOutlineAndSharpOnesLeak) {
  const EdgeScene scene;
  // The blurred red half-plane ends in a sharp edge. It should cover 0.23 of this pixel.
  const Frame far = render("rokita", scene.cloud, scene.view, EdgeScene::farInFocus());
  EXPECT_LT(EdgeScene::at(far, 4).r, kClean);
  // Where red is sharp, the blurred green beside it gathers red light.
  const Frame near = render("rokita", scene.cloud, scene.view, EdgeScene::nearInFocus());
  EXPECT_GT(EdgeScene::at(near, 4).r, 0.15f);
}

TEST(Matthews, NothingLeaksOverSharpEdgesAndNoLightIsMissing) {
  const EdgeScene scene;
  const Frame frame = render("matthews", scene.cloud, scene.view, EdgeScene::nearInFocus());
  EXPECT_LT(EdgeScene::at(frame, -4).g, kClean);
  for (int right_px : {-20, -8, -4, -2, 2, 4, 8, 20}) {
    const glm::vec3 color = EdgeScene::at(frame, right_px);
    EXPECT_NEAR(color.r + color.g, 1.0f, kClean) << right_px;
  }
}

TEST(Matthews, FailureInnerHalfOfABlurredOutlineStaysOpaque) {
  const EdgeScene scene;
  const Frame frame = render("matthews", scene.cloud, scene.view, EdgeScene::farInFocus());
  // Outside, the blurred red covers a part. Inside, the green behind it is missing (0.23).
  EXPECT_GT(EdgeScene::at(frame, 4).r, 0.1f);
  EXPECT_LT(EdgeScene::at(frame, -4).g, 0.12f);
}

TEST(Shinya, RaysHideEachOther) {
  const EdgeScene scene;
  const Frame near = render("shinya", scene.cloud, scene.view, EdgeScene::nearInFocus());
  EXPECT_LT(EdgeScene::at(near, -4).g, kClean);
  const Frame far = render("shinya", scene.cloud, scene.view, EdgeScene::farInFocus());
  for (int right_px : {-20, -8, -4, -2, 2, 4, 8, 20}) {
    for (const Frame* frame : {&near, &far}) {
      const glm::vec3 color = EdgeScene::at(*frame, right_px);
      EXPECT_NEAR(color.r + color.g, 1.0f, kClean) << right_px;
    }
  }
}

TEST(Shinya, RaysSpreadEvenlyOverTheLens) {
  const DotScene scene;
  const double sharp_px2 = scene.moments("pinhole", 0.0f).variance_x_px2;
  for (float radius_px : {2.0f, 5.0f, 10.0f}) {
    const Moments m = scene.moments("shinya:256", radius_px);
    // Rays are rounded to full pixels, which adds 1/12.
    const double expected_px2 = sharp_px2 + radius_px * radius_px / 4.0 + 1.0 / 12.0;
    EXPECT_NEAR(m.variance_x_px2 / expected_px2, 1.0, kVarianceTolerance) << radius_px;
    EXPECT_NEAR(m.variance_y_px2 / expected_px2, 1.0, kVarianceTolerance) << radius_px;
  }
}

TEST(Shinya, FailureSurfacesHiddenFromThePinholeAreMissingAndFewRaysAreGhosts) {
  const EdgeScene edge;
  const Frame far = render("shinya", edge.cloud, edge.view, EdgeScene::farInFocus());
  EXPECT_LT(EdgeScene::at(far, -4).g, 0.12f);  // 0.23

  // Seven rays show the dot seven times, with grey in between.
  const DotScene scene;
  const RenderSettings settings = lens(20.0f, 0.0f);
  const Frame frame = render("shinya:7", scene.with, scene.view, settings);
  const Frame grey = render("shinya:7", scene.without, scene.view, settings);
  int touched = 0;
  for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
    touched += frame.rgba[i].r - grey.rgba[i].r > 1e-3f;
  }
  EXPECT_GT(touched, 7);
  EXPECT_LT(touched, 7 * 60);  // of the disc's 1257 px
}

TEST(Fearing, IsPotmesilIfEveryTileIsComputed) {
  const EdgeScene scene;
  const auto method = makeMethod("fearing", scene.cloud);
  Frame frame;
  View closer = scene.view;
  closer.focal_px *= 1.1f;
  for (const View& view : {scene.view, closer}) {
    for (const auto& settings : {EdgeScene::nearInFocus(), EdgeScene::farInFocus()}) {
      method->render(view, settings, frame);
      EXPECT_TRUE(sameBytes(frame, render("potmesil", scene.cloud, view, settings)));
    }
  }
}

TEST(Fearing, ComputesOnlyChangedTiles) {
  // A wide scene is finished. Then one corner changes colour, and a quarter of the frame suffices.
  SurfelCloud cloud;
  addSheet(cloud, 1.0f, 1.4f, 300, glm::vec3(0.5f));
  const View view = squareView(256, 200.0f);
  const RenderSettings settings = lens(4.0f, 0.0f);
  const auto method = makeMethod("fearing:25", cloud);
  Frame frame;
  for (int i = 0; i < 4; ++i) method->render(view, settings, frame);
  EXPECT_TRUE(sameBytes(frame, render("potmesil", cloud, view, settings)));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.position_m[i].x > 0.5f && cloud.position_m[i].y > 0.5f) cloud.color[i].r = 1.0f;
  }
  method->render(view, settings, frame);
  EXPECT_TRUE(sameBytes(frame, render("potmesil", cloud, view, settings)));
}

TEST(Fearing, FailureTilesThatWaitShowAnEarlierFocus) {
  const EdgeScene scene;
  const auto method = makeMethod("fearing:25", scene.cloud);
  Frame frame;
  for (int i = 0; i < 4; ++i) method->render(scene.view, EdgeScene::nearInFocus(), frame);
  const Frame before = frame;
  method->render(scene.view, EdgeScene::farInFocus(), frame);
  const Frame after = render("potmesil", scene.cloud, scene.view, EdgeScene::farInFocus());
  std::size_t old = 0, done = 0, changed = 0;
  for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
    if (before.rgba[i] == after.rgba[i]) continue;
    ++changed;
    old += frame.rgba[i] == before.rgba[i];
    done += frame.rgba[i] == after.rgba[i];
  }
  EXPECT_GT(done, changed / 8);
  EXPECT_GT(old, changed / 4);
  EXPECT_EQ(done + old, changed);
}

TEST(Mulder, IsPotmesilAroundTheGaze) {
  const EdgeScene scene;
  const Frame frame = render("mulder", scene.cloud, scene.view, EdgeScene::farInFocus());
  const Frame potmesil = render("potmesil", scene.cloud, scene.view, EdgeScene::farInFocus());
  // 5 degrees are 26 px.
  for (int y = 40; y < 88; ++y) {
    for (int x = 40; x < 88; ++x) {
      if (glm::length(glm::vec2(x - 64, y - 64)) > 24.0f) continue;
      EXPECT_EQ(frame.at(x, y), potmesil.at(x, y));
    }
  }
}

TEST(Mulder, PyramidHasTheVarianceOfTheDisc) {
  SurfelCloud grey, dot;
  addSheet(grey, 1.0f, 3.0f, 450, glm::vec3(0.2f));
  double sharp_px2 = 0.0;
  View view = squareView(129, 100.0f);
  view.principal_px.x -= 50.0f;
  for (float radius_px : {0.0f, 1.0f, 2.0f, 4.0f, 7.0f, 12.0f}) {
    const RenderSettings settings = lens(radius_px, 0.0f);
    const Frame dark = render("mulder", grey, view, settings);
    double variance_px2 = 0.0;
    // The grid of the pyramid is visible, so take the mean over places in one of its largest
    // squares.
    constexpr int kPlaces = 16;
    for (int place = 0; place < kPlaces; ++place) {
      dot = grey;
      const glm::vec2 at_m(0.5f + 0.01f * static_cast<float>(place),
                           0.01f * static_cast<float>(place * 7 % 16));
      for (std::size_t i = 0; i < dot.size(); ++i) {
        if (glm::length(glm::vec2(dot.position_m[i]) - at_m) < 0.009f) dot.color[i].r = 1.0f;
      }
      variance_px2 += momentsOf(render("mulder", dot, view, settings), &dark).variance_x_px2;
    }
    variance_px2 /= kPlaces;
    if (radius_px == 0.0f) sharp_px2 = variance_px2;
    const double expected_px2 = sharp_px2 + radius_px * radius_px / 4.0;
    EXPECT_NEAR(variance_px2 / expected_px2, 1.0, 0.1) << radius_px;
  }
}

TEST(Mulder, FailureOffTheGazeOutlinesStaySharpAndSharpSurfacesLeak) {
  const SurfelCloud cloud = edgeBesideTheGaze();
  const Frame far = render("mulder", cloud, besideTheGaze(), EdgeScene::farInFocus());
  EXPECT_LT(EdgeScene::at(far, 4).r, kClean);  // 0.23
  const Frame near = render("mulder", cloud, besideTheGaze(), EdgeScene::nearInFocus());
  EXPECT_GT(EdgeScene::at(near, 4).r, 0.1f);
}

}  // namespace FOCI_FILE
}  // namespace foci
