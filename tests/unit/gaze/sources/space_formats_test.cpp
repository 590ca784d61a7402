// Vendors' tables of gaze in space, written here from their documentation.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kDigits = 1e-5;  // of the tables
const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.5313, 0.2989}, .distance_m = 0.6};

/// Both eyes look 0.1 to the right, 0.2 up for 1 ahead, in foci's axes.
const glm::dvec3 kSight = glm::normalize(glm::dvec3(0.1, 0.2, -1.0));

void expectSight(const GazeSample& sample) {
  ASSERT_TRUE(sample.direction);
  EXPECT_LT(glm::distance(*sample.direction, kSight), kDigits);
  ASSERT_TRUE(sample.eyes[0].origin_m && sample.eyes[1].origin_m);
  EXPECT_NEAR(sample.eyes[0].origin_m->x, -0.032, kDigits);
  EXPECT_NEAR(sample.eyes[1].origin_m->x, 0.032, kDigits);
}

/// A direction with x to the left and z forward.
std::string leftForward(char delimiter) {
  char text[80];
  std::snprintf(text, sizeof text, "%.7f%c%.7f%c%.7f", -kSight.x, delimiter, kSight.y, delimiter,
                -kSight.z);
  return text;
}

/// As the recorder of Imaoka et al. (2020) writes, in milliseconds of SRanipal's clock.
std::string sranipal(int valid_right) {
  std::string text =
      "time(100ns),time_stamp(ms),frame,eye_valid_L,eye_valid_R,openness_L,openness_R,"
      "pupil_diameter_L(mm),pupil_diameter_R(mm),gaze_origin_L.x(mm),gaze_origin_L.y(mm),"
      "gaze_origin_L.z(mm),gaze_origin_R.x(mm),gaze_origin_R.y(mm),gaze_origin_R.z(mm),"
      "gaze_direct_L.x,gaze_direct_L.y,gaze_direct_L.z,gaze_direct_R.x,gaze_direct_R.y,"
      "gaze_direct_R.z\n";
  for (int i = 0; i < 4; ++i) {
    text += std::to_string(637000000000000000 + 83333LL * i) + "," + std::to_string(5000 + 8 * i) +
            "," + std::to_string(i) + ",31," + std::to_string(valid_right) +
            ",1,1,3.5,3.7,32,0,-45,-32,0,-45," + leftForward(',') + "," +
            (valid_right == 31 ? leftForward(',') : "-1,-1,-1") + "\n";
  }
  return text;
}

TEST(SpaceFormats, ReadSRanipal) {
  const GazeTrace trace = readTrace(ScratchFile(sranipal(31)).path(), {}, kScreen);
  EXPECT_EQ(trace.format, "SRanipal, binocular");
  expectSight(trace.samples[1]);
  EXPECT_NEAR(trace.samples[1].time_s - trace.samples[0].time_s, 0.008, 1e-9);
  EXPECT_EQ(trace.samples[0].eyes[1].pupil_mm, 3.7);
  EXPECT_FALSE(trace.samples[0].head);
}

TEST(SpaceFormats, StateThatSRanipalsValidityIsUsed) {
  const TraceHeader header =
      streamTrace(ScratchFile(sranipal(31)).path(), {}, kScreen, [](const GazeSample&) {});
  EXPECT_EQ(header.columns.at(3).columns, "eye_valid_L");
  EXPECT_EQ(header.columns[3].meaning, "whether the left eye is valid");
  EXPECT_EQ(header.columns[4].meaning, "whether the right eye is valid");
}

// The gaze pose of the second moment is 0, rotation included, as in a blink.
TEST(SpaceFormats, ABlinkOfEyeNavGsIsDataLoss) {
  const auto text = [](const std::string& head) {
    std::string rows =
        "ViewIndex,FOV1,FOV2,FOV3,FOV4,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,"
        "QuaternionZ,QuaternionW,GazePosX,GazePosY,GazePosZ,GazeQX,GazeQY,GazeQZ,GazeQW,"
        "Timestamp\n";
    for (int i = 0; i < 4; ++i) {
      for (const char* side : {"0", "1"}) {
        rows += std::string(side) + ",-0.8,0.8,-0.8,0.8,0,1.6,0," + (i == 1 ? head : "0,0,0,1") +
                (i == 1 ? ",0,0,0,0,0,0,0," : ",0,1.6,0,0,0.01,0,1,") + std::to_string(20 * i) +
                "\n";
      }
    }
    return rows;
  };
  const GazeTrace trace = readTrace(ScratchFile(text("0,0,0,1")).path(), {}, kScreen);
  ASSERT_EQ(trace.samples.size(), 4u);
  EXPECT_FALSE(trace.samples[1].direction || trace.samples[1].eyes[0].direction);
  EXPECT_TRUE(trace.samples[1].head);
  EXPECT_TRUE(trace.samples[2].direction);
  EXPECT_THROW(readTrace(ScratchFile(text("0,0,0,0")).path(), {}, kScreen), InputError)
      << "a head without orientation";
}

