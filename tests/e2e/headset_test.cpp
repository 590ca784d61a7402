// Recordings of a headset, as users replay them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;

constexpr double kGaze_deg = 0.1;  // the rounding of EyeNavGS

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

/// What a pixel of a headset's image shows, at 12 px a degree straight ahead. The image has even
/// numbers of pixels.
/// @param side, up, down  tangents of the field's limits
glm::dvec3 sightThrough(double side, double up, double down, double x_px, double y_px) {
  const double focal_px = glm::degrees(12.0);
  const auto half = [&](double tangents) {
    return static_cast<double>(std::lround(0.5 * focal_px * tangents));
  };
  const double ahead_x_px = half(2.0 * side);
  const double ahead_y_px = half(up + down) - 0.5 * focal_px * (down - up);
  return glm::normalize(glm::dvec3(x_px - ahead_x_px, ahead_y_px - y_px, -focal_px));
}

double yawAt_deg(double time_s) { return 20.0 * std::sin(M_PI * time_s); }

const glm::dvec3 kTarget_m(0.1, 0.0, -1.0);

/// A head that turns by 63 deg/s while gaze rests on a point in the world. Unity's axes: the yaw is
/// positive to the right, and z points forward.
std::string turningHead() {
  std::ostringstream text;
  text.precision(9);
  text << "time_s,hx,hy,hz,qx,qy,qz,qw,gx,gy,gz\n";
  const glm::dvec3 sight = glm::normalize(kTarget_m);
  for (int i = 0; i < 300; ++i) {
    const double time_s = i / 100.0, half_rad = 0.5 * glm::radians(yawAt_deg(time_s));
    text << time_s << ",0,0,0,0," << std::sin(half_rad) << ",0," << std::cos(half_rad) << ','
         << sight.x << ',' << sight.y << ',' << -sight.z << '\n';
  }
  return text.str();
}

const char* const kUnityStudy = R"(
[scene]
file = "scene.ply"
[gaze]
source = "trace.csv"
direction = ["gx", "gy", "gz"]
head_position = ["hx", "hy", "hz"]
head_quaternion = ["qx", "qy", "qz", "qw"]
frame = "world"
axes = "right-up-forward"
[render]
method = "pinhole"
[output]
fps = 17
)";

TEST(ReplayOfAHeadset, KeepsGazeOnAPointWhileTheHeadTurns) {
  TemporaryFolder folder;
  folder.write("scene.ply", squarePly(24, 1.0));
  folder.write("trace.csv", turningHead());
  folder.write("study.toml", kUnityStudy);
  const Outcome outcome =
      runFoci({"replay", "study.toml", "--size", "32x32", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto rows = tableOf(folder.read("out/frames.tsv"));
  ASSERT_EQ(rows.size(), 52u) << outcome.err;
  const double distance_m = glm::length(kTarget_m), edge = std::tan(glm::radians(50.0));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double time_s = std::stod(rows[i][1]);
    const glm::dquat world_from_head =
        glm::angleAxis(-glm::radians(yawAt_deg(time_s)), glm::dvec3(0.0, 1.0, 0.0));
    const glm::dvec3 sight = world_from_head * sightThrough(edge, edge, edge, std::stod(rows[i][3]),
                                                            std::stod(rows[i][4]));
    EXPECT_LT(angle_deg(sight, kTarget_m), kGaze_deg) << "frame " << i;
    EXPECT_EQ(rows[i][5], "fixation") << "frame " << i;
    if (i == 1) continue;  // the first sample is no fixation yet
    EXPECT_NEAR(std::stod(rows[i][6]), distance_m, 0.01) << "frame " << i;
  }
}

TEST(ReplayOfAHeadset, GazeMeetsThePointInTheSceneWhileTheHeadMoves) {
  // The head goes 0.4 m to the side and 0.2 m forwards, turns and rolls. Gaze is in its frame.
  const auto positionAt_m = [](double time_s) {
    return glm::dvec3(0.2 * std::sin(2.0 * time_s), 0.0, 0.1 * std::cos(2.0 * time_s) - 0.1);
  };
  TemporaryFolder folder;
  std::ostringstream text;
  text.precision(9);
  text << "time_s,hx,hy,hz,qx,qy,qz,qw,gx,gy,gz\n";
  for (int i = 0; i < 300; ++i) {
    const double time_s = i / 100.0;
    const glm::dvec3 at_m = positionAt_m(time_s);
    const glm::dquat head =
        glm::angleAxis(-glm::radians(yawAt_deg(time_s)), glm::dvec3(0.0, 1.0, 0.0)) *
        glm::angleAxis(0.3 * std::sin(time_s), glm::dvec3(0.0, 0.0, 1.0));
    const glm::dvec3 sight = glm::inverse(head) * glm::normalize(kTarget_m - at_m);
    // Unity's z points forward: the mirrored turn has -x and -y.
    text << time_s << ',' << at_m.x << ',' << at_m.y << ',' << -at_m.z << ',' << -head.x << ','
         << -head.y << ',' << head.z << ',' << head.w << ',' << sight.x << ',' << sight.y << ','
         << -sight.z << '\n';
  }
  folder.write("scene.ply", squarePly(48, 1.0));
  folder.write("trace.csv", text.str());
  std::string study = kUnityStudy;
  study.replace(study.find("\"world\""), 7, "\"head\"");
  folder.write("study.toml", study);
  const Outcome outcome =
      runFoci({"replay", "study.toml", "--size", "32x32", "--out", "out"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto rows = tableOf(folder.read("out/gaze3d.tsv"));
  ASSERT_GT(rows.size(), 290u);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(rows[0], name) - rows[0].begin());
  };
  const auto vectorAt = [&](std::size_t row, const std::string& name) {
    const std::size_t x = column(name);
    return glm::dvec3(std::stod(rows[row][x]), std::stod(rows[row][x + 1]),
                      std::stod(rows[row][x + 2]));
  };
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const glm::dvec3 at_m = positionAt_m(std::stod(rows[i][column("time_s")]));
    EXPECT_LT(glm::distance(vectorAt(i, "origin_x_m"), at_m), 1e-3) << i;
    EXPECT_LT(glm::distance(vectorAt(i, "point_x_m"), kTarget_m), 0.004) << i;
    EXPECT_NEAR(std::stod(rows[i][column("distance_m")]), glm::distance(at_m, kTarget_m), 0.004)
        << i;
  }
}

