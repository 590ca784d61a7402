// Skins and morph targets, against shapes computed by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/read_mesh.h"

namespace foci {
namespace FOCI_FILE {

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Corners (0, 0, 0), (1, 0, 0), (0, 2, 0); joints; weights; two inverse bind matrices, of which
/// the second moves by (0, -1, 0); two targets, of which the second is sparse.
std::string buffer(unsigned last_joint = 1) {
  std::vector<float> bind(32, 0.0f);
  for (const std::size_t i : {0, 5, 10, 15, 16, 21, 26, 31}) bind[i] = 1.0f;
  bind[29] = -1.0f;
  return bytesOf<float>({0, 0, 0, 1, 0, 0, 0, 2, 0}) +
         bytesOf<std::uint8_t>(
             {0, 0, 0, 0, 0, 0, 0, 0, 0, static_cast<std::uint8_t>(last_joint), 0, 0}) +
         bytesOf<float>({1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}) + bytesOf(bind) +
         bytesOf<float>({0, 0, 4, 0, 0, 4, 0, 0, 4}) + bytesOf<std::uint32_t>({1}) +
         bytesOf<float>({8, 0, 0});
}

/// @param nodes  the first has the mesh
std::string json(const std::string& nodes, const std::string& skin, const std::string& mesh = "") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[)" + nodes +
         R"(],"skins":[{)" + skin +
         R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,)"
         R"("JOINTS_0":1,"WEIGHTS_0":2},"targets":[{"POSITION":4},{"POSITION":5}]}])" +
         mesh +
         R"(}],"accessors":[)"
         R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5121,"count":3,"type":"VEC4"},)"
         R"({"bufferView":2,"componentType":5126,"count":3,"type":"VEC4"},)"
         R"({"bufferView":3,"componentType":5126,"count":2,"type":"MAT4"},)"
         R"({"bufferView":4,"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,)"
         R"("indices":{"bufferView":5,"componentType":5125},"values":{"bufferView":6}}}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36},)"
         R"({"buffer":0,"byteOffset":36,"byteLength":12},)"
         R"({"buffer":0,"byteOffset":48,"byteLength":48},)"
         R"({"buffer":0,"byteOffset":96,"byteLength":128},)"
         R"({"buffer":0,"byteOffset":224,"byteLength":36},)"
         R"({"buffer":0,"byteOffset":260,"byteLength":4},)"
         R"({"buffer":0,"byteOffset":264,"byteLength":12}],)"
         R"("buffers":[{"byteLength":276,"uri":"b.bin"}]})";
}

class GltfShape : public ::testing::Test {
 protected:
  std::vector<glm::vec3> cornersOf(const std::string& text, const std::string& bytes = buffer()) {
    folder_.write("b.bin", bytes);
    const MeshFile file = readMesh(folder_.write("a.gltf", text));
    EXPECT_TRUE(file.mesh.remarks.empty()) << file.mesh.remarks.front();
    return {file.mesh.corners_m.begin(), file.mesh.corners_m.end()};
  }
  void expectCorners(const std::vector<glm::vec3>& corners,
                     const std::initializer_list<glm::vec3>& expected) {
    ASSERT_EQ(corners.size(), expected.size());
    std::size_t i = 0;
    for (const glm::vec3& each : expected) {
      EXPECT_LT(glm::distance(corners[i++], each), 1e-6f) << i;
    }
  }

  TemporaryFolder folder_;
};

/// The second joint is at (0, 1, 0) of the first one.
constexpr const char* kBothJoints = R"("joints":[1,2],"inverseBindMatrices":3)";
const std::string kMeshNode = R"({"mesh":0,"skin":0},)";

TEST_F(GltfShape, ASkinThatIsBoundAsItStandsDoesNotMove) {
  expectCorners(
      cornersOf(json(kMeshNode + R"({"children":[2]},{"translation":[0,1,0]})", kBothJoints)),
      {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
}

TEST_F(GltfShape, AJointThatTurnsTakesItsVerticesAlong) {
  // A quarter turn about x through (0, 1, 0): (0, 2, 0) becomes (0, 1, 1).
  const std::string turned = R"({"translation":[0,1,0],"rotation":[0.70710678,0,0,0.70710678]})";
  expectCorners(cornersOf(json(kMeshNode + R"({"children":[2]},)" + turned, kBothJoints)),
                {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}});
}

TEST_F(GltfShape, TheNodeOfASkinDoesNotPlaceItAndNodesAboveJointsDo) {
  const std::string moved = R"({"mesh":0,"skin":0,"translation":[5,5,5],"scale":[9,9,9]},)";
  expectCorners(
      cornersOf(json(moved + R"({"children":[2],"scale":[0.5,0.5,0.5]},{"translation":[0,1,0]})",
                     kBothJoints)),
      {{0, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}});
}

TEST_F(GltfShape, WithoutMatricesASkinIsBoundAtTheOrigin) {
  expectCorners(cornersOf(json(kMeshNode + R"({"translation":[0,0,3]})", R"("joints":[1,1])")),
                {{0, 0, 3}, {1, 0, 3}, {0, 2, 3}});
}

TEST_F(GltfShape, WeightsMoveMorphTargetsOfNodesBeforeThoseOfMeshes) {
  const std::string other = R"(,{})", unused = R"("joints":[1])";
  expectCorners(cornersOf(json(R"({"mesh":0})" + other, unused, R"(,"weights":[0.5,0])")),
                {{0, 0, 2}, {1, 0, 2}, {0, 2, 2}});
  expectCorners(cornersOf(json(R"({"mesh":0,"weights":[0,0.25],"translation":[0,0,1]})" + other,
                               unused, R"(,"weights":[0.5,0])")),
                {{0, 0, 1}, {3, 0, 1}, {0, 2, 1}});
}

TEST_F(GltfShape, NodesThatShareAMeshHaveTheirOwnShapes) {
  const auto corners = cornersOf(
      json(R"({"mesh":0,"weights":[1,0]},{"mesh":0,"translation":[0,0,-1]})", R"("joints":[1])"));
  expectCorners(corners, {{0, 0, 4}, {1, 0, 4}, {0, 2, 4}, {0, 0, -1}, {1, 0, -1}, {0, 2, -1}});
}

TEST_F(GltfShape, AJointThatIsNotThereIsRefused) {
  const std::string text =
      json(kMeshNode + R"({"children":[2]},{"translation":[0,1,0]})", kBothJoints);
  const auto refusal = [&](const std::string& changed, const std::string& bytes) {
    try {
      cornersOf(changed, bytes);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  EXPECT_NE(refusal(text, buffer(7)).find("a vertex names joint 7 of a skin that has 2"),
            std::string::npos);
  std::string without = text;
  without.replace(without.find(R"("joints")"), 8, R"("jointz")");
  EXPECT_NE(refusal(without, buffer()).find("the skin of node 0 cannot be read"),
            std::string::npos);
  std::string latin = text;
  latin.replace(latin.find("2.0"), 3, "2\xe9");
  EXPECT_EQ(cornersOf(latin).size(), 3u);  // a name that is not UTF-8 changes no shape
}

}  // namespace FOCI_FILE
}  // namespace foci
