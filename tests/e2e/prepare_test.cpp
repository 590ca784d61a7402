// `foci prepare`: points or a mesh become a scene with a report; other commands render the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

using Json = nlohmann::json;

/// A wavy square of 1 m, 2 m before the eye.
std::string wavyPly() {
  return reliefPly([](int x, int y) { return 2.0 + 0.002 * ((x * 7 + y * 3) % 5); });
}

constexpr const char* kQuadObj =
    "v -0.5 -0.5 -2\nv 0.5 -0.5 -2\nv 0.5 0.5 -2\nv -0.5 0.5 -2\nf 1 2 3 4\n";

Json prepared(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "prepare");
  arguments.push_back("--json");
  const Outcome outcome = runFoci(arguments, folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return Json::parse(outcome.out);
}

std::size_t countOf(const std::string& what, const std::string& text) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

/// A study of `scene`, rendered as linear floats.
Outcome render(const TemporaryFolder& folder, const std::string& scene, const std::string& out) {
  std::string study = smallStudy();
  study.replace(study.find("scene.ply"), 9, scene);
  folder.write("study.toml", study);
  folder.write("trace.tsv", steadyTrace());
  return runFoci({"render", "study.toml", "--out", out, "--focus", "2"}, folder.path());
}

/// Mean over the colours of all pixels of a PFM of 96 x 72.
double meanOf(const std::string& pfm) {
  constexpr std::size_t kValues = std::size_t{96} * 72 * 3;
  std::vector<float> values(kValues);
  EXPECT_GT(pfm.size(), kValues * sizeof(float));
  const std::string bytes = pfm.substr(pfm.size() - kValues * sizeof(float));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(values.data()));
  return std::accumulate(values.begin(), values.end(), 0.0) / kValues;
}

TEST(Prepare, PointsBecomeASceneWithAReportOfItsSumsAtEveryLevel) {
  const TemporaryFolder folder;
  folder.write("points.ply", wavyPly());
  const Json summary = prepared(folder, {"points.ply", "--out", "made/scene.foci"});
  EXPECT_EQ(summary.at("surfels"), 3600);
  EXPECT_NEAR(summary.at("area_m2").get<double>(), 1.0, 0.1);

  // Histograms before and after the solve, by size of the pixels, and of each level.
  std::vector<Json> sums;
  for (const char* when : {"normalisation_before", "normalisation"}) {
    ASSERT_EQ(summary.at(when).size(), 3u) << when;
    for (const Json& n : summary.at(when)) sums.push_back(n);
  }
  ASSERT_FALSE(summary.at("normalisation_of_levels").empty());
  for (const Json& level : summary.at("normalisation_of_levels")) {
    EXPECT_GE(level.at("nodes"), 1000);
    sums.push_back(level.at("sharp"));
    sums.push_back(level.at("blurred"));
  }
  for (const Json& n : sums) {
    const auto all = n.at("histogram").get<std::vector<std::size_t>>();
    const auto smooth = n.at("smooth_histogram").get<std::vector<std::size_t>>();
    const auto total = std::accumulate(all.begin(), all.end(), 0.0);
    const auto of_smooth = std::accumulate(smooth.begin(), smooth.end(), 0.0);
    EXPECT_GT(total, 9'000.0);
    EXPECT_NEAR(of_smooth / total, n.at("smooth_share").get<double>(), 1e-6);
    ASSERT_GT(of_smooth, 100.0);  // the coarsest level is border but for its middle
    EXPECT_GT(n.at("smooth_within_0.1"), 0.95);
  }

  const std::string report = folder.read("made/scene.html");
  EXPECT_EQ(countOf("<svg", report), sums.size());
  EXPECT_EQ(countOf("Level of ", report), summary.at("normalisation_of_levels").size());
  EXPECT_NE(report.find("3600 surfels"), std::string::npos);
  EXPECT_TRUE(report.ends_with("</html>\n"));

  // The scene has the light of its points.
  folder.write("made/points.ply", wavyPly());
  ASSERT_EQ(render(folder, "made/points.ply", "points.pfm").exit_code, 0);
  const Outcome rendered = render(folder, "made/scene.foci", "scene.pfm");
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  const double light = meanOf(folder.read("points.pfm"));
  EXPECT_GT(light, 0.01);
  EXPECT_NEAR(meanOf(folder.read("scene.pfm")) / light, 1.0, 0.05);
}

TEST(Prepare, SamplesAMeshThatRenders) {
  const TemporaryFolder folder;
  folder.write("quad.obj", kQuadObj);
  const Json summary =
      prepared(folder, {"quad.obj", "--out", "quad.foci", "--points", "4000", "--scale", "1"});
  EXPECT_NEAR(summary.at("surfels").get<double>() / 4000.0, 1.0, 0.2);
  EXPECT_NEAR(summary.at("area_m2").get<double>(), 1.0, 0.1);
  EXPECT_GT(summary.at("normalisation")[0].at("smooth_within_0.02"), 0.95);
  ASSERT_EQ(render(folder, "quad.foci", "quad.pfm").exit_code, 0);
  EXPECT_GT(meanOf(folder.read("quad.pfm")), 0.01);
}

/// A ball of 1 m, 3 m before the eye, as an OBJ of triangles.
std::string ballObj() {
  constexpr int kColumns = 48, kRows = 24;
  std::ostringstream obj;
  for (int i = 0; i <= kColumns; ++i) {
    for (int j = 0; j <= kRows; ++j) {
      const double around = 2.0 * M_PI * i / kColumns, down = M_PI * j / kRows;
      obj << "v " << 0.5 * std::sin(down) * std::sin(around) << ' ' << 0.5 * std::cos(down) << ' '
          << -3.0 + 0.5 * std::sin(down) * std::cos(around) << '\n';
    }
  }
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j < kRows; ++j) {
      const int a = i * (kRows + 1) + j + 1, b = a + 1, c = b + kRows + 1, d = c - 1;
      obj << "f " << a << ' ' << b << ' ' << c << "\nf " << a << ' ' << c << ' ' << d << '\n';
    }
  }
  return obj.str();
}

