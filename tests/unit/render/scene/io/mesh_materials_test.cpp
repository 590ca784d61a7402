// Colours and textures of meshes as exporters write them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <variant>

#include "base/input_error.h"
#include "render/image/srgb.h"
#include "render/scene/io/mesh_files.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/io/point_formats.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/read_mesh.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;
constexpr float kByte = 0.01f;  // 8-bit sRGB

const std::string kTriangle =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";

class MeshMaterials : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) {
    return folder_.write(name, text);
  }
  /// Four quarters: red and green above, blue and white below.
  void writeQuarters(const fs::path& file) const {
    cv::Mat image(64, 64, CV_8UC3);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        image.at<cv::Vec3b>(y, x) = y < 32 ? (x < 32 ? cv::Vec3b(0, 0, 255) : cv::Vec3b(0, 255, 0))
                                           : (x < 32 ? cv::Vec3b(255, 0, 0) : cv::Vec3b::all(255));
      }
    }
    fs::create_directories(file.parent_path());
    ASSERT_TRUE(cv::imwrite(file.string(), image));
  }
  static glm::vec3 colorOf(const MeshFile& file, std::size_t triangle = 0) {
    return colorAt(file.mesh, {static_cast<std::uint32_t>(triangle), glm::vec2(0.25f)}, 1e-3f)
        .color;
  }
  static bool remarks(const MeshFile& file, const std::string& part) {
    return std::any_of(file.mesh.remarks.begin(), file.mesh.remarks.end(),
                       [&](const auto& remark) { return remark.find(part) != std::string::npos; });
  }
  std::string refusal(const fs::path& path) {
    try {
      readScene(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder folder_;
};

TEST_F(MeshMaterials, ATextureIsFoundWhereItsPathWasOfAnotherMachine) {
  writeQuarters(folder_.path() / "Textures/Wood.PNG");
  write("m.mtl", "newmtl m\nmap_Kd D:\\work\\assets\\wood.png\n");
  const MeshFile file = readMesh(write("m.obj", "mtllib m.mtl\n" + kTriangle));
  EXPECT_TRUE(file.mesh.remarks.empty());
  EXPECT_TRUE(file.facts.has_colors);
  EXPECT_LT(glm::distance(colorOf(file), glm::vec3(0, 0, 1)), kByte);  // below left
}

TEST_F(MeshMaterials, AMissingTextureIsNoColour) {
  write("m.mtl", "newmtl m\nKd 0 1 0\nmap_Kd C:\\long\\path\\of\\another\\machine\\gone.png\n");
  const MeshFile file = readMesh(write("m.obj", "mtllib m.mtl\n" + kTriangle));
  EXPECT_TRUE(remarks(file, "\"gone.png\" is missing"));
  EXPECT_FALSE(file.facts.has_colors);  // so the scene is shaded
}

TEST_F(MeshMaterials, ATextureTooLargeIsRefusedByItsHeader) {
  std::string png = "\x89PNG\r\n\x1a\n";
  png += std::string("\0\0\0\rIHDR\0\0\x40\0\0\0\x40\0\x08\x02\0\0\0", 21);  // 16384 x 16384
  write("huge.png", png);
  write("m.mtl", "newmtl m\nmap_Kd huge.png\n");
  EXPECT_TRUE(remarks(readMesh(write("m.obj", "mtllib m.mtl\n" + kTriangle)), "8192 x 8192"));
}

TEST_F(MeshMaterials, ColoursOfMaterialsAreNoPicture) {
  write("m.mtl", "newmtl m\nKd 1 0 0\nnewmtl n\nKd 0 1 0\n");
  const std::string two = "mtllib m.mtl\n" + kTriangle + "v 0 0 1\nusemtl n\nf 1/1 2/2 4/3\n";
  const MeshFile file = readMesh(write("m.obj", two));
  EXPECT_FALSE(file.facts.has_colors);
  EXPECT_TRUE(file.facts.material_colors);
  const MeshFile one = readMesh(write("one.obj", "mtllib m.mtl\n" + kTriangle));
  EXPECT_FALSE(one.facts.material_colors);  // of all materials, one is in use
  const MeshFile undefined = readMesh(
      write("u.obj", "mtllib m.mtl\n" + kTriangle + "v 0 0 1\nusemtl gone\nf 1/1 2/2 4/3\n"));
  EXPECT_TRUE(remarks(undefined, "\"gone\" is in none of its MTL files"));
}

TEST_F(MeshMaterials, AMeshWithoutColoursIsGrey) {
  const MeshFile stl =
      readMesh(write("m.stl",
                     "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                     "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n"));
  const MeshFile ply =
      readMesh(write("m.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                     "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  for (const MeshFile* file : {&stl, &ply}) {
    EXPECT_LT(glm::distance(colorOf(*file), glm::vec3(linearFromSrgb(0.6f))), kByte);
  }
}

/// A glTF of one triangle whose corners have texture coordinates (0, 0), (1, 0), (0, 1); glTF's v
/// points downwards.
std::string gltf(const std::string& texture_info) {
  return R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_texture_transform"],"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],)"
         R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0)" +
         texture_info +
         R"(}}}],"textures":[{"source":0}],"images":[{"uri":"t.png"}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
         R"("min":[0,0,0],"max":[1,1,0]},)"
         R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],)"
         R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},)"
         R"({"buffer":0,"byteOffset":36,"byteLength":24}],)"
         R"("buffers":[{"uri":"b.bin","byteLength":60}]})";
}

