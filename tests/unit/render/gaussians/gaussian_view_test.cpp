// One Gaussian through the lens against closed forms, and walls of many.
#include "render/gaussians/gaussian_view.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "base/input_error.h"
#include "render/image/srgb.h"
#include "render/methods/method.h"
#include "tests/unit/render/gaussian_scenes.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kVarianceShare = 0.02, kLightShare = 0.01;  // the goals of this renderer

struct Spread {
  double mass = 0.0;
  glm::dvec2 mean{0.0};
  double xx = 0.0, xy = 0.0, yy = 0.0;
};

/// Moments of the coverage, which is linear in the opacity of a single Gaussian.
Spread spreadOf(const Frame& frame) {
  Spread all;
  for (int y = 0; y < frame.size_px.y; ++y) {
    for (int x = 0; x < frame.size_px.x; ++x) {
      const double a = frame.at(x, y).a;
      all.mass += a;
      all.mean += a * glm::dvec2(x + 0.5, y + 0.5);
      all.xx += a * x * x;
      all.xy += a * x * y;
      all.yy += a * y * y;
    }
  }
  all.mean /= all.mass;
  const glm::dvec2 m = all.mean - 0.5;
  all.xx = all.xx / all.mass - m.x * m.x;
  all.xy = all.xy / all.mass - m.x * m.y;
  all.yy = all.yy / all.mass - m.y * m.y;
  return all;
}

constexpr float kOpacity = 0.9f;

/// What is left of the variance of a Gaussian that is cut where its alpha falls below kMinAlpha. A
/// share 1 / (255 opacity) of its mass lies beyond.
double cutShare(double opacity) {
  const double beyond = double{kMinAlpha} / opacity;
  return 1.0 + beyond * std::log(beyond) / (1.0 - beyond);
}

/// A Gaussian 2 m away with a standard deviation of 4 px.
GaussianCloud oneGaussian() {
  GaussianCloud cloud;
  addGaussian(cloud, {0.0f, 0.0f, -2.0f}, glm::vec3(0.02f), kOpacity, glm::vec3(0.5f));
  return cloud;
}
const View kView = squareView(160, 400.0f);
constexpr double kSharpVariance_px2 = 16.0;

TEST(GaussianView, ProjectsTheCovariance) {
  const Spread spread = spreadOf(render("pinhole", oneGaussian(), kView, {}));
  const double expected = (kSharpVariance_px2 + double{kLowPass_px2}) * cutShare(kOpacity);
  EXPECT_NEAR(spread.xx, expected, kVarianceShare * expected);
  EXPECT_NEAR(spread.yy, expected, kVarianceShare * expected);
  EXPECT_NEAR(spread.xy, 0.0, 1e-3);
  EXPECT_NEAR(spread.mean.x, 80.0, 1e-3);
  const double mass = 2.0 * M_PI * kOpacity * (kSharpVariance_px2 + double{kLowPass_px2}) *
                      (1.0 - double{kMinAlpha} / double{kOpacity});
  EXPECT_NEAR(spread.mass, mass, kLightShare * mass);
}

TEST(GaussianView, BlursByTheDiscsVarianceAndKeepsTheLight) {
  const Spread sharp = spreadOf(render("pinhole", oneGaussian(), kView, {}));
  for (const double blur_px : {4.0, 12.0}) {
    // Half a dioptre out of focus.
    const RenderSettings settings = lens(static_cast<float>(2.0 * blur_px), 1.0f);
    for (const char* method : {"sweep", "sweep:7", "sweep-lod:7", "accumulate:100", "auto"}) {
      const Spread spread = spreadOf(render(method, oneGaussian(), kView, settings));
      // A whole-aperture pass cuts the blurred Gaussian, the others also unblurred ones.
      const double share = std::string(method) == "sweep" ? cutShare(kOpacity) : 1.0;
      const double added = share * blur_px * blur_px / 4.0;
      // By points of the lens the Gaussian is sheared, too: it is 2 cm deep.
      EXPECT_NEAR(spread.xx - sharp.xx, added, 1.5 * kVarianceShare * added) << method << blur_px;
      EXPECT_NEAR(spread.yy - sharp.yy, added, 1.5 * kVarianceShare * added) << method << blur_px;
      EXPECT_NEAR(spread.mass, sharp.mass, kLightShare * sharp.mass) << method << blur_px;
      EXPECT_NEAR(spread.mean.x, sharp.mean.x, 0.05) << method << blur_px;
    }
  }
}

