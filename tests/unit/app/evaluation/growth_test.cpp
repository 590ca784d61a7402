#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <string>

#include "app/evaluation/growth/growth.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;

template <class Cost>
std::vector<glm::dvec2> curveOf(const std::vector<double>& sizes, const Cost& cost) {
  std::vector<glm::dvec2> curve;
  for (const double size : sizes) curve.emplace_back(size, cost(size));
  return curve;
}

const std::vector<double> kDecades{1e2, 1e3, 1e4, 1e5, 1e6, 1e7};

TEST(FitGrowth, FindsTheExponentOfAPower) {
  for (const double exponent : {-1.0, 0.0, 0.06, 1.0, 2.0}) {
    const GrowthFit fit =
        fitGrowth(curveOf(kDecades, [&](double n) { return 3.0 * std::pow(n, exponent); }));
    EXPECT_NEAR(fit.exponent, exponent, kRounding);
    EXPECT_FALSE(fit.bend);
    EXPECT_EQ(growthText(fit, 1.0), growthText({.exponent = exponent}, 1.0));
  }
}

TEST(FitGrowth, FindsWhereTwoPowersMeet) {
  const GrowthFit fit = fitGrowth(
      curveOf(kDecades, [](double n) { return n < 1e5 ? n : 1e5 * std::pow(n / 1e5, 0.25); }));
  ASSERT_TRUE(fit.bend);
  EXPECT_NEAR(fit.bend->at, 1e5, 1e5 * kRounding);
  EXPECT_NEAR(fit.bend->before, 1.0, kRounding);
  EXPECT_NEAR(fit.bend->after, 0.25, kRounding);
  EXPECT_TRUE(growthText(fit, 1e6).ends_with("; 1.00 up to 0.1, then 0.25"))
      << growthText(fit, 1e6);
}

TEST(FitGrowth, BendsWhereALinearPartOutgrowsAConstantOne) {
  const GrowthFit fit = fitGrowth(curveOf(kDecades, [](double n) { return 1e4 + n; }));
  ASSERT_TRUE(fit.bend);
  EXPECT_GE(fit.bend->at, 1e3);
  EXPECT_LE(fit.bend->at, 1e5);
  EXPECT_LT(fit.bend->before, 0.2);
  EXPECT_GT(fit.bend->after, 0.8);
}

TEST(FitGrowth, TakesNoNoiseForABendAndLeavesOutSizeZero) {
  std::mt19937 random(3);
  auto noisy = curveOf(kDecades, [&](double n) {
    return std::sqrt(n) * (0.9 + 0.2 * static_cast<double>(random() % 1000) / 1000.0);
  });
  const GrowthFit fit = fitGrowth(noisy);
  EXPECT_FALSE(fit.bend);
  EXPECT_NEAR(fit.exponent, 0.5, 0.03);
  noisy.insert(noisy.begin(), {0.0, 7.0});
  EXPECT_EQ(fitGrowth(noisy).exponent, fit.exponent);
}

TEST(FitGrowth, FindsNoBendInThreePoints) {
  EXPECT_FALSE(fitGrowth({{1.0, 1.0}, {2.0, 1.0}, {4.0, 16.0}}).bend);
}

TEST(CostAt, FollowsTheLinesBetweenAndBeyondThePoints) {
  const std::vector<glm::dvec2> curve{{1.0, 2.0}, {10.0, 2.0}, {100.0, 20.0}};
  const std::map<double, double> expected{{0.1, 2.0},  {1.0, 2.0},    {5.0, 2.0},   {10.0, 2.0},
                                          {30.0, 6.0}, {100.0, 20.0}, {1e4, 2000.0}};
  for (const auto& [size, cost] : expected)
    EXPECT_NEAR(costAt(curve, size), cost, kRounding * cost);
}