TEST_F(MeshMaterials, OnlyThoseInUseCount) {
  write("m.mtl", "newmtl m\nKd 1 0 0\nnewmtl other\nd 0.2\nmap_Kd lost.png\n");
  const MeshFile file = readMesh(write("m.obj", "mtllib m.mtl\n" + kTriangle));
  ASSERT_EQ(file.facts.materials.size(), 1u);
  EXPECT_EQ(file.facts.materials[0].name, "m");
  EXPECT_EQ(file.facts.opacity, glm::vec2(1.0f));
  EXPECT_FALSE(remarks(file, "lost.png"));

  writeQuarters(folder_.path() / "t.png");
  const float data[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
  write("b.bin", std::string(reinterpret_cast<const char*>(data), sizeof(data)));
  EXPECT_EQ(readMesh(write("m.gltf", gltf(""))).facts.materials.size(), 1u);
}

TEST_F(MeshMaterials, TextureTransformOfGltfScalesThenTurnsThenMoves) {
  writeQuarters(folder_.path() / "t.png");
  const float data[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
  write("b.bin", std::string(reinterpret_cast<const char*>(data), sizeof(data)));
  const auto seen = [&](const std::string& transform) {
    const std::string info =
        transform.empty() ? "" : R"(,"extensions":{"KHR_texture_transform":{)" + transform + "}}";
    return colorOf(readMesh(write("m.gltf", gltf(info))));  // at (u, v) = (0.25, 0.25)
  };
  const glm::vec3 red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1), white(1);
  EXPECT_LT(glm::distance(seen(""), red), kByte);
  EXPECT_LT(glm::distance(seen(R"("offset":[0.5,0])"), green), kByte);
  EXPECT_LT(glm::distance(seen(R"("offset":[0,0.5])"), blue), kByte);
  EXPECT_LT(glm::distance(seen(R"("scale":[3,1])"), green), kByte);  // (0.75, 0.25)
  // By the specification, a quarter turn takes (u, v) to (v, -u): to (0.25, -0.25).
  EXPECT_LT(glm::distance(seen(R"("rotation":1.5707963267948966)"), blue), kByte);
  // Scaled to (0.75, 0.25), turned to (0.25, -0.75), moved to (0.75, -0.25): white. Turned before
  // it is scaled, it would end at (1.25, -0.75 + 0.5 = 0.25): red.
  EXPECT_LT(glm::distance(seen(R"("scale":[3,1],"rotation":1.5707963267948966,"offset":[0.5,0.5])"),
                          white),
            kByte);
}

TEST_F(MeshMaterials, NumbersOfAnObjMayBeginWithAPoint) {
  const MeshFile file =
      readMesh(write("a.obj",
                     "v 0 0 .5 .5 .25 .75\nv\t.75 0 0 .5 .25 .75\nv 0 -.5 0 .5 .25 .75\nvt .1 .1\n"
                     "f 1/1 2/1 3/1\n"));
  ASSERT_EQ(file.mesh.size(), 1u);
  EXPECT_EQ(file.mesh.corners_m[0], glm::vec3(0.0f, 0.0f, 0.5f));
  EXPECT_EQ(file.mesh.corners_m[1], glm::vec3(0.75f, 0.0f, 0.0f));
  EXPECT_EQ(file.mesh.corners_m[2], glm::vec3(0.0f, -0.5f, 0.0f));
  EXPECT_NEAR(file.mesh.color.at(0).y, 0.0509f, 1e-3f);  // linear light of 0.25
}

TEST_F(MeshMaterials, NamesInAGltfMayBePercentEncoded) {
  writeQuarters(folder_.path() / "a tü.png");
  const float data[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
  write("my bü.bin", std::string(reinterpret_cast<const char*>(data), sizeof(data)));
  std::string text = gltf("");
  text.replace(text.find("t.png"), 5, "a%20t%C3%BC.png");
  text.replace(text.find("b.bin"), 5, "my%20b%c3%bc.bin");
  const MeshFile encoded = readMesh(write("m.gltf", text));
  EXPECT_TRUE(encoded.mesh.remarks.empty());
  EXPECT_LT(glm::distance(colorOf(encoded), glm::vec3(1, 0, 0)), kByte);
  EXPECT_TRUE(encoded.facts.materials.at(0).textures.at(0).found);
  // A file of the very name comes first.
  write("my%20b%c3%bc.bin", std::string(60, '\0'));
  EXPECT_NE(refusal(folder_.path() / "m.gltf"), "");
}

TEST_F(MeshMaterials, RepeatsAndFlatTrianglesAreLeftOut) {
  const std::string repeated = kTriangle + "f 2/2 3/3 1/1\nf 3/3 2/2 1/1\nv 9 9 9\nf 4/1 4/1 4/1\n";
  const MeshFile file = readMesh(write("m.obj", repeated));
  EXPECT_EQ(file.mesh.size(), 2u);  // the other side is no repeat
  EXPECT_TRUE(remarks(file, "1 triangle equal to another one"));
  for (const glm::vec3& corner : file.mesh.corners_m) EXPECT_LE(corner.x, 1.0f);
}

TEST_F(MeshMaterials, RefusalsSayWhatToDo) {
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(refusal(write("w.obj", std::string("\xff\xfev\0 \0", 6))), "UTF-8"));
  EXPECT_TRUE(has(refusal(write("m.step", "ISO-10303-21;\n")), "FreeCAD"));
  EXPECT_TRUE(has(refusal(write("m.xyzzy", "hello\n")), "extension"));
}

TEST_F(MeshMaterials, DetailThatFloatsLoseIsNamed) {
  const MeshFile far = readMesh(write("far.ply",
                                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                      "property float y\nproperty float z\nelement face 1\n"
                                      "property list uchar int vertex_indices\nend_header\n"
                                      "1e7 1e7 0\n10000100 1e7 0\n1e7 10000100 0\n3 0 1 2\n"));
  EXPECT_TRUE(remarks(far, "far from the origin"));
  EXPECT_FALSE(remarks(readMesh(write("m.obj", kTriangle)), "far from the origin"));
}

TEST_F(MeshMaterials, AnObjOfAMapProjectionKeepsItsMillimetres) {
  const MeshFile far = readMesh(write("far.obj",
                                      "# UTM\nv 432123.001 5412345.002 12.5 1 0 0\n"
                                      "v 432124.003 5412345.002 12.5 1 0 0\r\n"
                                      "v\t432123.001  5412346.5 .25 1 0 0\nf 1 2 3\n"));
  EXPECT_TRUE(remarks(far, "relative to 432000 5412000 0"));
  EXPECT_FALSE(remarks(far, "far from the origin"));
  constexpr float kMillimetre = 1e-3f;
  const auto& corners = far.mesh.corners_m;
  ASSERT_EQ(corners.size(), 3u);
  EXPECT_LT(glm::distance(corners[0], glm::vec3(123.001f, 345.002f, 12.5f)), 0.1f * kMillimetre);
  EXPECT_LT(glm::distance(corners[1], glm::vec3(124.003f, 345.002f, 12.5f)), 0.1f * kMillimetre);
  EXPECT_LT(glm::distance(corners[2], glm::vec3(123.001f, 346.5f, 0.25f)), 0.1f * kMillimetre);
  EXPECT_LT(glm::distance(colorOf(far), glm::vec3(1, 0, 0)), kByte);
  // Where floats keep the detail, the file's own origin stays.
  const MeshFile near =
      readMesh(write("near.obj", "v 12000 0 0\nv 13000 0 0\nv 12000 1000 0\nf 1 2 3\n"));
  EXPECT_EQ(near.mesh.corners_m[0].x, 12000.0f);
  EXPECT_TRUE(near.mesh.remarks.empty());
}

TEST_F(MeshMaterials, ExtensionsMayHaveAnyCase) {
  write("m.mtl", "newmtl m\n");
  EXPECT_EQ(meshCompanions(write("m.Obj", "mtllib m.mtl\n")).size(), 1u);
}

TEST_F(MeshMaterials, BlackMaterialsThatEmitLightHaveItsColour) {
  write("m.mtl", "newmtl m\nKd 0 0 0\nKe 0 1 0\n");
  const MeshFile green = readMesh(write("m.obj", "mtllib m.mtl\n" + kTriangle));
  EXPECT_LT(glm::distance(colorOf(green), glm::vec3(0, 1, 0)), kByte);
  EXPECT_TRUE(remarks(green, "light nothing else"));
  write("m.mtl", "newmtl m\nKd 1 0 0\nKe 0 1 0\n");
  const MeshFile red = readMesh(write("n.obj", "mtllib m.mtl\n" + kTriangle));
  EXPECT_LT(glm::distance(colorOf(red), glm::vec3(1, 0, 0)), kByte);
  EXPECT_TRUE(remarks(red, "without the light"));

  writeQuarters(folder_.path() / "t.png");
  const float data[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
  write("b.bin", std::string(reinterpret_cast<const char*>(data), sizeof(data)));
  std::string text = gltf("");
  const std::string base = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}})";
  text.replace(text.find(base), base.size(),
               R"("pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1]},"emissiveFactor":[1,1,1],)"
               R"("emissiveTexture":{"index":0})");
  const MeshFile textured = readMesh(write("m.gltf", text));
  EXPECT_LT(glm::distance(colorOf(textured), glm::vec3(1, 0, 0)), kByte);
  EXPECT_TRUE(textured.facts.has_colors);
}