TEST(GaussianView, InflatesByTheVarianceOfEachRenderer) {
  const Spread sharp = spreadOf(render("pinhole", oneGaussian(), kView, {}));
  constexpr double kBlur_px = 5.0;
  struct Inflated {
    const char* method;
    double variance;  // over C^2
  };
  for (const auto& [method, variance] : {Inflated{"inflate", 0.5 / std::log(4.0)},
                                         {"inflate:spark", 1.0},
                                         {"inflate:splat-transform", 4.0}}) {
    const Spread spread = spreadOf(
        render(method, oneGaussian(), kView, lens(static_cast<float>(2.0 * kBlur_px), 1.0f)));
    const double added = cutShare(kOpacity) * variance * kBlur_px * kBlur_px;
    EXPECT_NEAR(spread.xx - sharp.xx, added, 1.5 * kVarianceShare * added) << method;
    EXPECT_NEAR(spread.yy - sharp.yy, added, 1.5 * kVarianceShare * added) << method;
    EXPECT_NEAR(spread.mass, sharp.mass, kLightShare * sharp.mass) << method;
  }
}

TEST(GaussianView, ProjectsASlantedGaussianAsItsPointsDo) {
  const float half_turn = 0.35f;
  const glm::vec4 rotation(0.6f * std::sin(half_turn), 0.8f * std::sin(half_turn), 0.0f,
                           std::cos(half_turn));
  const glm::vec3 sigma(0.06f, 0.02f, 0.04f), middle(0.12f, -0.1f, -2.0f);
  GaussianCloud cloud;
  addGaussian(cloud, middle, sigma, kOpacity, glm::vec3(0.5f), rotation);
  const Covariance3 v = cloud.covariance_m2[0];
  const Spread spread = spreadOf(render("pinhole", cloud, kView, {}));

  // Points of the same covariance, by its Cholesky factor.
  const double lxx = std::sqrt(v.xx), lxy = v.xy / lxx, lxz = v.xz / lxx;
  const double lyy = std::sqrt(v.yy - lxy * lxy), lyz = (v.yz - lxy * lxz) / lyy;
  const double lzz = std::sqrt(v.zz - lxz * lxz - lyz * lyz);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  constexpr int kPoints = 200'000;
  glm::dvec2 mean(0.0);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double a = normal(random), b = normal(random), c = normal(random);
    const glm::vec3 p = middle + glm::vec3(lxx * a, lxy * a + lyy * b, lxz * a + lyz * b + lzz * c);
    const glm::dvec2 at = project(kView, p);
    mean += at / double{kPoints};
    xx += at.x * at.x / kPoints;
    xy += at.x * at.y / kPoints;
    yy += at.y * at.y / kPoints;
  }
  const double share = cutShare(kOpacity), low_pass = double{kLowPass_px2};
  const double expected_xx = share * (xx - mean.x * mean.x + low_pass);
  const double expected_yy = share * (yy - mean.y * mean.y + low_pass);
  // Statistical, and the perspective that the affine approximation leaves out.
  EXPECT_NEAR(spread.xx, expected_xx, 0.03 * expected_xx);
  EXPECT_NEAR(spread.yy, expected_yy, 0.03 * expected_yy);
  EXPECT_NEAR(spread.xy, share * (xy - mean.x * mean.y),
              0.03 * std::sqrt(expected_xx * expected_yy));
  EXPECT_NEAR(spread.mean.x, mean.x, 0.2);
  EXPECT_NEAR(spread.mean.y, mean.y, 0.2);
}

TEST(GaussianView, BlursTheDepthOfAGaussianInFocus) {
  // Its middle is in focus, its ends are not.
  GaussianCloud cloud;
  addGaussian(cloud, {0.0f, 0.0f, -1.0f}, {0.01f, 0.01f, 0.1f}, kOpacity, glm::vec3(0.5f));
  const GaussianCloud& scene = cloud;
  const RenderSettings settings = lens(80.0f, 1.0f);
  const Spread sharp = spreadOf(render("pinhole", scene, kView, settings));
  const double added = std::pow(80.0 * 0.1, 2.0) / 4.0;  // R^2 e / 4, e = 0.1^2 D^2
  for (const char* method : {"sweep", "sweep:7", "accumulate:200"}) {
    const Spread spread = spreadOf(render(method, scene, kView, settings));
    // Points of the lens see ellipses of different areas, which the mean weights by area.
    EXPECT_GT(spread.xx - sharp.xx, 0.9 * added) << method;
    EXPECT_LT(spread.xx - sharp.xx, 1.5 * added) << method;
  }
}

