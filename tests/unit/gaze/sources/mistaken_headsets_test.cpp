// Recordings of headsets that are described wrongly, or broken: each is refused, or a warning names
// the key to set. They are made here from one good recording, which raises no doubt.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.5313, 0.2989}, .distance_m = 0.6};
constexpr int kRows = 1500;

/// A row of the good recording, in Unity's axes: x right, y up, z forward.
struct Row {
  double time_s = 0.0;
  glm::dvec3 head_m{0.0};
  glm::dquat head{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 angles_deg{0.0};  // of the head: to the right, upwards, roll to the right
  std::array<glm::dvec3, 2> origin_m{}, sight{};  // in the head's frame
  glm::dvec3 world_sight{0.0}, target_m{0.0};     // of both eyes
};

/// A head that walks and turns, and eyes that look at one point after the other, 0.5 to 0.8 m away.
std::vector<Row> goodRows() {
  std::uint64_t state = 7;
  const auto uniform = [&] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 40u) / static_cast<double>(1u << 24u) - 0.5;
  };
  std::vector<Row> rows;
  glm::dvec3 target_head(0.0, 0.0, 0.7);
  for (int i = 0; i < kRows; ++i) {
    Row row{.time_s = i / 100.0};
    row.angles_deg = {70.0 * std::sin(0.7 * row.time_s), 12.0 * std::sin(1.1 * row.time_s) - 5.0,
                      6.0 * std::sin(0.9 * row.time_s)};
    // Unity turns to the right about +y, downwards about +x, and to the left about +z.
    const glm::dvec3 turn = glm::radians(row.angles_deg);
    row.head = glm::angleAxis(turn.x, glm::dvec3(0.0, 1.0, 0.0)) *
               glm::angleAxis(-turn.y, glm::dvec3(1.0, 0.0, 0.0)) *
               glm::angleAxis(-turn.z, glm::dvec3(0.0, 0.0, 1.0));
    row.head_m = {0.3 * std::sin(0.4 * row.time_s), 1.6 + 0.02 * std::sin(3.0 * row.time_s),
                  0.2 * row.time_s};
    if (i % 33 == 0) {
      const double away_m = 0.65 + 0.3 * uniform();
      target_head = away_m * glm::normalize(glm::dvec3(0.6 * uniform(), 0.4 * uniform(), 1.0));
    }
    const glm::dvec3 noise = 0.002 * glm::dvec3(uniform(), uniform(), 0.0);
    for (std::size_t side : {0, 1}) {
      row.origin_m[side] = {side == 0 ? -0.031 : 0.031, 0.0, 0.01};
      row.sight[side] = glm::normalize(target_head - row.origin_m[side] + noise);
    }
    row.world_sight = row.head * glm::normalize(row.sight[0] + row.sight[1]);
    row.target_m = row.head_m + row.head * (target_head + noise);
    rows.push_back(row);
  }
  return rows;
}

const char* const kHeader =
    "time_s,hx,hy,hz,qx,qy,qz,qw,yaw,pitch,roll,lox,loy,loz,rox,roy,roz,lx,ly,lz,rx,ry,rz,wx,wy,wz,"
    "px,py,pz,h,v\n";

/// @param change  makes the mistake
std::string table(const std::function<void(Row&)>& change = {}) {
  std::string text = kHeader;
  for (Row row : goodRows()) {
    if (change) change(row);
    const auto add = [&](double value) {
      char number[40];
      std::snprintf(number, sizeof number, "%.12g", value);
      text += (text.back() == '\n' ? "" : ",") + std::string(number);
    };
    const auto addVector = [&](const glm::dvec3& v) {
      for (int axis : {0, 1, 2}) add(v[axis]);
    };
    add(row.time_s);
    addVector(row.head_m);
    for (const double part : {row.head.x, row.head.y, row.head.z, row.head.w}) add(part);
    addVector(row.angles_deg);
    for (std::size_t side : {0, 1}) addVector(row.origin_m[side]);
    for (std::size_t side : {0, 1}) addVector(row.sight[side]);
    addVector(row.world_sight);
    addVector(row.target_m);
    const glm::dvec3 sight = glm::conjugate(row.head) * row.world_sight;
    add(glm::degrees(std::atan2(sight.x, sight.z)));
    add(glm::degrees(std::asin(sight.y)));
    text += '\n';
  }
  return text;
}