/// Names in quotes, with blanks around them, relative to the MTL, of any case, several in a line.
TEST_F(MeshMaterials, NamesOfFilesAreFoundAsExportersWriteThem) {
  writeQuarters(folder_.path() / "maps/Wood Plank.png");
  fs::create_directories(folder_.path() / "mats");
  const auto isBlue = [&](const std::string& mtllib, const std::string& map) {
    write("mats/One Two.mtl", "newmtl n\nKd 1 1 1\n");
    write("mats/a.mtl", "\xef\xbb\xbf  newmtl  m \r\n\tmap_Kd " + map + "\r\n");
    const MeshFile file =
        readMesh(write("m.obj", "\xef\xbb\xbfmtllib " + mtllib + "\n  " + kTriangle));
    EXPECT_TRUE(file.mesh.remarks.empty()) << file.mesh.remarks[0];
    EXPECT_EQ(meshCompanions(folder_.path() / "m.obj").size(), 2u + (mtllib.size() > 12)) << mtllib;
    return glm::distance(colorOf(file), glm::vec3(0, 0, 1)) < kByte;
  };
  EXPECT_TRUE(isBlue("mats/a.mtl", "../maps/Wood Plank.png"));
  EXPECT_TRUE(isBlue("\"mats/a.mtl\"", "\"../maps/Wood Plank.png\""));
  EXPECT_TRUE(isBlue("MATS\\A.MTL ", "..\\maps\\wood plank.PNG  "));
  EXPECT_TRUE(isBlue("mats/One Two.mtl mats/a.mtl", "maps/Wood Plank.png"));
  EXPECT_TRUE(isBlue("\"mats/a.mtl\" \"mats/One Two.mtl\"", "maps/Wood Plank.png"));
}

