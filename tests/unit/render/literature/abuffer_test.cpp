#include "render/literature/paper/abuffer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "render/literature/paper/project.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kTolerance =
    4e-5f;  // the kernel's exponential, twice, and sums of some dozen terms
// Whether a pixel centre lies inside a rim may depend on rounding.
constexpr int kRimPixels = 3;

PaperSplats listed(const std::vector<PaperSplat>& splats, const glm::ivec2& size_px) {
  PaperSplats out;
  out.reserve(splats.size());
  out.chunks = {{0, static_cast<std::uint32_t>(splats.size())}};
  const glm::ivec2 last = (size_px - 1) / kPaperTile_px;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    out.splats[i] = splats[i];
    out.tiles[i] = {0, static_cast<std::uint16_t>(last.x), 0, static_cast<std::uint16_t>(last.y)};
  }
  return out;
}

Frame rendered(const PaperSplats& splats, const glm::ivec2& size_px, const glm::vec3& background,
               bool transparent, std::uint64_t* fragments = nullptr) {
  const std::size_t pixels = static_cast<std::size_t>(size_px.x) * size_px.y;
  Frame frame{.size_px = size_px,
              .rgba = std::vector<glm::vec4>(pixels),
              .depth_m = std::vector<float>(pixels)};
  PaperTileLists lists;
  lists.build(splats, size_px);
  const std::uint64_t count = renderABuffer(splats, lists, background, transparent, true, frame);
  if (fragments) *fragments = count;
  return frame;
}

/// Covers all of a small image with one weight.
PaperSplat veil(float near_m, float far_m, float weight, const glm::vec3& color,
                float opacity = 1.0f) {
  const glm::vec3 c = color * opacity;
  return {.x_px = 0.0f,
          .y_px = 0.0f,
          .qa = 0.0f,
          .qb = 0.0f,
          .qc = 0.0f,
          .height = weight * std::exp(-kPaperCutoff),
          .red = c.r,
          .green = c.g,
          .blue = c.b,
          .opacity = opacity,
          .near_m = near_m,
          .far_m = far_m,
          .distance_m = 0.5f * (near_m + far_m),
          .extent_x_px = 1e4f,
          .extent_y_px = 1e4f};
}

glm::vec4 pixelOf(const std::vector<PaperSplat>& splats, bool transparent) {
  const glm::ivec2 size_px(7, 5);
  return rendered(listed(splats, size_px), size_px, glm::vec3(0.0f), transparent).at(3, 2);
}

void expectNear(const glm::vec4& a, const glm::vec4& b) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(a[i], b[i], kTolerance) << "channel " << i;
}

const glm::vec3 kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1);

TEST(ABuffer, FragmentsWhoseRangesMeetMerge) {
  // Weights and colours add: 0.4 + 0.4 covers 0.8.
  expectNear(pixelOf({veil(1, 2, 0.4f, kRed), veil(1.5f, 3, 0.4f, kGreen)}, false),
             {0.4f, 0.4f, 0.0f, 0.8f});
  // Ranges that only touch meet too.
  expectNear(pixelOf({veil(1, 2, 0.4f, kRed), veil(2, 3, 0.4f, kGreen)}, false),
             {0.4f, 0.4f, 0.0f, 0.8f});
}

TEST(ABuffer, FragmentsWhoseRangesDoNotMeetHideOneAnother) {
  // In any order of insertion, the front fragment covers 0.4 and the next one 0.4 of the rest.
  for (const bool swapped : {false, true}) {
    std::vector<PaperSplat> splats = {veil(1, 2, 0.4f, kRed), veil(2.5f, 3, 0.4f, kGreen)};
    if (swapped) std::reverse(splats.begin(), splats.end());
    expectNear(pixelOf(splats, false), {0.4f, 0.24f, 0.0f, 0.64f});
  }
}

TEST(ABuffer, AFragmentThatMeetsSeveralMergesThemAll) {
  std::vector<PaperSplat> splats = {veil(1, 2, 0.2f, kRed), veil(3, 4, 0.2f, kGreen),
                                    veil(5, 6, 0.2f, kBlue), veil(9, 10, 0.5f, kBlue),
                                    veil(1.5f, 5.5f, 0.2f, kRed)};
  std::sort(splats.begin(), splats.end(),
            [](const PaperSplat& a, const PaperSplat& b) { return a.near_m < b.near_m; });
  do {
    expectNear(pixelOf(splats, false), {0.4f, 0.2f, 0.2f + 0.2f * 0.5f, 0.8f + 0.2f * 0.5f});
  } while (std::next_permutation(
      splats.begin(), splats.end(),
      [](const PaperSplat& a, const PaperSplat& b) { return a.near_m < b.near_m; }));
}

TEST(ABuffer, ColourIsDividedByAWeightAboveOne) {
  expectNear(
      pixelOf({veil(1, 2, 1.5f, kRed), veil(1, 2, 0.5f, kGreen), veil(3, 4, 1, kBlue)}, false),
      {0.75f, 0.25f, 0.0f, 1.0f});
}

TEST(ABuffer, OpacityIsTheMeanOfTheSurface) {
  // alpha = min(1, 2) * 0.25, then min(1, 0.5) * 0.5 of the rest.
  expectNear(pixelOf({veil(1, 2, 2.0f, kRed, 0.25f), veil(3, 4, 0.5f, kGreen, 0.5f)}, true),
             {0.25f, 0.75f * 0.25f, 0.0f, 1.0f - 0.75f * 0.75f});
}

