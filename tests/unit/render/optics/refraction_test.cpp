// Tests the observer's refraction against the textbook, and astigmatic rendering against closed
// forms: ellipses of confusion are lines at the ends of Sturm's interval, and a circle halfway.
#include "render/optics/colours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "render/image/metrics.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kFloat = 1e-6;
constexpr double kKernel = 0.02;   // of a variance: kernels on pixels
constexpr double kSampled = 0.03;  // likewise: 200 points on the lens, or random ones
constexpr float kRadius_px_per_D = 10.0f;

/// Variance of the red light in the image, px^2.
struct Spread {
  double xx = 0.0, xy = 0.0, yy = 0.0;

  double along(double angle_rad) const {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    return c * c * xx + 2.0 * c * s * xy + s * s * yy;
  }
};

Spread spreadOf(const Frame& frame) {
  double mass = 0.0, x = 0.0, y = 0.0;
  Spread sum;
  for (int py = 0; py < frame.size_px.y; ++py) {
    for (int px = 0; px < frame.size_px.x; ++px) {
      const double light = frame.at(px, py).r;
      mass += light;
      x += light * px;
      y += light * py;
      sum.xx += light * px * px;
      sum.xy += light * px * py;
      sum.yy += light * py * py;
    }
  }
  x /= mass;
  y /= mass;
  return {sum.xx / mass - x * x, sum.xy / mass - x * y, sum.yy / mass - y * y};
}

/// The lens of an eye that does not wear `prescription` and is focused, in the mean, at `focus_D`.
RenderSettings lensOf(const Prescription& prescription, float focus_D) {
  RenderSettings settings = lens(kRadius_px_per_D, focus_D);
  settings.defocus.astigmatism_D = refractionOf(prescription).astigmatism_D;
  return settings;
}

/// A point of light 1 m away; of methods that render splats, the mean over places within a pixel
/// and within the 4 px that samples are apart where blur is as large as here.
Spread pointThrough(const std::string& method, const RenderSettings& settings) {
  const bool sampled = method.starts_with("accumulate") || method.starts_with("raytrace");
  const int places = sampled ? 1 : 64;
  Spread mean;
  for (int place = 0; place < places; ++place) {
    const SurfelCloud cloud = pointOfLight(0.5f * glm::vec2(place % 8, place / 8));
    const Spread s = spreadOf(render(method, cloud, squareView(97, kPointFocal_px), settings));
    mean.xx += s.xx / places;
    mean.xy += s.xy / places;
    mean.yy += s.yy / places;
  }
  return mean;
}

TEST(Refraction, IsWhatGlassesTakeAway) {
  // -3 D of sphere with -2 D of cylinder: -3 D along the axis, -5 D across it.
  const Refraction eye = refractionOf({.sphere_D = -3.0, .cylinder_D = -2.0, .axis_deg = 180.0});
  EXPECT_NEAR(eye.far_point_D, 4.0, kFloat);
  EXPECT_NEAR(eye.far_point_D + eye.astigmatism_D.x, 3.0, kFloat);  // horizontally
  EXPECT_NEAR(eye.far_point_D - eye.astigmatism_D.x, 5.0, kFloat);  // vertically
  EXPECT_NEAR(eye.astigmatism_D.y, 0.0, kFloat);
}

TEST(Refraction, IsTheSameInBothFormsOfTheCylinder) {
  const Refraction minus = refractionOf({.sphere_D = 1.0, .cylinder_D = -2.5, .axis_deg = 20.0});
  const Refraction plus = refractionOf({.sphere_D = -1.5, .cylinder_D = 2.5, .axis_deg = 110.0});
  EXPECT_NEAR(minus.far_point_D, plus.far_point_D, kFloat);
  EXPECT_NEAR(glm::length(minus.astigmatism_D - plus.astigmatism_D), 0.0, kFloat);
}

TEST(ChromaticDifference, IsThatOfTheChromaticEye) {
  EXPECT_NEAR(chromaticDifference_D(0.58), 0.0, 1e-4);  // as many digits as the constants have
  EXPECT_NEAR(chromaticDifference_D(0.40) - chromaticDifference_D(0.70), 2.1, 0.1);  // its range
  const glm::vec3 primaries = chromaticDifferenceOfPrimaries_D();
  EXPECT_NEAR(primaries.r, -0.137, 1e-3);
  EXPECT_NEAR(primaries.g, 0.160, 1e-3);
  EXPECT_NEAR(primaries.b, 0.802, 1e-3);
}

