// Alpha and the placement of textures, as glTF 2.0 and Wavefront's MTL define them.
#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "render/scene/mesh/triangle_mesh.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/read_mesh.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kByte = 0.01f;   // 8-bit sRGB
constexpr float kPlace = 1e-3f;  // exact but for rounding

/// A triangle with the corners (0, 0), (1, 0) and (0, 1), whose texture coordinates are the place.
class MeshAlpha : public testing::Test {
 protected:
  /// Columns grow from black to white; with `alpha` from black to blue, and so does the alpha.
  void writeRamps(const std::string& name, bool alpha) const {
    constexpr int kSize = 256;
    cv::Mat image(kSize, kSize, alpha ? CV_8UC4 : CV_8UC1);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const auto level = static_cast<uchar>(x);
        if (alpha) image.at<cv::Vec4b>(y, x) = cv::Vec4b(level, 0, 0, level);
        if (!alpha) image.at<uchar>(y, x) = level;
      }
    }
    ASSERT_TRUE(cv::imwrite((folder_.path() / name).string(), image));
  }

  /// @param material  the JSON of the material; its texture has the index 0
  /// @param alphas    of the three corners' colours
  MeshFile gltf(const std::string& material, const std::string& sampler = "",
                std::array<float, 3> alphas = {1, 1, 1}, bool with_alpha = true) {
    std::vector<float> data = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 0};
    for (const float alpha : alphas) {
      data.insert(data.end(), {1, 1, 1});
      if (with_alpha) data.push_back(alpha);
    }
    folder_.write("b.bin", std::string(reinterpret_cast<const char*>(data.data()),
                                       data.size() * sizeof(float)));
    const std::string kind = with_alpha ? "VEC4" : "VEC3";
    const std::string bytes = std::to_string(data.size() * sizeof(float));
    const std::string color_bytes = with_alpha ? "48" : "36";
    return readMesh(folder_.write(
        "m.gltf",
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":2},)"
        R"("material":0}]}],"materials":[)" +
            material + R"(],"samplers":[{)" + sampler +
            R"(}],"textures":[{"source":0,"sampler":0}],"images":[{"uri":"t.png"}],)"
            R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
            R"("min":[0,0,0],"max":[1,1,0]},)"
            R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},)"
            R"({"bufferView":2,"componentType":5126,"count":3,"type":")" +
            kind +
            R"("}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},)"
            R"({"buffer":0,"byteOffset":36,"byteLength":24},)"
            R"({"buffer":0,"byteOffset":60,"byteLength":)" +
            color_bytes + R"(}],"buffers":[{"uri":"b.bin","byteLength":)" + bytes + "}]}"));
  }

  MeshFile obj(const std::string& material) {
    folder_.write("m.mtl", "newmtl m\n" + material);
    return readMesh(folder_.write("m.obj",
                                  "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
                                  "vt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"));
  }

  static MeshColor at(const MeshFile& file, float x, float y = 0.01f) {
    return colorAt(file.mesh, {0, glm::vec2(x, y)}, 0.0f);
  }

  const TemporaryFolder folder_;
};

TEST_F(MeshAlpha, AMaskCutsBelowTheCutoff) {
  writeRamps("t.png", true);
  const std::string base = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0})";
  const auto masked = [&](const std::string& more) {
    return gltf("{" + base + R"(},"alphaMode":"MASK")" + more + "}");
  };
  EXPECT_EQ(at(masked(""), 0.49f).opacity, 0.0f);
  EXPECT_EQ(at(masked(""), 0.51f).opacity, 1.0f);
  EXPECT_EQ(at(masked(R"(,"alphaCutoff":0.2)"), 0.19f).opacity, 0.0f);
  EXPECT_EQ(at(masked(R"(,"alphaCutoff":0.2)"), 0.21f).opacity, 1.0f);
  EXPECT_EQ(at(masked(R"(,"alphaCutoff":0)"), 0.01f).opacity, 1.0f);
  // The cutoff applies to the product with the factor: 0.8 x = 0.5 at x = 0.625.
  const MeshFile faded =
      gltf("{" + base + R"(,"baseColorFactor":[1,1,1,0.8]},"alphaMode":"MASK"})");
  EXPECT_EQ(at(faded, 0.61f).opacity, 0.0f);
  EXPECT_EQ(at(faded, 0.64f).opacity, 1.0f);
}

