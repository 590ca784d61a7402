// The numbers, nodes and materials of a glTF.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <glm/glm.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/read_mesh.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kShort = 1.0f / 32767.0f;  // a step of a normalised short

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A triangle with the corners (0, 0, 0), (1, 0, 0) and (0, 1, 0) in normalised shorts, 8 bytes
/// apart, and their x and y as texture coordinates in normalised unsigned shorts.
std::string triangleBytes() {
  return bytesOf<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0}) +
         bytesOf<std::uint16_t>({0, 0, 65535, 0, 0, 65535}) +
         bytesOf<float>({0, 0, 0, 5, 0, 0, 1, 1, 1, 2, 2, 2});  // of instances
}

/// @param count  of corners
std::string json(const std::string& buffer, int count = 3, const std::string& node = "") {
  const std::string corners = std::to_string(count);
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" +
         node +
         R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},)"
         R"("material":0}]}],)"
         R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
         R"("textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}],)"
         R"("images":[{"uri":"t.webp"}],)"
         R"("accessors":[{"bufferView":0,"componentType":5122,"normalized":true,"count":)" +
         corners +
         R"(,"type":"VEC3","min":[0,0,0],"max":[32767,32767,0]},)"
         R"({"bufferView":1,"componentType":5123,"normalized":true,"count":3,"type":"VEC2"},)"
         R"({"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"},)"
         R"({"bufferView":2,"byteOffset":24,"componentType":5126,"count":2,"type":"VEC3"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":24,"byteStride":8},)"
         R"({"buffer":0,"byteOffset":24,"byteLength":12},)"
         R"({"buffer":0,"byteOffset":36,"byteLength":48}],)"
         R"("buffers":[{"byteLength":84)" +
         buffer + "}]}";
}

void append32(std::string& to, std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  to.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

std::string glb(std::string text) {
  text.append((4 - text.size() % 4) % 4, ' ');
  std::string file = "glTF";
  append32(file, 2);
  append32(file, 12 + 8 + text.size() + 8 + triangleBytes().size());
  append32(file, text.size());
  file += "JSON" + text;
  append32(file, triangleBytes().size());
  return file + std::string("BIN\0", 4) + triangleBytes();
}

void expectTriangle(const TriangleMesh& mesh) {
  ASSERT_EQ(mesh.size(), 1u);
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec3 corner(i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f, 0.0f);
    EXPECT_LT(glm::distance(mesh.corners_m[i], corner), kShort);
    // The reader turns v upwards.
    EXPECT_LT(glm::distance(mesh.uv[i], glm::vec2(corner.x, 1.0f - corner.y)), kShort);
  }
}

TEST(GltfMesh, IntegersOfAttributesAreNumbers) {
  const TemporaryFolder folder;
  folder.write("b.bin", triangleBytes());
  expectTriangle(readMesh(folder.write("a.gltf", json(R"(,"uri":"b.bin")"))).mesh);
  expectTriangle(readMesh(folder.write("b.glb", glb(json("")))).mesh);
}

TEST(GltfMesh, IntegerColoursAreNormalisedWhateverTheAccessorSays) {
  const TemporaryFolder folder;
  std::string bytes(36, '\0');
  const float x = 1.0f;
  std::memcpy(bytes.data() + 12, &x, 4);
  std::memcpy(bytes.data() + 28, &x, 4);
  for (int i = 0; i < 3; ++i) bytes += std::string("\xff\x33\0\0", 4);  // 255, 51, 0
  folder.write("b.bin", bytes);
  const auto mesh =
      readMesh(folder.write("a.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],
      "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1}}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                   {"bufferView":1,"componentType":5121,"count":3,"type":"VEC3"}],
      "bufferViews":[{"buffer":0,"byteLength":36},
                     {"buffer":0,"byteOffset":36,"byteLength":12,"byteStride":4}],
      "buffers":[{"uri":"b.bin","byteLength":48}]})"))
          .mesh;
  EXPECT_LT(glm::distance(mesh.color.at(0), glm::vec3(1.0f, 0.2f, 0.0f)), kShort);
}