/// Methods truncate their kernels differently; each keeps a share of a round disc's variance.
class Ellipses : public testing::TestWithParam<const char*> {
 protected:
  double tolerance() const {
    return std::string(GetParam()).find(':') == std::string::npos ? kKernel : kSampled;
  }
  /// Variance of a point that a round lens blurs to a disc of so many dioptres.
  double roundVariance_px2(float defocus_D) const {
    return pointThrough(GetParam(), lens(kRadius_px_per_D, 1.0f + defocus_D)).xx;
  }
};

TEST_P(Ellipses, APointThroughACylinderIsALine) {
  // A plane cylinder of -2 D leaves 2 D in the meridian across its axis. Focused for the point
  // along the axis (at 1 D, the mean at 2 D), light is rendered out across the axis, which on the
  // screen lies clockwise: as far as 2 D render out a disc.
  const double long_px2 = roundVariance_px2(2.0f), sharp_px2 = roundVariance_px2(0.0f);
  for (const double axis_deg : {30.0, 135.0}) {
    const Spread spread = pointThrough(
        GetParam(), lensOf({.sphere_D = 0.0, .cylinder_D = -2.0, .axis_deg = axis_deg}, 2.0f));
    const double axis_rad = glm::radians(axis_deg);
    EXPECT_NEAR(spread.along(axis_rad + std::numbers::pi / 2.0) / long_px2, 1.0, tolerance())
        << axis_deg;
    EXPECT_NEAR(spread.along(axis_rad) / sharp_px2, 1.0, 0.1) << axis_deg;
  }
}

TEST_P(Ellipses, HalfwayBetweenTheLinesIsTheCircleOfLeastConfusion) {
  const Spread spread = pointThrough(
      GetParam(), lensOf({.sphere_D = 0.0, .cylinder_D = -2.0, .axis_deg = 30.0}, 1.0f));
  const double circle_px2 = roundVariance_px2(1.0f);
  for (const double angle_deg : {0.0, 30.0, 75.0, 120.0}) {
    EXPECT_NEAR(spread.along(glm::radians(angle_deg)) / circle_px2, 1.0, tolerance()) << angle_deg;
  }
}

std::vector<const char*> ellipseMethods() {
  std::vector<const char*> names{"sweep",     "sweep-lod", "auto",           "paper",
                                 "paper-lod", "inflate",   "accumulate:200", "rasanen:4096"};
#ifdef FOCI_RAYTRACE
  names.push_back("raytrace:200");
#endif
  return names;
}

INSTANTIATE_TEST_SUITE_P(Methods, Ellipses, testing::ValuesIn(ellipseMethods()),
                         [](const auto& method) {
                           std::string name = method.param;
                           std::erase_if(name, [](char c) { return c == '-' || c == ':'; });
                           return name;
                         });

TEST(Astigmatism, TheLineIsAsLongAsTheFormulaSays) {
  // A line of length A f |C|, its light spread as a disc's along a diameter: variance length^2
  // / 16.
  const double length_px = 2.0 * kRadius_px_per_D * 2.0;
  const double expected_px2 = kPointVariance_px2 + length_px * length_px / 16.0;
  for (const char* method : {"sweep", "sweep-lod", "accumulate:200"}) {
    const Spread spread =
        pointThrough(method, lensOf({.sphere_D = 0.0, .cylinder_D = -2.0, .axis_deg = 30.0}, 2.0f));
    EXPECT_NEAR(spread.along(glm::radians(120.0)) / expected_px2, 1.0, kSampled) << method;
  }
}

TEST(Astigmatism, AlongTheLineLightEndsWhereTheFormulaSays) {
  const Frame frame =
      render("accumulate:400", pointOfLight({0.0f, 0.0f}), squareView(97, kPointFocal_px),
             lensOf({.sphere_D = 0.0, .cylinder_D = -2.0, .axis_deg = 0.0}, 2.0f));
  // A vertical line of 2 (A/2) |C| px, which the prefilter rounds off within 3 px.
  const auto light = [&](int below_px) { return frame.at(48, 48 + below_px).r; };
  EXPECT_GT(light(16), 0.1f * light(0));
  EXPECT_LT(light(24), 1e-4f * light(0));
}

