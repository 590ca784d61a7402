#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/reproduce/reproduce.h"
#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "base/base64.h"
#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAsThePaperCounted = 0.15;

ReproduceRow row(const char* method, std::size_t aperture, unsigned threads, double ms,
                 double psnr_dB = 50.0) {
  return {.scene = "s",
          .aperture = aperture,
          .method = method,
          .ms_median = ms,
          .ms_min = ms,
          .threads = threads,
          .psnr_dB = psnr_dB,
          .silhouette_psnr_dB = {}};
}

/// Bands of surfels one behind the other; the first is in focus.
ReproduceScene steps(double depth_step_m) {
  ReproduceScene scene = planeScene(2);
  scene.name = "steps";
  SurfelCloud cloud;
  for (int i = 0; i < 1200; ++i) {
    const float x = static_cast<float>(i % 40) / 40.0f - 0.5f;
    const float y = static_cast<float>(i / 40) / 40.0f - 0.4f;
    const auto z = static_cast<float>(-2.0 - depth_step_m * (i % 7));
    appendSurfel(cloud, {x, y, z}, {0.0f, 0.0f, 1.0f}, 0.01f, 3e-4f, glm::vec3(0.5f));
  }
  scene.scene = {std::move(cloud)};
  scene.view = viewOfCamera(glm::mat4(1.0f), {128, 128}, 0.8);
  scene.settings.defocus.focus_D = 0.5f;
  return scene;
}

TEST(RunInTurn, TakesTurnsUntilEachHasHadItsRuns) {
  std::string order;
  std::vector<TimedRun> runs;
  for (const auto& [name, times] : {std::pair{'a', 3}, {'b', 1}, {'c', 2}}) {
    runs.push_back({.run_ms =
                        [&order, name = name] {
                          order += name;
                          return static_cast<double>(order.size());
                        },
                    .runs = times});
  }
  runInTurn(runs);
  EXPECT_EQ(order, "abcaca");
  EXPECT_EQ(runs[0].ms, (std::vector<double>{1.0, 4.0, 6.0}));
}

TEST(Median, IsTheMiddle) {
  EXPECT_EQ(median({3.0}), 3.0);
  EXPECT_EQ(median({9.0, 1.0, 4.0}), 4.0);
  EXPECT_EQ(median({9.0, 1.0, 4.0, 5.0}), 4.5);
}