TEST(ReplayOfAHeadset, StopsBeforeAnEmptyVideo) {
  TemporaryFolder folder;
  folder.write("scene.ply", squarePly(24, 1.0));
  folder.write("trace.csv", turningHead());
  folder.write("study.toml", kUnityStudy);
  const auto at = [&](const std::string& offset_m) {
    return runFoci({"replay", "study.toml", "--size", "32x32", "--seconds", "0:0.2", "--out", "out",
                    "--set", "gaze.scene_offset_m=" + offset_m},
                   folder.path());
  };
  // The square is 2 m wide and 1 m ahead; the headset sees 50 deg to each side.
  EXPECT_EQ(at("[0, 0, 0.5]").exit_code, 0);
  const Outcome behind = at("[0, 0, -5]");
  EXPECT_EQ(behind.exit_code, 2) << behind.err;
  EXPECT_NE(behind.err.find("trace.csv: the recorded head never has the scene in view"),
            std::string::npos)
      << behind.err;
}

TEST(ReplayOfAHeadset, RefusesASecondPlaceForTheEye) {
  TemporaryFolder folder;
  folder.write("scene.ply", squarePly(24, 1.0));
  folder.write("trace.csv", turningHead());
  folder.write("study.toml",
               kUnityStudy + std::string("[eye]\nposition_m = [0, 0, 1]\nlook_at_m = [0, 0, 0]\n"));
  const Outcome outcome = runFoci({"replay", "study.toml", "--out", "out"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("eye.position_m: the head of the recording moves the eye"),
            std::string::npos)
      << outcome.err;
}

/// A row of EyeNavGS as numbers.
std::vector<std::vector<double>> eyeNavGsRows(const fs::path& file) {
  std::ifstream in(file);
  std::string line, field;
  std::vector<std::vector<double>> rows;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    rows.emplace_back();
    while (std::getline(fields, field, ',')) rows.back().push_back(std::stod(field));
  }
  return rows;
}

glm::dquat headOf(const std::vector<double>& row) {
  return glm::normalize(glm::dquat(row[11], row[8], row[9], row[10]));
}

/// Whether the eye tracker was on.
bool hasGaze(const std::vector<double>& row) {
  return row[15] != 0.0 || row[16] != 0.0 || row[17] != 0.0;
}

/// Of gaze, or else of the head.
glm::dvec3 sightOf(const std::vector<double>& row) {
  if (!hasGaze(row)) return headOf(row) * glm::dvec3(0.0, 0.0, -1.0);
  return glm::normalize(glm::dquat(row[18], row[15], row[16], row[17])) *
         glm::dvec3(0.0, 0.0, -1.0);
}

