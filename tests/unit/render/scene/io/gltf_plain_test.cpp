// glTF that Assimp alone misreads.
#include "render/scene/io/gltf_plain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "render/scene/io/mesh.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace {

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

TEST(GltfPlain, IntegersOfAttributesAreNumbers) {
  const TemporaryFolder folder;
  folder.write("b.bin", triangleBytes());
  expectTriangle(readMesh(folder.write("a.gltf", json(R"(,"uri":"b.bin")"))).mesh);
  expectTriangle(readMesh(folder.write("b.glb", glb(json("")))).mesh);
}

TEST(GltfPlain, AccessorsBeyondTheirBufferAreRefused) {
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

TEST(GltfPlain, InstancesAreNodes) {
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

TEST(GltfPlain, ATextureMayBeWebpAlone) {
  const TemporaryFolder folder;
  folder.write("b.bin", triangleBytes());
  ASSERT_TRUE(cv::imwrite((folder.path() / "t.webp").string(),
                          cv::Mat(8, 8, CV_8UC3, cv::Scalar(0, 0, 255))));
  const MeshFile file = readMesh(folder.write("a.gltf", json(R"(,"uri":"b.bin")")));
  EXPECT_TRUE(file.mesh.remarks.empty());
  EXPECT_GT(colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color.x, 0.9f);
  EXPECT_LT(colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color.y, 0.1f);
}

TEST(GltfPlain, OtherFilesStayAsTheyAre) {
  const TemporaryFolder folder;
  EXPECT_EQ(plainGltf(readGltf(folder.write("a.gltf", R"({"asset":{"version":"2.0"}})"))), "");
  EXPECT_EQ(plainGltf(readGltf(folder.write("c.gltf", json(R"(,"uri":"gone.bin")")))), "");
  EXPECT_EQ(
      plainGltf(readGltf(folder.write("d.gltf", R"({"textures":[1],"nodes":{},"meshes":[7]})"))),
      "");
}

}  // namespace
}  // namespace foci
