// Files made to hang, to crash or to exhaust a program are refused in one line, soon.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

constexpr unsigned kMax_s = 20;  // far above any refusal, far below for ever

class HostileInputs : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("study.toml", smallStudy());
    folder.write("scene.ply", squarePly(16, 1.0));
    folder.write("trace.tsv", steadyTrace());
  }

  void pipe(const std::string& name) const {
    ASSERT_EQ(mkfifo((folder.path() / name).c_str(), 0600), 0);
  }

  std::string write(const std::string& name, const std::string& bytes) const {
    folder.write(name, bytes);
    return name;
  }

  /// Exit code 2, one line that names `file` and says `says`.
  void expectRefused(const Arguments& arguments, const std::string& file,
                     const std::string& says) const {
    const Outcome outcome = runFociUnder({.max_s = kMax_s}, arguments, folder.path());
    std::string typed;
    for (const auto& word : arguments) typed += word + " ";
    SCOPED_TRACE(typed);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
  }

  TemporaryFolder folder;
};

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// glTF with one triangle in each mesh; `nodes` is the list of its nodes.
std::string gltf(const std::string& nodes, const std::string& extras = "0") {
  return "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + extras +
         ",\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[" + nodes +
         "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
         "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
         "\"min\":[0,0,0],\"max\":[1,1,0]}],"
         "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
         "\"buffers\":[{\"byteLength\":36,\"uri\":\"triangle.bin\"}]}";
}

std::string triangleBytes() {
  const float corners[9] = {0, 0, -1, 1, 0, -1, 0, 1, -1};
  return {reinterpret_cast<const char*>(corners), sizeof(corners)};
}

TEST_F(HostileInputs, APipeIsNoInput) {
  for (const char* name : {"p.ply", "p.obj", "p.foci", "p.tsv", "p.toml", "p.json", "p.mp4",
                           "p.png", "eye01.png", "p_physio.tsv.gz"}) {
    pipe(name);
  }
  const std::string says = "not a file";
  for (const char* scene : {"p.ply", "p.obj", "p.foci"}) {
    expectRefused({"render", "study.toml", "--scene", scene, "--out", "a.png"}, scene, says);
    expectRefused({"prepare", scene, "--out", "a.foci"}, scene, says);
  }
  expectRefused({"reproduce", "--quick", "--scan", "p.ply", "--out", "out"}, "p.ply", says);
  expectRefused({"chart", "--quick", "--scan", "p.ply", "--out", "out"}, "p.ply", says);
  for (const char* trace : {"p.tsv", "p_physio.tsv.gz"}) {
    expectRefused({"events", trace}, trace, says);
    expectRefused({"events", "--score", trace, "trace.tsv"}, trace, says);
    expectRefused({"trace", "info", trace}, trace, says);
    expectRefused({"replay", "study.toml", "--trace", trace, "--out", "out"}, trace, says);
  }
  expectRefused({"render", "p.toml", "--out", "a.png"}, "p.toml", says);
  for (const char* screen : {"p.toml", "p.json"}) {
    expectRefused({"render", "study.toml", "--screen", screen, "--out", "a.png"}, screen, says);
    expectRefused({"calibrate", "screen", "--headless", "--monitor", screen}, screen, says);
  }
  expectRefused({"calibrate", "screen", "--headless", "--edid", "p.json"}, "p.json", says);
  for (const char* part : {"gaze", "binocular"}) {
    expectRefused({"calibrate", part, "--pairs", "p.tsv"}, "p.tsv", says);
  }
  write("fit.tsv", "onset_s duration_s x_target y_target\n0 1 3 0\n");
  for (const char* film : {"webcam:p.mp4", "webcam:eye%02d.png"}) {
    expectRefused({"calibrate", "gaze", "--source", film, "--pairs", "fit.tsv"},
                  film[7] == 'p' ? "p.mp4" : "eye01.png", says);
  }
  expectRefused({"calibrate", "camera", "--video", "p.mp4"}, "p.mp4", says);
  expectRefused({"calibrate", "camera", "--images", "p.png"}, "p.png", "");
}

TEST_F(HostileInputs, APipeIsNoMaterialTextureOrBuffer) {
  for (const char* name : {"pipe.mtl", "pipe.png", "triangle.bin"}) pipe(name);
  write("texture.mtl", "newmtl m\nmap_Kd pipe.png\n");
  const std::string face =
      "usemtl m\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  write("material.obj", "mtllib pipe.mtl\n" + face);
  write("texture.obj", "mtllib texture.mtl\n" + face);
  write("buffer.gltf", gltf("{\"mesh\":0}"));
  const auto refuse = [&](const char* scene, const char* file) {
    expectRefused({"prepare", scene, "--out", "a.foci"}, file, "not a file");
  };
  refuse("material.obj", "pipe.mtl");
  refuse("texture.obj", "pipe.png");
  refuse("buffer.gltf", "triangle.bin");
}

