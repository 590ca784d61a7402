// What gaze meets in the scene: gaze3d.tsv, fixations.tsv, saccades.tsv, objects.tsv.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"
#include "tests/temporary_folder.h"

namespace foci::e2e {
namespace FOCI_FILE {

constexpr glm::dvec2 kScreen_px(1920.0, 1080.0), kScreen_m(0.5313, 0.2989);
constexpr double kDistance_m = 0.6, kRate_Hz = 200.0;
constexpr const char* kPoints = "file = \"scene.ply\"\n";
constexpr int kFixations = 40, kSamplesEach = 60;

using Row = std::map<std::string, std::string>;

std::vector<Row> rowsOf(const std::string& table) {
  std::istringstream lines(table);
  std::vector<std::string> header;
  std::vector<Row> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::vector<std::string> values;
    for (std::string field; std::getline(fields, field, '\t');) values.push_back(field);
    if (header.empty()) {
      header = values;
      continue;
    }
    Row row;
    for (std::size_t i = 0; i < header.size(); ++i) row[header[i]] = values.at(i);
    rows.push_back(row);
  }
  return rows;
}

struct Cube {
  glm::dvec3 center_m;
  double half_m;
};

/// Twelve cubes at four distances, each 5.7 deg wide, 8.5 deg apart.
std::array<Cube, 12> cubes() {
  std::array<Cube, 12> all{};
  for (int i = 0; i < 12; ++i) {
    const double away_m = 1.0 + 0.7 * (i % 4);
    all[static_cast<std::size_t>(i)] = {
        {(i / 3 - 1.5) * 0.16 * away_m, (i % 3 - 1.0) * 0.15 * away_m, -away_m}, 0.05 * away_m};
  }
  return all;
}

std::string cubesObj() {
  std::ostringstream text;
  int first = 1;
  for (const auto& [center, half] : cubes()) {
    text << "o cube_" << (first - 1) / 8 + 1 << '\n';
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 side((k & 4) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 1) != 0 ? 1 : -1);
      const glm::dvec3 p = center + half * side;
      text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    }
    for (const auto& face : std::array<std::array<int, 4>, 6>{{{0, 1, 3, 2},
                                                               {4, 6, 7, 5},
                                                               {0, 4, 5, 1},
                                                               {2, 3, 7, 6},
                                                               {0, 2, 6, 4},
                                                               {1, 5, 7, 3}}}) {
      text << 'f';
      for (const int corner : face) text << ' ' << first + corner;
      text << '\n';
    }
    first += 8;
  }
  return text.str();
}

/// The cubes' fronts as points with labels, which open faster than a mesh.
std::string frontsPly() {
  constexpr int kSide = 24;
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << 12 * kSide * kSide
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty int label\n"
          "end_header\n";
  int label = 0;
  for (const auto& [center, half] : cubes()) {
    ++label;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double x = (i % kSide + 0.5) / kSide * 2.0 - 1.0;
      const double y = (i / kSide + 0.5) / kSide * 2.0 - 1.0;
      text << center.x + half * x << ' ' << center.y + half * y << ' ' << center.z + half << ' '
           << label << '\n';
    }
  }
  return text.str();
}

glm::dvec2 onScreen_px(const glm::dvec3& p) {
  const glm::dvec2 at_m = kDistance_m / -p.z * glm::dvec2(p.x, -p.y);
  return 0.5 * kScreen_px + at_m / kScreen_m * kScreen_px;
}

class GazeInScene : public testing::Test {
 protected:
  GazeInScene() {
    folder.write("scene.ply", frontsPly());
    folder.write("study.toml", study(kPoints));
  }

  static std::string study(const std::string& scene) {
    return "[scene]\n" + scene +
           "[eye]\nposition_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]\n"
           "[screen]\nsize_px = [1920, 1080]\nsize_m = [0.5313, 0.2989]\ndistance_m = 0.6\n"
           "[gaze]\nsource = \"trace.tsv\"\n"
           "[render]\nmethod = \"pinhole\"\n[output]\nsize_px = [96, 54]\nfps = 10\n";
  }

