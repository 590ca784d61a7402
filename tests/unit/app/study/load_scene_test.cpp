#include "app/study/load_scene.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <optional>
#include <utility>

#include "base/file.h"
#include "base/image_codec.h"
#include "render/lod/moment_tree.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/mesh/sample_mesh.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

// For all tests of this program.
[[maybe_unused]] const int kNoUserCache = setenv("XDG_CACHE_HOME", cacheWithoutScenes().c_str(), 1);

std::shared_ptr<const MeshTexture> textureOf(unsigned char grey) {
  DecodedImage image{.columns = 2, .rows = 2};
  for (int pixel = 0; pixel < 4; ++pixel) {
    image.rgba.insert(image.rgba.end(), {grey, grey, grey, 255});
  }
  return std::make_shared<MeshTexture>(image);
}

/// A textured square of two triangles.
TriangleMesh squareMesh() {
  const glm::vec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);
  TriangleMesh mesh;
  mesh.corners_m = {a, b, c, a, c, d};
  mesh.uv.resize(6);
  mesh.material = {0, 0};
  mesh.materials = {{.texture = textureOf(100)}};
  return mesh;
}

class SceneCacheTest : public testing::Test {
 protected:
  /// How many scenes were made for these calls.
  int madeFor(const SceneCache& cache, const TriangleMesh& mesh) {
    const SurfelCloud expected =
        withTree(surfelsFromPoints(sampleMesh(mesh, "square", {.points = 500})));
    const auto [cloud, made] = opened({.path = "square", .content = MeshFile{mesh, {}}}, {}, cache,
                                      [&] { return expected; });
    EXPECT_TRUE(builtTree(cloud));
    EXPECT_TRUE(cloud.position_m == expected.position_m);
    EXPECT_TRUE(cloud.axis_u_m == expected.axis_u_m);
    EXPECT_TRUE(cloud.color == expected.color);
    EXPECT_TRUE(cloud.area_m2 == expected.area_m2);
    EXPECT_EQ(cloud.oriented, expected.oriented);
    return made;
  }

  /// The surfels, as they were kept or as `make` gives them, and how many scenes were made.
  std::pair<SurfelCloud, int> opened(const SceneFile& file, const std::optional<glm::vec3>& eye_m,
                                     const SceneCache& cache,
                                     const std::function<SurfelCloud()>& make) {
    const auto entry = cache.entryOf(file, 1.0, eye_m);
    if (auto found = entry ? cache.find(*entry) : std::nullopt) return {std::move(*found), 0};
    SurfelCloud made = make();
    if (entry) cache.keep(*entry, {made});
    return {std::move(made), 1};
  }

