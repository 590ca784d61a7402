// What is a scene, and the right word for what is none.

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/gaussian_files_ply.h"
#include "tests/unit/render/scene/io/gaussian_files_sog.h"
#include "tests/unit/render/scene/io/gaussian_files_spz.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

class SceneFormats : public testing::Test {
 protected:
  std::string refusal(const fs::path& path) {
    try {
      readScene(path);
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      return text;
    }
    return "read";
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
  SceneFacts facts(const std::string& name, const std::string& bytes) {
    const auto path = scratch.write(name, bytes);
    EXPECT_TRUE(isScene(path)) << name;
    return factsOf(readScene(path));
  }

  const TemporaryFolder scratch;
};

constexpr const char* kPlyPoints =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    "0 0 0 255 0 0\n1 1 1 0 0 255\n";
constexpr const char* kObj = "# a mesh\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST_F(SceneFormats, APointerOfGitLfsIsNamedUnderEveryName) {
  const std::string pointer =
      "version https://git-lfs.github.com/spec/v1\noid sha256:" + std::string(64, '0') +
      "\nsize 1234\n";
  for (const char* name : {"a.ply", "a.spz", "a.glb", "a.las", "a.xyz", "a.e57", "a.toml", "a"}) {
    const auto path = scratch.write(name, pointer);
    EXPECT_TRUE(isScene(path)) << name;
    EXPECT_EQ(refusal(path), path.string() +
                                 ": is a pointer of Git LFS, not the file itself: git lfs pull "
                                 "fetches it");
  }
}

TEST_F(SceneFormats, WhatIsNoSceneIsNamed) {
  const std::string tar = std::string(257, 'a') + "ustar" + std::string(300, '\0');
  const std::vector<std::pair<std::string, std::string>> cases = {
      {zip({{"folder/scan.ply", kPlyPoints}}), "is a ZIP archive that begins with"},
      {zip({{"archive/data.pkl", "x"}}), "is a checkpoint of PyTorch"},
      {gzipped(tar), "packed by gzip, is a tar archive"},
      {"<!DOCTYPE html><html>not found</html>", "is a web page"},
      {"\n\n<html>not found</html>", "is a web page"},
      {"ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4\n", "ESRI ASCII grid"},
      {"\x89PNG\r\n\x1a\n" + std::string(20, '\1'), "is a picture"},
      {"\x93NUMPY\1", "is a NumPy array"},
      {"%PDF-1.7\n", "is a PDF"},
      {"ASTM-E57" + std::string(40, '\0'), "is an E57 scan"},
      {"b3dm" + std::string(40, '\0'), "is a tile of 3D Tiles"},
      {R"({"asset":{"version":"1.0"},"geometricError":500,"root":{}})", "is a tileset of 3D Tiles"},
      {R"({"camera_model":"OPENCV","frames":[]})", "is a list of cameras"},
      {std::string("\xff\xfe"
                   "1\0 \0"
                   "2\0 \0"
                   "3\0\n\0",
                   14),
       "is text in UTF-16"},
      {std::string("\xfe\xff\0"
                   "1\0 \0"
                   "2\0 \0"
                   "3\0\n",
                   14),
       "is text in UTF-16"}};
  for (const auto& [bytes, words] : cases) {
    for (const char* name : {"a.ply", "a.asc", "a.obj", "a.bin", "a"}) {
      const auto path = scratch.write(name, bytes);
      EXPECT_TRUE(isScene(path)) << name << words;
      EXPECT_TRUE(has(refusal(path), words)) << refusal(path);
    }
  }
  EXPECT_FALSE(isScene(scratch.write("study.toml", "[scene]\nfile = \"a.ply\"\n")));
  EXPECT_TRUE(has(refusal(scratch.write("a.what", "hello\n")), "is no scene that foci reads"));
  EXPECT_TRUE(has(refusal(scratch.write("empty", "")), "is empty"));
  EXPECT_TRUE(has(refusal(scratch.write("a.gz", gzipped("some other text"))),
                  "is packed by gzip, and is no scene"));
}

TEST_F(SceneFormats, AFolderIsNoSceneUnlessItIsOneOfSog) {
  const auto folder = scratch.path() / "some";
  fs::create_directory(folder);
  EXPECT_TRUE(isScene(folder));
  EXPECT_TRUE(has(refusal(folder), "is a folder"));
  const TemporaryFolder sog;
  for (const auto& [name, bytes] : sogFolder(1)) sog.write(name, bytes);
  EXPECT_EQ(factsOf(readScene(sog.path())).gaussians, 2u);
}

TEST_F(SceneFormats, WithoutAnExtensionTheContentDecides) {
  std::string stl(80, ' ');
  put(stl, std::uint32_t{1});
  for (const float x : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f}) {
    put(stl, x);
  }
  put(stl, std::uint16_t{0});
  const auto kindOf = [&](const std::string& name, const std::string& bytes) {
    const SceneFormat* const format = formatOf(FileStart(scratch.write(name, bytes)));
    return format == nullptr ? SceneKind::prepared : format->kind;
  };
  EXPECT_EQ(kindOf("mesh", stl), SceneKind::stl);
  EXPECT_EQ(kindOf("mesh", "solid a\nfacet normal 0 0 1\n"), SceneKind::stl);
  EXPECT_EQ(kindOf("mesh", kObj), SceneKind::obj);
  EXPECT_EQ(kindOf("mesh", "glTF" + std::string(20, '\0')), SceneKind::gltf);
  EXPECT_EQ(kindOf("mesh", "{\"asset\":{\"version\":\"2.0\"}}"), SceneKind::gltf);
  EXPECT_EQ(kindOf("mesh", "OFF\n3 1 0\n"), SceneKind::off_points);
  EXPECT_EQ(facts("scan", kPlyPoints).points, 2u);
  EXPECT_EQ(facts("points", "0 0 0 255 0 0\n1 1 1 0 0 255\n").points, 2u);
  EXPECT_EQ(facts("points.dat", "# scan\nx;y;z\n0;0;0\n1;1;1\n").points, 2u);
  EXPECT_EQ(facts("capture", gzipped(spzFile(3, 0))).gaussians, 2u);
  EXPECT_EQ(facts("capture2", gaussianPly(0)).gaussians, 2u);
  EXPECT_EQ(facts("capture3", splatFile()).gaussians, 2u);
}

TEST_F(SceneFormats, PointsMayBePackedByGzip) {
  EXPECT_EQ(facts("scan.ply.gz", gzipped(kPlyPoints)).points, 2u);
  EXPECT_EQ(facts("scan.xyz.gz", gzipped("0 0 0\n1 1 1\n2 2 2\n")).points, 3u);
  EXPECT_EQ(facts("scan.csv.gz", gzipped("x,y,z\n0,0,0\n")).points, 1u);
  EXPECT_EQ(facts("capture.ply.gz", gzipped(gaussianPly(1))).gaussians, 2u);
  // Streams one after another, as bgzip and cat write them.
  EXPECT_EQ(facts("two.xyz.gz", gzipped("0 0 0\n") + gzipped("1 1 1\n")).points, 2u);
  const std::string packed = gzipped(kPlyPoints);
  EXPECT_TRUE(has(refusal(scratch.write("cut.ply.gz", packed.substr(0, packed.size() - 12))),
                  "the file ends before its gzip stream does"));
  EXPECT_TRUE(has(refusal(scratch.write("m.obj.gz", gzipped(kObj))), "unpack it with gunzip"));
}

}  // namespace FOCI_FILE
}  // namespace foci
