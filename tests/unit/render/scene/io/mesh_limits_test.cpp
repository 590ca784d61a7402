#include "render/scene/io/mesh_limits.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace {

class MeshLimits : public testing::Test {
 protected:
  std::string refusal(const std::string& name, const std::string& bytes) const {
    try {
      refuseHostileGltf(readGltf(folder_.write(name, bytes)));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder folder_;
};

/// glTF 1.0 names its nodes; each of them has the next one twice as a child.
std::string doublingByName(int nodes) {
  std::string text = R"({"scene":"s","scenes":{"s":{"nodes":["n0"]}},"nodes":{)";
  for (int i = 0; i < nodes; ++i) {
    const std::string next = "\"n" + std::to_string(i + 1) + "\"";
    text += "\"n" + std::to_string(i) + "\":{\"children\":[" + next + "," + next + "]},";
  }
  return text + "\"n" + std::to_string(nodes) + "\":{}}}";
}

std::string binaryOf(const std::string& json) {
  const auto bytes = static_cast<std::uint32_t>(json.size());
  const std::uint32_t header[] = {0x46546c67, 2, bytes + 20, bytes, 0x4e4f534a};
  return std::string(reinterpret_cast<const char*>(header), sizeof(header)) + json;
}

TEST_F(MeshLimits, CountInstancesOfBothVersions) {
  EXPECT_EQ(refusal("a.gltf", doublingByName(16)), "");
  EXPECT_NE(refusal("a.gltf", doublingByName(18)).find("524,287 instances"), std::string::npos);
  EXPECT_NE(refusal("a.gltf", doublingByName(400)).find("instances"), std::string::npos);
  EXPECT_NE(refusal("a.GLB", binaryOf(doublingByName(18))).find("instances"), std::string::npos);
}

TEST_F(MeshLimits, NameTheVersionOfBinaryGltf) {
  std::string file = binaryOf("{}");
  file[4] = 1;
  EXPECT_NE(refusal("a.glb", file).find("version 1: expected version 2"), std::string::npos);
}

TEST_F(MeshLimits, CountEveryRootOfAScene) {
  std::string roots = "0";
  for (int i = 0; i < 300'000; ++i) roots += ",0";
  EXPECT_NE(refusal("a.gltf", "{\"scenes\":[{\"nodes\":[" + roots + "]}],\"nodes\":[{}]}")
                .find("300,001 instances"),
            std::string::npos);
}

TEST_F(MeshLimits, CountTheCornersOfMeshes) {
  const auto mesh = [](const std::string& count) {
    return R"({"accessors":[{"count":)" + count +
           R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  };
  EXPECT_EQ(refusal("a.gltf", mesh("67108864")), "");
  EXPECT_NE(refusal("a.gltf", mesh("67108865")).find("67,108,865 corners"), std::string::npos);
  EXPECT_NE(refusal("a.gltf", mesh("1e300")).find("over 1e15 corners"), std::string::npos);
}

TEST_F(MeshLimits, TextInQuotesDoesNotNest) {
  const std::string text = "{\"name\":\"" + std::string(200, '[') + "\\\"" + std::string(200, '{') +
                           "\", \"latin\":\"n\xe4me\"}";
  EXPECT_EQ(refusal("a.gltf", text), "");
  EXPECT_NE(refusal("a.gltf", std::string(200, '[')).find("200 deep"), std::string::npos);
}

TEST_F(MeshLimits, ADocumentKeepsNamesInUtf8) {
  const auto read = [&](const std::string& name) {
    return readGltf(folder_.write("a.gltf", R"({"extensionsRequired":[")" + name + R"(",7]})"));
  };
  EXPECT_EQ(requiredExtensions(read("n\xc3\xa4me")).at(0), "n\xc3\xa4me");
  EXPECT_FALSE(read("n\xc3\xa4me").altered);
  EXPECT_EQ(requiredExtensions(read("n\xe4me")).at(0), "n?me");
  EXPECT_TRUE(read("n\xe4me").altered);
}

TEST_F(MeshLimits, OddPartsAreLeftToAssimp) {
  for (const char* text :
       {"{}", R"({"nodes":3,"meshes":"a","scenes":[1,{"nodes":7},{"nodes":["x",{}]}]})",
        R"({"nodes":[0,{"children":{"a":1}},{"mesh":99}],"accessors":[]})",
        R"({"meshes":[{"primitives":[4,{"attributes":{"POSITION":-1},"indices":1e9}]}]})"}) {
    EXPECT_EQ(refusal("a.gltf", text), "") << text;
  }
  EXPECT_NE(refusal("a.gltf", "not JSON").find("JSON"), std::string::npos);
  EXPECT_NE(refusal("a.glb", "glTF").find("JSON"), std::string::npos);
}

}  // namespace
}  // namespace foci