TEST_F(MeshAlpha, BlendingMultipliesEveryAlpha) {
  writeRamps("t.png", true);
  const MeshFile file = gltf(
      R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"baseColorFactor":[1,1,1,0.5]},)"
      R"("alphaMode":"BLEND"})",
      "", {1.0f, 0.0f, 1.0f});
  for (const float x : {0.25f, 0.5f, 0.75f}) {
    EXPECT_NEAR(at(file, x).opacity, 0.5f * x * (1.0f - x), kByte) << x;
  }
  EXPECT_EQ(at(file, 0.998f, 0.001f).opacity, 0.0f);
}

TEST_F(MeshAlpha, OpaqueMaterialsHaveNoAlpha) {
  writeRamps("t.png", true);
  const MeshFile file =
      gltf(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})", "", {0.5f, 0.0f, 1.0f});
  EXPECT_EQ(at(file, 0.1f).opacity, 1.0f);
}

TEST_F(MeshAlpha, TheAlphaOfCornersCutsHoles) {
  const std::string plain = R"({"alphaMode":"MASK"})";
  const MeshFile file = gltf(plain, "", {0.0f, 1.0f, 0.0f});
  EXPECT_EQ(at(file, 0.45f).opacity, 0.0f);
  EXPECT_EQ(at(file, 0.55f).opacity, 1.0f);
  EXPECT_TRUE(file.mesh.remarks.empty());
  // Colours of three numbers have no alpha.
  const MeshFile rgb = gltf(plain, "", {}, false);
  EXPECT_EQ(at(rgb, 0.3f).opacity, 1.0f);
  EXPECT_TRUE(rgb.mesh.remarks.empty());
}

TEST_F(MeshAlpha, AMaskOfAnObjCutsHoles) {
  writeRamps("grey.png", false);
  writeRamps("leaf.png", true);
  for (const char* const name : {"grey.png", "leaf.png"}) {
    const MeshFile file = obj("Kd 1 0 0\nmap_d " + std::string(name) + "\n");
    EXPECT_EQ(at(file, 0.49f).opacity, 0.0f) << name;
    EXPECT_EQ(at(file, 0.51f).opacity, 1.0f) << name;
    EXPECT_TRUE(file.mesh.remarks.empty());
  }
  const MeshFile missing = obj("Kd 1 0 0\nmap_d gone.png\n");
  EXPECT_EQ(at(missing, 0.1f).opacity, 1.0f);
  ASSERT_EQ(missing.mesh.remarks.size(), 1u);
  EXPECT_NE(missing.mesh.remarks[0].find("without holes"), std::string::npos);
}

TEST_F(MeshAlpha, ATextureOfAnObjThatIsItsOwnMaskHasNoHoles) {
  writeRamps("t.png", false);
  EXPECT_EQ(at(obj("map_Kd t.png\nmap_d t.png\n"), 0.2f).opacity, 1.0f);
  writeRamps("t.png", true);
  EXPECT_EQ(at(obj("map_Kd t.png\nmap_d t.png\n"), 0.2f).opacity, 0.0f);
}

TEST_F(MeshAlpha, ATextureThatIsItsOwnMaskMayHaveAnotherName) {
  writeRamps("t.png", false);
  EXPECT_EQ(at(obj("map_Kd t.png\nmap_d .\\t.png\n"), 0.2f).opacity, 1.0f);
  writeRamps("u.png", false);
  EXPECT_EQ(at(obj("map_Kd t.png\nmap_d u.png\n"), 0.2f).opacity, 0.0f);
}

