// Project Aria: gaze of the glasses, and the trajectory beside it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

constexpr double kDigits = 1e-6;   // of the tables
constexpr double kDrawing = 2e-4;  // the drawing's axes have this much between them

// The observer stands at (1, 2, 3) of a world whose z is up, and looks along its y axis.
const glm::dvec3 kPlace(1.0, 2.0, 3.0);
const glm::dvec3 kForward(0.0, 1.0, 0.0), kUp(0.0, 0.0, 1.0), kRight(1.0, 0.0, 0.0);

class Aria : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_ / "eye_gaze"); }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const fs::path& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  /// Poses of the left camera of Gen 1, whose place and axes in the eyes' frame (x to the left, y
  /// up, z forward) are those that the documentation states.
  static std::string trajectory(double from_s, double to_s) {
    const glm::dmat3 world_from_eyes(-kRight, kUp, kForward);
    const glm::dvec3 y = glm::normalize(glm::dvec3(0.7934, 0.0, -0.6088));
    const glm::dvec3 z = glm::normalize(glm::dvec3(0.6079, -0.0523, 0.7923));
    const glm::dmat3 world_from_camera = world_from_eyes * glm::dmat3(glm::cross(y, z), y, z);
    const glm::dvec3 place = kPlace + world_from_eyes * glm::dvec3(0.0714, 0.0024, 0.0085);
    const glm::dquat q = glm::normalize(glm::quat_cast(world_from_camera));
    std::string text =
        "graph_uid,tracking_timestamp_us,utc_timestamp_ns,tx_world_device,ty_world_device,"
        "tz_world_device,qx_world_device,qy_world_device,qz_world_device,qw_world_device,rest\n";
    for (double at_s = from_s; at_s < to_s + 1e-4; at_s += 0.02) {
      char line[300];
      std::snprintf(line, sizeof line, "a-b,%lld,0,%.7f,%.7f,%.7f,%.9f,%.9f,%.9f,%.9f,0\n",
                    std::llround(1e6 * at_s), place.x, place.y, place.z, q.x, q.y, q.z, q.w);
      text += line;
    }
    return text;
  }

  fs::path folder_ = fs::temp_directory_path() / ("foci_aria_" + std::to_string(getpid()));
};

/// Both eyes look at a point 0.5 m to the left, 0.2 m up and 2 m ahead of the middle between them.
const glm::dvec3 kTarget(-0.5, 0.2, -2.0);

std::string bothEyes(bool second_generation) {
  std::string text = second_generation
                         ? "tracking_timestamp_us,yaw_rads_cpf,pitch_rads_cpf,left_yaw_rads_cpf,"
                           "right_yaw_rads_cpf,left_pitch_rads_cpf,right_pitch_rads_cpf,"
                           "tx_left_eye_cpf,ty_left_eye_cpf,tz_left_eye_cpf,tx_right_eye_cpf,"
                           "ty_right_eye_cpf,tz_right_eye_cpf\n"
                         : "tracking_timestamp_us,left_yaw_rads_cpf,right_yaw_rads_cpf,"
                           "pitch_rads_cpf,depth_m,tx_left_eye_cpf,ty_left_eye_cpf,"
                           "tz_left_eye_cpf,tx_right_eye_cpf,ty_right_eye_cpf,tz_right_eye_cpf\n";
  const double left = std::atan((0.5 - 0.0315) / 2.0), right = std::atan((0.5 + 0.0315) / 2.0);
  const double pitch = std::atan(0.1), middle = std::atan(0.25);
  // Of Gen 2: angles from the horizontal plane.
  const auto up = [](double x) { return std::asin(0.2 / std::hypot(x, 0.2, 2.0)); };
  for (int i = 0; i < 40; ++i) {
    char line[300];
    const long long time_us = 10'000'000 + 100'000LL * i;
    if (second_generation) {
      std::snprintf(line, sizeof line,
                    "%lld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,0.0315,0,0,-0.0315,0,0\n", time_us, middle,
                    up(0.5), left, right, up(0.5 - 0.0315), up(0.5 + 0.0315));
    } else {
      std::snprintf(line, sizeof line, "%lld,%.9f,%.9f,%.9f,2.07,0.0315,0,0,-0.0315,0,0\n", time_us,
                    left, right, pitch);
    }
    text += line;
  }
  return text;
}

void expectTarget(const GazeSample& sample) {
  for (const std::size_t side : {0, 1}) {
    const EyeSample& eye = sample.eyes[side];
    ASSERT_TRUE(eye.origin_m && eye.direction);
    const glm::dvec3 place_m(side == 0 ? -0.0315 : 0.0315, 0.0, 0.0);
    EXPECT_LT(glm::distance(*eye.origin_m, place_m), kDigits);
    EXPECT_LT(glm::distance(*eye.direction, glm::normalize(kTarget - place_m)), kDigits);
  }
  ASSERT_TRUE(sample.direction);
  // The mean of two directions is not quite that of the middle.
  EXPECT_LT(glm::distance(*sample.direction, glm::normalize(kTarget)), 2e-4);
}

TEST_F(Aria, AnglesAreTangentsOfEachEyeAndOfGen2Angles) {
  for (const bool second_generation : {false, true}) {
    const fs::path file = write("eye_gaze/general_eye_gaze.csv", bothEyes(second_generation));
    const GazeTrace trace = readTrace(file, {}, {});
    EXPECT_EQ(trace.format, "Project Aria, binocular");
    ASSERT_EQ(trace.samples.size(), 40u);
    EXPECT_NEAR(trace.samples[1].time_s, 10.1, 1e-9);
    expectTarget(trace.samples[5]);
    EXPECT_FALSE(trace.samples[5].head);
  }
}