/// Both eyes in the head's frame.
SpaceColumns eyesInHead() {
  SpaceColumns space{.head_position = {"hx", "hy", "hz"},
                     .head_quaternion = {"qx", "qy", "qz", "qw"},
                     .frame = SightFrame::head,
                     .axes = "right-up-forward"};
  space.eyes[0] = {.direction = {"lx", "ly", "lz"}, .origin = {"lox", "loy", "loz"}};
  space.eyes[1] = {.direction = {"rx", "ry", "rz"}, .origin = {"rox", "roy", "roz"}};
  return space;
}

SpaceColumns inWorld() {
  return {.both = {.direction = {"wx", "wy", "wz"}},
          .head_position = {"hx", "hy", "hz"},
          .head_quaternion = {"qx", "qy", "qz", "qw"},
          .frame = SightFrame::world,
          .axes = "right-up-forward"};
}

SpaceColumns anglesInHead() {
  SpaceColumns space = inWorld();
  space.both = {.angles = {"h", "v"}};
  space.frame = SightFrame::head;
  return space;
}

SpaceColumns pointsInWorld() {
  SpaceColumns space = inWorld();
  space.both = {.point = {"px", "py", "pz"}};
  return space;
}

SpaceColumns headByAngles() {
  SpaceColumns space = inWorld();
  space.head_quaternion = {};
  space.head_angles = {"yaw", "pitch", "roll"};
  return space;
}

template <class Change>
SpaceColumns with(SpaceColumns space, const Change& change) {
  change(space);
  return space;
}

/// The refusal, or all warnings; empty: silent.
std::string saidAbout(const std::string& text, const SpaceColumns& space,
                      TraceColumns columns = {}) {
  columns.space = space;
  try {
    std::string said;
    for (const std::string& warning :
         readTrace(ScratchFile(text).path(), columns, kScreen).warnings) {
      said += "- " + warning + "\n";
    }
    return said;
  } catch (const InputError& error) {
    return error.what();
  }
}

struct Mistake {
  const char* what;
  std::string said;
  const char* key;  ///< that the message must name
};

SpaceColumns axes(SpaceColumns space, const char* name) {
  space.axes = name;
  return space;
}

std::vector<Mistake> wrongFramesAndAxes() {
  const std::string good = table();
  const auto frame = [](SpaceColumns space, std::optional<SightFrame> to) {
    space.frame = to;
    return space;
  };
  return {
      {"world for head", saidAbout(good, frame(eyesInHead(), SightFrame::world)), "gaze.frame"},
      {"head for world", saidAbout(good, frame(inWorld(), SightFrame::head)), "gaze.frame"},
      {"points of the world for the head",
       saidAbout(good, frame(pointsInWorld(), SightFrame::head)), "gaze.frame"},
      {"no frame", saidAbout(good, frame(inWorld(), std::nullopt)), "gaze.frame"},
      {"no axes", saidAbout(good, with(inWorld(), [](auto& s) { s.axes.reset(); })), "gaze.axes"},
      {"z backward", saidAbout(good, axes(eyesInHead(), "right-up-back")), "gaze.axes"},
      {"z backward, world", saidAbout(good, axes(inWorld(), "right-up-back")), "gaze.axes"},
      {"y down", saidAbout(good, axes(inWorld(), "right-down-forward")), "gaze.axes"},
      {"y down, eyes", saidAbout(good, axes(eyesInHead(), "right-down-forward")), "gaze.axes"},
      {"x left", saidAbout(good, axes(eyesInHead(), "left-up-forward")), "gaze.axes"},
      {"ROS", saidAbout(good, axes(inWorld(), "forward-left-up")), "gaze.axes"},
      {"Unreal", saidAbout(good, axes(eyesInHead(), "forward-right-up")), "gaze.axes"},
      {"words that are no axes", saidAbout(good, axes(inWorld(), "xyz")), "gaze.axes"},
  };
}