TEST_F(MeshAlpha, ATextureWithAnAlphaOfZeroEverywhereIsOpaqueIfItHidesTheMesh) {
  cv::imwrite((folder_.path() / "t.png").string(),
              cv::Mat(4, 4, CV_8UC4, cv::Scalar(0, 0, 255, 0)));
  const MeshFile file = obj("map_Kd t.png\n");
  EXPECT_EQ(at(file, 0.5f).opacity, 1.0f);
  EXPECT_EQ(at(file, 0.5f).color, glm::vec3(1, 0, 0));
  EXPECT_NE(file.mesh.remarks.at(0).find("alpha of 0 everywhere"), std::string::npos);

  folder_.write("m.mtl", "newmtl m\nmap_Kd t.png\nnewmtl plain\nKd 1 0 0\n");
  const MeshFile part = readMesh(folder_.write("m.obj",
                                               "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                               "v 0 0 1\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n"
                                               "usemtl plain\nf 1 2 4\n"));
  EXPECT_EQ(at(part, 0.5f).opacity, 0.0f);
  EXPECT_NE(part.mesh.remarks.at(0).find("1 triangle of materials"), std::string::npos);

  const MeshFile opaque = gltf(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})");
  EXPECT_EQ(at(opaque, 0.5f).opacity, 1.0f);
  EXPECT_TRUE(opaque.mesh.remarks.empty());
}

TEST_F(MeshAlpha, OptionsOfAnObjScaleThenMoveTheTexture) {
  writeRamps("t.png", true);
  const auto place = [&](const std::string& options, float x) {
    return at(obj("map_Kd " + options + "t.png\nd 1\n"), x).color.z;
  };
  const auto light = [&](float x) { return place("", x); };
  EXPECT_NEAR(place("-s 2 2 1 ", 0.35f), light(0.7f), kByte);
  EXPECT_NEAR(place("-o 0.5 0 0 ", 0.25f), light(0.75f), kByte);
  EXPECT_NEAR(place("-mm 0 1 -o 0.1 0 -s 2 1 ", 0.3f), light(0.7f), kByte);
}

TEST_F(MeshAlpha, TransparencyThatHidesEverythingIsOpaque) {
  const MeshFile hidden = obj("Kd 1 0 0\nTr 1.0\n");
  EXPECT_EQ(at(hidden, 0.1f).opacity, 1.0f);
  ASSERT_EQ(hidden.mesh.remarks.size(), 1u);
  EXPECT_NE(hidden.mesh.remarks[0].find("`Tr 1`"), std::string::npos);
  EXPECT_FLOAT_EQ(at(obj("Kd 1 0 0\nTr 0.75\n"), 0.1f).opacity, 0.25f);
  EXPECT_FLOAT_EQ(at(obj("Kd 1 0 0\nTr 1\nd 0.5\n"), 0.1f).opacity, 0.5f);  // d decides
}

TEST_F(MeshAlpha, TexturesAreClampedOrMirrored) {
  writeRamps("t.png", true);
  const auto light = [&](const std::string& wrap, float u) {
    const MeshFile file =
        gltf(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})", wrap);
    const MeshTexture& texture = *file.mesh.materials.at(0).texture;
    return texture.at({u, 0.5f}, 0.0f, file.mesh.materials[0].wrap).w;  // a ramp of alpha
  };
  const std::string clamp = R"("wrapS":33071)", mirror = R"("wrapS":33648)";
  EXPECT_NEAR(light("", 1.25f), 0.25f, kByte);
  EXPECT_NEAR(light("", -0.25f), 0.75f, kByte);
  EXPECT_NEAR(light(clamp, 1.25f), 1.0f, kPlace);
  EXPECT_NEAR(light(clamp, -0.25f), 0.0f, kPlace);
  EXPECT_NEAR(light(mirror, 1.25f), 0.75f, kByte);
  EXPECT_NEAR(light(mirror, -0.25f), 0.25f, kByte);
  EXPECT_NEAR(light(mirror, 2.25f), 0.25f, kByte);
  // MTL has one option for both axes.
  EXPECT_EQ(obj("map_Kd -clamp on t.png\n").mesh.materials.back().wrap[1], TextureWrap::clamp);
}

}  // namespace FOCI_FILE
}  // namespace foci
