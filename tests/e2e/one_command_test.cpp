// From any file to a picture in one command: a scene where a study is expected, `foci info`, and
// what foci says about an eye in a bad place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A closed cube of `side` units with a material for each pair of faces.
std::string cubeObj(double side, const std::string& materials = "") {
  std::string obj = materials;
  for (int i = 0; i < 8; ++i) {
    obj += "v " + std::to_string(side * (i & 1)) + " " + std::to_string(side * (i >> 1 & 1)) + " " +
           std::to_string(side * (i >> 2)) + "\n";
  }
  return obj + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

class OneCommand : public testing::Test {
 protected:
  Outcome foci(std::vector<std::string> arguments) const {
    return runFoci(arguments, folder.path());
  }
  /// Standard error of a run that succeeds.
  std::string told(std::vector<std::string> arguments) const {
    const Outcome outcome = foci(std::move(arguments));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.err;
  }
  /// Standard error of a run that is refused.
  std::string refused(std::vector<std::string> arguments) const {
    const Outcome outcome = foci(std::move(arguments));
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  }
  /// Height and width over which an image is not black, as shares of the image.
  static std::pair<double, double> filled(const fs::path& png) {
    const cv::Mat image = cv::imread(png.string(), cv::IMREAD_GRAYSCALE);
    int top = image.rows, bottom = 0, left = image.cols, right = 0;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        if (image.at<unsigned char>(y, x) < 16) continue;
        top = std::min(top, y), bottom = std::max(bottom, y + 1);
        left = std::min(left, x), right = std::max(right, x + 1);
      }
    }
    return {static_cast<double>(bottom - top) / image.rows,
            static_cast<double>(right - left) / image.cols};
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  const TemporaryFolder folder;
};

TEST_F(OneCommand, ARecordingInPlaceOfTheSceneIsNamed) {
  folder.write("gaze.asc",
               "** CONVERTED FROM gaze.edf\nSTART\t10\tLEFT\tSAMPLES\n10\t1\t2\t3\t...\n"
               "12\t1\t2\t3\t...\nEND\t14\n");
  folder.write("sub-1_physio.json",
               R"({"Columns": ["timestamp", "x_coordinate", "y_coordinate"]})");
  folder.write("sub-1_physio.tsv", "0\t1\t2\n0.01\t1\t2\n");
  for (const std::string file : {"gaze.asc", "sub-1_physio.tsv"}) {
    const Outcome outcome = runFoci({"replay", file, "--out", "out"}, folder.path());
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("a recording"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("--trace"), std::string::npos) << outcome.err;
  }
}

TEST_F(OneCommand, AMeshOfAnySizeFillsTheImage) {
  for (const double side : {0.002, 1.0, 250.0}) {
    folder.write("cube.obj", cubeObj(side));
    const std::string said =
        told({"render", "cube.obj", "--out", "cube.png", "--size", "192x108", "--pupil", "1"});
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    EXPECT_TRUE(has(said, "y is up") && has(said, "scene.scale_m = ")) << said;
    EXPECT_EQ(has(said, "scene.scale_m = 1 ("), side == 1.0) << said;
    const auto [height, width] = filled(folder.path() / "cube.png");
    EXPECT_NEAR(height, 0.9, 0.1) << side;  // so near that depth shows; surfels end a little later
    EXPECT_GT(width, 0.2);
  }
}

TEST_F(OneCommand, AWrittenStudyRendersTheSameBytes) {
  folder.write("cube.obj", cubeObj(3.0));
  fs::create_directories(folder.path() / "studies");
  told({"render", "cube.obj", "--look", "left", "--out", "a.png", "--size", "96x54",
        "--write-study", "studies/cube.toml"});
  const std::string study = folder.read("studies/cube.toml");
  EXPECT_TRUE(study.starts_with("# A study of \"cube.obj\", written by foci.\n")) << study;
  EXPECT_TRUE(has(study, "# metres per unit of the file")) << study;
  told({"render", "studies/cube.toml", "--out", "b.png"});
  EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
  // The study says what the line said, and can be written again.
  told({"render", "studies/cube.toml", "--out", "b.png", "--write-study", "studies/again.toml"});
  told({"render", "studies/again.toml", "--out", "c.png"});
  EXPECT_EQ(folder.read("a.png"), folder.read("c.png"));
  told({"render", "cube.obj", "--look", "above", "--out", "above.png", "--size", "96x54"});
  EXPECT_NE(folder.read("a.png"), folder.read("above.png"));
}

TEST_F(OneCommand, PointsAsTextReplayUnderARecording) {
  std::string points;
  for (int i = 0; i < 900; ++i) {
    points += std::to_string(i % 30) + " " + std::to_string(i / 30) + " 0 200 " +
              std::to_string(i % 256) + " 40\n";
  }
  folder.write("scan.xyz", points);
  folder.write("gaze.tsv", steadyTrace());
  const std::string said =
      told({"replay", "scan.xyz", "--trace", "gaze.tsv", "--size", "96x54", "--seconds", "0:0.3",
            "--out", "out", "--write-study", "scan.toml"});
  EXPECT_TRUE(has(said, "z is up (the scene is flat across it; if not: --up y)")) << said;
  EXPECT_TRUE(fs::exists(folder.path() / "out/report.html"));
  EXPECT_TRUE(has(folder.read("scan.toml"), "source = \"gaze.tsv\""));
  const Json first = Json::parse(folder.read("out/manifest.json"));
  told({"replay", "scan.toml", "--out", "again"});
  const Json again = Json::parse(folder.read("again/manifest.json"));
  EXPECT_EQ(first.at("frames_sha256"), again.at("frames_sha256"));
}

