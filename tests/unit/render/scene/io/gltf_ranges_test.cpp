// Sizes and places in a glTF that reach past what the file holds.
#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/read_mesh.h"

namespace foci {
namespace FOCI_FILE {

using Json = nlohmann::json;

constexpr std::size_t kBytes = 4 * 12 + 6 * 2 + 4 * 8;  // a buffer of positions, indices and u, v

/// A square of two triangles with texture coordinates.
Json square() {
  return Json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1}]}],
    "accessors":[
      {"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
      {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},
      {"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},
                   {"buffer":0,"byteOffset":60,"byteLength":32}],
    "buffers":[{"byteLength":92,"uri":"b.bin"}]})");
}

class GltfRanges : public testing::Test {
 protected:
  GltfRanges() {
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const std::vector<std::uint16_t> indices = {0, 1, 2, 0, 2, 3};
    const std::vector<float> uv = {0, 0, 1, 0, 1, 1, 0, 1};
    add(positions.data(), positions.size() * sizeof(float));
    add(indices.data(), indices.size() * sizeof(std::uint16_t));
    add(uv.data(), uv.size() * sizeof(float));
    folder_.write("b.bin", bytes_);
  }

  void add(const void* data, std::size_t count) {
    bytes_.append(static_cast<const char*>(data), count);
  }

  /// The square with one value of its JSON changed. @return the refusal; empty if it is read
  std::string refusal(const std::string& pointer, const Json& value) const {
    Json changed = square();
    changed[Json::json_pointer(pointer)] = value;
    return refusal(changed);
  }

  std::string refusal(const Json& json) const {
    try {
      EXPECT_EQ(readMesh(folder_.write("a.gltf", json.dump())).mesh.size(), 2u) << json;
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder folder_;
  std::string bytes_;
};

TEST_F(GltfRanges, TheSquareItselfIsRead) {
  ASSERT_EQ(bytes_.size(), kBytes);
  EXPECT_EQ(refusal(square()), "");
}

TEST_F(GltfRanges, NothingIsReadOutsideOfABufferOrView) {
  const std::vector<std::pair<std::string, Json>> changes = {
      {"/accessors/0/byteOffset", 12},
      {"/accessors/0/byteOffset", 4000},
      {"/accessors/0/byteOffset", 18446744073709551612ull},
      {"/accessors/0/byteOffset", -12},
      {"/accessors/0/byteOffset", 1e300},
      {"/accessors/0/count", 5},
      {"/accessors/0/count", 4294967295u},
      {"/accessors/0/count", 1537228672809129302ull},  // times 12 is 2^64 + 8
      {"/accessors/0/type", "MAT4"},
      {"/accessors/1/byteOffset", 2},
      {"/accessors/1/byteOffset", 36000},
      {"/accessors/1/count", 600},
      {"/accessors/1/componentType", 5125},
      {"/accessors/2/count", 3},
      {"/accessors/2/count", 500},
      {"/accessors/2/byteOffset", 8},
      {"/bufferViews/0/byteStride", 16},
      {"/bufferViews/0/byteOffset", 60},
      {"/bufferViews/0/byteOffset", -4},
      {"/bufferViews/0/byteLength", 30},
      {"/bufferViews/1/byteLength", 1000},
      {"/bufferViews/1/byteOffset", 88},
      {"/bufferViews/2/byteOffset", 18446744073709551600ull},
      {"/buffers/0/byteLength", 60},
  };
  for (const auto& [pointer, value] : changes) {
    EXPECT_NE(refusal(pointer, value), "") << pointer << " = " << value;
  }
}

TEST_F(GltfRanges, SparseElementsStayInTheirViewsAndTheirAccessor) {
  Json json = square();
  json["accessors"][0]["sparse"] = {{"count", 1},
                                    {"indices", {{"bufferView", 1}, {"componentType", 5123}}},
                                    {"values", {{"bufferView", 0}}}};
  EXPECT_EQ(refusal(json), "");  // moves the first corner to where it is
  for (const auto& [pointer, value] : std::vector<std::pair<std::string, Json>>{
           {"/accessors/0/sparse/count", 5},
           {"/accessors/0/sparse/count", 4294967295u},
           {"/accessors/0/sparse/indices/byteOffset", 12},
           {"/accessors/0/sparse/values/byteOffset", 40},
           {"/accessors/0/sparse/indices",  // the upper half of 1.0f: 0x3f80
            {{"bufferView", 0}, {"byteOffset", 14}, {"componentType", 5123}}}}) {
    Json changed = json;
    changed[Json::json_pointer(pointer)] = value;
    EXPECT_NE(refusal(changed), "") << pointer << " = " << value;
  }
}

TEST_F(GltfRanges, BuffersInsideTheFileHaveTheBytesThatTheyState) {
  Json json = square();
  json["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAAAAAA";
  EXPECT_NE(refusal(json), "");
  json["buffers"][0].erase("uri");
  EXPECT_NE(refusal(json), "");
}

}  // namespace FOCI_FILE
}  // namespace foci
