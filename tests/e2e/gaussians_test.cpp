// Scenes of Gaussians, as users run them: a `.splat` file that the test writes, and captures where
// they are here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"
#include "tests/e2e/linear_image.h"

namespace foci::e2e {
namespace FOCI_FILE {

using Json = nlohmann::json;

constexpr int kWidth = 240, kHeight = 180;
constexpr float kWall_m = 2.0f, kBar_m = 0.4f;

struct Image : LinearImage {
  using LinearImage::LinearImage;

  /// The largest step between neighbours in a row.
  float steepestIn(int row) const { return LinearImage::steepestIn(row, 0, width); }

  /// Largest difference of red and blue.
  float fringe() const {
    float most = 0.0f;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) most = std::max(most, std::abs(at(x, y, 0) - at(x, y, 2)));
    }
    return most;
  }

  /// Column of the middle of what is brighter than `least`, among the columns `x0` to `x1`.
  float brightColumn(int x0, int x1, int row, float least) const {
    float sum = 0.0f, weights = 0.0f;
    for (int x = x0; x < x1; ++x) {
      if (at(x, row) < least) continue;
      sum += at(x, row) * static_cast<float>(x - x0);
      weights += at(x, row);
    }
    return weights > 0.0f ? sum / weights : -1.0f;
  }
};

void appendSplat(std::string& file, const std::array<float, 3>& position_m, float sigma_m,
                 unsigned char grey) {
  const std::array<float, 6> numbers{position_m[0], position_m[1], position_m[2],
                                     sigma_m,       sigma_m,       1e-4f};
  const std::array<unsigned char, 8> bytes{grey, grey, grey, 255, 255, 128, 128, 128};
  std::array<char, 32> record{};
  std::memcpy(record.data(), numbers.data(), sizeof numbers);
  std::memcpy(record.data() + sizeof numbers, bytes.data(), sizeof bytes);
  file.append(record.data(), record.size());
}

/// A wall whose left half is dark, and in its upper half, a thin white bar near the eye.
std::string wallAndBar() {
  constexpr float kSpacing_m = 0.02f;
  std::string file;
  for (int y = -45; y < 45; ++y) {
    for (int x = -60; x < 60; ++x) {
      appendSplat(file,
                  {(static_cast<float>(x) + 0.5f) * kSpacing_m,
                   (static_cast<float>(y) + 0.5f) * kSpacing_m, -kWall_m},
                  0.7f * kSpacing_m, x < 0 ? 30 : 150);
    }
  }
  for (int i = 0; i < 40; ++i) {
    appendSplat(file, {0.0f, 0.02f + 0.002f * static_cast<float>(i), -kBar_m}, 0.002f, 255);
  }
  return file;
}

class GaussianScenes : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("scene.splat", wallAndBar());
    folder.write("trace.tsv", steadyTrace());
    writeStudy("study.toml", "");
  }

  void writeStudy(const std::string& name, const std::string& more) const {
    std::string study = smallStudy();
    study.replace(study.find("scene.ply"), 9, "scene.splat");
    const std::string size = "[96, 72]";
    study.replace(study.find(size), size.size(),
                  "[" + std::to_string(kWidth) + ", " + std::to_string(kHeight) + "]");
    folder.write(name, study + more);
  }

  Image rendered(const std::string& study, std::vector<std::string> options) const {
    std::vector<std::string> arguments{"render",  study, "--out",   "image.pfm",
                                       "--focus", "2",   "--pupil", "8"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = runFoci(arguments, folder.path());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Image(folder.read("image.pfm"));
  }

  TemporaryFolder folder;
};

constexpr int kWallRow = kHeight * 3 / 4, kBarRow = kHeight * 3 / 8;

TEST_F(GaussianScenes, DepthIsTheDistanceOfEachSurface) {
  rendered("study.toml", {"--method", "pinhole", "--depth", "depth.pfm"});
  const Image depth(folder.read("depth.pfm"));
  ASSERT_EQ(depth.width, kWidth);
  // Along the axis, the distance of both definitions of distance is the same.
  constexpr float kWithin = 0.03f;  // a pixel near the axis is off by cos(5 deg)
  EXPECT_NEAR(depth.at(kWidth / 2, kHeight / 2 + 4), kWall_m, kWithin * kWall_m);
  EXPECT_NEAR(depth.at(kWidth / 2, kBarRow), kBar_m, kWithin * kBar_m);
}