TEST_F(OneCommand, BadWishesAreRefused) {
  folder.write("cube.obj", cubeObj(1.0));
  folder.write("study.toml", smallStudy());
  folder.write("scene.ply", squarePly(8, 1.0));
  EXPECT_TRUE(has(refused({"render", "cube.obj", "--look", "below", "--out", "a.png"}),
                  "expected front, left, above or outside"));
  EXPECT_TRUE(has(refused({"render", "cube.obj", "--up", "w", "--out", "a.png"}), "expected x, y"));
  EXPECT_TRUE(has(refused({"render", "study.toml", "--look", "left", "--out", "a.png"}),
                  "expected a scene"));
  EXPECT_TRUE(has(refused({"render", "cube.obj", "--scene", "scene.ply", "--out", "a.png"}),
                  "--scene scene.ply: expected a study"));
  EXPECT_TRUE(has(refused({"render", "absent.obj", "--out", "a.png"}), "absent.obj: no such file"));
  const std::string before = folder.read("cube.obj");
  EXPECT_NE(
      foci({"render", "cube.obj", "--size", "96x54", "--out", "a.png", "--write-study", "cube.obj"})
          .exit_code,
      0);
  EXPECT_EQ(folder.read("cube.obj"), before);
}

TEST_F(OneCommand, MissingMaterialsAndTexturesAreNamed) {
  folder.write("cube.obj", cubeObj(1.0, "mtllib absent.mtl\nusemtl wood\n"));
  const std::string said = told({"render", "cube.obj", "--out", "a.png", "--size", "96x54"});
  EXPECT_TRUE(has(said, "\"absent.mtl\" cannot be read")) << said;
  EXPECT_FALSE(has(said, "\"cube.mtl\"")) << said;  // Assimp's second guess
  folder.write("cube.mtl", "newmtl wood\nKd 0.2 0.9 0.2\nmap_Kd planks.png\n");
  folder.write("cube.obj", cubeObj(1.0, "mtllib cube.mtl\nvt 0 0\nusemtl wood\n"));
  const Outcome info = foci({"info", "cube.obj"});
  EXPECT_TRUE(has(info.out, "\"wood\", texture \"planks.png\" (missing)")) << info.out;
  EXPECT_TRUE(has(told({"render", "cube.obj", "--out", "a.png", "--size", "96x54"}),
                  "texture \"planks.png\" is missing"));
  const cv::Vec3b middle = cv::imread((folder.path() / "a.png").string()).at<cv::Vec3b>(27, 48);
  EXPECT_GT(middle[1], middle[2]);  // the material's green
}

TEST_F(OneCommand, InfoStatesTheFactsAndShowsThem) {
  folder.write("cube.obj", cubeObj(250.0));
  const Outcome outcome = foci({"info", "cube.obj", "--json", "--thumbnail", "cube.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json facts = Json::parse(outcome.out);
  EXPECT_EQ(facts.at("format"), "OBJ mesh");
  EXPECT_EQ(facts.at("triangles"), 12);
  EXPECT_EQ(facts.at("high"), Json({250.0, 250.0, 250.0}));
  EXPECT_EQ(facts.at("unit_m"), nullptr);
  EXPECT_EQ(facts.at("scale_m"), 0.001);
  EXPECT_EQ(facts.at("up"), "y");
  EXPECT_EQ(facts.at("normals"), false);
  EXPECT_NEAR(filled(folder.path() / "cube.png").first, 0.9, 0.1);

  folder.write("points.ply", squarePly(20, 2.0));
  const Outcome text = foci({"info", "points.ply"});
  EXPECT_TRUE(has(text.out, "400 points")) << text.out;
  EXPECT_TRUE(has(text.out, "PLY points")) << text.out;
  const Outcome prepared = foci({"prepare", "points.ply", "--out", "points.foci", "--json"});
  ASSERT_EQ(prepared.exit_code, 0) << prepared.err;
  EXPECT_EQ(Json::parse(prepared.out).at("input").at("points"), 400);
  const Outcome scene = foci({"info", "points.foci", "--json"});
  EXPECT_EQ(Json::parse(scene.out).at("surfels"), 400);
  EXPECT_EQ(Json::parse(scene.out).at("scale_m"), 1.0);
}

TEST_F(OneCommand, AnEyeInABadPlaceIsToldWhichKeyToSet) {
  const auto saidOf = [&](const std::string& eye, const std::string& scale) {
    folder.write("study.toml", "[scene]\nfile = \"cube.obj\"\nscale_m = " + scale + "\n[eye]\n" +
                                   eye + "\n[output]\nsize_px = [96, 54]\n");
    return told({"render", "study.toml", "--out", "a.png"});
  };
  folder.write("cube.obj", cubeObj(1.0));
  const std::string inside = "position_m = [0.5, 0.5, 0.5]\nlook_at_m = [0, 0.5, 0]";
  EXPECT_TRUE(has(saidOf(inside, "1.0"), "inside a solid"));
  const std::string away = "position_m = [0.5, 0.5, 3]\nlook_at_m = [0.5, 0.5, 9]";
  const std::string said = saidOf(away, "1.0");
  EXPECT_TRUE(has(said, "study.toml: nothing is in view") && has(said, "eye.look_at_m")) << said;
  const std::string outside = "position_m = [0.5, 0.5, 3]\nlook_at_m = [0.5, 0.5, 0]";
  EXPECT_EQ(saidOf(outside, "1.0"), "");
  const std::string far = "position_m = [500, 500, 9000]\nlook_at_m = [500, 500, 0]";
  const std::string wide = saidOf(far, "5000.0");
  EXPECT_TRUE(has(wide, "5000 m wide") && has(wide, "scene.scale_m")) << wide;
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
