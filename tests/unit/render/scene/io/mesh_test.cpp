#include "tests/unit/render/scene/io/read_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "render/scene/io/foci_file.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/mesh/sample_mesh.h"
#include "render/scene/sampling/poisson_disk.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kCount = 0.12;  // statistical: dart throwing fills more or less of the room
constexpr float kByte = 0.01f;   // 8-bit sRGB

PointCloud sampled(const std::filesystem::path& path, const MeshSampling& sampling) {
  return sampleMesh(readMesh(path).mesh, path, sampling);
}

class MeshTest : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& content) {
    return temporary_.write(name, content);
  }

  /// A quad of 2 x 1 whose texture is red on its left half, blue on its right, brighter at the top.
  std::filesystem::path texturedQuad() {
    cv::Mat image(64, 128, CV_8UC3);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 128; ++x) {
        const uchar level = y < 32 ? 255 : 128;
        image.at<cv::Vec3b>(y, x) = x < 64 ? cv::Vec3b(0, 0, level) : cv::Vec3b(level, 0, 0);
      }
    }
    cv::imwrite((folder_ / "t.png").string(), image);
    file("quad.mtl", "newmtl m\nKd 0.2 0.2 0.2\nmap_Kd t.png\n");
    return file("quad.obj",
                "mtllib quad.mtl\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n"
                "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n");
  }

  std::string refusal(const std::filesystem::path& path) {
    try {
      sampled(path, {.points = 100});
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      return what;
    }
    return "";
  }

  const TemporaryFolder temporary_;
  const std::filesystem::path& folder_ = temporary_.path();
};

TEST_F(MeshTest, TakesColoursFromATexture) {
  const PointCloud points = sampled(texturedQuad(), {.points = 2000});
  EXPECT_NEAR(static_cast<double>(points.size()), 2000.0, 2000.0 * kCount);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec3 p = points.position_m[i];
    EXPECT_EQ(points.normal[i], glm::vec3(0.0f, 0.0f, 1.0f));
    if (std::abs(p.x - 1.0f) < 0.05f || std::abs(p.y - 0.5f) < 0.05f) continue;  // across the edges
    if (p.x < 0.05f || p.x > 1.95f || p.y < 0.05f || p.y > 0.95f) continue;      // it repeats
    const float level = p.y > 0.5f ? 1.0f : 0.2159f;                             // sRGB 128
    const glm::vec3 expected = p.x < 1.0f ? glm::vec3(level, 0, 0) : glm::vec3(0, 0, level);
    ASSERT_LT(glm::distance(points.color[i], expected), kByte) << p.x << ", " << p.y;
  }
}

TEST_F(MeshTest, AveragesATextureFinerThanItsPoints) {
  cv::Mat checker(256, 256, CV_8UC1);
  for (int i = 0; i < 256 * 256; ++i) {
    checker.data[i] = (i % 256 + i / 256) % 2 == 0 ? 255 : 0;
  }
  cv::imwrite((folder_ / "t.png").string(), checker);
  file("q.mtl", "newmtl m\nmap_Kd t.png\n");
  const auto path = file("q.obj",
                         "mtllib q.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                         "usemtl m\nf 1/1 2/2 3/3\n");
  for (const glm::vec3& color : sampled(path, {.points = 500}).color) {
    EXPECT_NEAR(color.x, 0.5f, kByte);  // of the light, not of its code
  }
}

TEST_F(MeshTest, TakesColoursFromVertices) {
  const auto path = file("t.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                         "property float y\nproperty float z\nproperty uchar red\n"
                         "property uchar green\nproperty uchar blue\nelement face 1\n"
                         "property list uchar int vertex_indices\nend_header\n"
                         "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n");
  const PointCloud points = sampled(path, {.points = 500});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec3 p = points.position_m[i];
    EXPECT_LT(glm::distance(points.color[i], {1.0f - p.x - p.y, p.x, p.y}), kByte);
  }
}

TEST_F(MeshTest, ShowsTheColourOfTheMaterialWithoutLight) {
  file("m.mtl", "newmtl m\nKd 1 0.5 0\n");
  const auto path = file("t.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  for (const glm::vec3& color : sampled(path, {.points = 200}).color) {
    EXPECT_LT(glm::distance(color, {1.0f, 0.2140f, 0.0f}), 1e-3f);  // sRGB 0.5
  }
}

