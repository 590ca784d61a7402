// Level of detail by moments, and the method that renders with it.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include "render/image/metrics.h"
#include "render/lod/cut.h"
#include "render/methods/lens_samples.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/estimation/estimate.h"
#include "render/splat/project.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kTotalVariance = 0.03;  // of the formula's, at every level
constexpr double kSums = 1e-4;           // of single precision sums over thousands

/// A ball's surface: curved, closed, oriented.
SurfelCloud ball(int n, float radius_m, const glm::vec3& center_m) {
  SurfelCloud cloud;
  cloud.oriented = true;
  const float area_m2 = 4.0f * 3.14159265f * radius_m * radius_m / static_cast<float>(n);
  for (int i = 0; i < n; ++i) {
    const float z = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(n);
    const float angle = 2.39996323f * static_cast<float>(i), r = std::sqrt(1.0f - z * z);
    const glm::vec3 normal(r * std::cos(angle), r * std::sin(angle), z);
    appendSurfel(
        cloud, center_m + radius_m * normal, normal, kSigmaPerSpacing * std::sqrt(area_m2), area_m2,
        0.5f + 0.5f * glm::vec3(std::sin(40.0f * normal.x), std::sin(30.0f * normal.y), z));
  }
  return cloud;
}

double areaOf(const LodNode& node) {
  const float* v = node.variance_m2;
  const double minors = double{v[0]} * v[3] - double{v[1]} * v[1] + double{v[0]} * v[5] -
                        double{v[2]} * v[2] + double{v[3]} * v[5] - double{v[4]} * v[4];
  return node.density * std::sqrt(std::max(minors, 0.0));
}

TEST(MomentTree, EveryLevelKeepsAreaMeanAndVariance) {
  const SurfelCloud cloud = ball(3000, 0.4f, {0.1f, 0.2f, -1.0f});
  const MomentTree tree(cloud);
  double area = 0.0;
  glm::dvec3 mean(0.0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    area += cloud.area_m2[i];
    mean += double{cloud.area_m2[i]} * glm::dvec3(cloud.position_m[i]);
  }
  mean /= area;
  double variance = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(cloud.position_m[i]) - mean;
    const glm::dvec3 u(cloud.axis_u_m[i]), v(cloud.axis_v_m[i]);
    variance += cloud.area_m2[i] * (glm::dot(d, d) + glm::dot(u, u) + glm::dot(v, v)) / area;
  }
  for (int level = 0; level < tree.levels(); ++level) {
    double level_area = 0.0, level_variance = 0.0;
    glm::dvec3 level_mean(0.0);
    const std::size_t first = std::size_t{1} << level;
    for (std::size_t i = first; i < 2 * first; ++i) {
      const double a = areaOf(tree.nodes()[i]);
      level_area += a;
      level_mean += a * glm::dvec3(tree.nodes()[i].position_m);
    }
    level_mean /= level_area;
    for (std::size_t i = first; i < 2 * first; ++i) {
      const glm::dvec3 d = glm::dvec3(tree.nodes()[i].position_m) - mean;
      level_variance +=
          areaOf(tree.nodes()[i]) / level_area * (glm::dot(d, d) + tree.nodes()[i].trace_m2());
    }
    EXPECT_NEAR(level_area / area, 1.0, kSums) << level;
    EXPECT_LT(glm::distance(level_mean, mean), kSums) << level;
    EXPECT_NEAR(level_variance / variance, 1.0, kSums) << level;
  }
}

TEST(MomentTree, KeepsWithinAHundredBytesASurfel) {
  for (const int n : {1000, 1500, 3000, 6143}) {
    const MomentTree tree(ball(n, 0.4f, {0, 0, -1}));
    const SurfelCloud& surfels = tree.surfels();
    const std::size_t bytes = tree.nodes().size() * sizeof(LodNode) +
                              surfels.size() * (4 * sizeof(glm::vec3) + sizeof(float)) +
                              surfels.opacity.size() * sizeof(float);
    EXPECT_LE(bytes, 100u * n) << n;
  }
}

