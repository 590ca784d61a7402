#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "app/evaluation/cells.h"
#include "app/evaluation/chart/chart.h"
#include "app/evaluation/scene_in_view.h"
#include "app/graphics/plot.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/quantile.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ChartPoint point(const char* method, double ms, double psnr_dB) {
  ChartPoint one{{.psnr_dB = psnr_dB, .ssim = 0.5}};
  one.scene = "s";
  one.blur_px = 4.0;
  one.method = {method, {}};
  one.threads = 1;
  one.ms_median = one.ms_min = ms;
  one.reference_psnr_dB = 50.0;
  return one;
}

TEST(ParetoFrontier, HoldsTheEntriesThatNothingBeats) {
  //                              on     on   slower  worse  both
  EXPECT_EQ(paretoFrontier({1.0, 2.0, 3.0, 2.0, 9.0}, {30.0, 40.0, 40.0, 35.0, 20.0}),
            (std::vector<bool>{true, true, false, false, false}));
}

TEST(ParetoFrontier, HoldsOneAloneAndEqualOnesTogether) {
  EXPECT_TRUE(paretoFrontier({}, {}).empty());
  EXPECT_EQ(paretoFrontier({5.0}, {1.0}), (std::vector<bool>{true}));
  EXPECT_EQ(paretoFrontier({5.0, 5.0, 5.0}, {1.0, 1.0, 0.5}),
            (std::vector<bool>{true, true, false}));
}

TEST(ParetoFrontier, TakesInfinities) {
  EXPECT_EQ(paretoFrontier({1.0, 2.0, 3.0}, {30.0, kInfinity, kInfinity}),
            (std::vector<bool>{true, true, false}));
}

TEST(ParetoFrontier, IsAStaircaseThatDominatesTheRest) {
  std::mt19937 random(5);
  std::vector<double> cost, worth;
  for (int i = 0; i < 200; ++i) {
    cost.push_back(static_cast<double>(random() % 40));
    worth.push_back(static_cast<double>(random() % 40));
  }
  const std::vector<bool> on = paretoFrontier(cost, worth);
  const auto beats = [&](std::size_t a, std::size_t b) {
    return cost[a] <= cost[b] && worth[a] >= worth[b] && (cost[a] < cost[b] || worth[a] > worth[b]);
  };
  for (std::size_t i = 0; i < cost.size(); ++i) {
    bool beaten_by_one_on_it = false;
    for (std::size_t j = 0; j < cost.size(); ++j) {
      if (on[j]) beaten_by_one_on_it |= beats(j, i);
    }
    EXPECT_NE(on[i], beaten_by_one_on_it) << i;
  }
}

TEST(MarkFrontiers, CountsNoAccuracyBeyondTheReferencesOwnAndKeepsPanelsApart) {
  std::vector<ChartPoint> points = {point("a", 1.0, 30.0), point("b", 2.0, 51.0),
                                    point("c", 3.0, 58.0), point("d", 9.0, 10.0)};
  points[3].threads = 2;  // alone in its panel
  markFrontiers(points);
  EXPECT_TRUE(points[0].on_frontier);
  EXPECT_TRUE(points[1].on_frontier);
  EXPECT_FALSE(points[2].on_frontier);  // the reference has 50 dB: 58 counts as much as 51
  EXPECT_TRUE(points[3].on_frontier);
}

TEST(ChartCsv, HasTheColumnsThatProgramsRelyOn) {
  ChartPoint one = point("accumulate", 12.5, kInfinity);
  one.method.setting = 16;
  one.silhouette_psnr_dB = 41.25;
  one.coverage_error = 0.0125;
  one.visible_error = 1.25;
  one.expected_error = 1.5;
  one.tolerance_met = false;
  one.quality_level = QualityLevel::thorough;
  one.on_frontier = true;
  one.flip = 0.125;
  one.renderer = "2.0, mine";
  EXPECT_EQ(
      csvOf({one, point("sweep", 2.0, 30.0)}),
      "scene,blur_px,method,setting,threads,ms_median,ms_min,psnr_dB,ssim,"
      "silhouette_psnr_dB,coverage_error,reference_psnr_dB,on_frontier,visible_error,"
      "expected_error,tolerance_met,quality_level,flip,renderer\n"
      "s,4,accumulate,16,1,12.5000,12.5000,inf,0.500000,41.250,0.012500,50.000,yes,1.250,1.500,"
      "no,auto:9,0.1250,\"2.0, mine\"\n"
      "s,4,sweep,n/a,1,2.0000,2.0000,30.000,0.500000,n/a,n/a,50.000,no,0.000,n/a,n/a,n/a,0.0000,n/"
      "a\n");
}