TEST_F(MeshTest, ChoosesPointsFromTheMeshsDetail) {
  // A coarse quad needs the least; its texture of 4096 x 2048 px shows on a screen of 1080 rows.
  const auto pointsOf = [&](const std::filesystem::path& path) {
    return defaultPoints(readMesh(path).mesh);
  };
  EXPECT_EQ(pointsOf(texturedQuad()), kMinPoints);
  cv::imwrite((folder_ / "fine.png").string(), cv::Mat(2048, 4096, CV_8UC1, cv::Scalar(128)));
  file("fine.mtl", "newmtl m\nmap_Kd fine.png\n");
  const auto fine = file("fine.obj",
                         "mtllib fine.mtl\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n"
                         "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n");
  const double pixel = std::sqrt(5.0) / kScreenRows;  // the quad's diagonal fills the rows
  EXPECT_NEAR(static_cast<double>(pointsOf(fine)), std::max(2.0 / (pixel * pixel), 5e5), 1e4);
}

TEST_F(MeshTest, StripsOfLongTrianglesAreDetailedAcross) {
  // A fluted square: 1000 slopes of 45 degrees, each of two triangles from edge to edge. A
  // triangle has as much area as an equilateral one of edge 1/25.
  constexpr int kSlopes = 1000;
  std::ostringstream obj;
  for (int i = 0; i <= kSlopes; ++i) {
    const double x = static_cast<double>(i) / kSlopes, z = i % 2 / 1000.0;
    obj << "v " << x << " 0 " << z << "\nv " << x << " 1 " << z << '\n';
    if (i == 0) continue;
    const int a = 2 * i - 1;
    obj << "f " << a << ' ' << a + 2 << ' ' << a + 3 << "\nf " << a << ' ' << a + 3 << ' ' << a + 1
        << '\n';
  }
  const TriangleMesh mesh = readMesh(file("strips.obj", obj.str())).mesh;
  const double points = static_cast<double>(defaultPoints(mesh));
  const double across_m = std::sqrt(2.0) / kSlopes;
  EXPECT_LT(std::sqrt(areaOf_m2(mesh.corners_m) / points), 1.1 * across_m);
}

TEST_F(MeshTest, ReadsGltfWithItsNodesMoved) {
  // Three float positions, (0 0 0) (1 0 0) (0 1 0), as base64.
  const auto path = file("t.gltf",
                         R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
          "nodes":[{"mesh":0,"translation":[0,0,-5]}],
          "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
          "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,0.125,0.5]},
                        "alphaMode":"BLEND"}],
          "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
                        "min":[0,0,0],"max":[1,1,0]}],
          "bufferViews":[{"buffer":0,"byteLength":36}],
          "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  const PointCloud points = sampled(path, {.points = 300});
  EXPECT_GT(points.size(), 200u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_FLOAT_EQ(points.position_m[i].z, -5.0f);
    EXPECT_NEAR(points.color[i].x / points.color[i].y, 2.0f, 1e-4f);
    EXPECT_FLOAT_EQ(points.opacity[i], 0.5f);
  }
}