TEST(GaussianView, CompositesInDisplayValues) {
  // Two wide Gaussians, one before the other: half of red over half of blue over green.
  GaussianCloud cloud;
  addGaussian(cloud, {0.0f, 0.0f, -1.0f}, {50.0f, 50.0f, 1e-3f}, 0.5f, {1.0f, 0.0f, 0.0f});
  addGaussian(cloud, {0.0f, 0.0f, -2.0f}, {50.0f, 50.0f, 1e-3f}, 0.5f, {0.0f, 0.0f, 1.0f});
  RenderSettings settings;
  settings.lighting.background = {0.0f, linearFromSrgb(0.8f), 0.0f};
  const Frame frame = render("pinhole", cloud, squareView(8, 20.0f), settings);
  const glm::vec4 pixel = frame.at(4, 4);
  constexpr float kSlack = 1e-3f;  // of the polynomials, and of the Gaussians' slopes
  EXPECT_NEAR(pixel.r, linearFromSrgb(0.5f), kSlack);
  EXPECT_NEAR(pixel.g, linearFromSrgb(0.25f * 0.8f), kSlack);
  EXPECT_NEAR(pixel.b, linearFromSrgb(0.25f), kSlack);
  EXPECT_NEAR(pixel.a, 0.75f, kSlack);
}

TEST(GaussianView, AWallLooksLikeAWallOfSurfels) {
  const float shown = 0.7f;
  GaussianCloud cloud;
  // One layer of Gaussians that overlap lets some light through.
  for (const float depth_m : {1.0f, 1.0005f}) {
    addWall(cloud, depth_m, 0.3f, 60, 0.99f, glm::vec3(shown));
  }
  const GaussianCloud& gaussians = cloud;
  SurfelCloud surfels;
  addSheet(surfels, 1.0f, 0.3f, 60, glm::vec3(linearFromSrgb(shown)));
  RenderSettings settings = lens(16.0f, 0.5f);  // 8 px
  settings.depth = true;
  const View view = squareView(192, 400.0f);
  const Frame a = render("sweep:19", gaussians, view, settings);
  const Frame b = render("accumulate:100", surfels, view, settings);
  EXPECT_NEAR(a.at(96, 96).r, b.at(96, 96).r, 0.01f * b.at(96, 96).r);
  EXPECT_GT(a.at(96, 96).a, 0.99f);
  EXPECT_NEAR(a.depth_m[96 * 192 + 96], 1.0f, 1e-3f);
  // Where the blurred border covers half: Gaussians reach farther out than surfels, whose sums end
  // at the border, by less than a Gaussian's two standard deviations of 2.5 px.
  const auto borderOf = [](const Frame& frame) {
    int x = 0;
    while (frame.at(x, 96).a < 0.5f) ++x;
    return x;
  };
  EXPECT_LE(borderOf(a), borderOf(b));
  EXPECT_GE(borderOf(a), borderOf(b) - 3);
  EXPECT_NEAR(a.at(10, 10).a, 0.0f, 1e-3f);
}

// One flat Gaussian that is tilted by 50 degrees about x: its depth differs from pixel to pixel.
TEST(GaussianView, DepthIsThatOfTheSurfaceAtThePixel) {
  const float tilt = glm::radians(50.0f);
  GaussianCloud cloud;
  addGaussian(cloud, {0.1f, 0.0f, -2.0f}, {1.0f, 1.0f, 1e-4f}, 0.95f, glm::vec3(0.5f),
              {std::sin(0.5f * tilt), 0.0f, 0.0f, std::cos(0.5f * tilt)});
  const GaussianCloud& scene = cloud;
  const glm::dvec3 normal(0.0, -std::sin(tilt), std::cos(tilt));
  const View view = squareView(96, 200.0f);
  for (const DistanceAlong along : {DistanceAlong::axis, DistanceAlong::sight}) {
    RenderSettings settings = lens(6.0f, 0.5f);
    settings.depth = true;
    settings.defocus.along = along;
    for (const char* method : {"pinhole", "sweep", "sweep:7", "accumulate:7"}) {
      const Frame frame = render(method, scene, view, settings);
      for (const int y : {8, 28, 48, 68, 88}) {
        for (const int x : {8, 48, 88}) {
          const glm::dvec3 ray((x + 0.5 - 48.0) / 200.0, (48.0 - y - 0.5) / 200.0, -1.0);
          const double depth_m = -2.0 * normal.z / glm::dot(ray, normal);
          const bool by_sight = along == DistanceAlong::sight;
          const double expected_m = by_sight ? depth_m * glm::length(ray) : depth_m;
          // By sight, squares of the offset from the centre are left out.
          const glm::dvec2 offset = glm::dvec2(ray) - glm::dvec2(0.05, 0.0);
          const double slack = 0.005 + (by_sight ? glm::dot(offset, offset) : 0.0);
          EXPECT_NEAR(frame.depth_m[y * 96 + x], expected_m, slack * expected_m)
              << method << " " << x << " " << y;
        }
      }
    }
  }
}