// The error that `auto` predicts bounds the measured error on every scene of the chart. The
// prediction stays below the tolerance, also where `auto` prefers a whole-aperture pass to
// sub-apertures.
TEST(AutoOnTheChart, PredictsABoundOfItsErrorBelowTheTolerance) {
  const ChartPlan plan = planChart({.quick = true, .size_px = 96});
  for (const ChartScene& scene : plan.scenes) {
    if (scene.id == "gallery") continue;  // slow, and the scene of the mask from another view
    if (scene.gaussians) continue;        // below
    const SceneInView seen = scene.make();
    const auto method = makeMethod("auto", seen.scene);
    for (const double blur_px : {2.0, 12.0}) {
      const RenderSettings settings =
          seen.settingsThrough(blur_px / seen.largestBlurThrough_px(1.0));
      Frame frame, reference;
      const RenderStats stats = method->render(seen.view, settings, frame);
      const char* all_views = blur_px > 2.0 ? "accumulate:64" : "accumulate:16";
      makeMethod(all_views, seen.scene)->render(seen.view, settings, reference);
      auto apart = visibleDifference(frame, reference, kUsualPx_per_deg);
      ASSERT_TRUE(stats.tolerance_error.has_value());
      EXPECT_LE(quantile(apart, 0.95), *stats.tolerance_error) << scene.id << " " << blur_px;
      EXPECT_LE(*stats.tolerance_error, settings.quality.tolerance) << scene.id << " " << blur_px;
    }
  }
}

struct GaussianCase {
  int width_px;
  double blur_px;
};

// The fewer pixels, the more contrast a scene of Gaussians has from one to the next.
TEST(AutoOnTheChart, PredictsABoundOfItsErrorOnGaussians) {
  const int of_the_chart_px = planChart({.scenes = {"garden"}}).size_px;
  for (const auto& [width_px, blur_px] : {GaussianCase{of_the_chart_px, 2.0},
                                          {of_the_chart_px, 4.0},
                                          {of_the_chart_px, 12.0},
                                          {256, 2.0},
                                          {192, 2.0}}) {
    const SceneInView seen = gardenInView(width_px);
    const auto method = makeMethod("auto", seen.scene),
               views = makeMethod("accumulate:64", seen.scene);
    const RenderSettings settings = seen.settingsThrough(blur_px / seen.largestBlurThrough_px(1.0));
    Frame frame, reference;
    const RenderStats stats = method->render(seen.view, settings, frame);
    views->render(seen.view, settings, reference);
    auto apart = visibleDifference(frame, reference, kUsualPx_per_deg);
    ASSERT_TRUE(stats.tolerance_error.has_value());
    EXPECT_LE(quantile(apart, 0.95), *stats.tolerance_error) << blur_px;
    EXPECT_LE(*stats.tolerance_error, settings.quality.tolerance) << blur_px;
  }
}

TEST(PlanChart, HasEveryMethodWithSettingsThatItTakes) {
  for (const bool quick : {false, true}) {
    const ChartPlan plan = planChart({.quick = quick});
    std::set<std::string> planned, listed;
    for (const EvaluatedMethod& method : plan.scenes[0].methods) {
      EXPECT_EQ(expectedMethod(method.spec()), std::nullopt) << method.spec();
      planned.insert(method.name);
    }
    for (const MethodInfo& method : methods()) listed.emplace(method.name);
    EXPECT_EQ(planned, listed);
    EXPECT_EQ(plan.scenes.size(), 7u);
    EXPECT_TRUE(std::is_sorted(plan.blurs_px.begin(), plan.blurs_px.end()));
  }
}

TEST(PlanChart, TakesOnlyTheUsersChoiceAndRefusesUnknownNames) {
  const ChartPlan plan =
      planChart({.scenes = {"fence"}, .methods = {"sweep-lod", "accumulate:3", "pinhole"}});
  ASSERT_EQ(plan.scenes.size(), 1u);
  ASSERT_EQ(plan.scenes[0].methods.size(), 3u);
  EXPECT_EQ(plan.scenes[0].methods[0].spec(), "sweep-lod:7");
  EXPECT_EQ(plan.scenes[0].methods[1].fileName(), "accumulate-3");
  EXPECT_EQ(plan.scenes[0].methods[2].spec(), "pinhole");
  EXPECT_THROW(planChart({.scenes = {"statue", "cloud"}}), InputError);
  EXPECT_THROW(planChart({.methods = {"pinhole:2"}}), InputError);
  EXPECT_THROW(planChart({.scan = ScanView{"/nowhere/a.ply", {}}}), InputError);
}