TEST_F(MeshTest, LeavesOutHolesThatTheTextureCuts) {
  cv::Mat image(8, 8, CV_8UC4, cv::Scalar(255, 255, 255, 255));
  image.colRange(0, 4).setTo(cv::Scalar(255, 255, 255, 0));
  cv::imwrite((folder_ / "t.png").string(), image);
  file("q.mtl", "newmtl m\nmap_Kd t.png\n");
  const auto path = file("q.obj",
                         "mtllib q.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                         "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n");
  const PointCloud points = sampled(path, {.points = 1000});
  EXPECT_NEAR(static_cast<double>(points.size()), 500.0, 500.0 * kCount);
  for (const glm::vec3& p : points.position_m) EXPECT_TRUE(p.x > 0.4f || p.x < 0.1f);
}

TEST_F(MeshTest, SkipsFacesWithoutCorners) {
  const std::string vertices =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n";
  const PointCloud points = sampled(file("one.ply", vertices + "0\n3 0 1 2\n"), {.points = 500});
  EXPECT_NEAR(static_cast<double>(points.size()), 500.0, 500.0 * kCount);
  EXPECT_NE(refusal(file("none.ply", vertices + "0\n0\n")), "");
}

TEST_F(MeshTest, RefusesOtherFiles) {
  EXPECT_NE(refusal(folder_ / "missing.obj"), "");
  EXPECT_NE(refusal(file("empty.obj", "")), "");
  EXPECT_NE(refusal(file("text.gltf", "{")), "");
  EXPECT_NE(refusal(file("text.glb", "glTF\1\0\0\0")), "");
  EXPECT_NE(refusal(file("points.obj", "v 0 0 0\nv 1 0 0\n")), "");
  EXPECT_NE(refusal(file("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")), "");
  EXPECT_NE(refusal(file("sliver.obj", "v 0 0 0\nv 1e-38 0.1 0\nv 0 0.2 0\nf 1 2 3\n")), "");
  EXPECT_NE(refusal(file("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), "");
  EXPECT_NE(refusal(file("far.obj", "v 1 0 0\nv 1e30 0 0\nv 0 1e30 0\nf 1 2 3\n")), "");
  EXPECT_NE(refusal(file("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 900\n")), "");
  EXPECT_NE(refusal(file("index.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                         "property float y\nproperty float z\nelement face 1\n"
                         "property list uchar int vertex_indices\nend_header\n"
                         "0 0 0\n1 0 0\n0 1 0\n3 0 1 900\n")),
            "");
}

TEST_F(MeshTest, NamesMissingTexturesAndMaterialsAndShowsTheRest) {
  const std::string faces =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
  file("q.mtl", "newmtl m\nKd 0.9 0.1 0.1\nmap_Kd missing.png\n");
  const PointCloud red = sampled(file("q.obj", "mtllib q.mtl\n" + faces), {.points = 100});
  ASSERT_EQ(red.remarks.size(), 1u);
  EXPECT_NE(red.remarks[0].find("\"missing.png\""), std::string::npos) << red.remarks[0];
  EXPECT_GT(red.color[0].x, 2.0f * red.color[0].y);
  const PointCloud grey = sampled(file("r.obj", "mtllib absent.mtl\n" + faces), {.points = 100});
  ASSERT_EQ(grey.remarks.size(), 1u);
  EXPECT_NE(grey.remarks[0].find("\"absent.mtl\""), std::string::npos) << grey.remarks[0];
  EXPECT_TRUE(sampled(texturedQuad(), {.points = 100}).remarks.empty());
}

TEST_F(MeshTest, NamesTheCompressionOfAGltfThatItCannotRead) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_draco_mesh_compression"}) {
    const std::string what = refusal(
        file("t.gltf", R"({"asset":{"version":"2.0"},"extensionsUsed":[")" + std::string(name) +
                           R"("],"extensionsRequired":["KHR_materials_unlit",")" + name +
                           R"("],"meshes":[{"primitives":[{"attributes":{"POSITION":9}}]}]})"));
    EXPECT_NE(what.find(name), std::string::npos) << what;
    EXPECT_NE(what.find("without compression"), std::string::npos) << what;
  }
}

TEST_F(MeshTest, OpensLikeAPointCloudAndScaled) {
  const PointCloud points = openPoints(readScene(texturedQuad()), 0.5, {.points = 1000}).points;
  for (const glm::vec3& p : points.position_m) {
    ASSERT_TRUE(p.x >= 0.0f && p.x <= 1.0f && p.y >= 0.0f && p.y <= 0.5f);
  }
}

TEST_F(MeshTest, SceneFilesOpenByTheirContent) {
  SurfelCloud cloud;
  appendSurfel(cloud, {1.0f, 2.0f, 3.0f}, {0.0f, 0.0f, 1.0f}, 0.1f, 0.02f, glm::vec3(0.5f));
  writeSceneFile(folder_ / "scene.ply", {{cloud}});
  const Scene scene = openScene(folder_ / "scene.ply", 2.0, {}).scene;
  const SurfelCloud& read = *scene.surfels();
  EXPECT_EQ(read.position_m[0], glm::vec3(2.0f, 4.0f, 6.0f));
  EXPECT_FLOAT_EQ(glm::length(read.axis_u_m[0]), 0.2f);
  EXPECT_FLOAT_EQ(read.area_m2[0], 0.08f);
}

}  // namespace FOCI_FILE
}  // namespace foci
