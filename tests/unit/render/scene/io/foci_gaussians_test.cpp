// Gaussians and their tree in `.foci` files.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "base/input_error.h"
#include "render/scene/gaussian_tree.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/gaussian_scenes.h"

namespace foci {
namespace FOCI_FILE {

/// 37 Gaussians with harmonics, without a tree.
GaussianCloud withoutTree(int degree) {
  std::mt19937 random(1);
  GaussianCloud cloud;
  for (int i = 0; i < 37; ++i) {
    const auto next = [&] { return static_cast<float>(random() % 1000) / 1000.0f; };
    addGaussian(cloud, {next(), next(), next()}, {0.1f * next(), 0.01f, 0.02f}, next(),
                {next(), next(), -0.1f});
  }
  cloud.degree = degree;
  cloud.harmonics.resize(cloud.size() * cloud.harmonicsPerGaussian());
  for (std::int16_t& each : cloud.harmonics) each = static_cast<std::int16_t>(random() % 500);
  return cloud;
}

GaussianCloud some(int degree) { return withTree(withoutTree(degree)); }

PreparedScene prepared(GaussianCloud cloud, bool y_is_down = false) {
  return {{std::move(cloud)}, {.y_is_down = y_is_down}};
}

void expectSame(const GaussianCloud& a, const GaussianCloud& b) {
  EXPECT_EQ(a.position_m, b.position_m);
  EXPECT_EQ(a.covariance_m2, b.covariance_m2);
  EXPECT_EQ(a.opacity, b.opacity);
  EXPECT_EQ(a.color, b.color);
  EXPECT_EQ(a.harmonics, b.harmonics);
  EXPECT_EQ(a.degree, b.degree);
  EXPECT_EQ(a.preserves_light, b.preserves_light);
}

class FociGaussians : public testing::Test {
 protected:
  std::string refusal(const std::string& content) const {
    std::ofstream(path_, std::ios::binary) << content;
    try {
      readSceneFile(path_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "scene.foci";
};

TEST_F(FociGaussians, BringBackWhatWasWritten) {
  for (int degree = 0; degree <= kMaxHarmonicsDegree; ++degree) {
    GaussianCloud cloud = some(degree);
    cloud.preserves_light = degree == 2;
    writeSceneFile(path_, prepared(cloud, degree == 1));
    EXPECT_TRUE(isSceneFile(path_));
    const PreparedScene back = readSceneFile(path_);
    const GaussianCloud* const read = back.scene.gaussians();
    ASSERT_TRUE(read && read->tree);
    expectSame(*read, cloud);
    EXPECT_EQ(read->tree->nodes.position_m, cloud.tree->nodes.position_m);
    EXPECT_EQ(read->tree->nodes.harmonics, cloud.tree->nodes.harmonics);
    EXPECT_EQ(read->tree->spread_m2, cloud.tree->spread_m2);
    EXPECT_EQ(read->tree->growth_per_m2, cloud.tree->growth_per_m2);
    EXPECT_EQ(back.origin.y_is_down, degree == 1);
  }
}

TEST_F(FociGaussians, OpenAsASceneInMetres) {
  const GaussianCloud cloud = some(1);
  writeSceneFile(path_, prepared(cloud));
  const Scene scene = openScene(path_, 2.0, std::nullopt).scene;
  const GaussianCloud* const opened = scene.gaussians();
  ASSERT_TRUE(opened);
  GaussianCloud twice = cloud;
  scaleBy(twice, 2.0f);
  expectSame(*opened, twice);
  // The tree of the larger scene is the larger tree.
  GaussianCloud larger = withoutTree(1);
  scaleBy(larger, 2.0f);
  const GaussianCloud again = withTree(std::move(larger));
  for (std::size_t node = 1; node < again.tree->radius_m.size(); ++node) {
    EXPECT_NEAR(opened->tree->radius_m[node], again.tree->radius_m[node], 1e-4f);
    EXPECT_NEAR(opened->tree->nodes.opacity[node], again.tree->nodes.opacity[node], 1e-3f);
    EXPECT_NEAR(opened->tree->spread_m2[node], again.tree->spread_m2[node], 1e-4f);
    EXPECT_NEAR(opened->tree->growth_per_m2[node] / again.tree->growth_per_m2[node], 1.0f, 1e-3f);
  }
}

TEST_F(FociGaussians, TakeLittleMemory) {
  // Bytes in the file are bytes in memory.
  constexpr double kMost = 250.0;
  for (const std::size_t n : {4095u, 4096u, 5000u, 8191u}) {
    GaussianCloud cloud;
    for (std::size_t i = 0; i < n; ++i) {
      addGaussian(cloud, {static_cast<float>(i), 0.0f, 0.0f}, glm::vec3(0.1f), 0.5f,
                  glm::vec3(0.5f));
    }
    cloud.degree = kMaxHarmonicsDegree;
    cloud.harmonics.resize(n * cloud.harmonicsPerGaussian());
    writeSceneFile(path_, prepared(withTree(std::move(cloud))));
    EXPECT_LT(static_cast<double>(std::filesystem::file_size(path_)),
              kMost * static_cast<double>(n))
        << n;
  }
}

TEST_F(FociGaussians, RefuseWhatWasAltered) {
  writeSceneFile(path_, prepared(some(1)));
  std::ifstream in(path_, std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(refusal(good), "");
  for (std::size_t at = 0; at < good.size(); at += 13) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 4);
    EXPECT_NE(refusal(bad), "") << at;
    EXPECT_EQ(refusal(bad).find('\n'), std::string::npos);
  }
  EXPECT_NE(refusal(good.substr(0, good.size() - 1)).find("is cut short"), std::string::npos);
  EXPECT_NE(refusal(good + "x").find("is too long"), std::string::npos);
}

TEST_F(FociGaussians, RefuseWhatIsNotSound) {
  const auto refusalOf = [&](const GaussianCloud& cloud) {
    writeSceneFile(path_, prepared(cloud));
    try {
      readSceneFile(path_);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  GaussianCloud cloud = some(0);
  cloud.opacity[5] = 1.5f;
  EXPECT_NE(refusalOf(cloud).find("Gaussian 5 is not sound"), std::string::npos);
  cloud = some(0);
  cloud.position_m[36].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refusalOf(cloud).find("Gaussian 36 is not sound"), std::string::npos);
  cloud = some(0);
  GaussianTree tree = *cloud.tree;
  tree.radius_m[3] = -1.0f;
  cloud.tree = std::make_shared<const GaussianTree>(tree);
  EXPECT_NE(refusalOf(cloud).find("node 3 is not sound"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