TEST(PlanChart, ChartsGaussiansWithTheMethodsThatRenderThem) {
  const ChartPlan plan = planChart({.quick = true, .scenes = {"garden"}});
  ASSERT_EQ(plan.scenes.size(), 1u);
  std::set<std::string> specs;
  for (const EvaluatedMethod& method : plan.scenes[0].methods) specs.insert(method.spec());
  for (const char* method :
       {"auto", "pinhole", "sweep-lod:7", "inflate", "inflate:spark", "inflate:splat-transform"}) {
    EXPECT_TRUE(specs.contains(method)) << method;
  }
  EXPECT_FALSE(specs.contains("paper"));
  // Other methods leave the scene out, unless the user asks for it.
  EXPECT_EQ(planChart({.methods = {"paper"}}).scenes.size(), 6u);
  EXPECT_THROW(planChart({.scenes = {"garden"}, .methods = {"paper"}}), InputError);
}

TEST(PlanChart, ReferencesHaveAViewAPixelOfTheLargestDiscWithinBounds) {
  const ChartPlan plan = planChart({});
  EXPECT_EQ(plan.views(1.0), 256);
  EXPECT_EQ(plan.views(12.0), 453);  // pi 144
  EXPECT_EQ(plan.views(40.0), 1024);
}

TEST(PlanChart, HoldsAMeshAgainstItsTrianglesAndOtherScenesAgainstTheirSurfels) {
  const ChartPlan plan = planChart({.quick = true});
  for (const ChartScene& scene : plan.scenes) {
    const bool ball = scene.id == "ball";
    EXPECT_EQ(scene.truth == ChartTruth::triangles, ball) << scene.id;
    const bool traced = ball && !expectedMethod("raytrace:1");
    EXPECT_EQ(plan.reference(scene, 4.0), traced ? "raytrace:128" : "accumulate:64") << scene.id;
    if (!ball) continue;  // slow to make
    const SceneInView seen = scene.make();
    EXPECT_NE(seen.scene.surfels()->mesh, nullptr);
    EXPECT_GT(seen.settings.lighting.background.g, 0.5f);
  }
}

TEST(Ball, IsClosedAndAsLargeAsABall) {
  const TriangleMesh ball = makeBallMesh(1.0f);
  // By the divergence theorem: the triangles' oriented areas sum to zero, and the cones over them
  // to the volume.
  double volume = 0.0;
  glm::dvec3 area(0.0);
  for (std::size_t i = 0; i < ball.size(); ++i) {
    const glm::dvec3 a = ball.corners_m[3 * i], b = ball.corners_m[3 * i + 1],
                     c = ball.corners_m[3 * i + 2];
    volume += glm::dot(a, glm::cross(b, c)) / 6.0;
    area += 0.5 * glm::cross(b - a, c - a);
  }
  EXPECT_NEAR(volume, 4.0 / 3.0 * std::numbers::pi, 0.05);
  EXPECT_LT(glm::length(area), 1e-4);  // zero for a closed surface
}

class ChartCellsTest : public testing::Test {
 protected:
  const TemporaryFolder temporary_;
  const std::filesystem::path& folder_ = temporary_.path();
};