TEST_F(MeshMaterials, APartWithoutColoursBesideOneWithColoursIsPlain) {
  const std::string parts =
      "o plain\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no painted\nv 0 0 1 1 0 0\nv 1 0 1 0 1 0\n"
      "v 0 1 1 0 0 1\nf 4 5 6\n";
  const MeshFile file = readMesh(write("m.obj", parts));
  ASSERT_EQ(file.mesh.size(), 2u);
  const glm::vec3 plain = colorOf(file, 0), painted = colorOf(file, 1);
  EXPECT_TRUE(plain.x == plain.y && plain.y == plain.z && plain.x > 0.05f);
  EXPECT_GT(painted.x, painted.y + 0.1f);
}

TEST_F(MeshMaterials, PointsAndLinesBesideAMeshAreNamed) {
  const MeshFile file = readMesh(write("m.obj", kTriangle + "p 1 2\nl 1 2\nl 2 3\n"));
  EXPECT_TRUE(remarks(file, "1 point beside") || remarks(file, "2 points beside"));
  EXPECT_TRUE(remarks(file, "2 lines beside the triangles left out"));
}

TEST_F(MeshMaterials, WhatIsNotShownAsItIsIsNamed) {
  write("m.mtl", "newmtl m\nmap_Kd t.<UDIM>.png\nnewmtl clear\nTr 1\n");
  const MeshFile file =
      readMesh(write("m.obj", "mtllib m.mtl\n" + kTriangle + "usemtl clear\nf 1 2 3\n"));
  EXPECT_TRUE(remarks(file, "\"t.<UDIM>.png\" stands for many tiles"));
  EXPECT_TRUE(remarks(file, "1 triangle of materials with an opacity, or"));
  const std::string normals = "v 0 0 0 0 0 -1\nv 1 0 0 0 0 -1\nv 0 1 0 0 0 -1\nf 1 2 3\n";
  EXPECT_TRUE(remarks(readMesh(write("n.obj", normals)), "no colours (-1.000"));
}