TEST(ABuffer, ListsGrowAsLongAsNeeded) {
  // n fragments of weight w one behind the other leave (1 - w)^n. They are inserted in random
  // order, with a fragment of infinite range behind them.
  constexpr int kVeils = 150;
  std::vector<PaperSplat> splats;
  for (int i = 0; i < kVeils; ++i) {
    const auto z_m = static_cast<float>(i);
    splats.push_back(veil(z_m, z_m + 0.5f, 0.01f, kGreen));
  }
  std::shuffle(splats.begin(), splats.end(), std::mt19937(1));
  const float left = std::pow(0.99f, static_cast<float>(kVeils));
  expectNear(pixelOf(splats, false), {0.0f, 1.0f - left, 0.0f, 1.0f - left});
  // A fragment that spans all of them merges them into one surface of weight 1.5 + 1.
  splats.push_back(veil(0.0f, std::numeric_limits<float>::infinity(), 1.0f, kRed));
  expectNear(pixelOf(splats, false), {0.4f, 0.6f, 0.0f, 1.0f});
}

TEST(ABuffer, CountsOnlyPixelsOfTheImage) {
  for (const glm::ivec2 size_px : {glm::ivec2(1, 1), glm::ivec2(33, 7), glm::ivec2(70, 65)}) {
    std::uint64_t fragments = 0;
    rendered(listed({veil(1, 2, 0.5f, kRed), veil(3, 4, 0.5f, kRed)}, size_px), size_px,
             glm::vec3(0.0f), false, &fragments);
    EXPECT_EQ(fragments, 2u * size_px.x * size_px.y);
  }
}

/// One pixel by the definition: sorts all fragments, unites their ranges, and composites them.
glm::vec4 byDefinition(const PaperSplats& splats, const glm::dvec2& at_px,
                       const glm::vec3& background, double& depth_m, std::uint64_t& fragments) {
  struct Fragment {
    double near_m, far_m, weight, opacity, distance;
    glm::dvec3 color;
  };
  std::vector<Fragment> list;
  for (std::uint32_t i = 0; i < splats.chunks[0].count; ++i) {
    const PaperSplat& s = splats.splats[i];
    const double dx = at_px.x - s.x_px, dy = at_px.y - s.y_px;
    const double q = s.qa * dx * dx + s.qb * dx * dy + s.qc * dy * dy;
    if (q >= kPaperCutoff) continue;
    const double w = s.height * std::exp(kPaperCutoff - q);
    list.push_back({s.near_m, s.far_m, w, w * s.opacity, w * s.opacity * s.distance_m,
                    w * glm::dvec3(s.red, s.green, s.blue)});
  }
  fragments += list.size();
  std::sort(list.begin(), list.end(),
            [](const Fragment& a, const Fragment& b) { return a.near_m < b.near_m; });
  glm::dvec3 color(0.0);
  double through = 1.0, depth = 0.0;
  for (std::size_t i = 0; i < list.size();) {
    Fragment layer = list[i++];
    for (; i < list.size() && list[i].near_m <= layer.far_m; ++i) {
      layer.far_m = std::max(layer.far_m, list[i].far_m);
      layer.weight += list[i].weight;
      layer.opacity += list[i].opacity;
      layer.distance += list[i].distance;
      layer.color += list[i].color;
    }
    const double scale = through / std::max(1.0, layer.weight);
    color += scale * layer.color;
    depth += scale * layer.distance;
    through -= scale * layer.opacity;
  }
  depth_m = through < 1.0 ? depth / (1.0 - through) : 0.0;
  return {color + through * glm::dvec3(background), 1.0 - through};
}

TEST(ABuffer, AgreesWithTheDefinitionAtEachPixel) {
  for (const bool transparent : {false, true}) {
    for (const float blur_px_per_D : {0.0f, 3.0f, 20.0f}) {
      const SurfelCloud cloud = scattered(1500, 7, transparent);
      const View view = squareViewOf(101, 100.0f);
      const glm::vec3 background(0.1f, 0.2f, 0.3f);
      PaperSplats splats;
      splats.reserve(cloud.size());
      splats.chunks = {{0, projectPaper({.count = cloud.size(),
                                         .position_m = cloud.position_m.data(),
                                         .axis_u_m = cloud.axis_u_m.data(),
                                         .axis_v_m = cloud.axis_v_m.data(),
                                         .color = cloud.color.data(),
                                         .opacity = transparent ? cloud.opacity.data() : nullptr,
                                         .area_m2 = cloud.area_m2.data()},
                                        view, blurredBy(blur_px_per_D, 0.7f).defocus, {},
                                        splats.splats.get(), splats.tiles.get())}};
      std::uint64_t fragments = 0, expected_fragments = 0;
      const Frame frame = rendered(splats, view.size_px, background, transparent, &fragments);
      int differ = 0;
      for (int y = 0; y < view.size_px.y; ++y) {
        for (int x = 0; x < view.size_px.x; ++x) {
          double depth_m = 0.0;
          const glm::vec4 expected =
              byDefinition(splats, {x + 0.5, y + 0.5}, background, depth_m, expected_fragments);
          const glm::vec4 off = glm::abs(frame.at(x, y) - expected);
          const double depth_off =
              std::abs(frame.depth_m[static_cast<std::size_t>(y) * view.size_px.x + x] - depth_m);
          differ += std::max({off.r, off.g, off.b, off.a}) > kTolerance || depth_off > 4e-4;
        }
      }
      EXPECT_LE(differ, kRimPixels) << "blur " << blur_px_per_D << " transparent " << transparent;
      EXPECT_NEAR(static_cast<double>(fragments), static_cast<double>(expected_fragments),
                  kRimPixels);
      EXPECT_GT(fragments, 20000u);
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