TEST_F(ChartCellsTest, LoadsResultsUnderTheSameKeyOnly) {
  const ChartCells cells(folder_, "program 1; ", OutputGuard());
  const ChartCell cell{.errors = {.psnr_dB = kInfinity,
                                  .ssim = 1.0 / 3.0,
                                  .silhouette_psnr_dB = 40.1,
                                  .coverage_error = 1e-9,
                                  .visible_error = 1.0 / 7.0,
                                  .flip = 0.25,
                                  .expected_error = 0.7,
                                  .tolerance_met = true,
                                  .quality_level = QualityLevel::fine},
                       .first_ms = 7.25,
                       .ms = {{1, {2.0, 3.0}}, {16, {0.1}}}};
  cells.store("a", "plane", cell);
  const auto back = cells.load("a", "plane");
  ASSERT_TRUE(back);
  const ChartErrors& errors = back->errors;
  EXPECT_EQ(errors.psnr_dB, kInfinity);
  EXPECT_EQ(errors.ssim, cell.errors.ssim);
  EXPECT_EQ(errors.silhouette_psnr_dB, cell.errors.silhouette_psnr_dB);
  EXPECT_EQ(errors.coverage_error, cell.errors.coverage_error);
  EXPECT_EQ(errors.visible_error, cell.errors.visible_error);
  EXPECT_EQ(errors.flip, cell.errors.flip);
  EXPECT_EQ(errors.expected_error, cell.errors.expected_error);
  EXPECT_EQ(errors.tolerance_met, cell.errors.tolerance_met);
  EXPECT_EQ(errors.quality_level, cell.errors.quality_level);
  EXPECT_EQ(back->first_ms, cell.first_ms);
  EXPECT_EQ(back->ms, cell.ms);
  EXPECT_FALSE(cells.load("b", "plane"));
  EXPECT_FALSE(cells.load("a", "plane "));
  EXPECT_FALSE(ChartCells(folder_, "program 2; ", OutputGuard()).load("a", "plane"));

  cells.store("a", "plane", {.errors = {.silhouette_psnr_dB = {}}});
  EXPECT_EQ(cells.load("a", "plane")->errors.silhouette_psnr_dB, std::nullopt);
}

TEST_F(ChartCellsTest, CountsForeignFilesAsAbsent) {
  const ChartCells cells(folder_, "k", OutputGuard());
  fs::create_directory(folder_ / "cells");
  for (const char* text : {"", "{", "[]", "{\"key\": 1}", "{\"key\": \"k\"}",
                           "{\"key\": \"k\", \"psnr_dB\": [], \"ssim\": \"x\"}"}) {
    writeText(folder_ / "cells/a.json", text);
    EXPECT_FALSE(cells.load("a", "")) << text;
    EXPECT_FALSE(cells.loadReference("a", "")) << text;
  }
}

TEST_F(ChartCellsTest, LoadsAReferenceToTheBitAndNoTruncatedOne) {
  const ChartCells cells(folder_, "k", OutputGuard());
  ChartReference reference{.views = 64, .split_half_psnr_dB = 51.5, .frame = {}};
  reference.frame.size_px = {3, 2};
  for (int i = 0; i < 6; ++i) reference.frame.rgba.emplace_back(0.1f * static_cast<float>(i));
  cells.storeReference("r", "", reference);
  const auto back = cells.loadReference("r", "");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->views, 64);
  EXPECT_EQ(back->split_half_psnr_dB, 51.5);
  EXPECT_EQ(back->frame.size_px, reference.frame.size_px);
  EXPECT_EQ(back->frame.rgba, reference.frame.rgba);
  fs::resize_file(folder_ / "cells/r.rgba", 90);
  EXPECT_FALSE(cells.loadReference("r", ""));
}

TEST(PlotAxis, HoldsItsValuesBetweenRoundTicks) {
  for (const auto& values : std::vector<std::vector<double>>{
           {20.3, 61.8, kInfinity}, {0.1, 0.12}, {5.0}, {-3.0, 4000.0}}) {
    const PlotAxis axis = linearAxis("", values);
    for (const double value : values) {
      if (value == kInfinity) continue;
      EXPECT_LE(axis.from, value);
      EXPECT_GE(axis.to, value);
    }
    EXPECT_GE(axis.ticks.size(), 2u);
    EXPECT_LE(axis.ticks.size(), 10u);
    EXPECT_NEAR(axis.ticks.back().at, axis.to, 1e-9 * std::abs(axis.to));
  }
  const PlotAxis time = timeAxis("", {0.3, 2500.0});
  EXPECT_EQ(time.from, 0.1);
  EXPECT_EQ(time.ticks.front().text, "0.1 ms");
  EXPECT_EQ(time.ticks.back().text, "10 s");
}

TEST(Plot, DescribesItselfInWords) {
  Plot plot{.name = "n", .x = timeAxis("time", {1.0, 100.0}), .y = linearAxis("dB", {0.0, 10.0})};
  plot.series = {
      {.name = "s", .color = "#000000", .points = {{.x = 3.0, .y = 4.4}, {.x = 100.0, .y = 9.5}}}};
  const Drawing drawing = layOut(plot);
  EXPECT_EQ(drawing.title, "n");
  EXPECT_NE(drawing.description.find("Across: time, from 1 ms to 100 ms."), std::string::npos);
  EXPECT_NE(drawing.description.find("s: 4.4 at 3 ms to 9.5 at 100 ms, 2 points."),
            std::string::npos)
      << drawing.description;
  // An image without links is one thing for a screen reader.
  EXPECT_NE(svgOf(drawing).find("role=\"img\""), std::string::npos);
}