TEST_F(MeshMaterials, ColoursOfAnMtlThatAreNoneAreNamed) {
  const auto read = [&](const std::string& color) {
    write("m.mtl", "newmtl m\n" + color + "\n");
    return readMesh(write("m.obj", "mtllib m.mtl\n" + kTriangle));
  };
  EXPECT_TRUE(remarks(read("Kd 200 100 0"), "m.mtl has Kd \"200 100 0\": write red, green"));
  const MeshFile spectral = read("Kd spectral a.rfl 1");
  EXPECT_TRUE(remarks(spectral, "m.mtl has Kd \"spectral a.rfl 1\""));
  EXPECT_GT(colorOf(spectral).y, 0.05f);
  EXPECT_TRUE(read("Kd 1.0000001 0.5").mesh.remarks.empty());
}

TEST_F(MeshMaterials, ColoursOfAnMtlOfBlenderAreLinear) {
  const auto red = [&](const std::string& comment) {
    write("m.mtl", comment + "\nnewmtl m\nKd 0.5 0.2 0.2\n");
    return colorOf(readMesh(write("m.obj", "mtllib m.mtl\n" + kTriangle))).x;
  };
  EXPECT_FLOAT_EQ(red("# Blender 3.4.1 MTL File: 'None'"), 0.5f);
  for (const char* other : {"# Wavefront material file", "# Blender3D MTL File: a.blend"}) {
    EXPECT_FLOAT_EQ(red(other), linearFromSrgb(0.5f)) << other;
  }
}

TEST_F(MeshMaterials, GlassOfAGltfIsNamed) {
  const auto glass = [&](const std::string& mode) {
    return readMesh(write(
        "g.gltf",
        R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":)"
        R"([{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"materials":[{)" +
            mode +
            R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":0.9}}}],)"
            R"("accessors":[{"bufferView":0,"componentType":5121,"count":3,"type":"VEC3"}],)"
            R"("bufferViews":[{"buffer":0,"byteLength":12,"byteStride":4}],"buffers":)"
            R"([{"byteLength":12,"uri":"data:;base64,AAAAAAEAAAAAAQAA"}]})"));
  };
  EXPECT_TRUE(remarks(glass(""), "materials of glass"));
  EXPECT_FALSE(remarks(glass(R"("alphaMode":"BLEND",)"), "materials of glass"));
}

TEST_F(MeshMaterials, NumbersOfAnObjThatAreNoneAreNamedByLine) {
  EXPECT_NE(refusal(write("m.obj", "v 0 0 x\n")).find("m.obj:1: expected a number, found \"x\""),
            std::string::npos);
  EXPECT_NE(
      refusal(write("m.obj", "v 0 0 0\nv 1 2\nf 1 1 2\n")).find("m.obj:2: a vertex has 2 numbers"),
      std::string::npos);
  EXPECT_NE(refusal(write("m.obj", kTriangle + "f 1 2 x\n")).find("m.obj:9: found \"x\""),
            std::string::npos);
  EXPECT_NE(refusal(write("m.obj", kTriangle + "f 1 2 -9\n")).find("names vertex -9"),
            std::string::npos);
}

TEST_F(MeshMaterials, ZerosBesidePointsAreNoColour) {
  const PointCloud text = readTextPoints(write("p.xyz", "0 0 0 0 0 0\n1 0 0 0 0 0\n"));
  EXPECT_GT(text.color[0].x, 0.1f);
  EXPECT_TRUE(text.normal.empty());
  EXPECT_EQ(text.remarks.size(), 1u);
  const SceneFile ply = readScene(
      write("p.ply",
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
            "property double z\nproperty uchar red\nproperty uchar green\n"
            "property uchar blue\nend_header\n10000000.25 0 0 0 0 0\n10000000.5 0 0 0 0 0\n"));
  const auto& points = std::get<PointCloud>(ply.content);
  EXPECT_GT(points.color[0].x, 0.1f);
  EXPECT_FLOAT_EQ(points.position_m[1].x - points.position_m[0].x, 0.25f);
  EXPECT_EQ(points.position_m[0].x, 0.25f);
}

}  // namespace FOCI_FILE
}  // namespace foci