  std::vector<fs::path> entries() const {
    std::vector<fs::path> all;
    for (const auto& file : fs::directory_iterator(folder_)) all.push_back(file.path());
    return all;
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path() / "foci" / "scenes";
  const SceneCache cache_{folder_, {.min_surfels = 1}};
  const TriangleMesh mesh_ = squareMesh();
};

TEST_F(SceneCacheTest, FindsWhatItKept) {
  EXPECT_EQ(madeFor(cache_, mesh_), 1);
  EXPECT_EQ(madeFor(cache_, mesh_), 0);
  EXPECT_EQ(cache_.content().entries, 1u);
  EXPECT_EQ(cache_.content().bytes, fs::file_size(entries().at(0)));
}

TEST_F(SceneCacheTest, AnythingThatChangesIsAnotherScene) {
  EXPECT_EQ(madeFor(cache_, mesh_), 1);
  const std::vector<std::function<void(TriangleMesh&)>> changes = {
      [](TriangleMesh& mesh) { mesh.materials[0].texture = textureOf(101); },
      [](TriangleMesh& mesh) { mesh.materials[0].mask = mesh.materials[0].texture; },
      [](TriangleMesh& mesh) { mesh.materials[0].factor.y = 0.5f; },
      [](TriangleMesh& mesh) { mesh.materials[0].opacity = 0.5f; },
      [](TriangleMesh& mesh) { mesh.corners_m[1].x = 2.0f; },
      [](TriangleMesh& mesh) { mesh.uv[0].x = 0.1f; },
      [](TriangleMesh& mesh) { mesh.color.resize(6, glm::vec3(0.5f)); },
      [](TriangleMesh& mesh) {
        mesh.surface = {0, 1};
      },
      [](TriangleMesh& mesh) {
        mesh.objects = {.of = {1, 1}, .names = {"", "a"}};
      },
      [](TriangleMesh& mesh) {
        mesh.objects = {.of = {1, 1}, .names = {"", "b"}};
      }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    TriangleMesh changed = squareMesh();
    changes[i](changed);
    EXPECT_EQ(madeFor(cache_, changed), 1) << i;
    EXPECT_EQ(madeFor(cache_, changed), 0) << i;
  }
  EXPECT_EQ(cache_.content().entries, changes.size() + 1);
}

TEST_F(SceneCacheTest, AnotherScaleIsAnotherScene) {
  const SceneFile file{.path = "square", .content = MeshFile{mesh_, {}}};
  EXPECT_NE(cache_.entryOf(file, 1.0, {}), cache_.entryOf(file, 2.0, {}));
  EXPECT_EQ(cache_.entryOf(file, 2.0, {}), cache_.entryOf(file, 2.0, {}));
}

TEST_F(SceneCacheTest, ADamagedEntryIsMadeAgain) {
  EXPECT_EQ(madeFor(cache_, mesh_), 1);
  const fs::path entry = entries().at(0);
  const std::string whole = textOf(entry);
  std::string flipped = whole;
  flipped[whole.size() / 2] ^= 1;
  for (const std::string& damaged : {flipped, whole.substr(0, 1000), std::string("not a scene")}) {
    writeText(entry, damaged);
    EXPECT_EQ(madeFor(cache_, mesh_), 1);
    EXPECT_EQ(textOf(entry), whole);
    EXPECT_EQ(madeFor(cache_, mesh_), 0);
  }
}

TEST_F(SceneCacheTest, TheEntriesUsedLongestAgoGoFirst) {
  EXPECT_EQ(madeFor(cache_, mesh_), 1);
  const std::uint64_t bytes = cache_.content().bytes;
  const SceneCache bounded(folder_, {.max_B = 2 * bytes + bytes / 2, .min_surfels = 1});
  std::vector<TriangleMesh> meshes(3, mesh_);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    meshes[i].materials[0].factor.x = 0.1f * static_cast<float>(i + 1);
  }
  const auto age = [&](std::chrono::hours hours) {
    for (const fs::path& entry : entries()) {
      fs::last_write_time(entry, fs::last_write_time(entry) - hours);
    }
  };
  age(std::chrono::hours(3));
  EXPECT_EQ(madeFor(bounded, meshes[0]), 1);
  age(std::chrono::hours(1));
  EXPECT_EQ(madeFor(bounded, mesh_), 0);  // the older one is used
  EXPECT_EQ(madeFor(bounded, meshes[1]), 1);
  EXPECT_EQ(madeFor(bounded, mesh_), 0);
  EXPECT_EQ(madeFor(bounded, meshes[1]), 0);
  EXPECT_EQ(bounded.content().entries, 2u);
  EXPECT_LE(bounded.content().bytes, 2 * bytes + bytes / 2);
}

TEST_F(SceneCacheTest, WhatKilledRunsLeftGoes) {
  EXPECT_EQ(madeFor(cache_, mesh_), 1);
  const fs::path aside = entries().at(0).string() + ".123";
  writeText(aside, "half");
  EXPECT_EQ(cache_.content().entries, 1u);
  EXPECT_TRUE(fs::exists(aside));  // that run may go on
  fs::last_write_time(aside, fs::file_time_type::clock::now() - std::chrono::hours(2));
  EXPECT_EQ(cache_.content().entries, 1u);
  EXPECT_FALSE(fs::exists(aside));
}

TEST_F(SceneCacheTest, AScanDependsOnTheEyeWhereItsNormalsDo) {
  PointCloud points;
  for (int i = 0; i < 100; ++i) points.position_m.emplace_back(i % 10, i / 10, 0.0f);
  points.color.resize(100, glm::vec3(0.5f));
  const auto made = [&](const std::optional<glm::vec3>& viewpoint_m) {
    return opened({.path = "scan", .content = points}, viewpoint_m, cache_,
                  [&] {
                    return withTree(
                        surfelsFromPoints(PointCloud(points), {.viewpoint_m = viewpoint_m}));
                  })
        .second;
  };
  EXPECT_EQ(made(std::nullopt), 1);
  EXPECT_EQ(made(glm::vec3(0, 0, 1)), 1);
  EXPECT_EQ(made(glm::vec3(0, 0, -1)), 1);
  EXPECT_EQ(made(glm::vec3(0, 0, 1)), 0);
}

TEST_F(SceneCacheTest, WithoutAFolderScenesAreMade) {
  const SceneCache nowhere("/dev/null/foci", {.min_surfels = 1});
  EXPECT_EQ(madeFor(nowhere, mesh_), 1);
  EXPECT_EQ(madeFor(nowhere, mesh_), 1);
  EXPECT_EQ(nowhere.content().entries, 0u);
}

}  // namespace FOCI_FILE
}  // namespace foci
