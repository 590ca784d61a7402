// Tables whose rows are not all one eye of one person.
#include "gaze/sources/table_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr int kSamples = 600;
constexpr double kRate_Hz = 60.0;

std::string row(double time_s, const std::string& group, double x, double y) {
  return std::to_string(time_s) + "," + group + "," + std::to_string(x) + "," + std::to_string(y) +
         "\n";
}

/// A new point each half second, some noise.
double gazeX(int i) { return 400.0 + 300.0 * (i / 30 % 4) + i % 3; }

std::string twoPeople(const std::string& column, bool interleaved) {
  std::string text = "time_s," + column + ",x_px,y_px\n";
  std::string second;
  for (int i = 0; i < kSamples; ++i) {
    const double time_s = i / kRate_Hz;
    text += row(time_s, "A", gazeX(i), 300.0 + i % 2);
    std::string& other = interleaved ? text : second;
    other += row(time_s + (interleaved ? 0.5 / kRate_Hz : 100.0), "B", 1800.0 - gazeX(i), 900.0);
  }
  return text + second;
}

GazeTrace read(const std::string& text, const TraceColumns& columns = {}) {
  return readTrace(ScratchFile(text).path(), columns, {});
}

bool warns(const GazeTrace& trace, const std::string& of) {
  return std::ranges::any_of(trace.warnings, [&](const std::string& warning) {
    return warning.find(of) != std::string::npos;
  });
}