TEST(Plot, PutsPointsWhereTheAxesSay) {
  Plot plot{.x = timeAxis("", {1.0, 100.0}), .y = linearAxis("", {0.0, 10.0})};
  plot.series = {
      {.name = "s",
       .color = "#000000",
       .points = {{.x = 1.0, .y = 0.0}, {.x = 10.0, .y = 5.0}, {.x = 100.0, .y = 99.0}}}};
  const Drawing drawing = layOut(plot);
  ASSERT_EQ(drawing.discs.size(), 3u);
  const auto &a = drawing.discs[0].at_px, &b = drawing.discs[1].at_px, &c = drawing.discs[2].at_px;
  EXPECT_NEAR(b.x, 0.5 * (a.x + c.x), 1e-9);  // logarithmic
  EXPECT_NEAR(b.y, 0.5 * (a.y + c.y), 1e-9);  // beyond the axis: at its end
  EXPECT_LT(c.y, a.y);
}

TEST(Plot, LabelsDoNotCoverEachOtherAndThoseOfFullPointsComeFirst) {
  Plot plot{.x = timeAxis("", {1.0, 100.0}), .y = linearAxis("", {0.0, 10.0})};
  PlotSeries series{.name = "s", .color = "#000000"};
  for (int i = 0; i < 60; ++i) {
    series.points.push_back(
        {.x = 9.0 + 0.01 * i, .y = 5.0, .label = i == 59 ? "full" : "hollow", .hollow = i != 59});
  }
  plot.series = {series};
  std::vector<DrawnText> labels;
  for (const DrawnText& text : layOut(plot).texts) {
    if (text.words == "full" || text.words == "hollow") labels.push_back(text);
  }
  ASSERT_FALSE(labels.empty());
  EXPECT_LT(labels.size(), 12u);
  EXPECT_EQ(labels.front().words, "full");
  for (std::size_t i = 0; i < labels.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const glm::dvec2 apart = glm::abs(labels[i].at_px - labels[j].at_px);
      const double width = textWidth_px("full", labels[i].size_px);
      EXPECT_TRUE(apart.x >= width || apart.y >= labels[i].size_px - 1.0) << i << ", " << j;
    }
  }
}

TEST(ChartPanel, LinksEveryPointToItsImageAndDrawsTheFrontier) {
  const std::vector<ChartPoint> points = {point("pinhole", 1.0, 20.0), point("sweep", 4.0, 40.0),
                                          point("paper", 8.0, 30.0)};
  const Drawing drawing = layOut(panelOf(points, ChartMeasure::psnr, "a < b"));
  ASSERT_EQ(drawing.discs.size(), 3u);
  EXPECT_FALSE(drawing.discs[0].hollow);
  EXPECT_FALSE(drawing.discs[1].hollow);
  EXPECT_TRUE(drawing.discs[2].hollow);
  EXPECT_EQ(drawing.discs[1].link, "images/s_4px_sweep.png");
  const auto frontier = std::find_if(drawing.lines.begin(), drawing.lines.end(),
                                     [](const DrawnLine& line) { return line.color == kInk; });
  ASSERT_NE(frontier, drawing.lines.end());
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_NE(
        std::find(frontier->points_px.begin(), frontier->points_px.end(), drawing.discs[i].at_px),
        frontier->points_px.end());
  }
  const std::string svg = svgOf(drawing);
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
  EXPECT_NE(svg.find("href=\"images/s_4px_sweep.png\""), std::string::npos);
  // Screen readers: links are reachable, and the chart has a name and a text.
  EXPECT_NE(svg.find("role=\"group\""), std::string::npos);
  EXPECT_NE(svg.find("aria-label=\"a &lt; b\""), std::string::npos);
  EXPECT_NE(svg.find("<title>a &lt; b</title>"), std::string::npos);
  EXPECT_NE(svg.find("<desc>Across: time per frame"), std::string::npos);
}

TEST(SceneInView, BlurGrowsWithTheAperture) {
  const SceneInView plane = planeInView(32, 64);
  const double one_px = plane.largestBlurThrough_px(1.0);
  EXPECT_GT(one_px, 0.0);
  EXPECT_NEAR(plane.largestBlurThrough_px(0.25), 0.25 * one_px, 1e-4 * one_px);
  EXPECT_EQ(plane.largestBlurThrough_px(0.0), 0.0);
}

}  // namespace FOCI_FILE
}  // namespace foci