std::vector<Mistake> wrongOrientations() {
  const auto order = [](SpaceColumns space, const ColumnList<4>& columns) {
    space.head_quaternion = columns;
    return space;
  };
  const std::string good = table();
  const auto turned = [](const std::function<glm::dquat(const Row&)>& to) {
    return table([to](Row& row) { row.head = to(row); });
  };
  return {
      {"w first", saidAbout(good, order(eyesInHead(), {"qw", "qx", "qy", "qz"})),
       "gaze.head_quaternion"},
      {"w first, world", saidAbout(good, order(inWorld(), {"qw", "qx", "qy", "qz"})), "gaze.axes"},
      {"y and z exchanged", saidAbout(good, order(inWorld(), {"qx", "qz", "qy", "qw"})),
       "gaze.frame"},
      {"angles as a quaternion", saidAbout(good, order(inWorld(), {"yaw", "pitch", "roll", "qw"})),
       "quaternion"},
      {"a quaternion twice as long",
       saidAbout(turned([](const Row& row) { return 2.0 * row.head; }), inWorld()), "quaternion"},
      {"from world to head",
       saidAbout(table([](Row& row) { row.world_sight = row.head * (row.head * row.world_sight); }),
                 inWorld()),
       "gaze.frame"},
      {"no head at all",
       saidAbout(turned([](const Row&) { return glm::dquat(0.0, 0.0, 0.0, 0.0); }), eyesInHead()),
       "gaze.head_quaternion"},
      {"a place without an orientation",
       saidAbout(good, with(inWorld(), [](auto& s) { s.head_quaternion = {}; })),
       "gaze.head_quaternion"},
      {"quaternion and angles",
       saidAbout(good, with(headByAngles(),
                            [](auto& s) {
                              s.head_quaternion = {"qx", "qy", "qz", "qw"};
                            })),
       "gaze.head_angles"},
      {"head: degrees for rad",
       saidAbout(good, with(headByAngles(), [](auto& s) { s.angle_units = AngleUnit::rad; })),
       "gaze.angle_units"},
      {"head: rad for degrees",
       saidAbout(table([](Row& row) { row.angles_deg = glm::radians(row.angles_deg); }),
                 headByAngles()),
       "gaze.angle_units"},
      {"gaze: degrees for rad",
       saidAbout(good, with(anglesInHead(), [](auto& s) { s.angle_units = AngleUnit::rad; })),
       "gaze.angle_units"},
  };
}

std::vector<Mistake> wrongUnitsAndColumns() {
  const std::string good = table();
  const auto name = [&](auto change) { return saidAbout(good, with(eyesInHead(), change)); };
  return {
      {"head in mm", saidAbout(table([](Row& row) { row.head_m *= 1000.0; }), eyesInHead()),
       "gaze.head_scale_m"},
      {"head in cm", saidAbout(table([](Row& row) { row.head_m *= 100.0; }), eyesInHead()),
       "gaze.head_scale_m"},
      {"head in m, said mm", name([](auto& s) { s.head_scale_m = 1e-4; }), "gaze.head_scale_m"},
      {"head with no place", name([](auto& s) { s.head_position = {}; }), "gaze.head_position"},
      {"eyes in mm",
       saidAbout(table([](Row& row) {
                   for (auto& origin : row.origin_m) origin *= 1000.0;
                 }),
                 eyesInHead()),
       "gaze.origin_scale_m"},
      {"eyes in m, said mm", name([](auto& s) { s.origin_scale_m = 1e-3; }), "gaze.origin_scale_m"},
      {"origins exchanged", name([](auto& s) { std::swap(s.eyes[0].origin, s.eyes[1].origin); }),
       "gaze.left_origin"},
      {"directions exchanged",
       name([](auto& s) { std::swap(s.eyes[0].direction, s.eyes[1].direction); }), "left"},
      {"points for directions", name([](auto& s) {
         s.eyes[0].direction = {"px", "py", "pz"};
       }),
       "gaze.point"},
      {"two directions of one eye", name([](auto& s) {
         s.eyes[0].angles = {"h", "v"};
       }),
       "only one"},
      {"a column that is not there", name([](auto& s) {
         s.eyes[0].direction = {"lx", "ly", "lw"};
       }),
       "lw"},
      {"a column twice", name([](auto& s) {
         s.eyes[0].direction = {"lx", "ly", "ly"};
       }),
       "twice"},
      {"a head alone", name([](auto& s) { s.eyes = {}; }), "gaze.direction"},
      {"a column of text",
       saidAbout(std::string(good).replace(good.find('\n') + 1, 1, "left"), eyesInHead()), "time"},
  };
}