/// A real recording of Gen 2 states the direction of both eyes together, too.
TEST(AriaGen2, TheMeanOfTheEyesIsTheCombinedDirection) {
  const fs::path file = "../shared/data/gaze/aria/gen2_general_eye_gaze.csv";
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  std::stringstream in;
  in << std::ifstream(file).rdbuf();
  const ScratchFile alone(in.str());  // the trajectory beside it is of another recording
  const GazeTrace trace = readTrace(alone.path(), {}, {});
  std::string line, yaw, pitch;
  std::getline(in, line);
  for (const GazeSample& sample : trace.samples) {
    std::getline(in, line);
    std::istringstream fields(line);
    std::getline(fields, yaw, ',');
    std::getline(fields, yaw, ',');
    std::getline(fields, pitch, ',');
    const double h = std::stod(yaw), v = std::stod(pitch);  // to the left, upwards
    const glm::dvec3 combined(-std::sin(h) * std::cos(v), std::sin(v), -std::cos(h) * std::cos(v));
    ASSERT_LT(glm::distance(*sample.direction, combined), 1e-6);  // rounding of floats
  }
}

TEST_F(Aria, GazeKeepsItsUnitBesideAHeadInDegrees) {
  std::string text = bothEyes(false);
  for (std::size_t at = 0, line = 0; (at = text.find('\n', at)) != text.npos; ++line) {
    const char* const more = line == 0 ? ",right,up,roll" : ",90,0,0";
    text.insert(at, more);
    at += std::string_view(more).size() + 1;
  }
  TraceColumns columns;
  columns.space.head_angles = {"right", "up", "roll"};
  columns.space.axes = "right-up-forward";
  const GazeTrace trace = readTrace(write("eyegaze.csv", text), columns, {});
  expectTarget(trace.samples[5]);
  ASSERT_TRUE(trace.samples[5].head);
  const glm::dvec3 ahead = trace.samples[5].head->world_from_head * glm::dvec3(0.0, 0.0, -1.0);
  EXPECT_LT(glm::distance(ahead, glm::dvec3(1.0, 0.0, 0.0)), kDigits);
}

TEST_F(Aria, OlderFilesHaveOneAngleAndADepth) {
  std::string text =
      "tracking_timestamp_us,yaw_rads_cpf,pitch_rads_cpf,depth_m,yaw_low_rads_cpf,"
      "pitch_low_rads_cpf,yaw_high_rads_cpf,pitch_high_rads_cpf\n";
  for (int i = 0; i < 40; ++i) {
    char line[200];
    std::snprintf(line, sizeof line, "%d,%.9f,%.9f,%s,0,0,0,0\n", 10'000'000 + 100'000 * i,
                  std::atan(0.25), std::atan(0.1),
                  i < 20 ? "" : std::to_string(glm::length(kTarget)).c_str());
    text += line;
  }
  const GazeTrace trace = readTrace(write("eyegaze.csv", text), {}, {});
  ASSERT_TRUE(trace.samples[5].direction);
  EXPECT_LT(glm::distance(*trace.samples[5].direction, glm::normalize(kTarget)), kDigits);
  EXPECT_FALSE(trace.samples[5].eyes[0].direction);
  expectTarget(trace.samples[25]);
}

TEST_F(Aria, TheTrajectoryMovesTheHead) {
  write("slam/closed_loop_trajectory.csv", trajectory(11.0, 13.0));
  const fs::path file = write("eye_gaze/general_eye_gaze.csv", bothEyes(false));
  EXPECT_TRUE(previewSpace(file, {}).has_head);
  ASSERT_EQ(companionsOf(file).size(), 1u);
  const GazeTrace trace = readTrace(file, {}, {});
  ASSERT_EQ(trace.samples.size(), 40u);
  EXPECT_FALSE(trace.samples[5].head || trace.samples[5].direction);  // before the trajectory
  const GazeSample& sample = trace.samples[15];
  ASSERT_TRUE(sample.head && sample.direction);
  EXPECT_LT(glm::distance(sample.head->position_m, kPlace), kDrawing);
  const glm::dmat3 turn = glm::mat3_cast(sample.head->world_from_head);
  EXPECT_LT(glm::distance(turn * glm::dvec3(0.0, 0.0, -1.0), kForward), kDrawing);
  EXPECT_LT(glm::distance(turn * glm::dvec3(0.0, 1.0, 0.0), kUp), kDrawing);
  const glm::dvec3 target = kTarget.x * kRight + kTarget.y * kUp - kTarget.z * kForward;
  EXPECT_LT(glm::distance(turn * *sample.direction, glm::normalize(target)), 2.0 * kDrawing);
  ASSERT_FALSE(trace.warnings.empty());
}

TEST_F(Aria, RefusesADamagedTrajectory) {
  const fs::path file = write("general_eye_gaze.csv", bothEyes(false));
  const std::string good = trajectory(10.0, 14.0);
  const auto refusal = [&](const std::string& text) {
    write("closed_loop_trajectory.csv", text);
    return refusalBy([&] { readTrace(file, {}, {}); });
  };
  std::string text = good;
  EXPECT_NE(refusal(text.replace(text.find("qw_world"), 8, "qw_earth")).find("qw_world_device"),
            std::string::npos);
  text = good;
  EXPECT_NE(refusal(text.insert(text.find("a-b,") + 4, "x")).find("expected a number"),
            std::string::npos);
  // The last line may be cut off.
  EXPECT_EQ(refusal(good.substr(0, good.size() - 60)), "not refused");
}

}  // namespace FOCI_FILE
}  // namespace foci