TEST(Astigmatism, ASheetStaysWhole) {
  // One splat for each pixel, in focus along one meridian and far out of focus across it.
  SurfelCloud cloud;
  addSheet(cloud, 1.0f, 0.4f, 200, glm::vec3(1.0f));
  for (const char* method : {"sweep", "sweep-lod"}) {
    for (const double axis_deg : {0.0, 30.0, 45.0}) {
      const Frame frame = render(method, cloud, squareView(96, 500.0f),
                                 lensOf({.cylinder_D = -2.0, .axis_deg = axis_deg}, 2.0f));
      float least = 1.0f;
      for (int y = 30; y < 66; ++y) {
        for (int x = 30; x < 66; ++x) least = std::min(least, frame.at(x, y).a);
      }
      EXPECT_GT(least, 0.995f) << method << ' ' << axis_deg;
    }
  }
}

TEST(Astigmatism, IsMirroredWithItsAxis) {
  SurfelCloud cloud, mirrored;
  for (const glm::vec2 at : {glm::vec2(5.0f, -3.0f), glm::vec2(-9.0f, 4.0f)}) {
    for (auto [scene, x] : {std::pair{&cloud, at.x}, std::pair{&mirrored, -at.x}}) {
      appendSurfel(*scene, glm::vec3(glm::vec2(x, at.y) / kPointFocal_px, -1.0f),
                   {0.0f, 0.0f, 1.0f}, 1e-4f, 4e-8f, glm::vec3(1.0f));
    }
  }
  const auto seen = [](const SurfelCloud& scene, double axis_deg) {
    return render("sweep", scene, squareView(96, kPointFocal_px),
                  lensOf({.sphere_D = 0.0, .cylinder_D = 3.0, .axis_deg = axis_deg}, 1.4f));
  };
  const Frame one = seen(cloud, 25.0), other = seen(mirrored, 155.0);
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x) {
      ASSERT_NEAR(one.at(x, y).r, other.at(95 - x, y).r, 1e-5f) << x << "," << y;
    }
  }
}

TEST(Astigmatism, EdgesAreBlurredAcrossThemselvesOnly) {
  // In focus horizontally: the vertical edge is sharp, whatever the blur along it.
  const EdgeScene scene;
  RenderSettings settings = EdgeScene::nearInFocus();
  const float j0_D = 0.5f;
  settings.defocus.focus_D -= j0_D;
  settings.defocus.astigmatism_D = {j0_D, 0.0f};
  for (const char* method : {"sweep", "sweep-lod", "accumulate:100"}) {
    const Frame frame = render(method, scene.cloud, scene.view, settings);
    EXPECT_GT(EdgeScene::at(frame, -4).r, 0.95f) << method;
    EXPECT_LT(EdgeScene::at(frame, 4).r, 0.05f) << method;
  }
}

TEST(Astigmatism, SweepAgreesWithTheReference) {
  // Two sheets, the nearer over half of the other, an oblique eye focused between them.
  const EdgeScene scene;
  RenderSettings settings = lens(16.0f, 0.7f);
  settings.defocus.astigmatism_D = {0.15f, -0.25f};
  const Frame reference = render("accumulate:400", scene.cloud, scene.view, settings);
  constexpr double kLeast_dB = 36.0;
  EXPECT_GT(psnr_dB(render("sweep", scene.cloud, scene.view, settings), reference), kLeast_dB);
  EXPECT_GT(psnr_dB(render("sweep-lod", scene.cloud, scene.view, settings), reference), kLeast_dB);
}

TEST(Astigmatism, IsOfPostFiltersTheCircleOfTheSameVariance) {
  // 0.6 D of mean defocus and 0.8 D of astigmatism are 1 D of blur strength.
  RenderSettings oblique = lens(kRadius_px_per_D, 0.4f);
  oblique.defocus.astigmatism_D = {0.64f, 0.48f};
  SurfelCloud cloud;  // a bright and a dark half
  addSheet(cloud, 1.0f, 0.2f, 200, glm::vec3(0.9f), -0.1f);
  addSheet(cloud, 1.0f, 0.2f, 200, glm::vec3(0.1f), 0.1f);
  const View view = squareView(64, kPointFocal_px);
  for (const char* method : {"potmesil", "rokita", "matthews", "shinya", "layered"}) {
    EXPECT_FALSE(methodInfo(method).ellipses);
    const Frame ellipse = render(method, cloud, view, oblique);
    const Frame circle = render(method, cloud, view, lens(kRadius_px_per_D, 0.0f));
    EXPECT_GT(psnr_dB(ellipse, circle), 60.0) << method;
    EXPECT_LT(psnr_dB(ellipse, render(method, cloud, view, lens(kRadius_px_per_D, 0.4f))), 40.0)
        << method;
  }
}