TEST_F(HostileInputs, ANameNoFileCanHaveIsRefused) {
  const std::string name(300, 'a');
  write("fit.tsv", "onset_s duration_s x_target y_target\n0 1 3 0\n");
  for (const std::string ending : {".ply", ".obj", ".glb", ".foci"}) {
    expectRefused({"prepare", name + ending, "--out", "a.foci"}, name, "");
  }
  expectRefused({"render", name, "--out", "a.png"}, name, "cannot be read");
  expectRefused({"events", name}, name, "cannot be read");
  expectRefused({"calibrate", "gaze", "--pairs", name}, name, "cannot be read");
  expectRefused({"calibrate", "gaze", "--source", "webcam:" + name, "--pairs", "fit.tsv"}, name,
                "");
  expectRefused({"calibrate", "camera", "--images", name}, name, "");
  expectRefused({"calibrate", "camera", "--video", name}, name, "");
}

TEST_F(HostileInputs, AMeshHasLimits) {
  folder.write("triangle.bin", triangleBytes());
  const auto refuse = [&](const std::string& text, const char* says) {
    expectRefused({"prepare", write("mesh.gltf", text), "--out", "a.foci"}, "mesh.gltf", says);
  };
  refuse(gltf("{\"mesh\":0}", repeated("[", 300'000) + repeated("]", 300'000)),
         "JSON nests 300001 deep");
  refuse(gltf("{\"mesh\":0}", repeated("{\"a\":", 50'000) + "0" + repeated("}", 50'000)),
         "JSON nests 50001 deep");
  std::string doubling;
  for (int i = 1; i <= 40; ++i) {
    const std::string next = std::to_string(i);
    doubling += "{\"children\":[" + next + "," + next + "]},";
  }
  refuse(gltf(doubling + "{\"mesh\":0}"), "instances of nodes: expected at most 262,144");
  std::string chain;
  for (int i = 1; i <= 100'000; ++i) chain += "{\"children\":[" + std::to_string(i) + "]},";
  refuse(gltf(chain + "{\"mesh\":0}"), "nodes nest");
  refuse(gltf("{\"children\":[1]},{\"children\":[0]}"), "below itself");
  std::string many = gltf("{\"mesh\":0}");
  many.replace(many.find("\"count\":3"), 9, "\"count\":4000000000");
  refuse(many, "corners of triangles");
  // The same scene within the limits is read.
  write("mesh.gltf", gltf("{\"children\":[1,2]},{\"mesh\":0},{\"mesh\":0}"));
  const Outcome outcome =
      runFoci({"prepare", "mesh.gltf", "--points", "500", "--out", "a.foci"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(HostileInputs, APackedFileThatUnpacksWithoutEndIsRefused) {
  const std::string blank(1 << 20, '\n');
  for (const char* name : {"bomb.tsv.gz", "bomb.tsv"}) {
    const gzFile file = gzopen((folder.path() / name).c_str(), "wb");
    gzputs(file, "time_s\tx_px\ty_px\n");
    for (int mib = 0; mib < 90; ++mib)
      gzwrite(file, blank.data(), static_cast<unsigned>(blank.size()));
    gzclose(file);
    expectRefused({"trace", "info", name}, name, "unpacks to");
    expectRefused({"calibrate", "binocular", "--pairs", name}, name, "");
  }
}

// A PNG with a broken colour profile: libpng warns of it, and reads on.
std::string pngWithABadProfile() {
  const std::string ihdr("\0\0\0\1\0\0\0\1\x08\2\0\0\0", 13);
  std::string pixels(64, '\0');
  uLongf length = pixels.size();
  const unsigned char row[4] = {0, 200, 100, 50};
  compress(reinterpret_cast<Bytef*>(pixels.data()), &length, row, sizeof(row));
  pixels.resize(length);
  std::string png("\x89PNG\r\n\x1a\n", 8);
  const auto number = [&](std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) png += static_cast<char>(value >> shift & 0xff);
  };
  const auto chunk = [&](const std::string& name, const std::string& data) {
    number(static_cast<std::uint32_t>(data.size()));
    const std::string body = name + data;
    png += body;
    number(static_cast<std::uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()))));
  };
  chunk("IHDR", ihdr);
  chunk("iCCP", std::string("broken\0\0profile", 15));
  chunk("tIME", "no time");
  chunk("IDAT", pixels);
  chunk("IEND", "");
  return png;
}

TEST_F(HostileInputs, LibrariesDoNotWarnPastTheErrors) {
  write("bad.png", pngWithABadProfile());
  write("m.mtl", "newmtl m\nmap_Kd bad.png\n");
  write("m.obj",
        "mtllib m.mtl\nusemtl m\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nvt 0 0\nvt 1 0\nvt 0 1\n"
        "f 1/1 2/2 3/3\n");
  const Outcome outcome =
      runFoci({"prepare", "m.obj", "--points", "300", "--out", "m.foci"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("png"), std::string::npos) << outcome.err;

  write("text.mp4", "no video");
  expectRefused({"calibrate", "camera", "--video", "text.mp4"}, "text.mp4", "not a video");
  expectRefused({"calibrate", "camera", "--video", "absent.mp4"}, "absent.mp4", "not a video");
  expectRefused({"calibrate", "camera", "--images", "bad.png"}, "bad.png", "");
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