TEST_F(GaussianScenes, BothEyesSeeTheNearBarAtDifferentPlaces) {
  const Image both = rendered("study.toml", {"--method", "pinhole", "--view", "side-by-side"});
  constexpr float kWhite = 0.6f;
  const int half = both.width / 2, row = both.height * 3 / 8;
  const float left = both.brightColumn(0, half, row, kWhite);
  const float right = both.brightColumn(half, both.width, row, kWhite);
  ASSERT_GE(left, 0.0f);
  ASSERT_GE(right, 0.0f);
  // The bar is nearer than the screen: crossed disparity.
  EXPECT_GT(left, right + 2.0f);
}

TEST_F(GaussianScenes, AnUncorrectedShortSightedEyeSeesTheWallBlurred) {
  writeStudy("short.toml", "[observer]\nsphere_D = -10\ncorrected = false\n");
  writeStudy("glasses.toml", "[observer]\nsphere_D = -10\ncorrected = true\n");
  // The edge has a standard deviation of 2 px. The eye is 9.5 D out of focus, so 300 px per unit of
  // tangent and a pupil of 8 mm blur by 11 px, a deviation of 5.7 px: 0.35 of the slope is left.
  const float sharp = rendered("study.toml", {}).steepestIn(kWallRow);
  EXPECT_LT(rendered("short.toml", {}).steepestIn(kWallRow), 0.5f * sharp);
  EXPECT_GT(rendered("glasses.toml", {}).steepestIn(kWallRow), 0.8f * sharp);
}

TEST_F(GaussianScenes, ChromaticFocusGivesTheEdgesOfAGreyWallColours) {
  writeStudy("chromatic.toml", "[observer]\nchromatic = true\n");
  constexpr float kRounding = 1e-4f, kVisible = 0.01f;
  EXPECT_LT(rendered("study.toml", {}).fringe(), kRounding);
  EXPECT_GT(rendered("chromatic.toml", {}).fringe(), kVisible);
}

TEST_F(GaussianScenes, AReplayFocusesOnTheWallWithTheSameBytesAtAnyNumberOfThreads) {
  for (const std::string threads : {"1", "2"}) {
    const Outcome outcome = runFoci(
        {"replay", "study.toml", "--threads", threads, "--out", "out" + threads}, folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  const Json one = Json::parse(folder.read("out1/manifest.json"));
  const Json two = Json::parse(folder.read("out2/manifest.json"));
  EXPECT_EQ(one["frames_sha256"], two["frames_sha256"]);
  const auto table = tableOf(folder.read("out1/frames.tsv"));
  ASSERT_GT(table.size(), 2u);
  const auto column = std::ranges::find(table[0], "focus_D") - table[0].begin();
  ASSERT_LT(static_cast<std::size_t>(column), table[0].size());
  // Accommodation starts elsewhere and approaches the wall.
  EXPECT_NEAR(std::stod(table.back()[static_cast<std::size_t>(column)]), 1.0 / kWall_m, 0.1);
}

TEST_F(GaussianScenes, APreparedSceneLooksTheSame) {
  const Outcome outcome = runFoci({"prepare", "scene.splat", "--out", "scene.foci"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("10,840 Gaussians, a tree of "), std::string::npos) << outcome.out;
  std::string study = folder.read("study.toml");
  study.replace(study.find("scene.splat"), 11, "scene.foci");
  folder.write("prepared.toml", study);
  // `auto` makes the tree itself where the scene has none.
  const std::vector<float> original = rendered("study.toml", {}).values;
  EXPECT_EQ(rendered("prepared.toml", {}).values, original);
  const Outcome replayed = runFoci({"replay", "prepared.toml", "--out", "prepared"}, folder.path());
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  const Outcome info = runFoci({"info", "scene.foci"}, folder.path());
  EXPECT_NE(info.out.find("10,840 Gaussians"), std::string::npos) << info.out;
}

// A red board joins the captured wall, once before and once behind it.
TEST_F(GaussianScenes, APartOfTheSceneIsHiddenByTheWallAndHidesIt) {
  std::string board =
      "ply\nformat ascii 1.0\nelement vertex 600\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "end_header\n";
  for (int i = 0; i < 600; ++i) {
    board += std::to_string(0.01 * (i % 20) - 0.095) + ' ' + std::to_string(0.01 * (i / 20) - 0.4) +
             " 0 230 0 0\n";
  }
  folder.write("board.ply", board);
  const auto redness = [&](float z) {
    writeStudy("joined.toml", "[[scene.part]]\nfile = \"board.ply\"\nposition_m = [0, 0, " +
                                  std::to_string(z) + "]\n");
    const Outcome outcome = runFoci(
        {"render", "joined.toml", "--out", "j.pfm", "--write-study", "again.toml", "--overwrite"},
        folder.path());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(
        runFoci({"render", "again.toml", "--out", "k.pfm", "--overwrite"}, folder.path()).exit_code,
        0);
    EXPECT_EQ(folder.read("j.pfm"), folder.read("k.pfm"));
    int red = 0;
    const Image image(folder.read("j.pfm"));
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x)
        red += image.at(x, y, 0) > 0.2f && image.at(x, y, 1) < 0.05f;
    }
    return red;
  };
  EXPECT_GT(redness(-kWall_m + 0.5f), 20);
  EXPECT_EQ(redness(-kWall_m - 0.5f), 0);
  const Outcome none = [&] {
    writeStudy("joined.toml", "[[scene.part]]\nposition_m = [0, 0, 1]\n");
    return runFoci({"render", "joined.toml", "--out", "n.png"}, folder.path());
  }();
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("file in each part"), std::string::npos) << none.err;
  writeStudy("joined.toml", "[[scene.part]]\nfile = \"absent.ply\"\n");
  const Outcome absent = runFoci({"render", "joined.toml", "--out", "n.png"}, folder.path());
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_NE(absent.err.find("joined.toml: scene.part, entry 1: file = "), std::string::npos)
      << absent.err;
}

