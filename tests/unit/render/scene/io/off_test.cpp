#include "render/scene/io/point_formats.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "base/input_error.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kRounding = 1e-6f;

class Off : public testing::Test {
 protected:
  MeshFile mesh(const std::string& text) {
    return std::get<MeshFile>(readOff(scratch_.write("m.off", text)));
  }
  PointCloud points(const std::string& text) {
    return std::get<PointCloud>(readOff(scratch_.write("m.off", text)));
  }
  std::string refusal(const std::string& text) {
    try {
      readOff(scratch_.write("m.off", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  const TemporaryFolder scratch_;
};

const std::string kSquare = "0 0 0\n2 0 0\n2 1 0\n0 1 0\n";

TEST_F(Off, HeadersOfAllWritersAreOneMesh) {
  for (const char* header : {"OFF\n4 1 0\n", "OFF 4 1 0\n", "OFF4 1 0\n", "4 1 4\n",
                             "# a tool\nOFF # text\n\n4 1 0\n"}) {
    const MeshFile file = mesh(header + kSquare + "4 0 1 2 3\n");
    EXPECT_EQ(file.mesh.size(), 2u) << header;
    EXPECT_NEAR(areaOf_m2(file.mesh.corners_m), 2.0, 1e-6) << header;
    EXPECT_EQ(file.facts.triangles, 2u);
    EXPECT_FALSE(file.facts.has_colors || file.facts.material_colors);
  }
}

TEST_F(Off, AlphaIsOpacity) {
  const auto opacity = [&](const std::string& text) {
    return colorAt(mesh(text).mesh, {0, {0.2f, 0.2f}}, 0.0f).opacity;
  };
  EXPECT_FLOAT_EQ(opacity("OFF\n4 1 0\n" + kSquare + "4 0 1 2 3 255 0 0 51\n"), 0.2f);
  EXPECT_FLOAT_EQ(opacity("OFF\n4 1 0\n" + kSquare + "4 0 1 2 3 0 0 0 51\n"), 0.2f);
  EXPECT_EQ(opacity("OFF\n4 1 0\n" + kSquare + "4 0 1 2 3 1 0 0\n"), 1.0f);
  EXPECT_FLOAT_EQ(opacity("COFF\n3 1 0\n0 0 0 9 0 0 51\n1 0 0 9 0 0 51\n0 1 0 9 0 0 51\n3 0 1 2\n"),
                  0.2f);
  const MeshFile clear = mesh("OFF\n4 1 0\n" + kSquare + "4 0 1 2 3 255 0 0 0\n");
  EXPECT_TRUE(clear.mesh.alpha.empty());
  EXPECT_TRUE(has(clear.mesh.remarks.at(0), "shown opaque"));
  EXPECT_FLOAT_EQ(points("COFF\n2 0 0\n0 0 0 9 0 0 51\n1 0 0 9 0 0 255\n").opacity.at(0), 0.2f);
}

TEST_F(Off, ColoursAreThoseOfFacesOrVertices) {
  const MeshFile faces = mesh("OFF\n4 2 0\n" + kSquare + "3 0 1 2 1.0 0 0\n3 0 2 3 0 255 0 255\n");
  EXPECT_TRUE(faces.facts.material_colors);
  EXPECT_EQ(colorAt(faces.mesh, {0, {0.2f, 0.2f}}, 0.1f).color, glm::vec3(1, 0, 0));
  EXPECT_EQ(colorAt(faces.mesh, {1, {0.2f, 0.2f}}, 0.1f).color, glm::vec3(0, 1, 0));

  const MeshFile vertices =
      mesh("COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n3 0 1 2 5\n");
  EXPECT_TRUE(vertices.facts.has_colors);
  const glm::vec3 middle = colorAt(vertices.mesh, {0, glm::vec2(1.0f / 3.0f)}, 0.1f).color;
  EXPECT_LT(glm::distance(middle, glm::vec3(1.0f / 3.0f)), kRounding);
}

TEST_F(Off, ADarkColourBesideBrightOnesIsDark) {
  const PointCloud bytes = points("COFF\n2 0 0\n0 0 0 255 0 0 255\n1 0 0 0 1 0 255\n");
  EXPECT_LT(bytes.color.at(1).y, 0.001f);
  const PointCloud opaque = points("COFF\n2 0 0\n0 0 0 200 0 0\n1 0 0 0 1 1\n");
  EXPECT_LT(opaque.color.at(1).y, 0.001f);
  const PointCloud units = points("COFF\n2 0 0\n0 0 0 0.5 0 0 1\n1 0 0 0 1 0 1\n");
  EXPECT_EQ(units.color.at(1), glm::vec3(0, 1, 0));
  const PointCloud part = points("OFF\n4 0 0\n0 0 0\n1 0 0 0 255 0\n2 0 0\n3 0 0\n");
  EXPECT_EQ(part.color.at(1), glm::vec3(0, 1, 0));
  for (const std::size_t i : {0u, 2u, 3u}) EXPECT_EQ(part.color.at(i).x, part.color.at(i).y) << i;
  const MeshFile faces = mesh("OFF\n4 2 0\n" + kSquare + "3 0 1 2 1 0 0\n3 0 2 3 0 200 0\n");
  EXPECT_LT(colorAt(faces.mesh, {0, {0.2f, 0.2f}}, 0.1f).color.x, 0.001f);
}

TEST_F(Off, AConcavePolygonKeepsItsArea) {
  // An arrow head, whose fan from its first corner would cover the notch.
  for (const int first : {0, 1, 2, 3}) {
    std::string face = "4";
    for (int k = 0; k < 4; ++k) face += " " + std::to_string((first + k) % 4);
    const MeshFile file = mesh("OFF\n4 1 0\n0 0 0\n4 -2 0\n1 0 0\n4 2 0\n" + face + "\n");
    EXPECT_NEAR(areaOf_m2(file.mesh.corners_m), 2.0, 1e-6) << face;
  }
}

TEST_F(Off, WithoutFacesAreItsPoints) {
  const PointCloud cloud = points("NOFF\n2 0 0\n1 2 3 0 0 2\n4 5 6 0 0 0\n");
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_EQ(cloud.position_m[1], glm::vec3(4, 5, 6));
  EXPECT_EQ(cloud.normal[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(cloud.normal[1], glm::vec3(0));  // to be estimated
}

TEST_F(Off, DetailFarFromTheOriginIsKept) {
  const MeshFile file =
      mesh("OFF\n3 1 0\n10000000.01 5e6 0\n10000000.02 5e6 0\n10000000.01 5000000.01 0\n3 0 1 2\n");
  EXPECT_NEAR(areaOf_m2(file.mesh.corners_m), 0.5e-4, 1e-7);
  ASSERT_EQ(file.mesh.remarks.size(), 1u);
  EXPECT_TRUE(has(file.mesh.remarks[0], "positions are relative to"));
}

TEST_F(Off, RefusesBrokenFilesWithTheirLine) {
  EXPECT_TRUE(has(refusal(""), "is empty"));
  EXPECT_TRUE(has(refusal("PLY\n1 1 0\n"), "m.off:1: is no OFF file"));
  EXPECT_TRUE(has(refusal("OFF BINARY\n1 1 0\n"), "binary"));
  EXPECT_TRUE(has(refusal("4OFF\n1 1 0\n"), "three dimensions"));
  EXPECT_TRUE(has(refusal("OFF\n4000000 1 0\n0 0 0\n"), "room for"));
  EXPECT_TRUE(has(refusal("OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 x\n3 0 1 2\n"), "m.off:6"));
  EXPECT_TRUE(has(refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "expected 0 to 2"));
  EXPECT_TRUE(has(refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n"), "m.off:6"));
  EXPECT_TRUE(has(refusal("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "ends early"));
  EXPECT_TRUE(has(refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"), "no triangle"));
}

TEST_F(Off, OpensAsASceneWithYUp) {
  const SceneFile file =
      readScene(scratch_.write("m.OFF", "OFF\n4 1 0\n" + kSquare + "4 0 1 2 3\n"));
  EXPECT_TRUE(std::holds_alternative<MeshFile>(file.content));
  EXPECT_EQ(factsOf(file).kind, SceneKind::off_mesh);
  EXPECT_TRUE(isScene(file.path));
}

}  // namespace FOCI_FILE
}  // namespace foci