/// The red channel of a PFM of 96 x 72 in linear light.
std::vector<float> redOf(const std::string& pfm) {
  constexpr std::size_t kPixels = std::size_t{96} * 72;
  std::vector<float> values(3 * kPixels), red(kPixels);
  EXPECT_GT(pfm.size(), values.size() * sizeof(float));
  const std::string bytes = pfm.substr(pfm.size() - values.size() * sizeof(float));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(values.data()));
  for (std::size_t i = 0; i < kPixels; ++i) red[i] = values[3 * i];
  return red;
}

// The silhouette of the ball is a circle of tangent 0.5 / sqrt(9 - 0.25) around the middle.
TEST(Prepare, AMeshLeaksNothingBetweenBlackAndWhite) {
  const TemporaryFolder folder;
  folder.write("ball.obj", ballObj());
  folder.write("trace.tsv", steadyTrace());
  std::vector<std::vector<float>> red;
  for (const char* background : {"[0, 0, 0]", "[1, 1, 1]"}) {
    std::string study = smallStudy();
    study.replace(study.find("scene.ply"), 9, "ball.obj");
    study.insert(study.find("file = "), std::string("background = ") + background + "\n");
    folder.write("study.toml", study);
    const Outcome outcome =
        runFoci({"render", "study.toml", "--out", "a.pfm", "--focus", "2.5", "--method", "sweep"},
                folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    red.push_back(redOf(folder.read("a.pfm")));
  }
  const double focal_px = 0.5 * 96 / 0.4, radius_px = focal_px * 0.5 / std::sqrt(8.75);
  std::size_t inside = 0, outside = 0;
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) {
      const double from_middle_px = std::hypot(x + 0.5 - 48.0, y + 0.5 - 36.0);
      const float added = red[1][y * 96 + x] - red[0][y * 96 + x];
      if (from_middle_px < radius_px - 4.0) {
        EXPECT_LE(added, 0.05f) << x << ' ' << y;
        EXPECT_GT(red[0][y * 96 + x], 0.05f);
        ++inside;
      } else if (from_middle_px > radius_px + 4.0) {
        EXPECT_NEAR(added, 1.0f, 1e-5f) << x << ' ' << y;
        ++outside;
      }
    }
  }
  EXPECT_GT(inside, 500u);
  EXPECT_GT(outside, 2000u);
}

TEST(Prepare, AMeshLooksAsBeforeWithoutAStudy) {
  const TemporaryFolder folder;
  folder.write("ball.obj", ballObj());  // y is up in OBJ, and one colour is shaded
  prepared(folder, {"ball.obj", "--out", "ball.foci"});
  std::vector<std::vector<float>> red;
  for (const char* scene : {"ball.obj", "ball.foci"}) {
    const Outcome outcome = runFoci({"render", scene, "--look", "above", "--size", "96x72",
                                     "--method", "sweep-lod", "--out", "a.pfm", "--overwrite"},
                                    folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("y is up"), std::string::npos) << outcome.err;
    red.push_back(redOf(folder.read("a.pfm")));
  }
  double squared = 0.0;
  for (std::size_t i = 0; i < red[0].size(); ++i) squared += std::pow(red[0][i] - red[1][i], 2.0);
  EXPECT_LT(std::sqrt(squared / static_cast<double>(red[0].size())), 0.01);
}