TEST_F(GaussianScenes, TheChartHasTheMethodsThatRenderThem) {
  const auto chart = [&](const std::string& out, const std::string& method) {
    std::vector<std::string> arguments = {
        "chart",     "--quick", "--scene", "scan",  "--scan", "scene.splat", "--eye", "0,0,0",
        "--look-at", "0,0,-2",  "--up",    "0,1,0", "--size", "64",          "--out", out};
    if (!method.empty()) arguments.insert(arguments.end(), {"--method", method});
    return runFoci(arguments, folder.path());
  };
  const Outcome outcome = chart("chart", "");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string csv = folder.read("chart/chart.csv");
  for (const char* method :
       {"auto", "sweep-lod,7", "accumulate,16", "inflate:spark", "inflate:splat-transform"}) {
    EXPECT_NE(csv.find(std::string("scan,4,") + method + ","), csv.npos) << method;
  }
  EXPECT_EQ(csv.find("potmesil"), csv.npos);
  EXPECT_EQ(chart("none", "potmesil").exit_code, 2);
}

TEST_F(GaussianScenes, AGpuRendersThem) {
  const Json doctor = Json::parse(runFoci({"doctor", "--json"}, folder.path()).out);
  if (doctor["gpu"].contains("problem")) GTEST_SKIP() << doctor["gpu"]["problem"];
  const Outcome outcome =
      runFoci({"replay", "study.toml", "--device", "gpu", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("the CPU renders"), std::string::npos) << outcome.err;
  const Json manifest = Json::parse(folder.read("out/manifest.json"));
  EXPECT_EQ(std::string(manifest["device"]).find("the CPU"), std::string::npos)
      << manifest["device"];
}

/// A capture through the whole program.
class GaussianCaptures : public testing::TestWithParam<const char*> {};

TEST_P(GaussianCaptures, AreFramedAndReplayed) {
  const auto data = dataFolder();
  if (!data || !std::filesystem::exists(*data / "splats" / GetParam())) {
    GTEST_SKIP() << "no " << GetParam();
  }
  const TemporaryFolder folder;
  folder.write("trace.tsv", steadyTrace());
  const Outcome framed =
      runFoci({"render", (*data / "splats" / GetParam()).string(), "--size", "160x160", "--out",
               "a.pfm", "--depth", "depth.pfm", "--write-study", "study.toml"},
              folder.path());
  ASSERT_EQ(framed.exit_code, 0) << framed.err;
  const Image image(folder.read("a.pfm")), depth(folder.read("depth.pfm"));
  const auto shown = std::ranges::count_if(image.values, [](float v) { return v > 0.01f; });
  EXPECT_GT(shown, static_cast<std::ptrdiff_t>(image.values.size() / 50));
  EXPECT_GT(std::ranges::max(depth.values), 0.1f);
  const Outcome replayed =
      runFoci({"replay", "study.toml", "--trace", "trace.tsv", "--size", "160x160", "--out", "out"},
              folder.path());
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
}

INSTANTIATE_TEST_SUITE_P(Files, GaussianCaptures,
                         testing::Values("guitar.compressed.ply", "biker.compressed.ply",
                                         "biker.spz"),
                         [](const auto& test) {
                           std::string name(test.param);
                           std::ranges::replace(name, '.', '_');
                           return name;
                         });

}  // namespace FOCI_FILE
}  // namespace foci::e2e