TEST(PlanGrowth, ChangesOneSizeAtATime) {
  std::map<GrowthAxis, std::set<std::array<double, 4>>> conditions;
  std::map<GrowthAxis, std::set<double>> sizes;
  for (const GrowthPoint& one : planGrowth(false, 640, 100.0, 6).points) {
    conditions[one.axis].insert({one.splats, one.pixels, one.blur_px, double{1.0 * one.threads}});
    sizes[one.axis].insert(one.size);
    EXPECT_FALSE(one.gaussians && one.method == "paper-lod");
    if (one.axis == GrowthAxis::views) {
      EXPECT_TRUE(one.method.ends_with(":" + std::to_string(static_cast<int>(one.size))));
    }
  }
  for (const auto& [axis, all] : conditions) {
    std::array<std::set<double>, 4> values;
    for (const auto& one : all) {
      for (std::size_t i = 0; i < one.size(); ++i) values[i].insert(one[i]);
    }
    EXPECT_EQ(std::ranges::count_if(values, [](const auto& some) { return some.size() > 1; }),
              axis == GrowthAxis::views ? 0 : 1)
        << nameOf(axis);
  }
  EXPECT_EQ(sizes[GrowthAxis::threads], (std::set<double>{1.0, 2.0, 4.0, 6.0}));
  EXPECT_EQ(*sizes[GrowthAxis::blur].begin(), 0.0);
  EXPECT_EQ(*sizes[GrowthAxis::blur].rbegin(), 128.0);
}

TEST(PlanGrowth, KeepsToTheMemoryAndToTheSplatsPerPixel) {
  const auto mostSplats = [](int width_px, double memory_GB) {
    const GrowthPlan plan = planGrowth(false, width_px, memory_GB, 1);
    return std::ranges::max(plan.points, {}, &GrowthPoint::splats).splats;
  };
  EXPECT_EQ(mostSplats(640, 100.0), 3e7);
  EXPECT_EQ(mostSplats(640, 1.0), 3e6);
  EXPECT_NEAR(mostSplats(64, 100.0), 3e5, kRounding * 3e5);
}

/// At 640 x 360 px, `auto` takes 20 ms for each million splats.
std::vector<GrowthPoint> straightGrowth() {
  std::vector<GrowthPoint> points;
  for (const double millions : {1.0, 10.0}) {
    for (const char* method : {"auto", kPrepare}) {
      points.push_back({.size = 1e6 * millions,
                        .method = method,
                        .pixels = 640.0 * 360.0,
                        .cpu_ms = 20.0 * millions,
                        .memory_GB = (method == kPrepare ? 0.2 : 0.1) * millions});
    }
  }
  return points;
}

TEST(CurvesOf, AreThoseOfTwoSizesByAxisAndMethod) {
  std::vector<GrowthPoint> points = straightGrowth();
  for (const char* method : {"accumulate:4", "accumulate:16", "sweep-lod:7"}) {
    const double n =
        std::atof(std::string(method).substr(std::string(method).find(':') + 1).c_str());
    points.push_back({.axis = GrowthAxis::views,
                      .size = n,
                      .gaussians = true,
                      .method = method,
                      .cpu_ms = 3.0 * n,
                      .memory_GB = 1.0});
  }
  const auto curves = curvesOf(points);
  ASSERT_EQ(curves.size(), 3U);  // sweep-lod has one size
  EXPECT_EQ(nameOf(curves[0]), "auto over splats, surfels");
  EXPECT_EQ(nameOf(curves[1]), "prepare over splats, surfels");
  EXPECT_EQ(nameOf(curves[2]), "accumulate over views, Gaussians");
  for (const GrowthCurve& curve : curves) EXPECT_NEAR(curve.time.exponent, 1.0, kRounding);
  EXPECT_NEAR(curves[2].memory.exponent, 0.0, kRounding);
}

TEST(NeedsOf, SplatsGoWithPixels) {
  const auto curves = curvesOf(straightGrowth());
  EXPECT_FALSE(needsOf(1e6, true, curves));  // no Gaussians were measured
  const auto needs = needsOf(4e7, false, curves);
  ASSERT_TRUE(needs);
  // Four images of 640 x 360 with ten million splats each, 200 ms each.
  EXPECT_NEAR(needs->frame_cpu_s, 0.8, kRounding);
  EXPECT_NEAR(needs->memory_GB, 8.0, 8.0 * kRounding);  // `prepare` takes more than `auto`
  EXPECT_NEAR(needs->batch_core_h, 1000.0 * (600.0 * 24.0 + 3.7) / 3600.0, 1e-3);
}

}  // namespace FOCI_FILE
}  // namespace foci