TEST(Prepare, HoldsAMeshAgainstItsTrianglesAndWarnsOfTooFewPoints) {
  const TemporaryFolder folder;
  folder.write("ball.obj", ballObj());
  const Outcome few =
      runFoci({"prepare", "ball.obj", "--out", "few.foci", "--points", "200"}, folder.path());
  ASSERT_EQ(few.exit_code, 0) << few.err;
  if (few.out.find("built without ray tracing") != std::string::npos) GTEST_SKIP();
  EXPECT_NE(few.out.find("against the triangles, from 64 sides"), std::string::npos) << few.out;
  EXPECT_NE(few.err.find("foci: ball.obj: "), std::string::npos) << few.err;
  EXPECT_NE(few.err.find("set --points 500000"), std::string::npos) << few.err;
  const std::string page = folder.read("few.html");
  EXPECT_EQ(countOf("data:image/png;base64,", page), 4u);  // the map, and the worst view
  EXPECT_EQ(countOf("<img alt=\"", page), 4u);
  EXPECT_EQ(countOf("class=\"notice\"", page), countOf("foci: ball.obj: ", few.err));

  const Json summary = prepared(folder, {"ball.obj", "--out", "ball.foci", "--points", "20000"});
  const Json& figures = summary.at("triangles");
  EXPECT_EQ(figures.at("views"), 64);
  EXPECT_GT(figures.at("interior_px"), 1'000'000);
  EXPECT_LT(figures.at("leak_share"), 1e-3);  // 200 surfels leak over a hundredth
  EXPECT_LT(figures.at("outline_error_px"), 1.5);
  EXPECT_LT(std::abs(figures.at("outline_shift_px").get<double>()),
            figures.at("outline_error_px").get<double>() + 1e-9);
  EXPECT_EQ(figures.at("transparent_share"), 0.0);
}

TEST(Prepare, PointsHaveNoTrianglesToBeHeldAgainst) {
  const TemporaryFolder folder;
  folder.write("points.ply", squarePly(24, 1.0));
  const Json summary = prepared(folder, {"points.ply", "--out", "scene.foci"});
  EXPECT_TRUE(summary.at("triangles").is_null());
  EXPECT_TRUE(summary.at("warnings").empty());
  const std::string page = folder.read("scene.html");
  EXPECT_NE(page.find("The input has points only."), std::string::npos);
  EXPECT_EQ(countOf("<img", page), 0u);
}

TEST(Prepare, IsTheSameAtAnyNumberOfThreads) {
  const TemporaryFolder folder;
  folder.write("points.ply", wavyPly());
  Json one = prepared(folder, {"points.ply", "--out", "one/scene.foci", "--threads", "1"});
  Json three = prepared(folder, {"points.ply", "--out", "three/scene.foci", "--threads", "3"});
  EXPECT_EQ(folder.read("one/scene.foci"), folder.read("three/scene.foci"));
  for (Json* summary : {&one, &three}) {
    for (const char* own : {"seconds", "out", "report"}) summary->erase(own);
  }
  EXPECT_EQ(one, three);
}

TEST(Prepare, ATruncatedOrAlteredSceneIsRefused) {
  const TemporaryFolder folder;
  folder.write("points.ply", squarePly(24, 1.0));
  prepared(folder, {"points.ply", "--out", "scene.foci"});
  const std::string whole = folder.read("scene.foci");
  const auto expectRefused = [&](const std::string& bytes, const std::string& says) {
    folder.write("bad.foci", bytes);
    const Outcome outcome = render(folder, "bad.foci", "bad.pfm");
    SCOPED_TRACE(says);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("bad.foci"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "bad.pfm"));
  };
  expectRefused(whole.substr(0, 40), "cut short");
  expectRefused(whole.substr(0, whole.size() / 2), "cut short");
  expectRefused(whole.substr(0, whole.size() - 1), "cut short");
  expectRefused(whole + '\0', "too long");
  for (const std::size_t at : {std::size_t{20}, std::size_t{64}, whole.size() / 2}) {
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ 1);
    expectRefused(altered, "altered");
  }
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