TEST(MomentTree, SurfelsLieWithinTheirNodes) {
  const MomentTree tree(ball(2000, 0.4f, {0, 0, -1}));
  for (int level = 0; level < tree.levels(); ++level) {
    for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
      const LodNode& node = tree.nodes()[(std::size_t{1} << level) + j];
      const auto [begin, end] = tree.range(level, j);
      ASSERT_LT(begin, end);
      for (std::size_t i = begin; i < end; ++i) {
        EXPECT_LE(glm::distance(tree.surfels().position_m[i], node.position_m), node.radius_m);
      }
    }
  }
}

TEST(MomentTree, NormalsAreKeptToAHundredthOfADegree) {
  std::mt19937 random(4);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 n = glm::normalize(glm::vec3{normal(random), normal(random), normal(random)});
    std::int16_t packed[2];
    packNormal(n, packed);
    EXPECT_LT(glm::degrees(glm::distance(unpackNormal(packed), n)), 0.01f);
  }
}

TEST(Cut, WeightsSumToOneAboveEverySurfel) {
  const MomentTree tree(ball(5000, 0.4f, {0, 0, -2}));
  const View view = squareViewOf(400, 600.0f);
  for (const float focus_D : {0.0f, 0.4f, 0.5f, 0.6f}) {
    Cut cut;
    selectCut(tree, view, {.radius_px_per_D = glm::vec2(100.0f), .focus_D = focus_D},
              {.per_blur2 = 0.01f, .per_pixel2 = 0.1f, .foreshortened = true}, cut);
    std::vector<float> sum(tree.surfels().size(), 0.0f);
    for (const CutEntry& entry : cut.surfels) sum[entry.index] += entry.weight;
    for (const CutRange& range : cut.ranges) {
      ASSERT_LE(range.end - range.begin, Cut::kLongestRange);
      for (std::uint32_t i = range.begin; i < range.end; ++i) sum[i] += 1.0f;
    }
    for (const CutEntry& entry : cut.nodes) {
      const int level = static_cast<int>(std::bit_width(entry.index)) - 1;
      const auto [begin, end] = tree.range(level, entry.index - (std::size_t{1} << level));
      for (std::size_t i = begin; i < end; ++i) sum[i] += entry.weight;
    }
    for (const float s : sum) ASSERT_NEAR(s, 1.0f, 1e-5f);
  }
}

TEST(Cut, IsCoarserWhereBlurIsLarger) {
  const MomentTree tree(ball(20000, 0.4f, {0, 0, -2}));
  const View view = squareViewOf(400, 600.0f);
  std::size_t before = 20001;
  for (const float radius_px_per_D : {0.0f, 20.0f, 40.0f, 80.0f, 160.0f}) {
    Cut cut;
    selectCut(tree, view, {.radius_px_per_D = glm::vec2(radius_px_per_D), .focus_D = 2.0f},
              {.per_blur2 = 0.01f, .per_pixel2 = 0.01f}, cut);
    EXPECT_LT(cut.size(), before) << radius_px_per_D;
    before = cut.size();
  }
  EXPECT_LT(before, 2000u);
}

/// A sheet 20 m away, 4 m wide, whose normal makes the given angle with the line of sight.
SurfelCloud sheetAtAngle(float angle_deg) {
  SurfelCloud cloud;
  const float angle = glm::radians(angle_deg);
  addSheetOf(cloud, {.center_m = {0, 0, -20},
                     .up = {0.0f, std::cos(angle), -std::sin(angle)},
                     .side_m = 4.0f,
                     .samples = 500});
  std::mt19937 random(5);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.color[i] = glm::vec3(static_cast<float>(random() >> 8) / (1 << 24));
  }
  return cloud;
}