TEST(SpaceFormats, TakeTheHeadOfUnityBesideSRanipal) {
  std::string text = sranipal(31), with_head;
  for (std::size_t at = 0, row = 0; at < text.size(); ++row) {
    const std::size_t end = text.find('\n', at);
    with_head += text.substr(at, end - at) +
                 (row ? ",1,2,3,0,0.7071068,0,0.7071068\n" : ",hx,hy,hz,qx,qy,qz,qw\n");
    at = end + 1;
  }
  TraceColumns columns;
  columns.space.head_position = {"hx", "hy", "hz"};
  columns.space.head_quaternion = {"qx", "qy", "qz", "qw"};
  columns.space.axes = "right-up-forward";
  const GazeTrace trace = readTrace(ScratchFile(with_head).path(), columns, kScreen);
  expectSight(trace.samples[1]);
  ASSERT_TRUE(trace.samples[1].head);
  const HeadInWorld& head = *trace.samples[1].head;
  EXPECT_LT(glm::distance(head.position_m, glm::dvec3(1.0, 2.0, -3.0)), kDigits);
  const glm::dvec3 ahead = head.world_from_head * glm::dvec3(0.0, 0.0, -1.0);
  EXPECT_LT(glm::distance(ahead, glm::dvec3(1.0, 0.0, 0.0)), kDigits);
  columns.space.axes.reset();
  EXPECT_THROW(readTrace(ScratchFile(with_head).path(), columns, kScreen), InputError);
}

TEST(SpaceFormats, LoseAnEyeThatSRanipalMarksInvalid) {
  // Bits 1 and 2 of 5 and 4: not both of origin and direction.
  for (const int valid : {0, 4, 5}) {
    const std::string text = sranipal(31);
    const GazeTrace trace =
        readTrace(ScratchFile([&] {
                    std::string broken = text;
                    for (std::size_t at = 0; (at = broken.find(",31,31,", at)) != broken.npos;) {
                      broken.replace(at, 7, ",31," + std::to_string(valid) + ",");
                    }
                    return broken;
                  }())
                      .path(),
                  {}, kScreen);
    EXPECT_TRUE(trace.samples[0].eyes[0].direction) << valid;
    EXPECT_FALSE(trace.samples[0].eyes[1].direction) << valid;
    EXPECT_TRUE(trace.samples[0].direction) << valid;
  }
}

TEST(SpaceFormats, ReadGlassesFromTobiiProLab) {
  std::string text =
      "Recording timestamp [\xce\xbcs]\tSensor\tGaze point X [MCS px]\t"
      "Gaze point Y [MCS px]";
  for (const char* what :
       {"Gaze direction left %c [HUCS norm]", "Gaze direction right %c [HUCS norm]",
        "Pupil position left %c [HUCS mm]", "Pupil position right %c [HUCS mm]"}) {
    for (const char axis : {'X', 'Y', 'Z'}) {
      std::string name = what;
      name.replace(name.find("%c"), 2, 1, axis);
      text += "\t" + name;
    }
  }
  text += "\tPupil diameter left [mm]\tPupil diameter right [mm]\tValidity left\tValidity right\n";
  for (int i = 0; i < 4; ++i) {
    text += std::to_string(20000 * i) + "\tEye Tracker\t900\t500\t" + leftForward('\t') + "\t" +
            leftForward('\t') + "\t32\t-20\t-30\t-32\t-20\t-30\t3.1\t3.2\tValid\tValid\n";
    text += std::to_string(20000 * i + 100) + "\tGyroscope\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\n";
  }
  const GazeTrace trace = readTrace(ScratchFile(text).path(), {}, kScreen);
  EXPECT_EQ(trace.format, "Tobii Pro Lab, glasses, binocular");
  ASSERT_EQ(trace.samples.size(), 4u);
  expectSight(trace.samples[1]);
  EXPECT_NEAR(trace.samples[1].time_s, 0.02, 1e-9);
  EXPECT_EQ(trace.samples[0].eyes[0].pupil_mm, 3.1);
}

