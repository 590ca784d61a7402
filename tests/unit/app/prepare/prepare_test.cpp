#include "app/prepare/prepare.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "base/input_error.h"
#include "render/scene/gaussian_tree.h"
#include "render/scene/io/foci_file.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

class PrepareScene : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }

  /// A square of one square metre, as two triangles.
  std::filesystem::path square() {
    return file("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  }

  std::string refusal(const PrepareRequest& request) {
    try {
      prepareScene(request);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  const TemporaryFolder temporary_;
  const std::filesystem::path& folder_ = temporary_.path();
};

TEST_F(PrepareScene, MakesASceneAndAReportOfAMesh) {
  const PrepareSummary summary =
      prepareScene({.input = square(), .out = folder_ / "s.foci", .scale_m = 2.0, .points = 3000});
  const auto cloud = std::get<SurfelCloud>(readSceneFile(folder_ / "s.foci").scene.splats);
  EXPECT_EQ(cloud.size(), summary.surfels);
  EXPECT_NEAR(summary.area_m2, 4.0, 0.4);  // surfels at the border reach beyond it
  ASSERT_EQ(summary.normalisation.size(), 3u);
  EXPECT_GT(summary.normalisation[0].smooth.within_10, 0.95);
  std::size_t counted = 0;
  for (const std::size_t bin : summary.normalisation[0].whole.histogram) counted += bin;
  EXPECT_EQ(counted, 10000u);  // one sum for each probe

  std::ifstream report(folder_ / "s.html");
  const std::string page{std::istreambuf_iterator<char>(report), {}};
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(files(), 4u);  // mesh, scene, report and .foci-outputs: no temporary file is left
}

TEST_F(PrepareScene, GivesGaussiansTheirLevelsOfDetail) {
  // Records of a `.splat` file: place, standard deviations, then colour and rotation in bytes.
  std::string records;
  for (int i = 0; i < 10; ++i) {
    const std::array<float, 6> numbers{0.1f * static_cast<float>(i), 0.0f, 1.0f, 0.1f, 0.1f, 0.1f};
    records.append(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
    records += "\x80\x80\x80\xff\xff\x80\x80\x80";
  }
  const auto input = file("g.splat", records);
  const PrepareSummary summary = prepareScene({.input = input, .out = folder_ / "g.foci"});
  const auto cloud = std::get<GaussianCloud>(readSceneFile(folder_ / "g.foci").scene.splats);
  ASSERT_TRUE(cloud.tree);
  EXPECT_EQ(summary.gaussians, 10u);
  EXPECT_EQ(summary.nodes, cloud.tree->nodes.size() - 1);
  std::ifstream report(folder_ / "g.html");
  const std::string page{std::istreambuf_iterator<char>(report), {}};
  EXPECT_NE(page.find("10 Gaussians"), std::string::npos);
  EXPECT_THROW(
      prepareScene({.input = input, .out = folder_ / "g.foci", .points = 9, .overwrite = true}),
      InputError);
}

TEST_F(PrepareScene, CountsThePointsLeftOut) {
  const auto cloud = file("c.ply",
                          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                          "property float y\nproperty float z\nend_header\n"
                          "0 0 0\n1 0 0\nnan 0 0\n0 1 0\n");
  const PrepareSummary summary = prepareScene({.input = cloud, .out = folder_ / "c.foci"});
  EXPECT_EQ(summary.surfels, 3u);
  EXPECT_EQ(summary.dropped, 1u);
}

TEST_F(PrepareScene, RefusesInOneLineAndLeavesNothing) {
  EXPECT_NE(refusal({.input = square(), .out = folder_ / "s.ply"}).find(".foci"),
            std::string::npos);
  EXPECT_NE(refusal({.input = folder_ / "missing.ply", .out = folder_ / "s.foci"}), "accepted");
  EXPECT_NE(refusal({.input = file("bad.obj", "hello"), .out = folder_ / "s.foci"}), "accepted");
  std::filesystem::create_directory(folder_ / "folder.foci");
  EXPECT_NE(refusal({.input = square(), .out = folder_ / "folder.foci"}), "accepted");
  EXPECT_EQ(files(), 3u);

  prepareScene({.input = square(), .out = folder_ / "s.foci", .points = 100});
  EXPECT_NE(refusal({.input = folder_ / "s.foci", .out = folder_ / "t.foci"}).find("already"),
            std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