  /// Each fixation is off its cube by 0.5 deg (standard deviation along each axis).
  void simulate() {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    const double px_per_deg = kDistance_m * kScreen_px.x / kScreen_m.x * M_PI / 180.0;
    std::string trace = "time_s\tx_px\ty_px\n";
    for (int f = 0, i = 0; f < kFixations; ++f) {
      looked.push_back(random() % 12);
      const glm::dvec2 off(0.5 * normal(random), 0.5 * normal(random));
      for (int k = 0; k < kSamplesEach; ++k, ++i) {
        const glm::dvec2 jitter(0.05 * normal(random), 0.05 * normal(random));
        const glm::dvec2 at =
            onScreen_px(cubes()[looked.back()].center_m) + px_per_deg * (off + jitter);
        trace += std::to_string(i / kRate_Hz) + '\t' + std::to_string(at.x) + '\t' +
                 std::to_string(at.y) + '\n';
      }
    }
    folder.write("trace.tsv", trace);
  }

  std::vector<Row> table(const std::string& name) const { return rowsOf(folder.read(name)); }

  std::vector<std::size_t> looked;  // the cube of each fixation
  TemporaryFolder folder;
};

TEST_F(GazeInScene, FixationsMeetTheObjectsThatWereLookedAt) {
  simulate();
  folder.write("scene.obj", cubesObj());
  folder.write("study.toml", study("file = \"scene.obj\"\n"));
  const Outcome outcome = runFoci({"replay", "study.toml", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;

  const std::vector<Row> fixations = table("out/fixations.tsv");
  int right = 0;
  for (int f = 0; f < kFixations; ++f) {
    const double middle_s = (f + 0.5) * kSamplesEach / kRate_Hz;
    for (const Row& row : fixations) {
      const double since_s = middle_s - std::stod(row.at("onset_s"));
      if (since_s < 0.0 || since_s > std::stod(row.at("duration_s"))) continue;
      const std::size_t cube = looked[static_cast<std::size_t>(f)];
      right += row.at("object") == "cube_" + std::to_string(cube + 1);
    }
  }
  EXPECT_GE(right, 0.95 * kFixations);

  // Each sample's point lies on its ray, in the plane of a cube's front.
  for (const Row& row : table("out/gaze3d.tsv")) {
    if (row.at("object") == "n/a" || row.at("normal_z") != "1.0000") continue;
    const std::size_t cube = std::stoul(row.at("object").substr(5)) - 1;
    const double front_m = cubes()[cube].center_m.z + cubes()[cube].half_m;
    const double distance_m = std::stod(row.at("distance_m"));
    EXPECT_NEAR(std::stod(row.at("point_z_m")), front_m, 0.003);
    EXPECT_NEAR(distance_m * std::stod(row.at("direction_z")), std::stod(row.at("point_z_m")),
                2e-4);
  }

  double dwell_s = 0.0, met_s = 0.0;
  for (const Row& row : table("out/objects.tsv")) dwell_s += std::stod(row.at("dwell_s"));
  for (const Row& row : table("out/gaze3d.tsv")) met_s += row.at("object") != "n/a" ? 0.005 : 0.0;
  EXPECT_NEAR(dwell_s, met_s, 0.01);
  EXPECT_NE(folder.read("out/report.html").find("<td>cube_1</td>"), std::string::npos);
}

TEST_F(GazeInScene, TablesOfFixationsNeedNoJoining) {
  simulate();
  folder.write("scene.obj", cubesObj());
  folder.write("study.toml", study("file = \"scene.obj\"\n") +
                                 "[[trial]]\nname = \"b\"\ntype = \"far\"\nstart_s = 2\nend_s = 4\n"
                                 "[[trial]]\nname = \"a\"\nstart_s = 0.5\nend_s = 2\n");
  std::filesystem::create_directories(folder.path() / "sub-03/ses-2");
  std::filesystem::rename(folder.path() / "trace.tsv", folder.path() / "sub-03/ses-2/look.tsv");
  const Outcome outcome = runFoci(
      {"replay", "study.toml", "--trace", "sub-03/ses-2/look.tsv", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<Row> frames = table("out/frames.tsv"), fixations = table("out/fixations.tsv");
  ASSERT_GE(fixations.size(), 5u);
  for (const Row& row : fixations) {
    EXPECT_EQ(row.at("recording") + row.at("subject") + row.at("session"), "look032");
    const auto value = [&](const char* column) { return std::stod(row.at(column)); };
    const double onset_s = value("onset_s");
    EXPECT_EQ(row.at("trial"), onset_s < 0.5 ? "n/a"
                               : onset_s < 2 ? "a"
                               : onset_s < 4 ? "b"
                                             : "n/a");
    EXPECT_EQ(row.at("trial_type"), row.at("trial") == "b" ? "far" : "n/a");
    double focus_D = 0.0;
    int count = 0;
    for (const Row& frame : frames) {
      const double since_s = std::stod(frame.at("time_s")) - onset_s;
      if (since_s < 0.0 || since_s >= value("duration_s")) continue;
      focus_D += std::stod(frame.at("focus_D"));
      ++count;
    }
    if (count > 0) {
      EXPECT_NEAR(value("focus_D"), focus_D / count, 1e-3);
    }
    if (row.at("distance_m") == "n/a") continue;
    EXPECT_NEAR(value("surface_D"), 1.0 / value("distance_m"), 0.02);
    EXPECT_NEAR(value("defocus_D"), value("focus_D") - value("surface_D"), 2e-4);
    EXPECT_NEAR(value("blur_radius_arcmin"),
                3437.75 * 0.5e-3 * value("pupil_mm") * std::abs(value("defocus_D")), 2e-3);
  }
  double dwell_s = 0.0, met_s = 0.0;
  std::set<std::string> trials;
  for (const Row& row : table("out/objects.tsv")) {
    trials.insert(row.at("trial"));
    dwell_s += std::stod(row.at("dwell_s"));
  }
  for (const Row& row : table("out/gaze3d.tsv")) met_s += row.at("object") != "n/a" ? 0.005 : 0.0;
  EXPECT_NEAR(dwell_s, met_s, 0.02);
  EXPECT_TRUE(trials.contains("a") && trials.contains("b"));
  const std::vector<Row> saccades = table("out/saccades.tsv");
  ASSERT_GE(saccades.size(), 4u);
  EXPECT_NE(saccades[1].at("from_object"), saccades[1].at("to_object"));
}

TEST_F(GazeInScene, ShapesOfTheStudyNameParts) {
  simulate();
  folder.write("study.toml", study(std::string(kPoints) +
                                   "[[scene.object]]\nname = \"near\"\ncenter_m = [0, 0, -1]\n"
                                   "size_m = [4, 4, 0.3]\n"
                                   "[[scene.object]]\nname = \"far\"\ncenter_m = [0, 0, -4]\n"
                                   "radius_m = 2.6\n"));
  const Outcome outcome = runFoci({"replay", "study.toml", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const Row& row : table("out/gaze3d.tsv")) {
    if (row.at("object") == "n/a") continue;
    const double z = std::stod(row.at("point_z_m"));
    const bool near = z > -1.15;
    EXPECT_EQ(row.at("object") == "near", near) << z;
  }
}

TEST_F(GazeInScene, APreparedSceneKeepsItsObjects) {
  simulate();
  folder.write("scene.obj", cubesObj());
  folder.write("study.toml", study("file = \"scene.obj\"\n"));
  ASSERT_EQ(
      runFoci({"prepare", "scene.obj", "--out", "scene.foci", "--points", "20000"}, folder.path())
          .exit_code,
      0);
  folder.write("prepared.toml", study("file = \"scene.foci\"\n"));
  for (const std::string name : {"study", "prepared"}) {
    ASSERT_EQ(runFoci({"replay", name + ".toml", "--out", name}, folder.path()).exit_code, 0);
  }
  const std::vector<Row> of_mesh = table("study/fixations.tsv");
  const std::vector<Row> of_surfels = table("prepared/fixations.tsv");
  ASSERT_EQ(of_mesh.size(), of_surfels.size());
  for (std::size_t i = 0; i < of_mesh.size(); ++i) {
    EXPECT_EQ(of_mesh[i].at("object"), of_surfels[i].at("object"));
  }
}

TEST_F(GazeInScene, LabelsOfPointsAreObjectsAndBlinksMeetNothing) {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3600\nproperty float x\n"
      "property float y\nproperty float z\nproperty int label\nend_header\n";
  for (int i = 0; i < 3600; ++i) {  // a wall of two halves
    const int column = i % 60;
    ply += std::to_string((column - 29.5) * 0.02) + ' ' + std::to_string((i / 60 - 29.5) * 0.02) +
           " -1 " + (column < 30 ? "7" : "-2") + '\n';
  }
  folder.write("wall.ply", ply);
  folder.write("study.toml", study("file = \"wall.ply\"\n"));
  std::string trace = "time_s\tx_px\ty_px\n";
  for (int i = 0; i < 300; ++i) {
    const bool blinks = i >= 100 && i < 130;
    trace += std::to_string(i / kRate_Hz) + '\t' +
             (blinks    ? "nan\tnan"
              : i < 160 ? "700\t540"
                        : "1200\t540") +
             '\n';
  }
  folder.write("trace.tsv", trace);
  const Outcome outcome = runFoci({"replay", "study.toml", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<Row> rows = table("out/gaze3d.tsv");
  EXPECT_EQ(rows.at(50).at("object"), "7");
  EXPECT_EQ(rows.at(110).at("object"), "n/a");
  EXPECT_EQ(rows.at(110).at("direction_x"), "n/a");
  EXPECT_EQ(rows.at(250).at("object"), "-2");
  EXPECT_NEAR(std::stod(rows.at(50).at("distance_m")),
              std::hypot(1.0, (700.0 - 960.0) / 1920.0 * kScreen_m.x / kDistance_m), 0.002);
}

TEST_F(GazeInScene, TheHeatmapHasTheTimeOfGaze) {
  simulate();
  const Outcome outcome =
      runFoci({"replay", "study.toml", "--out", "out", "--heatmap", "heat.ply"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string ply = folder.read("heat.ply");
  const std::string end = "property float attention_s\nend_header\n";
  const std::size_t at = ply.find(end);
  ASSERT_NE(at, ply.npos);
  constexpr std::size_t kRecord = 6 * 4 + 3 + 4;  // position, normal, colour, attention
  const std::size_t first = at + end.size();
  ASSERT_EQ((ply.size() - first) % kRecord, 0u);
  double sum_s = 0.0;
  for (std::size_t i = first; i < ply.size(); i += kRecord) {
    float attention_s = 0.0f;
    std::memcpy(&attention_s, ply.data() + i + kRecord - 4, 4);
    ASSERT_GE(attention_s, 0.0f);
    sum_s += static_cast<double>(attention_s);
  }
  double met_s = 0.0;
  for (const Row& row : table("out/gaze3d.tsv")) met_s += row.at("object") != "n/a" ? 0.005 : 0.0;
  EXPECT_NEAR(sum_s, met_s, 0.01);
  EXPECT_NE(folder.read("out/report.html").find("turned by 60 degrees"), std::string::npos);
  EXPECT_EQ(runFoci({"render", "heat.ply", "--out", "heat.png"}, folder.path()).exit_code, 0);
  EXPECT_EQ(
      runFoci({"replay", "study.toml", "--out", "out", "--heatmap", "heat.txt"}, folder.path())
          .exit_code,
      2);
}

TEST_F(GazeInScene, MapsHaveDistanceAndDefocusOfEachPixel) {
  simulate();
  folder.write("study.toml", study(kPoints) +
                                 "maps = [\"light\", \"depth\", \"defocus\"]\nimages = "
                                 "true\nmarker = false\nseconds = [0, 0.3]\n");
  const Outcome outcome = runFoci({"replay", "study.toml", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ::setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  const auto map = [&](const std::string& name) {
    return cv::imread((folder.path() / "out" / name).string(), cv::IMREAD_UNCHANGED);
  };
  const cv::Mat depth_m = map("depth-000001.exr"), defocus_D = map("defocus-000001.exr");
  ASSERT_EQ(depth_m.type(), CV_32FC1);
  ASSERT_EQ(depth_m.size(), cv::Size(96, 54));
  const double focus_D = std::stod(table("out/frames.tsv").at(1).at("focus_D"));
  int seen = 0;
  for (int y = 0; y < depth_m.rows; ++y) {
    for (int x = 0; x < depth_m.cols; ++x) {
      const float u = depth_m.at<float>(y, x), d = defocus_D.at<float>(y, x);
      EXPECT_EQ(u == 0.0f, std::isnan(d));
      if (u == 0.0f) continue;
      ++seen;
      EXPECT_NEAR(d, 1.0 / static_cast<double>(u) - focus_D, 1e-3);
    }
  }
  EXPECT_GT(seen, 100);

  // The light of each pixel, as the screen's code, is the frame's image: half a code, and half a
  // step of the table (1/65536) where the code is steepest, 12.92 x 255.
  constexpr double kRounding = 0.5 + 0.5 / 65536.0 * 12.92 * 255.0 + 1e-3;
  const cv::Mat light = map("light-000001.exr"), image = map("frame-000001.png");
  ASSERT_EQ(light.type(), CV_32FC3);
  ASSERT_EQ(image.type(), CV_8UC3);
  for (int i = 0; i < 96 * 54; ++i) {
    for (int c = 0; c < 3; ++c) {
      const double linear = std::clamp(light.at<cv::Vec3f>(i)[c], 0.0f, 1.0f);
      const double code =
          255.0 * (linear <= 0.0031308 ? 12.92 * linear  // IEC 61966-2-1
                                       : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055);
      ASSERT_NEAR(code, image.at<cv::Vec3b>(i)[c], kRounding);
    }
  }
}

TEST_F(GazeInScene, ComparedRunsShowBlurDwellTimesAndDifferences) {
  simulate();
  const std::string pupil = "[observer]\npupil_mm = ";
  for (const std::string mm : {"3", "6"}) {
    folder.write("study.toml", study(kPoints) + pupil + mm + "\n");
    ASSERT_EQ(runFoci({"replay", "study.toml", "--out", "run" + mm}, folder.path()).exit_code, 0);
  }
  const Outcome outcome = runFoci({"compare", "run3", "run6", "--out", "both"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<Row> runs = table("both/compare.tsv");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].at("run"), "run3");
  const auto manifest = nlohmann::json::parse(folder.read("run3/manifest.json"));
  EXPECT_NEAR(std::stod(runs[0].at("duration_s")), manifest["summary"]["duration_s"], 0.001);
  EXPECT_NEAR(std::stod(runs[1].at("mean_blur_arcmin")),
              2.0 * std::stod(runs[0].at("mean_blur_arcmin")), 0.01);
  double dwell_s = 0.0;
  for (const Row& row : table("run3/objects.tsv")) dwell_s += std::stod(row.at("dwell_s"));
  for (const auto& [column, value] : runs[0]) {
    if (column.starts_with("dwell_s ")) dwell_s -= std::stod(value);
  }
  EXPECT_NEAR(dwell_s, 0.0, 1e-6);
  EXPECT_NE(folder.read("both/compare.html").find("difference of run6 from run3"),
            std::string::npos);
  EXPECT_EQ(runFoci({"compare", "run3", "--out", "one"}, folder.path()).exit_code, 2);
  const Outcome none = runFoci({"compare", "run3", "nowhere", "--out", "one"}, folder.path());
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("nowhere"), std::string::npos) << none.err;
}

TEST_F(GazeInScene, ComparesTheObserversOfABatch) {
  simulate();
  folder.write("study.toml", study(kPoints));
  folder.write("copy.tsv", folder.read("trace.tsv"));
  ASSERT_EQ(runFoci({"replay", "study.toml", "--trace", "trace.tsv", "copy.tsv", "--out", "batch"},
                    folder.path())
                .exit_code,
            0);
  const Outcome outcome = runFoci({"compare", "batch", "--out", "c"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<Row> runs = table("c/compare.tsv");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].at("run"), "batch/copy");
  EXPECT_EQ(runs[0].at("overlap trace"), "1.0000");
  EXPECT_EQ(runs[0].at("fixations"), runs[1].at("fixations"));
  const double each_s = std::stod(runs[0].at("mean_fixation_s"));
  EXPECT_NEAR(
      each_s * std::stod(runs[0].at("fixations")),
      [&] {
        double sum_s = 0.0;
        for (const Row& row : table("batch/copy/fixations.tsv")) {
          sum_s += std::stod(row.at("duration_s"));
        }
        return sum_s;
      }(),
      0.02);
}

TEST_F(GazeInScene, RefusesAShapeThatIsBothOrNeither) {
  simulate();
  for (const std::string shape : {"size_m = [1, 1, 1]\nradius_m = 1\n", "", "radius_m = -1\n"}) {
    folder.write("study.toml", study(std::string(kPoints) +
                                     "[[scene.object]]\nname = \"a\"\n"
                                     "center_m = [0, 0, 0]\n" +
                                     shape));
    const Outcome outcome = runFoci({"replay", "study.toml", "--out", "out"}, folder.path());
    EXPECT_EQ(outcome.exit_code, 2) << shape;
    EXPECT_NE(outcome.err.find("radius_m"), std::string::npos) << outcome.err;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
