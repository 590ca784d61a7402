// The cache of opened scenes: runs with, without and again have the same frames.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;

std::string squareObj(const std::string& colour) {
  return "v -0.5 -0.5 -2 " + colour + "\nv 0.5 -0.5 -2 " + colour + "\nv 0.5 0.5 -2 " + colour +
         "\nv -0.5 0.5 -2 " + colour + "\nf 1 2 3 4\n";
}

TEST(SceneCache, FramesAreTheSameWithWithoutAndAgain) {
  const TemporaryFolder folder;
  folder.write("scene.obj", squareObj("0.2 0.4 0.6"));
  std::string study = smallStudy();
  study.replace(study.find("scene.ply"), 9, "scene.obj");
  folder.write("study.toml", study);
  folder.write("trace.tsv", steadyTrace());
  const fs::path scenes = folder.path() / "cache" / "foci" / "scenes";
  const auto kept = [&] {
    return fs::exists(scenes) ? std::distance(fs::directory_iterator(scenes), {}) : 0;
  };
  const auto framesOf = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"replay", "study.toml", "--out", "run", "--overwrite"});
    const Outcome outcome =
        runFoci(options, folder.path(), {"XDG_CACHE_HOME=" + (folder.path() / "cache").string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(folder.read("run/manifest.json")).at("frames_sha256");
  };
  const auto without = framesOf({"--no-cache"});
  EXPECT_EQ(kept(), 0);
  EXPECT_EQ(framesOf({}), without);
  EXPECT_EQ(kept(), 1);
  EXPECT_EQ(framesOf({}), without);
  EXPECT_EQ(kept(), 1);
  EXPECT_EQ(framesOf({"--set", "scene.cache=false"}), without);

  folder.write("scene.obj", squareObj("0.6 0.4 0.2"));
  EXPECT_NE(framesOf({}), without);
  EXPECT_EQ(kept(), 2);
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