TEST(Cut, TakesFewerNodesOfASurfaceThatIsSeenEdgeOn) {
  // The low-pass of an edge-on node may be wider by sqrt(8 / 3), so that nodes are fewer by that.
  const auto ratioAt = [](float angle_deg) {
    const MomentTree tree(sheetAtAngle(angle_deg));
    double sizes[2];
    for (const bool foreshortened : {false, true}) {
      CutSettings settings = kFaithfulCut;
      settings.foreshortened = foreshortened;
      Cut cut;
      double sum = 0.0;
      for (int step = 0; step < 8; ++step) {  // over one level of the tree
        const float focal_px = 300.0f * std::exp2(static_cast<float>(step) / 16.0f);
        selectCut(tree, squareViewOf(400, focal_px), {}, settings, cut);
        sum += static_cast<double>(cut.size());
      }
      sizes[foreshortened] = sum;
    }
    return sizes[false] / sizes[true];
  };
  EXPECT_NEAR(ratioAt(0.0f), 1.0, 0.02);  // the corners are seen at 8 degrees
  EXPECT_NEAR(ratioAt(85.0f), std::sqrt(8.0 / 3.0), 0.25);
}

TEST(SweepLod, LooksAsEverySurfelWhereASurfaceIsSeenEdgeOn) {
  for (const float angle_deg : {70.0f, 85.0f}) {
    const SurfelCloud cloud = sheetAtAngle(angle_deg);
    const View view = squareViewOf(200, 500.0f);
    const Frame every = renderedBy("sweep", cloud, view, {});
    EXPECT_GE(psnr_dB(renderedBy("sweep-lod:1", cloud, view, {}), every), 50.0) << angle_deg;
    EXPECT_GE(psnr_dB(renderedBy("auto:1", cloud, view, {}), every), 45.0) << angle_deg;
  }
}

TEST(Cut, TakesSurfelsAsTheyLieWhereNoNodeIsCoarseEnough) {
  const MomentTree tree(ball(20000, 0.4f, {0, 0, -2}));
  const View view = squareViewOf(400, 600.0f);
  const auto cutOf = [&](float per_pixel2) {
    Cut cut;
    selectCut(tree, view, {}, {.per_blur2 = 0.01f, .per_pixel2 = per_pixel2}, cut);
    return cut;
  };
  const Cut fine = cutOf(1e-6f);
  EXPECT_TRUE(fine.nodes.empty());
  EXPECT_EQ(fine.surfels.size(), 0u);
  EXPECT_EQ(fine.size(), tree.surfels().size());
  EXPECT_TRUE(cutOf(100.0f).ranges.empty());
}

TEST(Cut, LeavesOutNodesThatCannotTouchTheImage) {
  const MomentTree tree(ball(5000, 0.1f, {0, 0, 2}));  // behind the eye
  Cut cut;
  selectCut(tree, squareViewOf(64, 100.0f), {}, {.per_blur2 = 0.01f, .per_pixel2 = 0.1f}, cut);
  EXPECT_EQ(cut.size(), 0u);
}

/// The image's 32 px wide squares whose corners are a multiple of 48 px.
std::vector<View> squaresOf(const View& view) {
  std::vector<View> squares;
  for (int y = 0; y + 32 <= view.size_px.y; y += 48) {
    for (int x = 0; x + 32 <= view.size_px.x; x += 48) {
      View square = view;
      square.size_px = glm::ivec2(32);
      square.principal_px -= glm::vec2(x, y);
      squares.push_back(square);
    }
  }
  return squares;
}

