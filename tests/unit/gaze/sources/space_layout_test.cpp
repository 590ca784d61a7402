// Gaze in space, read from tables that a study describes.

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "base/input_error.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;
const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.5313, 0.2989}, .distance_m = 0.6};

const ColumnList<3> kXyz = {"x", "y", "z"}, kHeadPlace = {"hx", "hy", "hz"};
const ColumnList<4> kHead = {"hi", "hj", "hk", "hw"};

GazeSample sampleOf(const std::string& header, const std::string& row, const SpaceColumns& space,
                    TraceColumns columns = {}) {
  columns.space = space;
  const std::string text = "time_s," + header + "\n0," + row + "\n0.01," + row + "\n";
  return readTrace(ScratchFile(text).path(), columns, kScreen).samples.front();
}

std::string refusalOf(const std::string& header, const std::string& row,
                      const SpaceColumns& space) {
  try {
    sampleOf(header, row, space);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

SpaceColumns directions(const char* axes) { return {.both = {.direction = kXyz}, .axes = axes}; }

TEST(SpaceLayout, ReadsOneDirectionInAllItsForms) {
  // 30 degrees to the right, 20 degrees up.
  const glm::dvec3 sight(std::sin(glm::radians(30.0)) * std::cos(glm::radians(20.0)),
                         std::sin(glm::radians(20.0)),
                         -std::cos(glm::radians(30.0)) * std::cos(glm::radians(20.0)));
  const auto near = [&](const GazeSample& sample) {
    return sample.direction ? glm::distance(*sample.direction, sight) : 9.0;
  };
  char vector[80], quaternion[120], point[80];
  std::snprintf(vector, sizeof vector, "%.12f,%.12f,%.12f", sight.x, sight.y, -sight.z);
  const glm::dquat turn = glm::angleAxis(glm::radians(-30.0), glm::dvec3(0.0, 1.0, 0.0)) *
                          glm::angleAxis(glm::radians(20.0), glm::dvec3(1.0, 0.0, 0.0));
  std::snprintf(quaternion, sizeof quaternion, "%.12f,%.12f,%.12f,%.12f", turn.x, turn.y, turn.z,
                turn.w);
  const glm::dvec3 at_mm = 1000.0 * (glm::dvec3(0.03, 0.0, 0.0) + 2.0 * sight);
  std::snprintf(point, sizeof point, "%.9f,%.9f,%.9f,30,0,0", at_mm.x, at_mm.y, at_mm.z);

  EXPECT_LT(near(sampleOf("x,y,z", vector, directions("right-up-forward"))), kRounding);
  SpaceColumns angles{.both = {.angles = {"h", "v"}}, .axes = "right-up-back"};
  EXPECT_LT(near(sampleOf("h,v", "30,20", angles)), kRounding);
  angles.angle_units = AngleUnit::rad;
  EXPECT_LT(near(sampleOf("h,v", "0.52359877560,0.34906585040", angles)), kRounding);
  EXPECT_LT(near(sampleOf("i,j,k,w", quaternion,
                          {.both = {.quaternion = {"i", "j", "k", "w"}}, .axes = "right-up-back"})),
            kRounding);
  EXPECT_LT(near(sampleOf("x,y,z,ox,oy,oz", point,
                          {.both = {.point = kXyz, .origin = {"ox", "oy", "oz"}},
                           .axes = "right-up-back",
                           .origin_scale_m = 1e-3})),
            kRounding);
}

TEST(SpaceLayout, TurnsGazeFromTheWorldToTheHead) {
  // Unity: the head at (1, 2, 3), turned 90 degrees to the right, so that its forward is +x.
  SpaceColumns space{.both = {.point = kXyz},
                     .head_position = kHeadPlace,
                     .head_quaternion = kHead,
                     .frame = SightFrame::world,
                     .axes = "right-up-forward"};
  const std::string head = "1,2,3,0,0.70710678,0,0.70710678,";
  const GazeSample sample = sampleOf("hx,hy,hz,hi,hj,hk,hw,x,y,z", head + "5,2,3", space);
  ASSERT_TRUE(sample.head && sample.direction);
  EXPECT_LT(glm::distance(sample.head->position_m, glm::dvec3(1.0, 2.0, -3.0)), kRounding);
  EXPECT_LT(glm::distance(*sample.direction, glm::dvec3(0.0, 0.0, -1.0)), 1e-7);
  ASSERT_TRUE(sample.point_px);
}

TEST(SpaceLayout, TurnsTheHeadByAngles) {
  // To the right by 90, then up by 30: the head looks at +x, raised.
  SpaceColumns space{.both = {.direction = kXyz},
                     .head_angles = {"yaw", "pitch", "roll"},
                     .frame = SightFrame::head,
                     .axes = "right-up-back"};
  const GazeSample sample = sampleOf("yaw,pitch,roll,x,y,z", "90,30,10,0,0,-1", space);
  ASSERT_TRUE(sample.head);
  const glm::dquat& turn = sample.head->world_from_head;
  EXPECT_LT(glm::distance(turn * glm::dvec3(0.0, 0.0, -1.0), glm::dvec3(std::sqrt(0.75), 0.5, 0.0)),
            kRounding);
  // Rolled to the right: the head's right side points down, here by 10 degrees of the raised one.
  EXPECT_LT((turn * glm::dvec3(1.0, 0.0, 0.0)).y, -0.1);
}

TEST(SpaceLayout, TurnsTheHeadAsUnitysEulerAngles) {
  // Unity turns down about +x, to the right about +y, and lifts the right side about +z.
  SpaceColumns space{.head_euler = {"ex", "ey", "ez"}, .axes = "right-up-forward"};
  space.from_head = true;
  const double cos30 = std::sqrt(0.75), sin30 = 0.5;
  const double cos10 = std::cos(glm::radians(10.0)), sin10 = std::sin(glm::radians(10.0));
  const auto turnOf = [&](const char* row) {
    return sampleOf("ex,ey,ez", row, space).head->world_from_head;
  };
  const glm::dquat turn = turnOf("30,90,10");
  EXPECT_LT(glm::distance(turn * glm::dvec3(0.0, 0.0, -1.0), glm::dvec3(cos30, -sin30, 0.0)),
            kRounding);
  EXPECT_LT(glm::distance(turn * glm::dvec3(1.0, 0.0, 0.0),
                          glm::dvec3(sin10 * sin30, sin10 * cos30, cos10)),
            kRounding);
  // The same orientation as Unity writes it, 0 to 360.
  EXPECT_GT(std::abs(glm::dot(turnOf("350,270,355"), turnOf("-10,-90,-5"))), 1.0 - kRounding);
  // About z first: 90 to the left, so that "downwards" about the new x turns to the right.
  space.head_euler_order = "zxy";
  EXPECT_LT(
      glm::distance(turnOf("30,0,90") * glm::dvec3(0.0, 0.0, -1.0), glm::dvec3(sin30, 0.0, -cos30)),
      kRounding);
}

TEST(SpaceLayout, TakesTheHeadForGazeIfAsked) {
  SpaceColumns space{
      .head_position = kHeadPlace, .head_quaternion = kHead, .axes = "right-up-back"};
  const std::string names = "hx,hy,hz,hi,hj,hk,hw", row = "1,2,3,0,0.70710678,0,0.70710678";
  EXPECT_NE(refusalOf(names, row, space).find("gaze.from_head"), std::string::npos);
  space.from_head = true;
  const GazeSample sample = sampleOf(names, row, space);
  ASSERT_TRUE(sample.head && sample.direction && sample.point_px);
  EXPECT_EQ(*sample.direction, kStraightAhead);
  space.both.direction = {"hx", "hy", "hz"};
  EXPECT_NE(refusalOf(names, row, space).find("no columns of gaze"), std::string::npos);
  space.both = {};
  space.head_position = {};
  space.head_quaternion = {};
  EXPECT_NE(refusalOf(names, row, space).find("gaze.head_quaternion"), std::string::npos);
}

TEST(SpaceLayout, KeepsTheEyesApart) {
  SpaceColumns space{.axes = "right-up-back", .origin_scale_m = 1e-3};
  space.eyes[0] = {.direction = {"lx", "ly", "lz"}, .origin = {"ox", "oy", "oz"}};
  space.eyes[1] = {.direction = {"rx", "ry", "rz"}};
  const GazeSample both =
      sampleOf("lx,ly,lz,ox,oy,oz,rx,ry,rz", "0.1,0,-0.994987,-31,0,0,-0.1,0,-0.994987", space);
  ASSERT_TRUE(both.direction && both.eyes[0].origin_m);
  EXPECT_LT(glm::distance(*both.direction, glm::dvec3(0.0, 0.0, -1.0)), 1e-6);
  EXPECT_NEAR(both.eyes[0].origin_m->x, -0.031, kRounding);
  const GazeSample left = sampleOf("lx,ly,lz,ox,oy,oz,rx,ry,rz", "0,0,-1,-31,0,0,0,0,0", space);
  EXPECT_TRUE(left.eyes[0].direction);
  EXPECT_FALSE(left.eyes[1].direction);
  ASSERT_TRUE(left.direction);
  EXPECT_EQ(*left.direction, *left.eyes[0].direction);
}

TEST(SpaceLayout, RefusesWhatItWouldHaveToGuess) {
  SpaceColumns space = directions("right-up-back");
  space.head_quaternion = kHead;
  const auto refused = [&](const char* row, const char* words) {
    const std::string said = refusalOf("x,y,z,hi,hj,hk,hw", row, space);
    EXPECT_NE(said.find(words), std::string::npos) << row << ": " << said;
  };
  const char* good = "0,0,-1,0,0,0,1";
  refused(good, "gaze.frame");
  space.frame = SightFrame::head;
  EXPECT_EQ(refusalOf("x,y,z,hi,hj,hk,hw", good, space), "");
  refused("0,0,-2,0,0,0,1", "gaze.point");
  refused("0,0,-1,0,0,0,2", "quaternion");
  refused("a,0,-1,0,0,0,1", "expected a number");
  space.axes.reset();
  refused(good, "gaze.axes");
  space.axes = "right-up-back";
  space.head_quaternion = {"hi", "hj", "hk", "hk"};
  refused(good, "twice");
  space.head_quaternion = {"hi", "hj", "hk", "hq"};
  refused(good, "hq");
}

TEST(SpaceLayout, ReadsAnglesFromZeroToAWholeTurn) {
  const SpaceColumns angles{.both = {.angles = {"h", "v"}}, .axes = "right-up-forward"};
  const GazeSample signed_turn = sampleOf("h,v", "-20,-10", angles);
  const GazeSample whole_turn = sampleOf("h,v", "340,350", angles);
  ASSERT_TRUE(signed_turn.direction && whole_turn.direction);
  EXPECT_LT(glm::distance(*signed_turn.direction, *whole_turn.direction), kRounding);
  EXPECT_TRUE(sampleOf("h,v", "0,89", angles).direction);
  EXPECT_NE(refusalOf("h,v", "0,91", angles).find("a quarter turn"), std::string::npos);
  EXPECT_NE(refusalOf("h,v", "0,269", angles).find("a quarter turn"), std::string::npos);
  EXPECT_NE(refusalOf("h,v", "0,420", angles).find("more than a turn"), std::string::npos);
  EXPECT_NE(refusalOf("h,v", "420,0", angles).find("more than a turn"), std::string::npos);

  const SpaceColumns head{
      .head_euler = {"hx", "hy", "hz"}, .from_head = true, .axes = "right-up-forward"};
  const GazeSample turned = sampleOf("hx,hy,hz", "-10,-20,-1", head);
  const GazeSample wrapped = sampleOf("hx,hy,hz", "350,340,359", head);
  ASSERT_TRUE(turned.head && wrapped.head);
  EXPECT_LT(glm::distance(turned.head->world_from_head * kStraightAhead,
                          wrapped.head->world_from_head * kStraightAhead),
            kRounding);
}

TEST(SpaceLayout, WarnsOfAnUnusedConfidence) {
  TraceColumns columns;
  columns.space = directions("right-up-back");
  const std::string text = "time_s,x,y,z,LeftEyeConfidence\n0,0,0,-1,1\n0.01,0,0.1,-0.99,0\n";
  const TraceHeader header =
      streamTrace(ScratchFile(text).path(), columns, kScreen, [](const GazeSample&) {});
  ASSERT_FALSE(header.warnings.empty());
  EXPECT_NE(header.warnings[0].find("\"LeftEyeConfidence\" is unused"), std::string::npos);
}

TEST(SpaceLayout, TakesZerosAndAbsentFieldsForDataLoss) {
  const std::string text =
      "time_s,x,y,z\n0,0,0,-1\n0.01,0,0,0\n0.02,,,\n0.03,nan,nan,nan\n0.04,0,0,-1\n";
  TraceColumns columns;
  columns.space = directions("right-up-back");
  const GazeTrace trace = readTrace(ScratchFile(text).path(), columns, kScreen);
  for (const std::size_t i : {1, 2, 3}) EXPECT_FALSE(trace.samples[i].direction) << i;
  EXPECT_TRUE(trace.samples[4].direction);
}

}  // namespace FOCI_FILE
}  // namespace foci
