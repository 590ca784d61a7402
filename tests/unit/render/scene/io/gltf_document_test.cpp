// What a glTF may ask of its reader, and what it may be.
#include "render/scene/io/gltf_document.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/input_error.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/read_mesh.h"

namespace foci {
namespace FOCI_FILE {

class GltfLimits : public testing::Test {
 protected:
  std::string refusal(const std::string& name, const std::string& bytes) const {
    try {
      readMesh(folder_.write(name, bytes));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder folder_;
};

/// Each node has the next one twice as a child.
std::string doubling(int nodes) {
  std::string text = R"({"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)";
  for (int i = 1; i <= nodes; ++i) {
    text += "{\"children\":[" + std::to_string(i) + "," + std::to_string(i) + "]},";
  }
  return text + "{}]}";
}

std::string binaryOf(const std::string& json) {
  const auto bytes = static_cast<std::uint32_t>(json.size());
  const std::uint32_t header[] = {0x46546c67, 2, bytes + 20, bytes, 0x4e4f534a};
  return std::string(reinterpret_cast<const char*>(header), sizeof(header)) + json;
}

TEST_F(GltfLimits, InstancesAreCounted) {
  EXPECT_NE(refusal("a.gltf", doubling(16)).find("has no faces"), std::string::npos);
  EXPECT_NE(refusal("a.gltf", doubling(18)).find("at most 262,144"), std::string::npos);
  EXPECT_NE(refusal("a.gltf", doubling(400)).find("instances"), std::string::npos);
  EXPECT_NE(refusal("a.GLB", binaryOf(doubling(18))).find("instances"), std::string::npos);
  std::string roots = "0";
  for (int i = 0; i < 300'000; ++i) roots += ",0";
  EXPECT_NE(refusal("a.gltf", "{\"scenes\":[{\"nodes\":[" + roots + "]}],\"nodes\":[{}]}")
                .find("at most 262,144"),
            std::string::npos);
}

TEST_F(GltfLimits, VersionOneIsNamed) {
  std::string file = binaryOf("{}");
  file[4] = 1;
  EXPECT_NE(refusal("a.glb", file).find("version 1: expected version 2"), std::string::npos);
  EXPECT_NE(refusal("a.gltf", R"({"nodes":{"n":{}}})").find("version 1: expected version 2"),
            std::string::npos);
}

TEST_F(GltfLimits, CornersAreCountedBeforeTheyAreRead) {
  const auto mesh = [](const std::string& count) {
    return R"({"accessors":[{"count":)" + count +
           R"(}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  };
  EXPECT_NE(refusal("a.gltf", mesh("67108865")).find("67,108,865 corners"), std::string::npos);
  EXPECT_NE(refusal("a.gltf", mesh("1e300")).find("count = 1e+300 is no number"),
            std::string::npos);
}

TEST_F(GltfLimits, TextInQuotesDoesNotNest) {
  const std::string text = "{\"name\":\"" + std::string(200, '[') + "\\\"" + std::string(200, '{') +
                           "\", \"latin\":\"n\xe4me\"}";
  EXPECT_NE(refusal("a.gltf", text).find("no scene with nodes"), std::string::npos);
  EXPECT_NE(refusal("a.gltf", std::string(200, '[')).find("200 deep"), std::string::npos);
}

TEST_F(GltfLimits, ADocumentKeepsNamesInUtf8) {
  const auto read = [&](const std::string& name) {
    return GltfDocument(folder_.write("a.gltf", R"({"name":")" + name + R"("})")).json()["name"];
  };
  EXPECT_EQ(read("n\xc3\xa4me"), "n\xc3\xa4me");
  EXPECT_EQ(read("n\xe4me"), "n?me");
}

TEST_F(GltfLimits, OddPartsAreRefused) {
  for (
      const char* text :
      {"{}", R"({"nodes":3,"meshes":"a","scenes":[1,{"nodes":7},{"nodes":["x",{}]}]})",
       R"({"nodes":[0,{"children":{"a":1}},{"mesh":99}],"accessors":[]})",
       R"({"nodes":[{"mesh":0}],"meshes":[{"primitives":[4,{"attributes":{"POSITION":-1},"indices":1e9}]}]})",
       R"({"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":7}]}]})",
       R"({"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":"4"}]}]})"}) {
    EXPECT_NE(refusal("a.gltf", text), "") << text;
  }
  EXPECT_NE(refusal("a.gltf", "not JSON").find("JSON"), std::string::npos);
  EXPECT_NE(refusal("a.glb", "glTF").find("JSON"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