TEST(GltfMesh, AccessorsBeyondTheirBufferAreRefused) {
  const TemporaryFolder folder;
  folder.write("b.bin", triangleBytes());
  const auto path = folder.write("a.gltf", json(R"(,"uri":"b.bin")", 12));
  try {
    readMesh(path);
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("accessor 0 reaches beyond its view of 24 bytes"),
              std::string::npos)
        << error.what();
  }
}

TEST(GltfMesh, InstancesAreNodes) {
  const TemporaryFolder folder;
  folder.write("b.bin", triangleBytes());
  const std::string node =
      R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2,"SCALE":3}}})";
  const TriangleMesh mesh =
      readMesh(folder.write("a.gltf", json(R"(,"uri":"b.bin")", 3, node))).mesh;
  ASSERT_EQ(mesh.size(), 2u);
  float farthest = 0.0f;
  for (const glm::vec3& corner : mesh.corners_m) farthest = std::max(farthest, corner.x);
  EXPECT_NEAR(farthest, 5.0f + 2.0f, 4.0f * kShort);
}

TEST(GltfMesh, InstancesHaveColours) {
  const TemporaryFolder folder;
  folder.write("b.bin", triangleBytes());
  ASSERT_TRUE(cv::imwrite((folder.path() / "t.webp").string(),
                          cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(255))));
  const std::string node =
      R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2,"_COLOR_0":2}}})";
  const MeshFile file = readMesh(folder.write("a.gltf", json(R"(,"uri":"b.bin")", 3, node)));
  EXPECT_EQ(colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(0));
  EXPECT_GT(colorAt(file.mesh, {1, glm::vec2(0.25f)}, 0.0f).color.x, 0.9f);
  EXPECT_EQ(colorAt(file.mesh, {1, glm::vec2(0.25f)}, 0.0f).color.y, 0.0f);
  for (const char* unusable : {"99", "-1", R"("red")"}) {
    std::string other = node;
    other.replace(other.rfind("2}"), 1, unusable);
    const MeshFile plain = readMesh(folder.write("b.gltf", json(R"(,"uri":"b.bin")", 3, other)));
    EXPECT_EQ(plain.mesh.size(), 2u) << unusable;
    EXPECT_TRUE(plain.mesh.color.empty()) << unusable;
  }
}

TEST(GltfMesh, HiddenNodesAreNotShown) {
  const TemporaryFolder folder;
  folder.write("b.bin", triangleBytes());
  const auto file = [&](const std::string& seen) {
    return folder.write("a.gltf",
                        json(R"(,"uri":"b.bin")", 3,
                             R"(,"extensions":{"KHR_node_visibility":{"visible":)" + seen + "}}"));
  };
  EXPECT_EQ(readMesh(file("true")).mesh.size(), 1u);
  const auto refusal = [](const std::filesystem::path& path) -> std::string {
    try {
      readMesh(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal(file("false")).find("1 node is hidden (KHR_node_visibility)"),
            std::string::npos);
  std::string both = json(R"(,"uri":"b.bin")", 3,
                          R"(},{"mesh":0,"children":[2],"extensions":)"
                          R"({"KHR_node_visibility":{"visible":false}}},)"
                          R"({"mesh":0)");
  both.replace(both.find("[0]"), 3, "[0,1]");
  const TriangleMesh part = readMesh(folder.write("b.gltf", both)).mesh;
  EXPECT_EQ(part.size(), 1u);
  EXPECT_NE(std::ranges::find(part.remarks, "1 node is hidden (KHR_node_visibility): not shown"),
            part.remarks.end());
}

TEST(GltfMesh, ATextureMayBeWebpAlone) {
  const TemporaryFolder folder;
  folder.write("b.bin", triangleBytes());
  ASSERT_TRUE(cv::imwrite((folder.path() / "t.webp").string(),
                          cv::Mat(8, 8, CV_8UC3, cv::Scalar(0, 0, 255))));
  const MeshFile file = readMesh(folder.write("a.gltf", json(R"(,"uri":"b.bin")")));
  EXPECT_TRUE(file.mesh.remarks.empty());
  EXPECT_GT(colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color.x, 0.9f);
  EXPECT_LT(colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color.y, 0.1f);
}

/// A primitive of these attributes and indices, and what else the file has, with the buffer b.bin.
std::string primitive(const std::string& json, const std::string& lists, std::size_t bytes) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{)" +
         json + R"(}]}],)" + lists + R"(,"buffers":[{"byteLength":)" + std::to_string(bytes) +
         R"(,"uri":"b.bin"}]})";
}

/// Positions of four corners of a square, as an accessor and a view.
const std::string kSquareBytes = bytesOf<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
constexpr const char* kSquareLists =
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}],)"
    R"("bufferViews":[{"buffer":0,"byteLength":48}])";