GaussianCloud randomGaussians(int n) {
  std::mt19937 random(9);
  const auto uniform = [&](float a, float b) {
    return a + (b - a) * static_cast<float>(random() >> 8) / static_cast<float>(1 << 24);
  };
  GaussianCloud cloud;
  for (int i = 0; i < n; ++i) {
    addGaussian(cloud, {uniform(-1.0f, 1.0f), uniform(-1.0f, 1.0f), uniform(-4.0f, 0.2f)},
                {uniform(0.001f, 0.05f), uniform(0.001f, 0.05f), uniform(0.001f, 0.05f)},
                uniform(0.0f, 1.0f),
                {uniform(0.0f, 1.5f), uniform(0.0f, 1.0f), uniform(0.0f, 1.0f)},
                glm::normalize(glm::vec4(uniform(-1.0f, 1.0f), uniform(-1.0f, 1.0f),
                                         uniform(-1.0f, 1.0f), uniform(0.1f, 1.0f))));
  }
  return cloud;
}

TEST(GaussianView, SameBytesAtAnyNumberOfThreads) {
  const GaussianCloud scene = randomGaussians(5000);
  RenderSettings settings = lens(20.0f, 1.0f);
  settings.depth = true;
  for (const char* method : {"pinhole", "sweep:7", "sweep-lod:7", "accumulate:5", "auto"}) {
    const auto renderedOn = [&](std::size_t threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return render(method, scene, squareView(110, 110.0f), settings);
    };
    const Frame one = renderedOn(1), three = renderedOn(3);
    EXPECT_EQ(std::memcmp(one.rgba.data(), three.rgba.data(), one.rgba.size() * sizeof(glm::vec4)),
              0);
    EXPECT_EQ(one.depth_m, three.depth_m);
  }
}

TEST(GaussianView, StaysFiniteUnderAnyLens) {
  const GaussianCloud scene = randomGaussians(500);
  for (const float radius_px_per_D : {1e6f, std::numeric_limits<float>::infinity()}) {
    for (const char* method : {"sweep", "sweep:7", "sweep-lod:7", "auto", "auto:5"}) {
      const Frame frame = render(method, scene, squareView(5, 5.0f), lens(radius_px_per_D, 0.5f));
      for (const glm::vec4& pixel : frame.rgba) {
        for (int channel = 0; channel < 4; ++channel) ASSERT_TRUE(std::isfinite(pixel[channel]));
      }
    }
  }
}

TEST(GaussianView, AnAstigmaticLensBlursAlongAndAcross) {
  // In focus across, out of focus along x: a line.
  RenderSettings settings = lens(16.0f, 0.5f);
  settings.defocus.astigmatism_D = {0.25f, 0.0f};
  settings.defocus.focus_D = 0.75f;  // 1 D along x, 0.5 D along y; the Gaussian is at 0.5 D
  const Spread sharp = spreadOf(render("pinhole", oneGaussian(), kView, {}));
  for (const char* method : {"sweep:7", "accumulate:100"}) {
    const Spread spread = spreadOf(render(method, oneGaussian(), kView, settings));
    const double added = 8.0 * 8.0 / 4.0;
    EXPECT_NEAR(spread.xx - sharp.xx, added, 2.0 * kVarianceShare * added) << method;
    EXPECT_NEAR(spread.yy - sharp.yy, 0.0, 0.1) << method;
  }
}

TEST(GaussianView, OtherMethodsSayThatTheyRenderSurfaces) {
  for (const MethodInfo& method : methods()) {
    if (method.gaussians) continue;
    try {
      makeMethod(method.name, oneGaussian());
      FAIL() << method.name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("expected one of auto, sweep"), std::string::npos);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