/// Replays a recording of EyeNavGS, and compares the gaze of each frame with the file's rows: the
/// latest gaze before the frame, in the head's view at the frame's time.
void expectItsOwnGaze(const fs::path& file, const std::vector<std::vector<double>>& rows) {
  TemporaryFolder folder;
  folder.write("study.toml",
               std::string("scene.builtin = \"plane\"\nrender.method = \"pinhole\"\n") +
                   "output.fps = 6\n" + (hasGaze(rows[0]) ? "" : "gaze.from_head = true\n"));
  const Outcome outcome =
      runFoci({"replay", "study.toml", "--trace", file.string(), "--size", "32x32", "--out", "out"},
              folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto frames = tableOf(folder.read("out/frames.tsv"));
  ASSERT_GT(frames.size(), 200u);
  const double side = std::tan(rows[1][2]), up = std::tan(rows[0][4]), down = -std::tan(rows[0][3]);
  std::size_t row = 0, compared = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const double time_ms = 1000.0 * std::stod(frames[i][1]);
    while (row + 3 < rows.size() && rows[row + 2][19] <= time_ms) row += 2;
    if (row + 3 >= rows.size() || frames[i][3] == "n/a") continue;
    // At a row's very time, rounding decides whether the frame has it.
    if (std::min(time_ms - rows[row][19], rows[row + 2][19] - time_ms) < 0.01) continue;
    const double share = (time_ms - rows[row][19]) / (rows[row + 2][19] - rows[row][19]);
    const glm::dquat head = glm::slerp(headOf(rows[row]), headOf(rows[row + 2]), share);
    const glm::dvec3 world = glm::normalize(sightOf(rows[row]) + sightOf(rows[row + 1]));
    const glm::dvec3 seen =
        sightThrough(side, up, down, std::stod(frames[i][3]), std::stod(frames[i][4]));
    EXPECT_LT(angle_deg(head * seen, world), kGaze_deg) << file << " frame " << i;
    ++compared;
  }
  EXPECT_GT(compared, frames.size() * 9 / 10);
}

TEST(ReplayOfEyeNavGs, ReprojectsGazeIntoTheHeadsView) {
  const auto data = dataFolder();
  if (!data) GTEST_SKIP() << "no ../shared/data";
  int with_gaze = 0;
  for (const char* name :
       {"user105_bicycle", "user107_playroom", "user111_london", "user118_drjohnson"}) {
    const fs::path file = *data / "gaze/vr" / (std::string(name) + ".csv");
    if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
    const auto rows = eyeNavGsRows(file);
    // The eye tracker was off in three of the four.
    if (!hasGaze(rows[0])) {
      TemporaryFolder folder;
      const Outcome outcome = runFoci({"trace", "info", file.string()}, folder.path());
      EXPECT_EQ(outcome.exit_code, 2) << name;
      EXPECT_NE(outcome.err.find("gaze.from_head"), std::string::npos) << outcome.err;
    } else {
      ++with_gaze;
    }
    expectItsOwnGaze(file, rows);
  }
  EXPECT_EQ(with_gaze, 1);
}

/// A row of a table by the names of its columns.
std::string fieldOf(const std::vector<std::vector<std::string>>& table, std::size_t row,
                    const std::string& name) {
  const auto column = std::ranges::find(table[0], name);
  if (column == table[0].end()) return "no column " + name;
  return table[row][static_cast<std::size_t>(column - table[0].begin())];
}

// The distances were computed from the files with NumPy: the median of the points within 2 degrees
// of the line of sight.
TEST(ReplayOfAria, FindsTheDistancesOfItsOwnScene) {
  const auto data = dataFolder();
  if (!data || !fs::exists(*data / "gaze/aria/global_points.csv.gz")) {
    GTEST_SKIP() << "no ../shared/data/gaze/aria";
  }
  const fs::path aria = *data / "gaze/aria";
  TemporaryFolder folder;
  const Outcome outcome =
      runFoci({"replay", (aria / "global_points.csv.gz").string(), "--trace",
               (aria / "generalized_gaze.csv").string(), "--set", "focus.cone_deg=2", "--set",
               "render.method=\"pinhole\"", "--size", "64x64", "--out", "out"},
              folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto sights = tableOf(folder.read("out/gaze3d.tsv"));
  constexpr double kBound = 0.1;
  const std::pair<double, double> distances[] = {{149.803, 3.88}, {151.003, 3.71}, {152.203, 2.04},
                                                 {153.403, 1.71}, {154.603, 1.77}, {155.803, 1.49},
                                                 {157.603, 1.05}, {158.803, 0.87}, {160.003, 0.98}};
  for (const auto& [time_s, distance_m] : distances) {
    std::size_t nearest = 1;
    const auto away_s = [&, at_s = time_s](std::size_t row) {
      return std::abs(std::stod(fieldOf(sights, row, "time_s")) - at_s);
    };
    for (std::size_t row = 1; row < sights.size(); ++row) {
      if (away_s(row) < away_s(nearest)) nearest = row;
    }
    ASSERT_LT(away_s(nearest), 0.001);
    const std::string found = fieldOf(sights, nearest, "distance_m");
    ASSERT_NE(found, "n/a") << time_s;
    EXPECT_NEAR(std::stod(found), distance_m, kBound * distance_m) << time_s;
  }
  // The vergence of these glasses was not calibrated, and does not follow the distance.
  const auto frames = tableOf(folder.read("out/frames.tsv"));
  std::size_t disagree = 0;
  for (std::size_t row = 1; row < frames.size(); ++row) {
    disagree += fieldOf(frames, row, "vergence_disagrees") == "1";
  }
  EXPECT_GT(disagree, 0u);
  EXPECT_NE(folder.read("out/report.html").find("vergence"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
