// Streamed SOG: which level of which box is read.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>

#include "base/input_error.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/gaussian_files_sog.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

/// Two boxes, x below and above 0. Level 0 has a Gaussian in each; level 1 only in the first.
constexpr const char* kMeta =
    R"({"version":1,"count":3,"counts":[2,1],"lodLevels":2,"filenames":["0_0/meta.json","1_0/meta.json"],
    "tree":{"bound":{"min":[-1,-3,0],"max":[2,3,5]},"children":[
    {"bound":{"min":[-1,-3,0],"max":[0,3,5]},"lods":{
      "0":{"file":0,"offset":0,"count":1},"1":{"file":1,"offset":1,"count":1}}},
    {"bound":{"min":[0,-3,0],"max":[2,3,5]},"lods":{"0":{"file":0,"offset":1,"count":1}}}]}})";

class StreamedSog : public testing::Test {
 protected:
  /// The folder of a scene; both chunks are the same SOG of two Gaussians.
  fs::path write(const std::string& meta = kMeta) {
    for (const char* chunk : {"0_0", "1_0", "env"}) {
      fs::create_directories(folder.path() / chunk);
      for (const auto& [name, bytes] : sogFolder(1)) {
        folder.write(std::string(chunk) + "/" + name, bytes);
      }
    }
    return folder.write("lod-meta.json", meta);
  }
  GaussianFile read(const fs::path& path, float needed) {
    return StreamedGaussians(path).read(
        [needed](const glm::vec3&, const glm::vec3&) { return needed; });
  }
  static std::string replaced(std::string text, const std::string& what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
  }

  const TemporaryFolder folder;
};

constexpr float kCoarse = std::numeric_limits<float>::infinity();

TEST_F(StreamedSog, TheViewChoosesTheLevelOfEachBox) {
  const fs::path path = write();
  const GaussianFile fine = read(path, 0.0f), coarse = read(path, kCoarse);
  ASSERT_EQ(fine.cloud.size(), 2u);
  EXPECT_NEAR(fine.cloud.position_m[0].z, kPosition.z, 1e-3f);
  EXPECT_NEAR(fine.cloud.position_m[1].z, kPosition.z + 1.0f, 1e-3f);
  EXPECT_TRUE(fine.remarks.empty());
  // The second box has no coarser level; the first one takes the second Gaussian of its chunk.
  ASSERT_EQ(coarse.cloud.size(), 2u);
  EXPECT_EQ(coarse.cloud.position_m[0], fine.cloud.position_m[1]);
  EXPECT_EQ(coarse.cloud.position_m[1], fine.cloud.position_m[1]);
  EXPECT_EQ(coarse.cloud.degree, 1);
  EXPECT_EQ(fine.cloud.harmonics.size(), 2 * fine.cloud.harmonicsPerGaussian());
}

TEST_F(StreamedSog, OpensByItsContentFromAFolderOrAnArchive) {
  const fs::path path = write();
  SogMembers members = {{"lod-meta.json", kMeta}};
  for (const char* chunk : {"0_0/", "1_0/"}) {
    for (const auto& [name, bytes] : sogFolder(1)) members.emplace_back(chunk + name, bytes);
  }
  const fs::path archive = folder.write("scene.ssog", zip(members));
  for (const fs::path& each : {path, folder.path(), archive}) {
    EXPECT_TRUE(isScene(each));
    SceneFile file = readScene(each);
    const SceneFacts facts = factsOf(file);
    EXPECT_EQ(facts.gaussians, 2u);
    EXPECT_EQ(facts.format, "3D Gaussians (streamed SOG)");
    EXPECT_EQ(facts.position.size(), 16u);
    const OpenedScene scene = openScene(std::move(file), 0.5, {});
    ASSERT_TRUE(scene.scene.gaussians());
    EXPECT_NEAR(scene.scene.gaussians()->position_m[0].z, 0.5f * kPosition.z, 1e-3f);
  }
}

TEST_F(StreamedSog, TheEnvironmentIsAlwaysThere) {
  const std::string meta =
      replaced(kMeta, "\"tree\"", "\"environment\":\"env/meta.json\",\"tree\"");
  EXPECT_EQ(read(write(meta), kCoarse).cloud.size(), 4u);
  EXPECT_EQ(
      read(write(replaced(kMeta, "\"tree\"", "\"environment\":null,\"tree\"")), 0.0f).cloud.size(),
      2u);
}

TEST_F(StreamedSog, DamagedFilesAreRefusedInOneLine) {
  const auto refusal = [&](const std::string& meta) -> std::string {
    try {
      read(write(meta), 0.0f);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "read";
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(refusal(replaced(kMeta, "\"version\":1", "\"version\":2")), "of version 2"));
  EXPECT_TRUE(has(refusal(replaced(kMeta, "\"file\":0", "\"file\":7")), "names a chunk"));
  EXPECT_TRUE(has(refusal(replaced(kMeta, "\"count\":1}", "\"count\":9}")), "fewer than"));
  EXPECT_TRUE(has(refusal(replaced(kMeta, "0_0/meta", "../meta")), "expected one in its folder"));
  EXPECT_TRUE(has(refusal(replaced(kMeta, "0_0/meta", "9_9/meta")), "no such file"));
  EXPECT_TRUE(has(refusal(replaced(kMeta, "\"tree\"", "\"wood\"")), "lod-meta.json: expected"));
  EXPECT_TRUE(has(refusal("{\"lodLevels\":1,\"filenames\":[],\"tree\":{}}"), "has no Gaussians"));
}

}  // namespace FOCI_FILE
}  // namespace foci