TEST(GltfMesh, StripsAndFansAreTriangles) {
  const TemporaryFolder folder;
  folder.write("b.bin", kSquareBytes);
  const auto areaAndSide = [&](int mode) {
    const std::string json = R"("attributes":{"POSITION":0},"mode":)" + std::to_string(mode);
    const TriangleMesh mesh =
        readMesh(folder.write("a.gltf", primitive(json, kSquareLists, 48))).mesh;
    glm::vec3 sum(0.0f);
    for (std::size_t i = 0; i < mesh.corners_m.size(); i += 3) {
      sum += glm::cross(mesh.corners_m[i + 1] - mesh.corners_m[i],
                        mesh.corners_m[i + 2] - mesh.corners_m[i]);
    }
    return sum.z;
  };
  EXPECT_FLOAT_EQ(areaAndSide(5), 2.0f);  // two triangles of area 1/2, both counter-clockwise
  EXPECT_FLOAT_EQ(areaAndSide(6), 0.0f);  // the fan's second triangle is turned over
}

TEST(GltfMesh, PointsAndLinesBesideTrianglesAreNamed) {
  const TemporaryFolder folder;
  folder.write("b.bin", kSquareBytes);
  const std::string json = R"("attributes":{"POSITION":0}},{"attributes":{"POSITION":0},"mode":)";
  for (const auto& [mode, what] : {std::pair("0", "4 points"), {"1", "2 lines"}}) {
    const MeshFile file =
        readMesh(folder.write("a.gltf", primitive(json + mode, kSquareLists, 48)));
    ASSERT_EQ(file.mesh.remarks.size(), 1u);
    EXPECT_EQ(file.mesh.remarks[0], std::string(what) + " beside the triangles left out");
  }
}

/// The packed bytes are those of meshoptimizer's encoder.
TEST(GltfMesh, MeshoptViewsAreUnpacked) {
  const TemporaryFolder folder;
  std::string packed(meshopt_encodeVertexBufferBound(4, 12), '\0');
  packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()),
                                           packed.size(), kSquareBytes.data(), 4, 12));
  const std::vector<std::uint32_t> corners = {0, 1, 2, 2, 1, 3};
  std::string indices(meshopt_encodeIndexBufferBound(6, 4), '\0');
  indices.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(indices.data()),
                                           indices.size(), corners.data(), 6));
  folder.write("b.bin", packed + indices);
  const auto extension = [&](std::size_t at, std::size_t length, int count, int stride,
                             const std::string& mode) {
    return R"({"buffer":1,"byteLength":)" + std::to_string(count * stride) +
           R"(,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteOffset":)" +
           std::to_string(at) + R"(,"byteLength":)" + std::to_string(length) + R"(,"byteStride":)" +
           std::to_string(stride) + R"(,"count":)" + std::to_string(count) + R"(,"mode":")" + mode +
           R"("}}})";
  };
  const auto lists = [&](std::size_t length) {
    return R"("extensionsRequired":["EXT_meshopt_compression"],"accessors":[)"
           R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
           R"({"bufferView":1,"componentType":5125,"count":6,"type":"SCALAR"}],"bufferViews":[)" +
           extension(0, length, 4, 12, "ATTRIBUTES") + "," +
           extension(packed.size(), indices.size(), 6, 4, "TRIANGLES") + "]";
  };
  const std::string json = R"("attributes":{"POSITION":0},"indices":1)";
  const auto write = [&](std::size_t length) {
    return folder.write("a.gltf", primitive(json, lists(length), packed.size() + indices.size()));
  };
  const TriangleMesh mesh = readMesh(write(packed.size())).mesh;
  ASSERT_EQ(mesh.size(), 2u);
  EXPECT_EQ(mesh.corners_m[1], glm::vec3(1, 0, 0));
  try {
    readMesh(write(packed.size() - 5));
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("view 0 of EXT_meshopt_compression cannot be decoded"),
              std::string::npos)
        << error.what();
  }
}