std::string refusal(const std::string& text, const TraceColumns& columns = {}) {
  try {
    read(text, columns);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(RowGroups, SeveralPeopleAreRefusedByNameAndEachCanBeRead) {
  for (const char* column :
       {"participant", "Subject ID", "user", "RECORDING_SESSION_LABEL", "who"}) {
    for (const bool interleaved : {true, false}) {
      const std::string text = twoPeople(column, interleaved);
      if (!interleaved && std::string(column) == "who") continue;  // its name tells nothing
      const std::string said = refusal(text);
      EXPECT_NE(said.find("\"A\", \"B\""), std::string::npos) << column << ": " << said;
      EXPECT_NE(said.find("gaze.rows"), std::string::npos) << said;
      for (const char* person : {"A", "B"}) {
        const GazeTrace trace = read(text, {.rows = {{column, person}}});
        EXPECT_EQ(trace.samples.size(), kSamples);
        EXPECT_NEAR(trace.rate_Hz, kRate_Hz, 0.1);
      }
      EXPECT_NE(refusal(text, {.rows = {{column, "C"}}}).find("\"A\""), std::string::npos);
      EXPECT_EQ(peopleOf(ScratchFile(text).path(), {}).size(), 2u);
    }
  }
  EXPECT_TRUE(
      peopleOf(ScratchFile("time_s,participant,x_px,y_px\n0,A,1,2\n1,A,1,2\n").path(), {}).empty());
}

TEST(RowGroups, AColumnOfAnyNameMayTellPeopleApart) {
  for (const char* column : {"name", "session", "who", "Datei"}) {
    std::string text = "time_s," + std::string(column) + ",x_px,y_px\n";
    std::string anew = text;
    for (int i = 0; i < 2 * kSamples; ++i) {
      const std::string who = i < kSamples ? "anna" : "ben";
      text += row(i / kRate_Hz, who, gazeX(i), 300.0 + i % 2);
      anew += row(i % kSamples / kRate_Hz, who, gazeX(i), 300.0 + i % 2);
    }
    const GazeTrace trace = read(text);
    EXPECT_TRUE(warns(trace, "\"anna\", \"ben\"")) << column;
    const TraceColumns ben{.rows = {{column, "ben"}}};
    EXPECT_FALSE(warns(read(text, ben), "anna"));
    EXPECT_EQ(read(text, ben).samples.size(), kSamples);

    const std::string said = refusal(anew);
    EXPECT_NE(said.find(std::string("column \"") + column + "\": \"anna\", \"ben\""),
              std::string::npos)
        << said;
    EXPECT_EQ(peopleOf(ScratchFile(anew).path(), {}).size(), 2u);
  }
}

TEST(RowGroups, PartsOfAnExperimentAreNotPeople) {
  for (const char* column : {"trial", "stimulus_name", "battery", "eye_state"}) {
    std::string text = "time_s," + std::string(column) + ",x_px,y_px\n";
    for (int i = 0; i < 3 * kSamples; ++i) {
      text += row(i / kRate_Hz, std::to_string(9 - i / kSamples), gazeX(i), 300.0 + i % 2);
    }
    EXPECT_FALSE(warns(read(text), "one after another")) << column;
  }
}

TEST(RowGroups, OneRowForEachEyeIsOneSampleOfBoth) {
  for (const auto& [left, right] : {std::pair("L", "R"), {"left", "right"}, {"0", "1"}}) {
    for (const double late_s : {0.0, 0.004}) {
      std::string text = "time_s,eye,x_px,y_px\n";
      for (int i = 0; i < kSamples; ++i) {
        text += row(i / kRate_Hz, left, gazeX(i), 300.0);
        text += row(i / kRate_Hz + late_s, right, gazeX(i) + 10.0, 302.0);
      }
      const GazeTrace trace = read(text);
      EXPECT_EQ(trace.format, "CSV, binocular");
      ASSERT_EQ(trace.samples.size(), kSamples) << left;
      EXPECT_NEAR(trace.rate_Hz, kRate_Hz, 0.1);
      const GazeSample& sample = trace.samples[100];
      EXPECT_EQ(*sample.eyes[0].point_px, glm::dvec2(gazeX(100), 300.0));
      EXPECT_EQ(*sample.eyes[1].point_px, glm::dvec2(gazeX(100) + 10.0, 302.0));
      EXPECT_EQ(*sample.point_px, glm::dvec2(gazeX(100) + 5.0, 301.0));
    }
  }
}

TEST(RowGroups, RowsOfBothEyesTogetherAreLeftOut) {
  std::string text = "time_s,eye,x_px,y_px\n";
  for (int i = 0; i < kSamples; ++i) {
    for (const char* eye : {"L", "R", "B"}) text += row(i / kRate_Hz, eye, gazeX(i), 300.0);
  }
  const GazeTrace trace = read(text);
  EXPECT_EQ(trace.format, "CSV, binocular");
  EXPECT_EQ(trace.samples.size(), kSamples);
}

TEST(RowGroups, TheSideOfAStimulusIsNoEye) {
  std::string text = "time_s,target,x_px,y_px\n";
  for (int i = 0; i < kSamples; ++i) {
    text += row(i / kRate_Hz, i / 60 % 2 == 0 ? "left" : "right", gazeX(i), 300.0);
  }
  EXPECT_EQ(read(text).format, "CSV");
}

TEST(RowGroups, EyesMeasuredInTurnAreSamplesOfTheirOwn) {
  std::string text = "time_s,eye_id,x_px,y_px\n";
  for (int i = 0; i < kSamples; ++i) {
    char time[16];
    std::snprintf(time, sizeof time, "%.5f", i / 240.0);  // rounded: intervals of 4.16 and 4.17 ms
    text += std::string(time) + "," + std::to_string(i % 2) + "," + std::to_string(gazeX(i / 4)) +
            ",300\n";
  }
  const GazeTrace trace = read(text);
  EXPECT_EQ(trace.samples.size(), kSamples);
  EXPECT_NEAR(trace.rate_Hz, 240.0, 0.5);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_TRUE(trace.samples[i].eyes[i % 2].point_px) << i;
    EXPECT_FALSE(trace.samples[i].eyes[1 - i % 2].point_px) << i;
  }
}

/// Gaze at 120 Hz with rows of a mouse between, and data loss of 0.2 s.
std::string withMouse(const std::string& header, const std::string& of_gaze,
                      const std::string& of_mouse) {
  std::string text = header + "\n";
  for (int i = 0; i < 1200; ++i) {
    const double time_s = i / 120.0;
    const bool lost = i >= 600 && i < 624;
    text += std::to_string(time_s) + of_gaze +
            (lost ? "," : std::to_string(gazeX(i / 2)) + ",300") + ",\n";
    if (i % 3 == 0) text += std::to_string(time_s + 0.0031) + of_mouse + ",,500\n";
  }
  return text;
}

TEST(RowGroups, RowsOfOtherDevicesAreSkippedAndSaid) {
  for (const auto& text : {withMouse("time_s,event,x_px,y_px,mouse_x", ",,", ",,"),
                           withMouse("time_s,device,x_px,y_px,mouse_x", ",ET,", ",Mouse,")}) {
    const GazeTrace trace = read(text);
    EXPECT_NEAR(static_cast<double>(trace.samples.size()), 1200.0, 2.0);
    EXPECT_NEAR(trace.rate_Hz, 120.0, 0.1);
    ASSERT_FALSE(trace.assumed.empty());
    EXPECT_NE(trace.assumed[0].find("skipped"), std::string::npos) << trace.assumed[0];
  }
}

TEST(RowGroups, DataLossAloneIsNotSkipped) {
  std::string text = "time_s,x_px,y_px\n";
  for (int i = 0; i < kSamples; ++i) {
    const bool lost = i % 20 > 16;
    text += std::to_string(i / kRate_Hz) + (lost ? ",," : "," + std::to_string(gazeX(i)) + ",300") +
            "\n";
  }
  EXPECT_EQ(read(text).samples.size(), kSamples);
}

// A tracker measures both eyes in turn, and does not see one of them.
TEST(RowGroups, RowsOfATableOfSamplesAreNeverSkipped) {
  std::string text = "time_s,x_px,y_px\n";
  for (int i = 0; i < 2 * kSamples; ++i) {
    text +=
        std::to_string(i / kRate_Hz) + (i % 2 ? ",,\n" : "," + std::to_string(gazeX(i)) + ",300\n");
  }
  EXPECT_EQ(read(text).samples.size(), kSamples);
  EXPECT_NEAR(static_cast<double>(read("# rows=samples\n" + text).samples.size()), 2.0 * kSamples,
              1.0);
}

// Most samples are lost, at random: that is no other device, whose rows are left out.
TEST(RowGroups, ScatteredDataLossIsLoss) {
  for (const bool has_validity : {false, true}) {
    for (const double kept : {0.05, 0.15, 0.2, 0.22, 0.3, 0.5}) {
      std::string text = has_validity ? "time_s,x_px,y_px,validity\n" : "time_s,x_px,y_px\n";
      std::mt19937 random(7);
      for (int i = 0; i < 3 * kSamples; ++i) {
        // 0 to 1, with the same bytes of each library
        const double chance = static_cast<double>(random()) / 4294967296.0;
        const bool lost = chance >= kept;
        text += std::to_string(i / 500.0) + (lost ? ",," : "," + std::to_string(gazeX(i)) + ",300");
        if (has_validity) text += lost ? (i % 50 == 0 ? ",0" : ",") : ",1";
        text += "\n";
      }
      const GazeTrace trace = read(text);
      EXPECT_EQ(trace.samples.size(), 3 * kSamples) << kept << has_validity;
      EXPECT_NEAR(trace.rate_Hz, 500.0, 1.0);
    }
  }
}

TEST(RowGroups, NamesThatAreNotEnoughAreRefused) {
  EXPECT_NE(refusal("timestamp,id,confidence,norm_pos_x,norm_pos_y,diameter,ellipse_center_x\n"
                    "1.0,0,0.9,0.4,0.5,40,120\n1.004,1,0.9,0.5,0.5,40,160\n")
                .find("gaze_positions.csv"),
            std::string::npos);
  for (const char* header : {"t,gaze_x,gaze_y,gaze_z", "t,x,y,z", "t,gaze_x_m,gaze_y_m,gaze_z_m",
                             "t,left_gaze_x,left_gaze_y,left_gaze_z"}) {
    EXPECT_NE(refusal(std::string(header) + "\n0,1,2,3\n0.01,1,2,3\n").find("gaze."),
              std::string::npos)
        << header;
  }
  // PsychoPy's third axis has no values.
  for (const char* z : {"0", "0.0", "nan", ""}) {
    const std::string end = std::string(z) + "\n";
    const GazeTrace trace =
        read("time_s,left_gaze_x,left_gaze_y,left_gaze_z\n0,100,50," + end + "0.01,110,60," + end);
    EXPECT_EQ(trace.samples[1].eyes[0].point_px, glm::dvec2(110, 60)) << z;
  }
}

TEST(RowGroups, ValidityOfPyGazesTobiiTablesIsOneForValid) {
  const GazeTrace trace = read(
      "TimeStamp\tEvent\tGazePointXLeft\tGazePointYLeft\tValidityLeft\tGazePointXRight\t"
      "GazePointYRight\tValidityRight\tGazePointX\tGazePointY\tPupilSizeLeft\tPupilValidityLeft\t"
      "PupilSizeRight\tPupilValidityRight\n"
      "0\t\t700\t500\t1\t710\t500\t1\t705\t500\t3\t1\t3\t1\n"
      "17\t\t-1\t-1\t0\t710\t500\t1\t710\t500\t3\t0\t3\t1\n");
  EXPECT_EQ(trace.format, "PyGaze, Tobii, binocular");
  EXPECT_TRUE(trace.samples[0].eyes[0].point_px);
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_TRUE(trace.samples[1].eyes[1].point_px);
}

TEST(RowOrder, CopiesAreDroppedAndSwappedNeighboursSorted) {
  std::string text = "time_s,x_px,y_px\n";
  for (int i = 0; i < 300; ++i) {
    const int at = i == 100 ? 101 : i == 101 ? 100 : i;  // two swapped rows
    const std::string line = std::to_string(at * 0.01) + "," + std::to_string(500 + at) + ",300\n";
    text += line;
    if (i == 50 || i == 200) text += line;
  }
  const GazeTrace trace = read(text);
  ASSERT_EQ(trace.samples.size(), 300u);
  for (std::size_t i = 0; i < 300; ++i) {
    EXPECT_NEAR(trace.samples[i].time_s, 0.01 * static_cast<double>(i), 1e-9);
    EXPECT_EQ(trace.samples[i].point_px->x, 500.0 + static_cast<double>(i));
  }
  ASSERT_EQ(trace.warnings.size(), 2u);
  EXPECT_NE(trace.warnings[0].find("2 rows are exact copies"), std::string::npos);
  EXPECT_NE(trace.warnings[1].find("sorted by time"), std::string::npos);
}

TEST(RowOrder, RowsThatComeThreeTimesCountOnce) {
  std::string text = "time_s,x_px,y_px\n";
  for (int i = 0; i < 900; ++i) {
    text += std::to_string(i / 3 * 0.01) + "," + std::to_string(500 + i / 3) + ",300\n";
  }
  EXPECT_EQ(read(text).samples.size(), 300u);
}

TEST(RowOrder, ResetsJumpsAndDisorderAreToldApart) {
  const auto said = [&](const auto& time) {
    std::string text = "time_s,x_px,y_px\n";
    for (int i = 0; i < 600; ++i) {
      text += std::to_string(time(i)) + "," + std::to_string(500 + i) + ",300\n";
    }
    return refusal(text);
  };
  const auto reset = said([](int i) { return 0.01 * (i % 300); });
  const auto jump = said([](int i) { return 0.01 * i - (i > 400 ? 1.0 : 0.0); });
  const auto disorder = said([](int i) { return 0.01 * (i / 4 * 4 + (3 - i % 4)); });
  const auto wild = said([](int i) { return i == 300 ? 1e4 : 0.01 * i; });
  EXPECT_NE(reset.find("starts anew"), std::string::npos) << reset;
  EXPECT_NE(jump.find("set back"), std::string::npos) << jump;
  EXPECT_NE(disorder.find("not in order"), std::string::npos) << disorder;
  EXPECT_NE(wild.find("time 10000 is wrong"), std::string::npos) << wild;
}

/// Fixations of half a second at `rate_Hz`, times in units of `unit_s`.
std::string unlabelled(double rate_Hz, double unit_s, double from, bool whole) {
  std::string text = "timestamp,gaze_x,gaze_y\n";
  const int dwell = static_cast<int>(0.5 * rate_Hz);
  for (int i = 0; i < static_cast<int>(8.0 * rate_Hz); ++i) {
    const double time = from + i / rate_Hz / unit_s;
    char field[64];
    std::snprintf(field, sizeof field, whole ? "%.0f" : "%.9f", time);
    text += std::string(field) + "," + std::to_string(300 + 400 * (i / dwell % 4) + i % 3) + "," +
            std::to_string(200 + 300 * (i / dwell % 2) + i % 2) + "\n";
  }
  return text;
}

TEST(UnitOfTime, IsToldByRateSizeAndFixationsOrAskedFor) {
  const struct {
    double rate_Hz, unit_s, from;
    bool whole;
  } cases[] = {{30, 1e-7, 133500000000000000.0, true},
               {250, 1e-7, 0, true},
               {60, 1e-3, 0, true},
               {30, 1e-3, 0, true},
               {1000, 1e-4, 0, true},
               {250, 1e-4, 5000, true},
               {60, 60, 0, false},
               {250, 60, 0, false},
               {60, 1, 0, false},
               {120, 1e-6, 0, true},
               {60, 1e-3, 1.7e12, true},
               {250, 1e-6, 1.7e15, true},
               {500, 1e-7, 6.4e17, true}};
  for (const auto& each : cases) {
    const std::string text = unlabelled(each.rate_Hz, each.unit_s, each.from, each.whole);
    const GazeTrace trace = read(text);
    EXPECT_NEAR(trace.rate_Hz / each.rate_Hz, 1.0, 0.03) << each.rate_Hz << " " << each.unit_s;
  }
  // Numbers of frames: 1000 Hz would make fixations far too short.
  EXPECT_NE(refusal(unlabelled(30, 1.0 / 30, 0, true)).find("frames"), std::string::npos);
}

/// Two eyes in columns of these names, of which `lost` is the position and the validity in data
/// loss of 100 ms.
GazeTrace withValidity(const std::string& header, int valid, int invalid, const char* lost) {
  std::string text = header + "\n";
  for (int i = 0; i < kSamples; ++i) {
    const bool is_lost = i % 60 < 6;
    const std::string at = is_lost
                               ? std::string(lost) + "\t" + lost
                               : std::to_string(gazeX(i)) + "\t" + std::to_string(300.5 + i % 2);
    const std::string eye = at + "\t" + std::to_string(is_lost ? invalid : valid);
    text += std::to_string(i * 1000 / 60) + "\t" + eye + "\t" + eye + "\n";
  }
  return read(text);
}

TEST(Validity, FollowsThePositionsWhereTheFormatsCodeIsReversed) {
  const std::string studio =
      "RecordingTimestamp\tGazePointLeftX (ADCSpx)\tGazePointLeftY (ADCSpx)\tValidityLeft\t"
      "GazePointRightX (ADCSpx)\tGazePointRightY (ADCSpx)\tValidityRight";
  const std::string plain = "time_ms\tlx\tly\tvalidity_left\trx\try\tvalidity_right";
  for (const std::string& header : {studio, plain}) {
    for (const char* lost : {"-1", "0", ""}) {
      for (const auto& [valid, invalid] : {std::pair(1, 0), {0, 1}, {0, 4}}) {
        const GazeTrace trace = withValidity(header, valid, invalid, lost);
        ASSERT_EQ(trace.samples.size(), kSamples);
        for (int i = 0; i < kSamples; ++i) {
          ASSERT_EQ(trace.samples[i].point_px.has_value(), i % 60 >= 6) << header << valid << i;
        }
        if (header == plain) continue;
        EXPECT_EQ(warns(trace, "validity of an eye"), invalid != 4);
      }
    }
  }
}

TEST(RowGroups, AnEyeThatIsOpenOrShutIsNoOtherEye) {
  std::string text = "time_s,eye_open,x_px,y_px\n";
  for (int i = 0; i < kSamples; ++i) {
    text += row(i / kRate_Hz, i % 40 < 6 ? "0" : "1", gazeX(i), 300.0 + i % 2);
  }
  const GazeTrace trace = read(text);
  EXPECT_EQ(trace.format, "CSV");
  EXPECT_TRUE(warns(trace, "\"eye_open\" is unused"));
  for (const char* name : {"bad", "flag", "gaze_state", "artifact"}) {
    std::string other = text;
    other.replace(other.find("eye_open"), 8, name);
    EXPECT_TRUE(warns(read(other), std::string(name) + "\" is unused")) << name;
  }
}

/// Gaze at a rate, with times in ticks of a counter's frequency.
GazeTrace inTicks(double rate_Hz, double ticks_Hz) {
  std::string text = "timestamp,x_px,y_px\n";
  for (int i = 0; i < 3 * kSamples; ++i) {
    const int fixation = static_cast<int>(i / rate_Hz / 0.3);
    text += std::to_string(8'123'456 + std::llround(i * ticks_Hz / rate_Hz)) + "," +
            std::to_string(400.0 + 300.0 * (fixation % 4) + i % 3) + "," +
            std::to_string(300.5 + i % 2) + "\n";
  }
  return read(text);
}

TEST(UnitOfTime, AnUnusualRateOrDurationOfFixationsIsDoubted) {
  for (const auto& [rate_Hz, ticks_Hz] : {std::pair(120.0, 3'579'545.0),
                                          {60.0, 1e5},
                                          {500.0, 1e5},
                                          {250.0, 44'100.0},
                                          {60.0, 90e3}}) {
    EXPECT_TRUE(warns(inTicks(rate_Hz, ticks_Hz), "gaze.time_scale_s")) << ticks_Hz;
  }
  for (const double rate_Hz : {60.0, 120.0, 250.0}) {
    EXPECT_FALSE(warns(inTicks(rate_Hz, 1e3), "gaze.time_scale_s")) << rate_Hz;
    EXPECT_FALSE(warns(inTicks(rate_Hz, 1e6), "gaze.time_scale_s")) << rate_Hz;
  }
}

TEST(PositionDoubts, AZeroOfOneAxisAndEyesOfTwoScalesAreDoubted) {
  std::string zeros = "time_s,x_px,y_px\n", scales = "time_s,left_x,left_y,right_x,right_y\n";
  for (int i = 0; i < kSamples; ++i) {
    const std::string time = std::to_string(i / kRate_Hz) + ",";
    const double x = gazeX(i), y = 300.5 + i % 2 + i / 30 % 5 * 50.0;
    zeros += time + std::to_string(i % 40 < 6 ? 0.0 : x) + "," + std::to_string(y) + "\n";
    scales += time + std::to_string(x / 1920) + "," + std::to_string(y / 1080) + "," +
              std::to_string(x) + "," + std::to_string(y) + "\n";
  }
  EXPECT_TRUE(warns(read(zeros), "x is 0 in 15 %"));
  EXPECT_TRUE(warns(read(scales), "of one unit"));
}

}  // namespace FOCI_FILE
}  // namespace foci