TEST(SpaceFormats, ReadGazeBaseVr) {
  // Both eyes look at a point 0.5 m ahead of the middle between them, 0.05 m to the right of it.
  const double left_deg = glm::degrees(std::atan2(0.05 + 0.032, 0.5));
  const double right_deg = glm::degrees(std::atan2(0.05 - 0.032, 0.5));
  std::string text = "n,x,y,lx,ly,rx,ry,xT,yT,zT,clx,cly,clz,crx,cry,crz\n";
  for (int i = 0; i < 4; ++i) {
    char row[200];
    std::snprintf(row, sizeof row,
                  "%d,5.7106,0,%.7f,0,%.7f,0,0.05,0,0.47,-0.032,0.003,-0.03,0.032,0.003,-0.03\n",
                  4 * i, left_deg, right_deg);
    text += row;
  }
  const GazeTrace trace = readTrace(ScratchFile(text).path(), {}, kScreen);
  EXPECT_EQ(trace.format, "GazeBaseVR, binocular");
  const GazeSample& sample = trace.samples[1];
  EXPECT_NEAR(sample.time_s, 0.004, 1e-9);
  ASSERT_TRUE(sample.eyes[0].direction && sample.eyes[1].direction && sample.direction);
  for (const EyeSample& eye : sample.eyes) {
    const glm::dvec3 at_m = *eye.origin_m + *eye.direction * (0.5 / -eye.direction->z);
    EXPECT_LT(glm::distance(at_m, glm::dvec3(0.05, 0.003, -0.47)), kDigits);
  }
  EXPECT_NEAR(glm::degrees(std::atan(sample.direction->x / -sample.direction->z)), 5.7106, 1e-9);
}

/// A row of Stream Recorder: the head at (1, 2, 3), turned by 90 degrees to the right.
std::string holoLensRow(int i, bool gaze) {
  std::string row = std::to_string(132500000000000000 + 333333LL * i);
  for (const double value :
       {0.0, 0.0, -1.0, 1.0, 0.0, 1.0, 0.0, 2.0, 1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1.0}) {
    row += "," + std::to_string(value);
  }
  for (int k = 0; k < 2 * 417; ++k) row += ",0";
  // Ahead of that head is +x; gaze is 0.1 to its right (+z), 0.2 up.
  row += gaze ? ",1,1,2,3,1,1,0.2,0.1,0,1.5" : ",0,0,0,0,0,0,0,0,0,0";
  return row + "\n";
}

TEST(SpaceFormats, ReadHoloLens) {
  const GazeTrace trace = readTrace(
      ScratchFile(holoLensRow(0, true) + holoLensRow(1, false) + holoLensRow(2, true)).path(), {},
      kScreen);
  EXPECT_EQ(trace.format, "HoloLens 2, Stream Recorder");
  ASSERT_EQ(trace.samples.size(), 3u);
  ASSERT_TRUE(trace.samples[0].head && trace.samples[0].direction);
  EXPECT_LT(glm::distance(trace.samples[0].head->position_m, glm::dvec3(1.0, 2.0, 3.0)), kDigits);
  EXPECT_LT(glm::distance(*trace.samples[0].direction, kSight), kDigits);
  EXPECT_FALSE(trace.samples[1].direction);
  EXPECT_TRUE(trace.samples[1].head);
  EXPECT_NEAR(trace.samples[2].time_s, 0.0666666, 1e-5);
  EXPECT_TRUE(previewSpace(ScratchFile(holoLensRow(0, true)).path(), {}).has_head);
}

TEST(SpaceFormats, TheLastLineOfAHoloLensMayBeCutOff) {
  const std::string rows = holoLensRow(0, true) + holoLensRow(1, true),
                    cut = "132500000000666666,1";
  const GazeTrace trace = readTrace(ScratchFile(rows + cut).path(), {}, kScreen);
  EXPECT_EQ(trace.samples.size(), 2u);
  ASSERT_FALSE(trace.warnings.empty());
  EXPECT_NE(trace.warnings.back().find("cut off"), std::string::npos);
  EXPECT_THROW(readTrace(ScratchFile(rows + cut + "\n" + holoLensRow(3, true)).path(), {}, kScreen),
               InputError);
  const GazeTrace head =
      readTrace(ScratchFile(rows).path(), {.space = {.from_head = true}}, kScreen);
  EXPECT_EQ(head.samples[0].direction, glm::dvec3(0.0, 0.0, -1.0));
}

TEST(SpaceFormats, RefuseAHoloLensHeadThatIsNotRigid) {
  std::string row = holoLensRow(0, true);
  row.replace(row.find(",0.0"), 4, ",0.5");
  EXPECT_THROW(readTrace(ScratchFile(row + holoLensRow(1, true)).path(), {}, kScreen), InputError);
}

}  // namespace FOCI_FILE
}  // namespace foci