TEST(Cut, HasEverySplatThatTouchesTheImage) {
  // A cut with a wide margin reaches far beyond the square, so it lacks nothing that touches it.
  const MomentTree tree(ball(20000, 0.4f, {0, 0, -1.5f}));
  const Defocus round{.radius_px_per_D = glm::vec2(40.0f), .focus_D = 1.5f};
  Defocus astigmatic = round;
  astigmatic.astigmatism_D = {0.2f, 0.1f};
  const Acuity soft{.gaze_px = {40.0f, 60.0f}, .base_px = 1.0f, .per_px = 0.05f};
  for (const Defocus& defocus : {Defocus{}, round, astigmatic}) {
    for (const float coarser : {0.01f, 1.0f, 20.0f}) {
      for (const Acuity& acuity : {Acuity{}, soft}) {
        for (const View& square : squaresOf(squareViewOf(400, 600.0f))) {
          const auto splatsOf = [&](int margin_px) {
            CutSettings settings{.per_blur2 = coarser * kFaithfulCut.per_blur2,
                                 .per_pixel2 = coarser * kFaithfulCut.per_pixel2,
                                 .acuity = acuity,
                                 .margin_px = margin_px};
            Cut cut;
            selectCut(tree, square, defocus, settings, cut);
            SplatChunks chunks;
            projectCut(tree, cut, square, defocus, {.acuity = acuity}, chunks);
            return chunks.total();
          };
          EXPECT_EQ(splatsOf(0), splatsOf(1000));
        }
      }
    }
  }
}

TEST(Cut, OfASmallSquareTakesFewSurfelsBesideIt) {
  const MomentTree tree(ball(200000, 0.4f, {0, 0, -1.5f}));
  const CutSettings fine{.per_blur2 = 0.0f, .per_pixel2 = 1e-6f};
  std::size_t taken = 0, within = 0;
  for (const View& square : squaresOf(squareViewOf(400, 600.0f))) {
    Cut cut;
    selectCut(tree, square, {}, fine, cut);
    SplatChunks chunks;
    projectCut(tree, cut, square, {}, {}, chunks);
    taken += cut.size();
    within += chunks.total();
  }
  EXPECT_LT(taken, 3 * within);
}

TEST(SweepLod, TotalVarianceIsTheFormulasAtEveryLevel) {
  // A white sheet 16 px wide of 96 x 96 surfels, blurred more and more: levels from the surfels
  // themselves to a few nodes. Its own variance is side^2 / 12.
  SurfelCloud cloud;
  addSheetOf(cloud, {.center_m = {0, 0, -1}, .side_m = 0.016f, .samples = 96});
  const View view = squareViewOf(420, 1000.0f);
  const double sigma_px = kSigmaPerSpacing * 16.0 / 96.0;
  std::uint64_t before = 96 * 96 + 1;
  for (const float radius_px : {0.0f, 1.0f, 2.0f, 4.0f, 8.0f, 16.0f, 32.0f, 64.0f}) {
    double mass = 0.0, variance = 0.0;
    std::uint64_t splats = 0;
    for (int place = 0; place < 16; ++place) {  // samples lie up to 8 px apart
      SurfelCloud moved = cloud;
      for (glm::vec3& p_m : moved.position_m) {
        p_m += glm::vec3(place % 4, place / 4, 0) * 0.00225f;
      }
      RenderStats stats;
      const FrameMoments m =
          frameMoments(renderedBy("sweep-lod", moved, view, blurredBy(radius_px, 0.0f), &stats));
      mass += m.mass / 16.0;
      variance += 0.5 * (m.variance_x + m.variance_y) / 16.0;
      splats = std::max(splats, stats.splats);
    }
    const double formula =
        16.0 * 16.0 / 12.0 + sigma_px * sigma_px + 1.0 + 0.25 * radius_px * radius_px;
    EXPECT_NEAR(variance / formula, 1.0, kTotalVariance) << radius_px << " px";
    EXPECT_NEAR(mass / 256.0, 1.0, 0.01) << radius_px << " px";
    EXPECT_LE(splats, before) << radius_px << " px";
    before = splats;
  }
  EXPECT_LE(before, 32u);
}