TEST(GltfMesh, ColoursOfSpecularGlossinessAndLightAreShown) {
  const TemporaryFolder folder;
  folder.write("b.bin", kSquareBytes);
  const auto read = [&](const std::string& material) {
    return readMesh(folder.write(
        "a.gltf",
        primitive(R"("attributes":{"POSITION":0},"material":0)",
                  std::string(kSquareLists) + R"(,"materials":[{)" + material + "}]", 48)));
  };
  const MeshFile specular = read(
      R"("extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.1,0.6,0.2,1]}})");
  EXPECT_EQ(colorAt(specular.mesh, {0, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(0.1f, 0.6f, 0.2f));
  EXPECT_FALSE(specular.facts.has_colors);  // so the scene is shaded
  EXPECT_TRUE(read(R"("extensions":{"KHR_materials_unlit":{}})").facts.has_colors);
}

TEST(GltfMesh, AMaterialOfOneColourBesideATextureIsShaded) {
  const TemporaryFolder folder;
  folder.write("b.bin", kSquareBytes);
  ASSERT_TRUE(
      cv::imwrite((folder.path() / "t.png").string(), cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(9))));
  // The second node is turned by a quarter about y.
  const std::string text =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],"nodes":[{"mesh":0},)"
      R"({"mesh":0,"rotation":[0,0.70710678,0,0.70710678]},{"mesh":1}],"meshes":[)"
      R"({"primitives":[{"attributes":{"POSITION":0},"material":0}]},)"
      R"({"primitives":[{"attributes":{"POSITION":0},"material":1}]}],"materials":[{},)"
      R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)"
      R"("images":[{"uri":"t.png"}],)" +
      std::string(kSquareLists) + R"(,"buffers":[{"byteLength":48,"uri":"b.bin"}]})";
  const MeshFile file = readMesh(folder.write("a.gltf", text));
  ASSERT_EQ(file.mesh.size(), 3u);
  const auto light = [&](std::uint32_t triangle) {
    return colorAt(file.mesh, {triangle, glm::vec2(0.25f)}, 0.0f).color.x;
  };
  EXPECT_TRUE(file.facts.has_colors);
  EXPECT_GT(std::abs(light(0) - light(1)), 0.05f);
  EXPECT_LE(std::max(light(0), light(1)), 1.0f);
}

TEST(GltfMesh, DracoIsUnpackedWhateverTheTypeOfIndices) {
  const char* folder = std::getenv("FOCI_DATA");
  const std::filesystem::path data = folder != nullptr ? folder : FOCI_SOURCE_DIR "/../shared/data";
  for (const char* name : {"draco_u16_indices.glb", "draco_u32_indices.glb"}) {
    const std::filesystem::path path = data / "cases/scenes" / name;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    const MeshFile file = readMesh(path);
    EXPECT_EQ(file.mesh.size(), 304u);
    for (const glm::vec3& corner : file.mesh.corners_m) {
      EXPECT_NEAR(glm::length(corner), 1.0f, 1e-3f);
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