std::vector<Mistake> wrongClocksAndLoss() {
  const std::string good = table();
  const auto timed = [](const std::function<double(double)>& to) {
    return saidAbout(table([to](Row& row) { row.time_s = to(row.time_s); }), eyesInHead());
  };
  const auto seen = [](const std::function<void(Row&)>& change) {
    return saidAbout(table(change), eyesInHead());
  };
  const auto all = [](const glm::dvec3& sight) {
    return [sight](Row& row) { row.sight = {sight, sight}; };
  };
  TraceColumns positions;
  positions.x = "h";
  positions.y = "v";
  return {
      {"milliseconds for seconds", timed([](double t) { return 1000.0 * t; }), "unit of time"},
      {"time runs back", timed([](double t) { return 20.0 - t; }), "time"},
      {"time stands still", timed([](double) { return 1.0; }), "time"},
      {"a clock that jumps a year", timed([](double t) { return t < 7.0 ? t : t + 3.2e7; }),
       "a day"},
      {"all lost", seen(all(glm::dvec3(0.0))), "no sample has"},
      {"straight ahead all the time", seen(all(glm::dvec3(0.0, 0.0, 1.0))), "hardly moves"},
      {"-1 for data loss", seen([](Row& row) {
         if (row.time_s > 5.0 && row.time_s < 6.0) row.sight[0] = glm::dvec3(-1.0);
       }),
       "gaze.missing"},
      {"most of it lost", seen([](Row& row) {
         if (row.time_s > 5.0) row.sight = {};
       }),
       "gaze.missing"},
      {"a position, too", saidAbout(good, eyesInHead(), positions), "gaze.x"},
  };
}

TEST(MistakenHeadsets, TheGoodOneRaisesNoDoubt) {
  const std::string good = table();
  EXPECT_EQ(saidAbout(good, eyesInHead()), "");
  EXPECT_EQ(saidAbout(good, inWorld()), "");
  EXPECT_EQ(saidAbout(good, anglesInHead()), "");
  EXPECT_EQ(saidAbout(good, pointsInWorld()), "");
  EXPECT_EQ(saidAbout(good, headByAngles()), "");
}

TEST(MistakenHeadsets, AllFormsGiveTheSameGaze) {
  const std::string good = table();
  const auto samplesOf = [&](const SpaceColumns& space) {
    TraceColumns columns;
    columns.space = space;
    return readTrace(ScratchFile(good).path(), columns, kScreen).samples;
  };
  constexpr double kDigits = 1e-6;  // nine of the table
  const auto expected = samplesOf(inWorld());
  for (const SpaceColumns& space : {eyesInHead(), anglesInHead(), headByAngles()}) {
    const auto samples = samplesOf(space);
    for (std::size_t i = 0; i < samples.size(); i += 100) {
      EXPECT_LT(glm::distance(*samples[i].direction, *expected[i].direction), kDigits) << i;
      const double turn =
          std::abs(glm::dot(samples[i].head->world_from_head, expected[i].head->world_from_head));
      EXPECT_GT(turn, 1.0 - kDigits) << i;
    }
  }
}

TEST(MistakenHeadsets, NoneIsSilentAndEachNamesWhatToDo) {
  std::vector<Mistake> all;
  for (const auto& some :
       {wrongFramesAndAxes(), wrongOrientations(), wrongUnitsAndColumns(), wrongClocksAndLoss()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  EXPECT_GE(all.size(), 40u);
  for (const Mistake& mistake : all) {
    EXPECT_NE(mistake.said.find(mistake.key), std::string::npos)
        << mistake.what << ": \"" << mistake.said << "\" does not name " << mistake.key;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