TEST(SweepLod, ATexturesPointHasTheFormulasVarianceAtEveryLevel) {
  // One bright surfel of a dark sheet, in 64 places. Its light spreads about its own place.
  for (const float radius_px : {2.0f, 6.0f, 20.0f}) {
    double all_mass = 0.0, all_square = 0.0;
    for (int place = 0; place < 64; ++place) {
      SurfelCloud cloud;
      // The sheet moves, so that nodes lie differently between samples up to 8 px apart.
      const glm::vec3 center_m(0.00225f * static_cast<float>(place % 4),
                               0.00225f * static_cast<float>(place / 4 % 4), -1.0f);
      addSheetOf(cloud, {.center_m = center_m, .side_m = 0.128f, .samples = 128, .color = {}});
      const std::size_t i = (56 + place * 5 % 8) * 128 + 56 + place * 7 / 8 % 8;
      cloud.color[i] = glm::vec3(100.0f);
      const Frame frame =
          renderedBy("sweep-lod", cloud, squareViewOf(200, 1000.0f), blurredBy(radius_px, 0.0f));
      const double x = 100.0 + 1000.0 * cloud.position_m[i].x;
      const double y = 100.0 - 1000.0 * cloud.position_m[i].y;
      double mass = 0.0, square = 0.0;
      for (int py = 0; py < 200; ++py) {
        for (int px = 0; px < 200; ++px) {
          const double light = frame.at(px, py).r, dx = px + 0.5 - x, dy = py + 0.5 - y;
          mass += light;
          square += light * (dx * dx + dy * dy);
        }
      }
      all_mass += mass;
      all_square += 0.5 * square;
    }
    const double formula = 1.0 + kSigmaPerSpacing * kSigmaPerSpacing + 0.25 * radius_px * radius_px;
    EXPECT_NEAR(all_square / all_mass / formula, 1.0, kTotalVariance) << radius_px << " px";
  }
}

TEST(SweepLod, LooksAsTheReferenceWhereACardHidesAPlane) {
  // Card and plane are blurred, with the focus between them. The lens sees around the card's edges.
  SurfelCloud cloud;
  addSheetOf(cloud, {.center_m = {0.03f, 0, -0.8f},
                     .side_m = 0.12f,
                     .samples = 120,
                     .color = {0.9f, 0.3f, 0.1f}});
  addSheetOf(
      cloud,
      {.center_m = {0, 0, -1.6f}, .side_m = 1.0f, .samples = 256, .color = {0.1f, 0.4f, 0.8f}});
  const View view = squareViewOf(200, 400.0f);
  const RenderSettings settings = blurredBy(24.0f, 0.9f);
  const Frame reference = renderedBy("accumulate:400", cloud, view, settings);
  EXPECT_GT(psnr_dB(renderedBy("sweep-lod", cloud, view, settings), reference), 42.0);
}

TEST(SweepLod, LensSidesTellWhatACardHides) {
  // A copy of the card far behind it must not be visible beside it.
  SurfelCloud cloud;
  addSheetOf(cloud, {.center_m = {0, 0, -1.0f}, .side_m = 0.1f, .samples = 100});
  addSheetOf(cloud, {.center_m = {0, 0, -1.2f}, .side_m = 0.12f, .samples = 100});
  const View view = squareViewOf(200, 500.0f);
  const RenderSettings settings = blurredBy(16.0f, 0.0f);  // 16 and 13 px
  const Frame reference = renderedBy("accumulate:400", cloud, view, settings);
  EXPECT_GT(psnr_dB(renderedBy("sweep", cloud, view, settings), reference), 36.0);
}

