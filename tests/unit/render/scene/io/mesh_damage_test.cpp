// Meshes of which a part is damaged: refused, or shown with a remark that counts what is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <variant>

#include "base/input_error.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/read_mesh.h"

namespace foci {
namespace FOCI_FILE {

class MeshDamage : public testing::Test {
 protected:
  /// The message, or the remarks of a mesh that is read.
  std::string said(const std::string& name, const std::string& text) {
    try {
      const SceneFile file = readScene(folder_.write(name, text));
      std::string all;
      if (const auto* mesh = std::get_if<MeshFile>(&file.content)) {
        for (const std::string& remark : mesh->mesh.remarks) all += remark + "\n";
      }
      return all;
    } catch (const InputError& error) {
      return error.what();
    }
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  const TemporaryFolder folder_;
};

std::string ply(const std::string& faces, const std::string& more = "") {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement face 2\nproperty list uchar int vertex_indices\n" +
         more + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces;
}

TEST_F(MeshDamage, PlyFacesThatAreCutOffAreRefused) {
  EXPECT_EQ(said("a.ply", ply("3 0 1 2\n\n3 0 2 3\n")), "");
  EXPECT_TRUE(has(said("a.ply", ply("3 0 1 2\n3 0 2")), "a.ply:15: too few values for a face"));
  EXPECT_TRUE(has(said("a.ply", ply("3 0 1 2\n\n\n\n\n")), "ends after 1 of 2 items"));
  EXPECT_TRUE(has(said("a.ply", ply("3 0 1 2\n3 0 2 4\n")),
                  ":15: a face names vertex 4: expected "
                  "0 to 3"));
  EXPECT_TRUE(has(said("a.ply", ply("3 0 1 2\n3 0 2 -1\n")), "names vertex -1"));
  EXPECT_TRUE(has(said("a.ply", ply("3 0 1 2\n3 0 2 x\n")), "expected a number, found \"x\""));
}

TEST_F(MeshDamage, BinaryPlyFacesAreChecked) {
  const auto binary = [](int corner) {
    const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const int index[] = {0, 1, corner};
    return "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
           "property float y\nproperty float z\nelement face 1\n"
           "property list uchar int vertex_indices\nend_header\n" +
           std::string(reinterpret_cast<const char*>(corners), sizeof(corners)) + '\3' +
           std::string(reinterpret_cast<const char*>(index), sizeof(index));
  };
  EXPECT_EQ(said("a.ply", binary(2)), "");
  EXPECT_TRUE(has(said("a.ply", binary(3)), "face 1: a face names vertex 3"));
  EXPECT_TRUE(has(said("a.ply", binary(2).substr(0, binary(2).size() - 2)), "ends at byte"));
}

TEST_F(MeshDamage, PlyNamesMayHaveCapitals) {
  std::string capital = ply("3 0 1 2\n3 0 2 3\n");
  for (const char axis : {'x', 'y', 'z'}) {
    capital.replace(capital.find(std::string("float ") + axis) + 6, 1, 1,
                    static_cast<char>(axis - 32));
  }
  const MeshFile file = readMesh(folder_.write("a.ply", capital));
  EXPECT_EQ(file.mesh.size(), 2u);
  EXPECT_EQ(file.mesh.corners_m[1], glm::vec3(1, 0, 0));
}

/// Two triangles with these properties and values of all vertices but the first, which has 0.
std::string plyWith(const std::string& properties, const std::string& first,
                    const std::string& others) {
  std::string text = ply("3 0 1 2\n3 0 2 3\n");
  text.insert(text.find("element face"), properties);
  for (const char* vertex : {"0 0 0\n", "1 0 0\n", "1 1 0\n", "0 1 0\n"}) {
    text.insert(text.find(vertex) + 5, std::string(vertex) == "0 0 0\n" ? first : others);
  }
  return text;
}

TEST_F(MeshDamage, AlphaOfPlyVerticesIsOpacity) {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                    alpha = "property uchar alpha\n";
  const auto opacities = [&](const std::string& text) {
    const MeshFile file = readMesh(folder_.write("a.ply", text));
    return std::array{colorAt(file.mesh, {0, glm::vec2(0.0f)}, 0.0f).opacity,
                      colorAt(file.mesh, {0, glm::vec2(1.0f, 0.0f)}, 0.0f).opacity};
  };
  EXPECT_EQ(opacities(plyWith(colors, " 9 9 9", " 9 9 9")), (std::array{1.0f, 1.0f}));
  EXPECT_EQ(opacities(plyWith(colors + alpha, " 9 9 9 255", " 9 9 9 255")),
            (std::array{1.0f, 1.0f}));
  EXPECT_EQ(opacities(plyWith(colors + alpha, " 9 9 9 51", " 9 9 9 255")),
            (std::array{0.2f, 1.0f}));
  EXPECT_EQ(opacities(plyWith(colors + alpha, " 9 9 9 51", " 9 9 9 51")), (std::array{0.2f, 0.2f}));
  EXPECT_EQ(opacities(plyWith(alpha, " 51", " 255")), (std::array{0.2f, 1.0f}));
  EXPECT_EQ(opacities(plyWith("property float opacity\n", " 0.2", " 1")), (std::array{0.2f, 1.0f}));
  EXPECT_EQ(opacities(plyWith("property uchar r\nproperty uchar g\nproperty uchar b\n"
                              "property uchar a\n",
                              " 9 9 9 51", " 9 9 9 255")),
            (std::array{0.2f, 1.0f}));
  const MeshFile alone = readMesh(folder_.write("c.ply", plyWith(alpha, " 51", " 255")));
  EXPECT_GT(colorAt(alone.mesh, {0, glm::vec2(0.0f)}, 0.0f).color.x, 0.3f) << "grey, not black";
  EXPECT_EQ(alone.facts.opacity.x, 0.2f);
  EXPECT_TRUE(has(said("b.ply", plyWith(colors + alpha, " 9 9 9 0", " 9 9 9 0")),
                  "alpha of all vertices is 0"));
}

TEST_F(MeshDamage, PlyStripsAreTrianglesOfAlternateWinding) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\n"
      "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
      "8 0 1 2 3 -1 2 3 4\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
  const MeshFile file = readMesh(folder_.write("a.ply", text));
  ASSERT_EQ(file.mesh.size(), 3u);
  for (std::size_t t = 0; t < 3; ++t) {
    const glm::vec3* const c = &file.mesh.corners_m[3 * t];
    EXPECT_GT(glm::cross(c[1] - c[0], c[2] - c[0]).z, 0.0f) << t;
  }
  EXPECT_TRUE(has(said("b.ply", text.substr(0, text.find("8 0")) + "8 0 1 2 3 -1 2 3 9\n" +
                                    text.substr(text.find("0 0 0\n"))),
                  "names vertex 9: expected 0 to 4"));
}

TEST_F(MeshDamage, ColoursOfPlyFacesAreShown) {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const MeshFile file =
      readMesh(folder_.write("a.ply", ply("3 0 1 2 255 0 0\n3 0 2 3 0 255 0\n", colors)));
  EXPECT_EQ(colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(1, 0, 0));
  EXPECT_EQ(colorAt(file.mesh, {1, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(0, 1, 0));
  EXPECT_TRUE(file.facts.material_colors && !file.facts.has_colors);
}

/// A square whose first corner has the x 0.5000006, whose first byte is that of a line end.
TEST_F(MeshDamage, ABinaryPlyMayBeginWithALineEnd) {
  const auto write = [&](const std::string& header_end) {
    const float corners[] = {0.5000006f, 0, 0, 1, 0, 0, 1, 1, 0};
    const int index[] = {0, 1, 2};
    return folder_.write(
        "a.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header" +
            header_end + std::string(reinterpret_cast<const char*>(corners), sizeof(corners)) +
            '\3' + std::string(reinterpret_cast<const char*>(index), sizeof(index)));
  };
  for (const char* header_end : {"\n", "\r\n"}) {
    EXPECT_EQ(readMesh(write(header_end)).mesh.corners_m.at(0).x, 0.5000006f);
  }
}

TEST_F(MeshDamage, PlyElementsMayComeInAnyOrderAndTakeSeveralLines) {
  const std::string header = "ply\nformat ascii 1.0\n",
                    face =
                        "element face 1\n"
                        "property list uchar int vertex_index\n";
  const std::string vertex =
      "element vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float diffuse_red\nproperty float diffuse_green\n"
      "property float diffuse_blue\n";
  const MeshFile file = readMesh(folder_.write(
      "a.ply", header + "element camera 1\nproperty float f\n" + face + vertex +
                   "end_header\n7\n3 0 1 2\n0 0 0\n1 0 0\n1 0 0\n1 0 0\n0 1 0\n1 0 0.5\n"));
  ASSERT_EQ(file.mesh.size(), 1u);
  EXPECT_EQ(colorAt(file.mesh, {0, glm::vec2(0.0f)}, 0.0f).color, glm::vec3(1, 0, 0));
  EXPECT_TRUE(has(said("b.ply", header + face + vertex +
                                    "end_header\n3 0 1 2\n0 0 0\n1 0 0 1\n0 1 0\n1 0 0\n1 1 1\n"),
                  "b.ply:14: too few values for a vertex"));
}

TEST_F(MeshDamage, APlyInDoublesKeepsItsDetail) {
  std::string text = ply("3 0 1 2\n3 0 2 3\n");
  for (int i = 0; i < 3; ++i) text.replace(text.find("property float"), 14, "property double");
  text.replace(text.find("0 0 0\n"), text.size(),
               "500000 5400000 0\n500000.25 5400000 0\n500000.25 5400000.25 0\n"
               "500000 5400000.25 0\n3 0 1 2\n3 0 2 3\n");
  const MeshFile file = readMesh(folder_.write("a.ply", text));
  EXPECT_EQ(file.mesh.corners_m.at(1), glm::vec3(0.25f, 0.0f, 0.0f));
  EXPECT_TRUE(has(said("a.ply", text), "positions are relative to"));
}

/// Two squares side by side, of which each has a texture of its own.
TEST_F(MeshDamage, FacesOfAPlyChooseTheirTexture) {
  cv::imwrite((folder_.path() / "red.png").string(), cv::Mat(4, 4, CV_8UC3, cv::Scalar(0, 0, 255)));
  cv::imwrite((folder_.path() / "blue one.png").string(),
              cv::Mat(4, 4, CV_8UC3, cv::Scalar(255, 0, 0)));
  const std::string text =
      "ply\nformat ascii 1.0\ncomment TextureFile red.png\ncomment TextureFile blue one.png \n"
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 3\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "property int texnumber\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
      "3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 6 0 0 1 1 0 1 1\n3 2 1 0 6 0 0 0 0 0 0 ";
  const MeshFile file = readMesh(folder_.write("a.ply", text + "7\n"));
  ASSERT_EQ(file.mesh.size(), 3u);
  EXPECT_EQ(colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(1, 0, 0));
  EXPECT_EQ(colorAt(file.mesh, {1, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(0, 0, 1));
  EXPECT_TRUE(has(said("a.ply", text + "7\n"), "1 face with a texture that the file does not"));
  EXPECT_EQ(said("a.ply", text + "-1\n"), "");
}

TEST_F(MeshDamage, ATextureOfAPlyNeedsANameAndCoordinates) {
  const std::string start = "ply\nformat ascii 1.0\n",
                    vertices =
                        "element vertex 3\nproperty float x\nproperty float y\n"
                        "property float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string plain = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_TRUE(has(said("a.ply", start + "comment TextureFile t.png\n" + vertices + faces + plain),
                  "has no texture coordinates"));
  EXPECT_TRUE(has(said("b.ply", start + vertices + "property float s\nproperty float t\n" + faces +
                                    "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"),
                  "names no texture"));
  EXPECT_EQ(said("c.ply", start + vertices + faces + plain), "");
}

TEST_F(MeshDamage, ColoursOfVerticesMayBe0To255) {
  EXPECT_TRUE(has(said("a.obj", "v 0 0 0 300 0 0\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3\n"),
                  "no colours (300.000 is among them): left out; write colours as 0 to 1, or as "));
  EXPECT_TRUE(has(said("a.obj", "v 0 0 0 1.5 0 0\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3\n"),
                  "no colours (1.500"));
  const std::string normals = "v 0 0 0 0.6 -0.8 0\nv 1 0 0 0.6 -0.8 0\nv 0 1 0 0.6 -0.8 0\n";
  EXPECT_TRUE(has(said("n.obj", normals + "f 1 2 3\n"), "no colours (-0.800"));
  EXPECT_TRUE(readMesh(folder_.write("n.obj", normals + "f 1 2 3\n")).mesh.color.empty());
  const auto points = std::get<PointCloud>(readObj(folder_.write("p.obj", normals)));
  EXPECT_TRUE(has(points.remarks.at(0), "no colours (-0.800"));
  const std::string bytes = "v 0 0 0 255 0 0\nv 1 0 0 255 0 0\nv 0 1 0 255 0 0\nf 1 2 3\n";
  EXPECT_TRUE(has(said("c.obj", bytes), "colours are 0 to 255"));
  const MeshFile file = readMesh(folder_.write("c.obj", bytes));
  EXPECT_EQ(colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(1, 0, 0));
  EXPECT_EQ(said("b.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3\n"), "");
}

TEST_F(MeshDamage, SevenNumbersOfAnObjHaveAWeightOrAnAlpha) {
  const MeshFile alpha = readMesh(
      folder_.write("a.obj", "v 2 0 0 0 0 1 1\nv 4 0 0 0 0 1 1\nv 2 1 0 0 0 1 1\nf 1 2 3\n"));
  EXPECT_EQ(alpha.mesh.corners_m.at(1).x, 4.0f);
  EXPECT_EQ(colorAt(alpha.mesh, {0, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(0, 0, 1));
  const MeshFile weight = readMesh(
      folder_.write("w.obj", "v 2 0 0 1 0 1 0\nv 4 0 0 1 0 1 0\nv 2 1 0 1 0 1 0\nf 1 2 3\n"));
  EXPECT_EQ(colorAt(weight.mesh, {0, glm::vec2(0.25f)}, 0.0f).color, glm::vec3(0, 1, 0));
}

TEST_F(MeshDamage, AnObjThatEndsWithinAFaceIsRefused) {
  const std::string start = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
  EXPECT_EQ(said("a.obj", start + "f 1/1 3/1 4/1"), "");
  for (const char* cut : {"f", "f 1/1", "f 1/1 3/1", "f 1/1 3/1 ", "f 1/1 3/1 4", "f 1/1 3/1 4/"}) {
    EXPECT_TRUE(has(said("b.obj", start + cut), "b.obj:7: ends within a face")) << cut;
  }
  EXPECT_TRUE(has(said("c.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 2 3"),
                  "may be cut off"));
  std::string many = start;
  for (int i = 5; i <= 40; ++i) many += "v " + std::to_string(i) + " 0 1\n";
  EXPECT_EQ(said("d.obj", many + "f 10/1 11/1 12/1\nf 20/1 21/1 4/1"), "");
  EXPECT_TRUE(has(said("e.obj", many + "f 10 11 12\nf 20 21 4"), "may be cut off"));
  EXPECT_EQ(said("f.obj", many + "f 10 11 12\nf 20 21 4\n"), "");
}

TEST_F(MeshDamage, ObjFacesMayHaveCommentsOrTwoCorners) {
  const std::string start = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(said("a.obj", start + "f 1 2 3 # a\nf 1 \\\n3 4\n"), "");
  EXPECT_EQ(readMesh(folder_.write("a.obj", start + "f 1 2 3 # a\nf 1 \\\n3 4")).mesh.size(), 2u);
  const std::string two = start + "f 1 2 3\nf 2 4\nf 1 3 4\n";
  EXPECT_TRUE(has(said("b.obj", two), "1 face with two corners"));
  EXPECT_EQ(readMesh(folder_.write("b.obj", two)).mesh.size(), 2u);
}

TEST_F(MeshDamage, CornersThatAreNotFiniteAreCounted) {
  EXPECT_TRUE(has(said("a.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 1 3 4\n"),
                  "1 triangle with a corner that is not finite"));
  EXPECT_EQ(readMesh(folder_.write("c.obj", "v 0,5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"))
                .mesh.corners_m.at(0)
                .x,
            0.5f);
}

/// Two triangles, the second with this corner.
std::string gltf(int corner, const std::string& more = "") {
  static constexpr const char* kIndex[] = {"AAABAAIAAAACAAMA", "AAABAAIAAAACAE0A"};
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)"
         R"("min":[0,0,0],"max":[1,1,0]},)"
         R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":1,"byteLength":12}],)"
         R"("buffers":[{"byteLength":48,"uri":"data:application/octet-stream;base64,)"
         R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAA"},)"
         R"({"byteLength":12,"uri":"data:application/octet-stream;base64,)" +
         std::string(kIndex[corner == 3 ? 0 : 1]) + "\"}]" + more + "}";
}

TEST_F(MeshDamage, GltfTrianglesWithoutAVertexAreCounted) {
  EXPECT_EQ(said("a.gltf", gltf(3)), "");
  EXPECT_TRUE(has(said("b.gltf", gltf(77)), "1 triangle with a vertex that is not there"));
}

TEST_F(MeshDamage, GltfHasAByteOrderMarkOrAWrongNameOrIsCutOff) {
  EXPECT_EQ(said("a.gltf", "\xef\xbb\xbf" + gltf(3)), "");
  const std::string json = gltf(3) + std::string((4 - gltf(3).size() % 4) % 4, ' ');
  const auto word = [](std::size_t number) {
    const auto bits = static_cast<std::uint32_t>(number);
    return std::string(reinterpret_cast<const char*>(&bits), sizeof(bits));
  };
  const std::string binary =
      "glTF" + word(2) + word(20 + json.size()) + word(json.size()) + "JSON" + json;
  EXPECT_EQ(said("c.gltf", binary), "") << "by content";
  EXPECT_EQ(said("d.glb", json), "");
  EXPECT_TRUE(has(said("e.glb", binary.substr(0, binary.size() - 9)), "is cut off: states"));
}

TEST_F(MeshDamage, FilesOfNothingAreNamed) {
  EXPECT_TRUE(has(said("a.gltf", R"({"asset":{"version":"2.0"}})"), "has no scene with nodes"));
  EXPECT_TRUE(has(said("b.gltf", R"({"asset":{"version":"1.0"}})"), "is glTF of version \"1.0\""));
  EXPECT_TRUE(has(said("a.foci", "junk"), "is no prepared scene"));
}

TEST_F(MeshDamage, ExtensionsThatAGltfRequiresMustBeKnown) {
  EXPECT_TRUE(has(said("a.gltf", gltf(3, R"(,"extensionsRequired":["KHR_foo"])")),
                  "requires the glTF extension \"KHR_foo\""));
  EXPECT_EQ(said("b.gltf", gltf(3, R"(,"extensionsRequired":["KHR_materials_unlit"])")), "");
  EXPECT_EQ(said("c.gltf", gltf(3, R"(,"extensionsUsed":["KHR_foo"])")), "");
}

/// A tetrahedron's corner: three triangles, each with this colour.
/// @param last  colour of the last triangle; 0: as the others
std::string stl(std::string header, unsigned color, unsigned stated = 3, unsigned last = 0) {
  header.resize(80, ' ');
  const auto append = [&](const auto& value) {
    header.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  append(static_cast<std::uint32_t>(stated));
  for (int i = 0; i < 3; ++i) {
    for (int number = 0; number < 12; ++number) {
      const bool one = (number == 6 + i) || (number == 9 + (i + 1) % 3);
      append(one ? 1.0f : 0.0f);
    }
    append(static_cast<std::uint16_t>(i == 2 && last != 0 ? last : color));
  }
  return header;
}

TEST_F(MeshDamage, AStlThatIsCutOffStatesBothSizes) {
  EXPECT_EQ(said("a.stl", stl("binary", 0)), "");
  EXPECT_TRUE(has(said("b.stl", stl("binary", 0, 20)),
                  "is cut off: states 20 triangles in 1,084 bytes, and has 234"));
}

TEST_F(MeshDamage, BytesBehindTheTrianglesOfAnStlAreLeftOut) {
  EXPECT_TRUE(has(said("a.stl", stl("binary", 0) + "1234"), "the last 4 bytes are behind"));
  EXPECT_EQ(readMesh(folder_.write("a.stl", stl("binary", 0) + "1234")).mesh.size(), 3u);
}

TEST_F(MeshDamage, AnStlAsTextMayBeInCapitals) {
  const std::string text =
      "solid Foo\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid Foo\n";
  std::string capitals = text;
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(said("a.stl", text), "");
  EXPECT_EQ(said("b.stl", capitals), "");
  EXPECT_TRUE(has(said("c.stl", text.substr(0, text.find("endsolid"))), "no line endsolid"));
  EXPECT_TRUE(has(said("d.stl", text.substr(0, text.find("vertex 0 1"))), "is cut off"));
}

TEST_F(MeshDamage, EmptySolidsOfAnStlAreLeftOut) {
  const std::string solid =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid a\n";
  const std::string empty = "solid b\nendsolid b\n";
  const auto sizeOf = [&](const std::string& text) {
    return readMesh(folder_.write("a.stl", text)).mesh.size();
  };
  EXPECT_EQ(sizeOf(empty + solid + empty), 1u);
  EXPECT_EQ(sizeOf(solid + empty + solid), 1u);  // the second repeats the first
  EXPECT_THROW(sizeOf(empty + empty), InputError);
}

TEST_F(MeshDamage, AStlOfMagicsHasTheColourOfItsHeaderWhereMarked) {
  const std::string header = std::string("COLOR=") + "\xff" + std::string(2, '\0') + "\xff";
  const auto color = [&](unsigned bits) {
    const MeshFile file = readMesh(folder_.write("a.stl", stl(header, bits)));
    return colorAt(file.mesh, {0, glm::vec2(0.25f)}, 0.0f).color;
  };
  EXPECT_LT(glm::distance(color(0x8000), glm::vec3(1, 0, 0)), 0.01f);
  EXPECT_LT(glm::distance(color(31), glm::vec3(1, 0, 0)), 0.01f);  // its own: red in the low bits
  EXPECT_LT(glm::distance(color(31 << 10), glm::vec3(0, 0, 1)), 0.01f);
  EXPECT_LT(glm::distance(color(0x8000 | 31 << 10), glm::vec3(0, 0, 1)), 0.01f);  // MeshLab
  // Triangles with and without the mark are of Magics, though the marked ones have a code, too.
  const MeshFile mixed =
      readMesh(folder_.write("b.stl", stl(header, 31 << 5, 3, 0x8000 | 31 << 10)));
  const auto colorOf = [&](std::uint32_t triangle) {
    return colorAt(mixed.mesh, {triangle, glm::vec2(0.25f)}, 0.0f).color;
  };
  EXPECT_LT(glm::distance(colorOf(0), glm::vec3(0, 1, 0)), 0.01f);
  EXPECT_LT(glm::distance(colorOf(2), glm::vec3(1, 0, 0)), 0.01f);
}

TEST_F(MeshDamage, PartsOfAGltfThatAreNotShownAreNamed) {
  for (const std::string name : {"KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"}) {
    EXPECT_TRUE(has(said("a.gltf", gltf(3, R"(,"extensionsRequired":[")" + name +
                                               R"("],"textures":[{"extensions":{")" + name +
                                               R"(":{"source":0}}}],"images":[{"uri":"t"}])")),
                    "KTX2, AVIF or DDS"))
        << name;
  }
  EXPECT_EQ(said("b.gltf", gltf(3, R"(,"textures":[{"sampler":0}],"samplers":[{}])")), "");
}

}  // namespace FOCI_FILE
}  // namespace foci
