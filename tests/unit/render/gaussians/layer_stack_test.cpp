// Layers of a tile: where they are worth it, and that they show what one layer shows.
#include "render/gaussians/layer_stack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "render/gaussians/gaussian_view.h"
#include "render/image/metrics.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/method.h"
#include "tests/unit/render/gaussian_scenes.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

TEST(LensPairs, WeighEachViewAlike) {
  for (const auto& [front, behind] : {std::pair(1, 7), {3, 13}, {7, 19}, {13, 7}, {7, 7}}) {
    const LensPairs pairs = pairLensDiscs(subApertureDiscs(front), subApertureDiscs(behind));
    const auto n = static_cast<std::size_t>(front), m = static_cast<std::size_t>(behind);
    for (std::size_t j = 0; j < n; ++j) {
      float sum = 0.0f;
      for (std::size_t i = 0; i < m; ++i) sum += pairs.weights[i * n + j];
      EXPECT_NEAR(sum, 1.0f, 1e-5f);
    }
    for (std::size_t i = 0; i < m; ++i) {
      const auto row = pairs.weights.begin() + static_cast<std::ptrdiff_t>(i * n);
      EXPECT_NEAR(std::accumulate(row, row + front, 0.0f) * static_cast<float>(m),
                  static_cast<float>(n), 1e-3f * static_cast<float>(n));
    }
  }
}

TEST(LensPairs, ViewsOfOneNumberMeetThemselves) {
  const LensPairs pairs = pairLensDiscs(subApertureDiscs(7), subApertureDiscs(7));
  for (std::size_t i = 0; i < 7; ++i) {
    const auto row = pairs.weights.begin() + static_cast<std::ptrdiff_t>(7 * i);
    EXPECT_EQ(std::max_element(row, row + 7) - row, static_cast<std::ptrdiff_t>(i));
  }
}

// Cubics reproduce parabolas between samples; at the edges, the parabola goes on.
TEST(InterpolateBehind, ReproducesParabolas) {
  const auto parabola = [](float x, float y) {
    return 0.3f + 0.02f * x - 0.001f * x * x + 0.004f * y * y;
  };
  auto from = std::make_unique<BehindPlanes>(), to = std::make_unique<BehindPlanes>();
  for (const int step_px : {2, 4, 8}) {
    const auto step = static_cast<float>(step_px);
    const int samples = kTile / step_px + 1;
    for (int y = 0; y < samples; ++y) {
      for (int x = 0; x < samples; ++x) {
        from->planes[BehindPlanes::coverage]
                    [placeOf(samples, static_cast<std::size_t>(x), static_cast<std::size_t>(y))] =
            parabola(step * static_cast<float>(x), step * static_cast<float>(y));
      }
    }
    interpolateBehind(
        {.from_samples = samples, .to_samples = kTile, .first = 0.5f / step, .step = 1.0f / step},
        *from, *to);
    for (std::size_t y = 0; y < kTile; ++y) {
      for (std::size_t x = 0; x < kTile; ++x) {
        EXPECT_NEAR(to->planes[BehindPlanes::coverage][placeOf(kTile, x, y)],
                    parabola(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f), 2e-4f)
            << step_px << ": " << x << " " << y;
      }
    }
  }
}

/// The linear light of display values goes with the display values, so that what is seen through
/// clear air is the mean light.
TEST(InterpolateBehind, TakesOffTheLightOfTheDisplayValues) {
  auto from = std::make_unique<BehindPlanes>(), to = std::make_unique<BehindPlanes>();
  std::fill_n(from->planes[BehindPlanes::red], placesOf(9), 0.5f);
  std::fill_n(from->planes[BehindPlanes::light_red], placesOf(9), 0.3f);
  interpolateBehind({.from_samples = 9, .to_samples = kTile, .first = 0.125f, .step = 0.25f}, *from,
                    *to);
  EXPECT_NEAR(to->planes[BehindPlanes::light_red][0], 0.3f - 0.21404f, 1e-4f);
}

/// A scattered sharp layer before far walls of many colours.
GaussianCloud leavesBeforeAWall(int seed) {
  GaussianCloud cloud;
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  const auto scatter = [&](int count, float near_m, float far_m, float sigma_m, float opacity) {
    for (int i = 0; i < count; ++i) {
      const float depth = near_m + (far_m - near_m) * unit(random);
      const float half = 0.45f * depth;
      addGaussian(
          cloud, {half * (2.0f * unit(random) - 1.0f), half * (2.0f * unit(random) - 1.0f), -depth},
          glm::vec3(sigma_m), opacity * (0.3f + 0.7f * unit(random)),
          {unit(random), unit(random), unit(random)});
    }
  };
  scatter(300, 0.95f, 1.1f, 0.01f, 0.95f);
  scatter(1500, 1.4f, 4.0f, 0.03f, 0.9f);
  return cloud;
}

const View kView = squareView(192, 200.0f);

float quantile95(std::vector<float> errors) {
  std::ranges::sort(errors);
  return errors[errors.size() * 95 / 100];
}

RenderSettings blurBehind(float blur_px) {
  // In focus at 1 m; this blur radius at 4 m.
  return {.defocus = {.radius_px_per_D = glm::vec2(blur_px / 0.75f), .focus_D = 1.0f}};
}