TEST(SweepLod, ABallsBlurredOutlineIsSmooth) {
  // Nodes whose mean normal lies across the line of sight: each lens point sees another share.
  const SurfelCloud cloud = ball(60'000, 0.25f, {0, 0, -1.0f});
  const View view = squareViewOf(96, 171.0f);
  RenderSettings settings = blurredBy(9.3f, 1.0f / 0.75f);  // 3 px at the outline
  settings.lighting.background = glm::vec3(0.8f);
  const Frame reference = renderedBy("accumulate:200", cloud, view, settings);
  for (const char* method : {"sweep", "sweep-lod:1", "sweep-lod:7"}) {
    const Frame frame = renderedBy(method, cloud, view, settings);
    float worst = 0.0f;
    for (std::size_t p = 0; p < frame.rgba.size(); ++p) {
      worst = std::max(worst, glm::length(frame.rgba[p] - reference.rgba[p]));
    }
    EXPECT_LT(worst, 0.1f) << method;
  }
}

TEST(SweepLod, ConstantSheetStaysConstantAcrossCoarseTiles) {
  SurfelCloud cloud;
  addSheetOf(cloud, {.side_m = 0.6f, .samples = 300, .color = {0.2f, 0.5f, 0.8f}});
  const View view = squareViewOf(300, 1000.0f);
  for (const float radius_px : {4.0f, 12.0f, 24.0f, 48.0f}) {
    const Frame frame = renderedBy("sweep-lod", cloud, view, blurredBy(radius_px, 0.0f));
    double off = 0.0;
    for (const glm::vec4& pixel : frame.rgba) {
      ASSERT_NEAR(pixel.a, 1.0f, 0.05f) << radius_px;
      ASSERT_NEAR(pixel.g, 0.5f, 0.025f) << radius_px;
      off += std::abs(pixel.a - 1.0f);
    }
    EXPECT_LE(off / static_cast<double>(frame.rgba.size()), 0.01) << radius_px;
  }
}

TEST(SweepLod, CoversAJitteredPlaneEvenlyAtEveryLevel) {
  // One surfel for each pixel on average, each anywhere in its square. At a coverage of a half both
  // too much and too little are visible.
  constexpr int kSide = 146;
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  PointCloud points;
  for (int i = 0; i < kSide * kSide; ++i) {
    const float x = static_cast<float>(i % kSide) + uniform() - 0.5f * kSide;
    points.position_m.emplace_back(
        1e-3f * glm::vec3(x, static_cast<float>(i / kSide) + uniform() - 0.5f * kSide, -1000.0f));
  }
  points.color.assign(points.size(), glm::vec3(1.0f));
  SurfelCloud cloud = surfelsFromPoints(std::move(points), {.solve = KernelSolve::thorough});
  for (float& area_m2 : cloud.area_m2) area_m2 *= 0.5f;
  const auto shareOff = [&](float radius_px, float tolerance) {
    const Frame frame =
        renderedBy("sweep-lod", cloud, squareViewOf(80, 1000.0f), blurredBy(radius_px, 0.0f));
    const auto off = std::count_if(frame.rgba.begin(), frame.rgba.end(), [&](const glm::vec4& p) {
      return std::abs(2.0f * p.a - 1.0f) > tolerance;
    });
    return static_cast<double>(off) / static_cast<double>(frame.rgba.size());
  };
  EXPECT_LE(shareOff(0.0f, 0.02f), 0.01);
  for (const float radius_px : {3.0f, 6.0f, 10.0f, 14.0f}) {
    EXPECT_LE(shareOff(radius_px, 0.02f), 0.05) << radius_px;  // discs sampled by nodes ripple
    EXPECT_LE(shareOff(radius_px, 0.04f), 0.01) << radius_px;
  }
}

TEST(SweepLod, LittlePopsAsFocusMoves) {
  // The method without levels shows how much else changes from frame to frame.
  const SurfelCloud cloud = ball(20000, 0.4f, {0, 0, -2});
  const View view = squareViewOf(200, 300.0f);
  const auto frameAt = [&](const char* method, int step) {
    return renderedBy(method, cloud, view,
                      blurredBy(60.0f, 0.30f + 0.01f * static_cast<float>(step)));
  };
  Frame lod = frameAt("sweep-lod:1", 0), all = frameAt("sweep", 0);
  for (int step = 1; step <= 20; ++step) {
    const Frame next_lod = frameAt("sweep-lod:1", step), next_all = frameAt("sweep", step);
    std::size_t popped = 0;
    for (std::size_t i = 0; i < lod.rgba.size(); ++i) {
      const glm::vec4 extra =
          glm::abs((next_lod.rgba[i] - lod.rgba[i]) - (next_all.rgba[i] - all.rgba[i]));
      popped += std::max({extra.r, extra.g, extra.b}) > 0.03f;
    }
    EXPECT_LE(popped, lod.rgba.size() / 100) << step;
    lod = next_lod;
    all = next_all;
  }
}

TEST(SweepLod, SameBytesAtAnyNumberOfThreads) {
  const SurfelCloud cloud = ball(20000, 0.4f, {0, 0, -2});
  const View view = squareViewOf(200, 300.0f);
  std::vector<Frame> frames;
  for (const int threads : {1, 2, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    frames.push_back(renderedBy("sweep-lod", cloud, view, blurredBy(60.0f, 0.4f)));
  }
  for (const Frame& frame : frames) {
    EXPECT_EQ(0, std::memcmp(frame.rgba.data(), frames[0].rgba.data(),
                             frame.rgba.size() * sizeof(glm::vec4)));
  }
}

TEST(SweepLod, ExtremeScenesAreRendered) {
  const View view = squareViewOf(64, 100.0f);
  const auto finite = [&](const SurfelCloud& cloud, float radius_px_per_D) {
    const Frame frame = renderedBy("sweep-lod", cloud, view, blurredBy(radius_px_per_D, 0.5f));
    return std::all_of(frame.rgba.begin(), frame.rgba.end(), [](const glm::vec4& p) {
      return std::isfinite(p.r) && p.r >= 0.0f && p.a >= 0.0f && p.a <= 1.0f;
    });
  };
  for (const float blur : {0.0f, 3.0f, 1000.0f}) {
    EXPECT_TRUE(finite(SurfelCloud(), blur));
    SurfelCloud one, same, sizes, behind;
    const glm::vec3 up(0, 0, 1), white(1.0f);
    appendSurfel(one, {0, 0, -1}, up, 0.01f, 4e-4f, white);
    EXPECT_TRUE(finite(one, blur));
    for (int i = 0; i < 1000; ++i) appendSurfel(same, {0, 0, -1}, up, 0.01f, 4e-4f, white);
    EXPECT_TRUE(finite(same, blur));
    for (int i = 0; i < 100; ++i) {
      const float sigma_m = std::pow(10.0f, -7.0f + 9.0f * static_cast<float>(i) / 99.0f);
      appendSurfel(sizes, {0, 0, -1.0f - 0.01f * static_cast<float>(i)}, up, sigma_m,
                   4.0f * sigma_m * sigma_m, white);
      appendSurfel(behind, {0, 0, 1.0f - 0.02f * static_cast<float>(i)}, up, 0.1f, 0.04f, white);
    }
    EXPECT_TRUE(finite(sizes, blur));
    EXPECT_TRUE(finite(behind, blur));
  }
}

TEST(SubApertures, HaveTheDiscsMeanAndVariance) {
  for (const int n : {3, 4, 7, 16, 19, 100}) {
    glm::vec2 mean(0.0f);
    float xx = 0.0f, xy = 0.0f, yy = 0.0f;
    for (const glm::vec2& part : subApertureCentres(n)) {
      mean += part / static_cast<float>(n);
      xx += part.x * part.x / static_cast<float>(n);
      xy += part.x * part.y / static_cast<float>(n);
      yy += part.y * part.y / static_cast<float>(n);
    }
    EXPECT_LT(glm::length(mean), 1e-5f) << n;
    EXPECT_NEAR(xx, 0.25f, 1e-5f) << n;
    EXPECT_NEAR(yy, 0.25f, 1e-5f) << n;
    EXPECT_NEAR(xy, 0.0f, 1e-5f) << n;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
