// Tables of vendors and labs that look like others. The values are made up.
#include <gtest/gtest.h>

#include <string>

#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"
#include "tests/unit/gaze/sources/read_tables.h"

namespace foci {
namespace FOCI_FILE {

GazeTrace read(const std::string& text, const TraceColumns& columns = {}) {
  return readTrace(ScratchFile(text).path(), columns, {});
}

/// So many rows, where N is the number of the row.
std::string rowsOf(const std::string& pattern, int count = 64) {
  std::string rows;
  for (int i = 0; i < count; ++i) {
    for (const char c : pattern) rows += c == 'N' ? std::to_string(i + 1) : std::string(1, c);
    rows += '\n';
  }
  return rows;
}

bool warnsOf(const TraceFacts& trace, const std::string& part) {
  for (const std::string& warning : trace.warnings) {
    if (warning.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(MistakenTable, PixelsOfASceneCameraAreNotThoseOfAScreen) {
  const std::string lab =
      "Recording timestamp [ms]\tSensor\tGaze point X\tGaze point Y\tValidity left\tValidity "
      "right\t";
  const std::string row = "N0\tEye Tracker\t53N\t576\tValid\tValid\t";
  for (const char* glasses : {"Recording media width", "Gaze point 3D X", "Gyro X"}) {
    EXPECT_TRUE(warnsOf(read(lab + glasses + "\n" + rowsOf(row + "1920")), "scene camera"))
        << glasses;
  }
  const GazeTrace screen = read(lab + "Recording resolution width\tRecording resolution height\n" +
                                rowsOf(row + "1920\t1080"));
  EXPECT_FALSE(warnsOf(screen, "scene camera"));

  const std::string smi =
      "RecordingTime [ms],Trial,Category Binocular,Point of Regard Binocular X [px],Point of "
      "Regard Binocular Y [px]";
  const std::string smi_row = "N0,Trial001,Fixation,53N.2,576.1";
  EXPECT_TRUE(warnsOf(read(smi + ",Video Time [h:m:s:ms]\n" + rowsOf(smi_row + ",00:00:00:000")),
                      "scene camera"));
  EXPECT_FALSE(warnsOf(read(smi + "\n" + rowsOf(smi_row)), "scene camera"));
}

TEST(MistakenTable, DirectionsOfGlassesNeedNoPositionsOfThePupils) {
  for (const bool has_units : {false, true}) {
    std::string header = "Recording timestamp [ms]\tSensor\tGaze point X";
    if (!has_units) header += "\tRecording media width";
    for (const std::string eye : {"left", "right"}) {
      for (const std::string axis : {"X", "Y", "Z"}) {
        header.append("\tGaze direction ").append(eye).append(" ").append(axis);
        if (has_units) header += " [HUCS norm]";
      }
    }
    // The head unit's axes point to the left, up and forward.
    const GazeTrace trace =
        read(header + "\n" +
             rowsOf(std::string("N0\tEye Tracker\t53N") + (has_units ? "" : "\t1920") +
                    "\t0.6\t0\t0.8\t0.6\t0\t0.8"));
    EXPECT_EQ(trace.format, "Tobii Pro Lab, glasses, binocular");
    ASSERT_TRUE(trace.samples[0].direction);
    EXPECT_LT(glm::distance(*trace.samples[0].direction, glm::dvec3(-0.6, 0.0, -0.8)), 1e-12);
  }
}

TEST(MistakenTable, UnitsOfAnglesAreReadAsTheyStand) {
  // A screen of 2 x 1 m and 2000 x 1000 px, 1 m away: its edge lies 45 degrees to the right.
  const Screen screen{.size_px = {2000, 1000}, .size_m = {2.0, 1.0}, .distance_m = 1.0};
  const auto point = [&](const std::string& unit, const std::string& value,
                         const TraceColumns& columns = {}) {
    const std::string text =
        "time (msecs),gaze_x " + unit + ",gaze_y " + unit + "\n" + rowsOf("N0," + value + ",0");
    const GazeTrace trace = readTrace(ScratchFile(text).path(), columns, screen);
    EXPECT_DOUBLE_EQ(trace.samples[1].time_s - trace.samples[0].time_s, 0.01) << unit;
    return *trace.samples[0].point_px;
  };
  for (const auto& [unit, value] : {std::pair("(arcmin)", "2700"),
                                    {"[mrad]", "785.39816339744831"},
                                    {"[rad]", "0.78539816339744831"},
                                    {"(degs)", "45"},
                                    {"[\xc2\xb0]", "45"},
                                    {"(visual angle)", "45"},
                                    {"(degrees of visual angle)", "45"}}) {
    EXPECT_LT(glm::distance(point(unit, value), glm::dvec2(2000, 500)), 1e-9) << unit;
  }
  TraceColumns own;
  own.scale = glm::dvec2(1.0 / 60.0);
  EXPECT_LT(glm::distance(point("(arcmin)", "2700", own), glm::dvec2(2000, 500)), 1e-9);
}

TEST(MistakenTable, AnUnknownUnitIsSaidToBeOne) {
  const auto headerOf = [](const std::string& unit) {
    const std::string text =
        "time_s,gaze_x " + unit + ",gaze_y " + unit + "\n" + rowsOf("N,63N.5,583.1");
    return streamTrace(ScratchFile(text).path(), {}, {}, [](const GazeSample&) {});
  };
  for (const char* unit : {"(mV)", "[vw]", "(stage units)"}) {
    const TraceHeader header = headerOf(unit);
    EXPECT_TRUE(warnsOf(header, "unknown unit")) << unit;
    EXPECT_EQ(header.columns[1].why, "a guess: its unit is unknown") << unit;
  }
  for (const char* none : {"(left)", "(n/a)", "[Screenshot 1]", "[0-1]", "(raw)", "(both eyes)"}) {
    const TraceHeader header = headerOf(none);
    EXPECT_FALSE(warnsOf(header, "unknown unit")) << none;
    EXPECT_EQ(header.columns[1].why, "a guess: its name has no unit") << none;
  }
  const std::string inches = "time_s,gaze_x [in],gaze_y [in]\n" + rowsOf("N,6.5,5.1");
  EXPECT_NE(refusal(inches).find("gaze.scale"), std::string::npos);
}

// psychopy_tobii_controller writes names of Tobii Studio, and PsychoPy's units from the middle.
TEST(MistakenTable, PsychoPysPositionsFromTheMiddleAreNotTobiiStudios) {
  const GazeTrace trace = read(
      "TimeStamp\tGazePointXLeft\tGazePointYLeft\tPupilLeft\tValidityLeft\tGazePointXRight\t"
      "GazePointYRight\tPupilRight\tValidityRight\tGazePointX\tGazePointY\n" +
      rowsOf("N6.7\t-434.1\t-36.N\t3.1\t1\t-417.9\t-36.N\t3.3\t1\t-425.4\t-36.N"));
  EXPECT_EQ(trace.format, "TSV, binocular");
  EXPECT_TRUE(warnsOf(trace, "from the middle of the screen"));
}

TEST(MistakenTable, AVendorsPixelsAboutZeroWarn) {
  const std::string lab =
      "Recording timestamp [ms]\tSensor\tGaze point X\tGaze point Y\tValidity left\tValidity "
      "right\n";
  const std::string row = "N0\tEye Tracker\t";
  const std::string end = "576\tValid\tValid";
  EXPECT_TRUE(warnsOf(read(lab + rowsOf(row + "-53N\t" + end)), "from the middle"));
  EXPECT_FALSE(warnsOf(read(lab + rowsOf(row + "53N\t" + end)), "from the middle"));
}

// Gazepoint keeps the last position of a lost eye.
TEST(MistakenTable, AKeptPositionIsNoSignThatAnEyeIsValid) {
  const std::string header =
      "TIME,BPOGX,BPOGY,BPOGV,LPOGX,LPOGY,LPOGV,RPOGX,RPOGY,RPOGV,LPMM,RPMM\n";
  const auto rows = [](const std::string& x, char valid, int count) {
    const std::string eye = "0.4" + x + ",0.5," + valid;
    return rowsOf("N," + eye + "," + eye + "," + eye + ",3,3", count);
  };
  const auto isGood = [&](const std::string& text) {
    std::string timed = header;
    int number = 0;
    for (std::size_t at = 0; at < text.size(); ++number) {
      const std::size_t end = text.find('\n', at), comma = text.find(',', at);
      timed += std::to_string(number / 60.0) + text.substr(comma, end + 1 - comma);
      at = end + 1;
    }
    return read(timed).samples.back().eyes[0].point_px.has_value();
  };
  EXPECT_TRUE(isGood(rows("N", '1', 100) + rows("", '0', 3000) + rows("N", '1', 100)));
  // Lost with a position that moves: a warning of the rows that follow would come too late.
  EXPECT_TRUE(isGood(rows("N", '0', 3000) + rows("N", '1', 100)));
  EXPECT_FALSE(isGood(rows("N", '0', 3000) + rows("", '1', 100)));
}

TEST(MistakenTable, AnUnknownWordOfValidityIsRefused) {
  const std::string text =
      "time_ms,left_gaze_x,left_gaze_y,left_validity,right_gaze_x,right_gaze_y,right_validity\n" +
      rowsOf("N0,53N,576,Valid,54N,577,invalid") + "650,531,576,G\xc3\xbcltig,541,577,Valid\n";
  const std::string refused = refusal(text);
  EXPECT_NE(refused.find(":66: column 4 = \"G\xc3\xbcltig\": expected"), std::string::npos)
      << refused;
}

TEST(MistakenTable, DirectionsWithoutAxesAndFrameAskForThem) {
  const auto header = [](const std::string& unit) {
    std::string text = "time_ms";
    for (const std::string column : {"origin_", "direction_"}) {
      for (const char* axis : {"x", "y", "z"}) {
        text.append(",left_").append(column).append(axis);
        if (column == "origin_") text += unit;
      }
    }
    return text + "\n";
  };
  // Straight ahead in OpenXR's axes, and in those of docs/calibration.md.
  const std::string rows = rowsOf("N0,0.03,1.6,0.1,0,0.0N,-1");
  for (const char* unit : {"", "_m"}) {
    const std::string refused = refusal(header(unit) + rows);
    EXPECT_NE(refused.find("gaze.axes and gaze.frame"), std::string::npos) << refused;
  }
  EXPECT_TRUE(read(header("_mm") + rows).samples[0].eyes[0].direction);
}

TEST(MistakenTable, RowNumbersWithoutANameAreNoField) {
  for (const char* text :
       {"\"time\" \"x\" \"y\"\n\"1\" 0.00 534.6 576.2\n\"2\" 0.01 535.6 577.2\n",
        "   time      x      y\n0  0.00  534.6  576.2\n1  0.01  535.6  577.2\n"}) {
    const GazeTrace trace = read(text);
    ASSERT_EQ(trace.samples.size(), 2u);
    expectPoint(trace.samples[1].point_px, 535.6, 577.2);
  }
  EXPECT_NE(refusal("time x y\n0 0.00 534.6 576.2\n1 0.01 535.6 577.2\n").find("4 fields"),
            std::string::npos);
}

TEST(MistakenTable, EPrimesTablesOfTobiiHaveFractionsAndMilliseconds) {
  const GazeTrace trace = readTrace(
      ScratchFile("TETTime\tRTTime\tXGazePosLeftEye\tYGazePosLeftEye\tDiameterPupilLeftEye\t"
                  "ValidityLeftEye\tXGazePosRightEye\tYGazePosRightEye\tDiameterPupilRightEye\t"
                  "ValidityRightEye\n"
                  "1000.5\t1\t0.25\t0.5\t3\t0\t0.75\t0.5\t3.2\t0\n"
                  "1017.5\t2\t-1\t-1\t-1\t4\t0.75\t0.5\t3.2\t0\n")
          .path(),
      {}, {.size_px = {1000, 500}});
  EXPECT_EQ(trace.format, "E-Prime, Tobii, binocular");
  expectPoint(trace.samples[0].point_px, 500, 250);
  EXPECT_DOUBLE_EQ(*trace.samples[0].pupil_mm, 3.1);
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_NEAR(trace.samples[1].time_s - trace.samples[0].time_s, 0.017, 1e-12);
}

}  // namespace FOCI_FILE
}  // namespace foci