TEST(Base64Text, MatchesTheVectorsOfRfc4648) {
  for (const auto& [text, expected] : {std::pair<std::string, std::string>{"", ""},
                                       {"f", "Zg=="},
                                       {"fo", "Zm8="},
                                       {"foo", "Zm9v"},
                                       {"foob", "Zm9vYg=="},
                                       {"fooba", "Zm9vYmE="},
                                       {"foobar", "Zm9vYmFy"}}) {
    std::ostringstream out;
    Base64 base64(out);
    base64.add(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    base64.finish();
    EXPECT_EQ(out.str(), expected);
  }
}

TEST(GridOf, PutsImagesSideBySideUnderTheirTitles) {
  const auto plain = [](std::uint8_t value) {
    return Image{.size_px = {4, 3}, .rgb = std::vector<std::uint8_t>(36, value)};
  };
  const Image grid = gridOf({{plain(10), plain(20)}, {plain(30), plain(40)}}, {"a", "b"});
  ASSERT_EQ(grid.size_px, glm::ivec2(4 + 8 + 4, 28 + 3 + 8 + 3));
  const auto at = [&](int x, int y) { return grid.rgb[3u * (y * grid.size_px.x + x)]; };
  EXPECT_EQ(at(3, 28), 10);
  EXPECT_EQ(at(12, 30), 20);
  EXPECT_EQ(at(0, 39), 30);
  EXPECT_EQ(at(15, 41), 40);
  EXPECT_EQ(at(5, 29), 255);
}

TEST(DifferenceOf, AmplifiesDifferences) {
  Frame a{.size_px = {2, 1}, .rgba = {glm::vec4(0.2f), glm::vec4(0.5f)}, .depth_m = {}};
  Frame b = a;
  b.rgba[1] = glm::vec4(0.25f);
  const Image image = differenceOf(a, b, 4.0f);
  EXPECT_EQ(image.rgb[0], 0);
  EXPECT_EQ(image.rgb[3], 255);
}

TEST(CsvOf, HasTheColumnsThatProgramsRelyOn) {
  ReproduceRow one = row("sweep-lod", 1, 2, 1.25, kInfinity);
  one.aperture_m = 0.5;
  one.blur_px_max = 6.0;
  one.lod = true;
  one.kfragments = 17630.4321;
  one.points = 262144;
  one.ssim = 1.0;
  EXPECT_EQ(csvOf({one}),
            "scene,aperture,blur_px_max,method,lod,kfragments,points,ms_median,ms_min,threads,"
            "psnr_dB,ssim,silhouette_psnr_dB\n"
            "s,0.500000,6.000,sweep-lod,yes,17630.432,262144,1.2500,1.2500,2,inf,1.000000,n/a\n");
}

TEST(CsvOf, QuotesANameWithCommas) {
  ReproduceRow one = row("paper", 0, 1, 1.0);
  one.scene = "a,\"b\"";
  EXPECT_NE(csvOf({one}).find("\n\"a,\"\"b\"\"\",0.0"), std::string::npos);
}

TEST(RatiosOf, TakeTheWorstRow) {
  const std::vector<ReproduceRow> rows = {
      row("sweep-lod", 0, 1, 10.0, kInfinity),   row("sweep-lod", 0, 2, 5.0, kInfinity),
      row("sweep-lod", 2, 1, 4.0, 43.0),         row("sweep-lod", 2, 2, 2.5, 43.0),
      row("paper-lod", 0, 1, 90.0, 40.0),        row("paper-lod", 0, 2, 50.0, 40.0),
      row("paper-lod", 2, 1, 28.0, 36.5),        row("paper-lod", 2, 2, 20.0, 36.5),
      row("accumulate:200", 2, 1, 2000.0, 55.0), row("accumulate:200", 2, 2, 1300.0, 55.0)};
  const auto value = [&](const std::string& key, bool is_plane) {
    for (const ReproduceRatio& ratio : ratiosOf(rows, is_plane)) {
      if (ratio.key == key) return std::pair(ratio.value, ratio.reached());
    }
    return std::pair(-1.0, false);
  };
  EXPECT_EQ(value("sweep_lod_largest_over_unblurred", true), std::pair(0.5, true));
  EXPECT_EQ(value("paper_lod_over_sweep_lod", true), std::pair(7.0, false));
  EXPECT_EQ(value("accumulate_200_over_sweep_lod", true), std::pair(500.0, true));
  EXPECT_EQ(value("sweep_lod_psnr_dB", true), std::pair(43.0, true));
  EXPECT_EQ(value("sweep_lod_over_paper_lod_dB", true), std::pair(6.5, true));
  EXPECT_EQ(value("sweep_lod_over_paper_lod_dB", false), std::pair(6.5, false));  // 10 dB
}

TEST(RatiosOf, OfAGrownSceneTakeTheWorstAperture) {
  Growth growth;
  growth.before = {.surfels = 1'000'000, .ms_median = {10.0, 5.0, 4.0}};
  growth.after = {.surfels = 10'000'000,
                  .build_s = 12.0,
                  .bytes_per_surfel = 90.0,
                  .ms_median = {11.0, 6.0, 4.4}};
  const auto ratios = ratiosOf(growth);
  ASSERT_EQ(ratios.size(), 3u);
  EXPECT_FALSE(ratios[0].reached());
  EXPECT_TRUE(ratios[1].reached());
  EXPECT_DOUBLE_EQ(ratios[2].value, 1.2);
}

TEST(PlaneScene, RendersThePapersFragmentsAndAllItsSurfels) {
  const ReproduceScene plane = planeScene();
  const auto paper = makeMethod("paper", plane.scene);
  Frame frame;
  for (const PaperRow& theirs : plane.paper) {
    if (theirs.lod) continue;
    const RenderStats stats = paper->render(plane.view, plane.settingsAt(theirs.aperture), frame);
    EXPECT_EQ(static_cast<double>(stats.splats), theirs.points);
    EXPECT_NEAR(static_cast<double>(stats.fragments) / (1000.0 * theirs.kfragments), 1.0,
                kAsThePaperCounted)
        << "aperture " << theirs.aperture_as;
  }
}

TEST(ChooseApertures, FindsThePapersRatiosOfFragments) {
  ReproduceScene scene = steps(0.1);
  int frames = 0;
  chooseApertures(scene, [&] { ++frames; });
  EXPECT_LT(frames, 15);
  const auto paper = makeMethod("paper", scene.scene);
  Frame frame;
  const auto fragments = [&](std::size_t aperture) {
    return static_cast<double>(
        paper->render(scene.view, scene.settingsAt(aperture), frame).fragments);
  };
  EXPECT_NEAR(fragments(1) / fragments(0), 17630.0 / 5685.0, 0.01 * 3.1);
  EXPECT_NEAR(fragments(2) / fragments(0), 196752.0 / 5685.0, 0.01 * 34.6);
}

TEST(ChooseApertures, RefusesASceneThatNoApertureBlurs) {
  ReproduceScene flat = steps(0.0);
  EXPECT_THROW(chooseApertures(flat, [] {}), InputError);
}

TEST(ReferenceViews, AreOneAPixelOfTheLargestDisc) {
  ReproduceScene scene = steps(0.1);
  scene.apertures_m = {0.0, 0.01, 4.0};
  // The farthest band is 2.6 m away; the focus lies at 2 m.
  const double per_m = 0.5 * scene.view.focal_px.x * (0.5 - 1.0 / 2.6);
  EXPECT_NEAR(scene.largestBlur_px(1), 0.01 * per_m, 1e-5);
  EXPECT_EQ(referenceViews(scene, 0, {}), 1);
  EXPECT_EQ(referenceViews(scene, 1, {}), 256);
  EXPECT_EQ(referenceViews(scene, 2, {}), static_cast<int>(std::ceil(M_PI * 16.0 * per_m * per_m)));
  EXPECT_EQ(referenceViews(scene, 2, {.max_views = 300}), 300);
}

TEST(MeasureScene, CountsItsFramesAndSortsItsRows) {
  ReproduceScene scene = steps(0.1);
  scene.apertures_m = {0.0, 0.02, 0.08};
  const ReproduceEffort effort{.runs = 2, .accumulate_runs = 1, .min_views = 16, .max_views = 32};
  const std::vector<unsigned> threads{1, 2};
  std::size_t frames = 0;
  const SceneResult result =
      measureScene(scene, effort, threads, [&](std::size_t n) { frames += n; });
  EXPECT_EQ(frames, framesToMeasure(scene, effort, threads));
  std::size_t at = 0;
  for (const ReproduceRow& one : result.rows) {
    EXPECT_GE(one.aperture, at);
    at = one.aperture;
    EXPECT_GT(one.ms_min, 0.0);
    EXPECT_LE(one.ms_min, one.ms_median);
    if (one.method == "sweep" && one.aperture == 0) {
      EXPECT_EQ(one.psnr_dB, kInfinity);
    }
    EXPECT_GT(one.psnr_dB, 20.0) << one.method;
  }
  EXPECT_EQ(at, 2u);
  EXPECT_NE(chartOf(scene, result.rows, 2).find("</svg>"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
