#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

/// A bumpy square before the eye at the origin.
std::string bumpyPly() {
  return reliefPly([](int x, int y) { return 2.0 + 0.01 * ((x / 6 + y / 6) % 3) + 0.01 * x; });
}

std::vector<std::string> seenAlong(const std::string& up, std::vector<std::string> more) {
  more.insert(more.begin(), {"--eye", "0,0,0", "--look-at", "0,0,-1", "--up", up});
  return more;
}

Outcome reproduce(const TemporaryFolder& folder, const std::vector<std::string>& options) {
  std::vector<std::string> arguments = {"reproduce", "--out", "made/out", "--quick"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return runFoci(arguments, folder.path());
}

TEST(Reproduce, WritesTheTableThePageAndTheFigures) {
#ifdef FOCI_SANITIZED
  GTEST_SKIP() << "thousands of frames of 512 x 512 px are too slow under a sanitizer";
#endif
  const TemporaryFolder folder;
  folder.write("bumps.ply", bumpyPly());
  const Outcome outcome = reproduce(folder, seenAlong("0,1,0", {"--scan", "bumps.ply", "--json"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("rendering: "), std::string::npos);

  std::istringstream csv(folder.read("made/out/table1.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "scene,aperture,blur_px_max,method,lod,kfragments,points,ms_median,ms_min,threads,"
            "psnr_dB,ssim,silhouette_psnr_dB");
  std::size_t rows = 0;
  for (; std::getline(csv, line); ++rows) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 12) << line;
    EXPECT_TRUE(line.starts_with("plane,") || line.starts_with("bumps,")) << line;
  }

  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("rows").size(), rows);
  for (const char* scene : {"plane", "bumps"}) {
    // Fragments of `paper` with one thread, against the paper's own counts.
    std::vector<double> fragments;
    for (const auto& row : json.at("rows")) {
      if (row.at("scene") == scene && row.at("method") == "paper" && row.at("threads") == 1) {
        fragments.push_back(row.at("kfragments"));
      }
    }
    ASSERT_EQ(fragments.size(), 3u);
    if (std::string(scene) == "plane") {
      EXPECT_NEAR(fragments[0] / 5685, 1.0, 0.15);
      EXPECT_NEAR(fragments[1] / 17630, 1.0, 0.15);
      EXPECT_NEAR(fragments[2] / 196752, 1.0, 0.15);
    } else {
      EXPECT_NEAR(fragments[1] / fragments[0] / (7771.0 / 2266), 1.0, 0.01);
      EXPECT_NEAR(fragments[2] / fragments[0] / (90219.0 / 2266), 1.0, 0.01);
    }
  }
  const std::string page = folder.read("made/out/reproduce.html");
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);  // the page needs no other file
  EXPECT_NE(page.find("<title>foci reproduce: plane, bumps (quick)</title>"), std::string::npos);
  EXPECT_NE(page.find("aria-label=\"Time per frame against aperture: bumps\""), std::string::npos);
  // A quick run does not judge.
  EXPECT_EQ(page.find("<b class=\"no\">"), std::string::npos);
  EXPECT_EQ(page.find("<b class=\"yes\">"), std::string::npos);
  EXPECT_NE(page.find("This is a quick run"), std::string::npos);
  EXPECT_EQ(json.at("quick"), true);
  for (const auto& ratio : json.at("ratios")) EXPECT_FALSE(ratio.contains("reached"));
  for (const char* file : {"figure1.png", "figure6_plane.png", "figure6_bumps.png"}) {
    EXPECT_TRUE(folder.read(std::string("made/out/") + file).starts_with("\x89PNG")) << file;
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path() / "made/out"), {}),
            6);  // and .foci-outputs
}

struct Refusal {
  std::string says;
  std::vector<std::string> options;
};

TEST(Reproduce, RefusesInOneLineAndLeavesNothing) {
  const TemporaryFolder folder;
  folder.write("flat.ply", squarePly(80, 2.0));
  folder.write("few.ply", squarePly(8, 2.0));
  folder.write("none.ply", "ply\n");
  const std::vector<Refusal> refusals = {
      {"missing.ply", {"--scan", "missing.ply"}},
      {"none.ply", {"--scan", "none.ply"}},
      {"16 points in view", seenAlong("0,1,0", {"--scan", "few.ply"})},
      {"all its points in view are in focus", seenAlong("0,1,0", {"--scan", "flat.ply"})},
      {"--look-at", seenAlong("0,0,1", {"--scan", "flat.ply"})},
      {"--eye", {"--eye", "1,2"}},
      {"1 to 1024", {"--threads", "0"}},
  };
  for (const Refusal& refusal : refusals) {
    const Outcome outcome = reproduce(folder, refusal.options);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(refusal.says), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "made"));
  }
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