/// The projected scene, its layers, and the image through the same number of discs in each layer.
class Layered {
 public:
  Layered(const GaussianCloud& scene, const RenderSettings& settings)
      : settings_(settings), view_(scene) {
    discs_ = subApertureDiscs(61);
    pairs_ = pairLensDiscs(discs_, discs_);
    view_.project(kView, settings.defocus, discs_);
    layers_ = view_.divide(true);
  }
  Frame render(bool layered) {
    Frame frame;
    frame.resize(kView.size_px, true);
    if (!layered) view_.project(kView, settings_.defocus, discs_);
    std::vector<SampledErrors> errors;
    view_.render(
        [&](std::size_t) {
          TileLens lens{.discs = &discs_};
          if (layered) lens.pairs.fill(&pairs_);
          return lens;
        },
        settings_.lighting.background, frame, &errors);
    return frame;
  }
  const std::vector<TileLayers>& layers() const { return layers_; }

 private:
  RenderSettings settings_;
  GaussianView view_;
  std::vector<LensDisc> discs_;
  LensPairs pairs_;
  std::vector<TileLayers> layers_;
};

TEST(LayerStack, TellsTheErrorOfOneDisc) {
  for (const float blur_px : {2.0f, 4.0f}) {
    const GaussianCloud scene = leavesBeforeAWall(1);
    const RenderSettings settings = blurBehind(blur_px);
    const std::vector<LensDisc> one = subApertureDiscs(1), three = subApertureDiscs(3);
    GaussianView view(scene);
    std::vector<LensDisc> all = one;
    all.insert(all.end(), three.begin(), three.end());
    view.project(kView, settings.defocus, all);
    Frame frame;
    frame.resize(kView.size_px, false);
    std::vector<SampledErrors> told;
    view.render([&](std::size_t) { return TileLens{.discs = &one, .judges = &three}; },
                settings.lighting.background, frame, &told);
    double told2 = 0.0, samples = 0.0;
    for (const SampledErrors& tile : told) {
      for (std::size_t i = 0; i < tile.count; ++i) {
        told2 += double{tile.layers_jnd[0][i]} * double{tile.layers_jnd[0][i]};
      }
      samples += static_cast<double>(tile.count);
    }
    double errors2 = 0.0;
    const auto errors = visibleDifference(frame, render("accumulate:200", scene, kView, settings),
                                          kUsualPx_per_deg);
    for (const float each : errors) errors2 += double{each} * double{each};
    const double ratio =
        std::sqrt(told2 / samples) / std::sqrt(errors2 / static_cast<double>(errors.size()));
    EXPECT_GE(ratio, 1.0) << blur_px;
    EXPECT_LE(ratio, 1.5) << blur_px;
  }
}

TEST(TileLayers, AreSeveralWhereTheSceneBehindIsBlurred) {
  const auto several = [](const std::vector<TileLayers>& layers) {
    return std::ranges::count_if(layers, [](const TileLayers& each) { return each.count > 1; });
  };
  const GaussianCloud scene = leavesBeforeAWall(1);
  const Layered layered(scene, blurBehind(20.0f));
  EXPECT_GT(several(layered.layers()), 20);
  for (const TileLayers& tile : layered.layers()) {
    for (std::size_t k = 1; k < tile.count; ++k) {
      EXPECT_GT(tile.layers[k].step_px, tile.layers[k - 1].step_px);
      EXPECT_GT(tile.layers[k].size, 0u);
    }
  }
  EXPECT_EQ(several(Layered(scene, blurBehind(1.0f)).layers()), 0);
  // Focus behind all: what is blurred is nearer, and a single layer.
  RenderSettings near = blurBehind(20.0f);
  near.defocus.focus_D = 0.1f;
  EXPECT_EQ(several(Layered(scene, near).layers()), 0);
}

// Through many discs, what layers show is close to the mean of pinholes, and to one layer.
TEST(TileLayers, ShowWhatOneLayerShows) {
  for (const int seed : {1, 2}) {
    const GaussianCloud scene = leavesBeforeAWall(seed);
    const RenderSettings settings = blurBehind(20.0f);
    const Frame lens = render("accumulate:200", scene, kView, settings);
    Layered layered(scene, settings);
    const Frame through = layered.render(true), one = layered.render(false);
    EXPECT_GT(psnr_dB(through, lens), 49.0);
    constexpr float kMost_JND = 0.75f;  // of 95 % of the pixels
    EXPECT_LT(quantile95(visibleDifference(through, lens, kUsualPx_per_deg)), kMost_JND);
    double apart_m = 0.0, apart_coverage = 0.0, more_coverage = 0.0;
    bool differs = false;
    for (std::size_t i = 0; i < one.depth_m.size(); ++i) {
      apart_m += std::abs(double{one.depth_m[i]} - double{through.depth_m[i]});
      const double more = double{through.rgba[i].a} - double{one.rgba[i].a};
      more_coverage += more;
      apart_coverage += std::abs(more);
      differs = differs || one.rgba[i] != through.rgba[i];
    }
    EXPECT_TRUE(differs);  // there are several layers
    const auto pixels = static_cast<double>(one.depth_m.size());
    EXPECT_LT(apart_m / pixels, 0.02);
    EXPECT_LT(apart_coverage / pixels, 0.005);
    EXPECT_NEAR(more_coverage / pixels, 0.0, 0.001);
  }
}

TEST(TileLayers, AutoKeepsItsPrediction) {
  const GaussianCloud scene = leavesBeforeAWall(3);
  const RenderSettings settings = blurBehind(20.0f);
  const Frame lens = render("accumulate:200", scene, kView, settings);
  Frame frame;
  const RenderStats stats = makeMethod("auto", scene)->render(kView, settings, frame);
  EXPECT_LE(quantile95(visibleDifference(frame, lens, kUsualPx_per_deg)), *stats.tolerance_error);
}

}  // namespace FOCI_FILE
}  // namespace foci