TEST(Chromatic, EachPrimaryHasItsOwnFocus) {
  RenderSettings settings = lens(kRadius_px_per_D, 0.5f);
  const SurfelCloud point = pointOfLight({0.0f, 0.0f});
  const View view = squareView(64, kPointFocal_px);
  const glm::vec3 nearer_D(-0.1f, 0.2f, 0.8f);
  settings.colours = {{-0.1f, {1, 0, 0}}, {0.2f, {0, 1, 0}}, {0.8f, {0, 0, 1}}};
  for (const char* method : {"sweep", "auto", "accumulate:16", "potmesil"}) {
    const Frame colored = render(method, point, view, settings);
    for (int channel = 0; channel < 3; ++channel) {
      const Frame alone =
          render(method, point, view, lens(kRadius_px_per_D, 0.5f + nearer_D[channel]));
      for (std::size_t p = 0; p < alone.rgba.size(); ++p) {
        ASSERT_EQ(colored.rgba[p][channel], alone.rgba[p][channel]) << method << channel;
      }
    }
  }
}

TEST(Chromatic, SpectraBlurEachPrimaryByItsOwnMixture) {
  // Two wavelengths in green, one in red and blue: green is the mean of two blurs.
  RenderSettings settings = lens(kRadius_px_per_D, 0.5f);
  settings.colours = {{-0.2f, {1.0f, 0.25f, 0.0f}}, {0.6f, {0.0f, 0.75f, 1.0f}}};
  const SurfelCloud point = pointOfLight({0.0f, 0.0f});
  const View view = squareView(64, kPointFocal_px);
  const Frame colored = render("sweep", point, view, settings);
  const Frame far = render("sweep", point, view, lens(kRadius_px_per_D, 0.3f));
  const Frame near = render("sweep", point, view, lens(kRadius_px_per_D, 1.1f));
  for (std::size_t p = 0; p < far.rgba.size(); ++p) {
    ASSERT_EQ(colored.rgba[p].r, far.rgba[p].r);
    ASSERT_NEAR(colored.rgba[p].g, 0.25f * far.rgba[p].g + 0.75f * near.rgba[p].g, 1e-6f);
    ASSERT_EQ(colored.rgba[p].b, near.rgba[p].b);
  }
}

TEST(Chromatic, TheEyeIsMostSensitiveAt555nm) {
  EXPECT_NEAR(luminousEfficiency(555.0), 1.0, 0.006);
  EXPECT_EQ(luminousEfficiency(560.0), 0.995);
  EXPECT_NEAR(luminousEfficiency(455.0), 0.049, 1e-9);
  EXPECT_EQ(luminousEfficiency(300.0), 0.0);
  EXPECT_EQ(luminousEfficiency(900.0), 0.0);
}

TEST(Chromatic, NarrowSpectraAreLightOfOneWavelength) {
  std::vector<SpectrumSample> spectra;
  for (int nm = 400; nm <= 700; ++nm) {
    const auto at = [&](int peak_nm) { return nm == peak_nm ? 1.0 : 0.0; };
    spectra.push_back({static_cast<double>(nm), {at(611), at(549), at(464)}});
  }
  const std::vector<Colour> colours = coloursOfSpectra(spectra, 31);
  glm::vec3 sum(0.0f), mean_D(0.0f);
  for (const Colour& one : colours) {
    sum += one.share;
    mean_D += one.nearer_D * one.share;
  }
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(sum[channel], 1.0f, 1e-5f);
    EXPECT_NEAR(mean_D[channel], chromaticDifferenceOfPrimaries_D()[channel], 0.05f);
  }
  EXPECT_LE(colours.size(), 6u);
}

}  // namespace FOCI_FILE
}  // namespace foci
