// Files as exporters write them: shown right, or with a word about what is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

class OddScenes : public testing::Test {
 protected:
  SceneFile read(const std::string& name, const std::string& text) {
    return readScene(scratch_.write(name, text));
  }
  MeshFile mesh(const std::string& name, const std::string& text) {
    return std::get<MeshFile>(read(name, text).content);
  }
  PointCloud points(const std::string& name, const std::string& text) {
    return std::get<PointCloud>(read(name, text).content);
  }
  std::string refusal(const std::string& name, const std::string& text) {
    try {
      read(name, text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static bool has(const std::vector<std::string>& remarks, const std::string& part) {
    return std::ranges::any_of(
        remarks, [&](const std::string& each) { return each.find(part) != std::string::npos; });
  }

  TemporaryFolder scratch_;
};

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(OddScenes, ColumnsNameTheirUnitAndColours) {
  const PointCloud scan = points("p.csv", "x_mm,y_mm,z_mm,Rf,Gf,Bf\n1,2,3,1,0,0\n4,5,6,0,0,1\n");
  EXPECT_EQ(scan.unit_m, 0.001);
  EXPECT_EQ(scan.color.at(0), glm::vec3(1, 0, 0));
}

TEST_F(OddScenes, AnObjMayEndItsLinesByCarriageReturns) {
  std::string text = kSquare + "f 1 2 3\nf 1 3 4\n";
  std::ranges::replace(text, '\n', '\r');
  EXPECT_EQ(mesh("m.obj", text).mesh.size(), 2u);
}

TEST_F(OddScenes, VerticesOfAnObjHaveAWeightBesideAColour) {
  const MeshFile read =
      mesh("m.obj", "v 0 0 0 1 1 0 0\nv 1 0 0 1 1 0 0\nv 2 2 0 2 1 0 0\nf 1 2 3\n");
  EXPECT_EQ(read.mesh.corners_m.at(2), glm::vec3(1, 1, 0));
  EXPECT_EQ(read.mesh.color.at(0), glm::vec3(1, 0, 0));
}

TEST_F(OddScenes, ColoursOfZbrushAreComments) {
  const std::string painted =
      kSquare + "#MRGB ffff0000ff00ff00\n#MRGB ff0000ffffffffff\nf 1 2 3 4\n";
  const MeshFile read = mesh("m.obj", painted);
  EXPECT_TRUE(read.facts.has_colors);
  EXPECT_EQ(read.mesh.color.at(0), glm::vec3(1, 0, 0));
  EXPECT_EQ(read.mesh.color.at(1), glm::vec3(0, 1, 0));
  const MeshFile fewer = mesh("m.obj", kSquare + "#MRGB ffff0000\nf 1 2 3 4\n");
  EXPECT_FALSE(fewer.facts.has_colors);
  EXPECT_TRUE(has(fewer.mesh.remarks, "#MRGB"));
}

TEST_F(OddScenes, AGridOfPtxIsNotTakenForPoints) {
  const std::string pose = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  const std::string ptx = "2\n1\n" + pose + "0 0 1 0.5\n1 0 1 0.5\n";
  EXPECT_NE(refusal("scan.txt", ptx).find("PTX"), std::string::npos);
  EXPECT_NE(refusal("scan.pts", ptx).find("PTX"), std::string::npos);
}

TEST_F(OddScenes, PointsOfAnObjHaveNormals) {
  const PointCloud scan = points("p.obj", "v 0 0 0\nv 1 0 0\nvn 0 0 2\nvn 0 1 0\n");
  ASSERT_EQ(scan.normal.size(), 2u);
  EXPECT_EQ(scan.normal[0], glm::vec3(0, 0, 1));
}

TEST_F(OddScenes, WhatWouldHideAllIsOpaque) {
  scratch_.write("m.mtl", "newmtl a\nKd 1 0 0\nd 0\n");
  const MeshFile hidden = mesh("m.obj", "mtllib m.mtl\nusemtl a\n" + kSquare + "f 1 2 3\n");
  EXPECT_EQ(hidden.mesh.materials.at(hidden.mesh.material.at(0)).opacity, 1.0f);
  EXPECT_EQ(hidden.facts.opacity.x, 1.0f);
  EXPECT_TRUE(has(hidden.mesh.remarks, "shown opaque"));
  const std::string vertices =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar alpha\nend_header\n";
  const PointCloud scan = points("p.ply", vertices + "0 0 0 0\n1 0 0 0\n");
  EXPECT_TRUE(scan.opacity.empty());
  EXPECT_TRUE(has(scan.remarks, "alpha of all points is 0"));
  EXPECT_EQ(points("p.ply", vertices + "0 0 0 0\n1 0 0 51\n").opacity.size(), 2u);
}

TEST_F(OddScenes, PartsThatLieFarApartAreNamed) {
  const auto two = [&](const std::string& x) {
    return mesh("m.obj",
                kSquare + "v " + x + " 0 0\nv " + x + " 1 0\nv " + x + " 1 1\nf 1 2 3\nf 5 6 7\n")
        .mesh.remarks;
  };
  EXPECT_FALSE(has(two("20"), "far apart")) << "two walls of a room";
  EXPECT_TRUE(has(two("2000"), "its 2 parts lie so far apart"));
}

TEST_F(OddScenes, EdgesAndBlankLinesOfAPly) {
  const PointCloud scan =
      points("p.ply",
             "\n \nply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
             "property float z\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n"
             "end_header\n0 0 0\n1 0 0\n0 1\n");
  EXPECT_EQ(scan.size(), 2u);
  EXPECT_TRUE(has(scan.remarks, "1 edge left out"));
}

TEST_F(OddScenes, TexturesOfAPlyAreNamedInAnyCase) {
  const MeshFile read = mesh(
      "m.ply",
      "ply\nformat ascii 1.0\ncomment texturefile gone.png\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 "
      "2\n");
  EXPECT_TRUE(has(read.mesh.remarks, "\"gone.png\" is missing"));
}

TEST_F(OddScenes, OtherVersionsOfGltfAreRefused) {
  EXPECT_NE(
      refusal("m.gltf", R"({"asset":{"version":"1.0"},"nodes":[{}]})").find("version \"1.0\""),
      std::string::npos);
  EXPECT_NE(
      refusal("m.gltf", R"({"asset":{"version":"3.0"},"nodes":[{}]})").find("version \"3.0\""),
      std::string::npos);
}

TEST_F(OddScenes, FoldersAndListsOfColmap) {
  std::filesystem::create_directories(scratch_.path() / "sparse/0");
  scratch_.write("sparse/0/points3D.txt", "1 0 0 0 255 0 0 0.5 1 1\n2 1 0 0 0 0 255 0.5\n");
  const SceneFile scan = readScene(scratch_.path());
  EXPECT_EQ(std::get<PointCloud>(scan.content).size(), 2u);
  EXPECT_NE(refusal("images.txt", "# Image list with two lines of data per image:\n1 1 0 0 0\n")
                .find("is a list of COLMAP"),
            std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
