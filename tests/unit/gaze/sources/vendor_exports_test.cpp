// Exports of Tobii Studio, Tobii Pro Lab and SMI, in small files with their vendors' columns,
// preambles and codes for data loss. The values are made up.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"
#include "tests/unit/gaze/sources/read_tables.h"

namespace foci {
namespace FOCI_FILE {

std::filesystem::path recording(const char* name) {
  return std::filesystem::path(FOCI_SOURCE_DIR) / "tests/unit/gaze/sources/recordings" / name;
}

GazeTrace read(const char* name, const TraceColumns& columns = {}) {
  return readTrace(recording(name), columns, {});
}

TEST(VendorExport, TobiiStudio2HasAPreambleAndCodesForDataLoss) {
  const GazeTrace trace = read("tobii_studio_2.tsv");
  EXPECT_EQ(trace.format, "Tobii Studio, binocular");
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(1280, 1024));
  ASSERT_EQ(trace.samples.size(), 4u);  // rows of clicks and of the log are none
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 0.017);
  expectPoint(trace.samples[0].point_px, 640, 510);
  expectPoint(trace.samples[0].eyes[0].point_px, 630, 500);
  EXPECT_DOUBLE_EQ(*trace.samples[0].pupil_mm, 3.2);
  expectPoint(trace.samples[1].point_px, 652, 522);
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_DOUBLE_EQ(*trace.samples[1].pupil_mm, 3.3);
  EXPECT_FALSE(trace.samples[2].point_px);  // (0, 0)
  EXPECT_FALSE(trace.samples[2].pupil_mm);  // -1
}

TEST(VendorExport, TobiiStudio2WithoutValidityHasEyesAtMinusTheScreensSize) {
  const GazeTrace trace =
      readTrace(ScratchFile("System Properties:\r\nRecording resolution:\t 1280 x 1024\r\n\r\n"
                            "Timestamp\tNumber\tGazePointXLeft\tGazePointYLeft\tGazePointXRight\t"
                            "GazePointYRight\t\r\n"
                            "17\t1\t630\t500\t650\t520\t\r\n33\t2\t-1280\t-1024\t650\t520\t\r\n")
                    .path(),
                {}, {});
  ASSERT_EQ(trace.samples.size(), 2u);
  expectPoint(trace.samples[0].point_px, 640, 510);
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  expectPoint(trace.samples[1].point_px, 640, 510);
}

TEST(VendorExport, TobiiStudio3IsReadInScreenPixelsNotOnTheMedia) {
  const GazeTrace trace = read("tobii_studio_3.tsv");
  EXPECT_EQ(trace.format, "Tobii Studio, binocular");
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(1920, 1080));
  ASSERT_EQ(trace.samples.size(), 4u);
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 0.003);
  expectPoint(trace.samples[0].point_px, 910, 510);
  expectPoint(trace.samples[0].eyes[1].point_px, 920, 520);
  EXPECT_DOUBLE_EQ(*trace.samples[0].pupil_mm, 3.3);  // "3,20" and "3,40"
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_FALSE(trace.samples[2].point_px);
}

TEST(VendorExport, TobiiProLabKeepsTheEyeTrackersRowsAndTheScreensColumns) {
  const GazeTrace trace = read("tobii_pro_lab.tsv");
  EXPECT_EQ(trace.format, "Tobii Pro Lab, binocular");
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(1920, 1080));
  ASSERT_EQ(trace.samples.size(), 4u);
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 0.001);
  EXPECT_NEAR(trace.rate_Hz, 300.0, 0.1);
  expectPoint(trace.samples[0].point_px, 960, 540);
  expectPoint(trace.samples[0].eyes[0].point_px, 950, 530);
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_FALSE(trace.samples[2].point_px);
}

TEST(VendorExport, PositionsOnTheMediaOrInMillimetresAreRefused) {
  const std::string media = refusal(
      "Recording timestamp [ms]\tSensor\tGaze point X [MCS px]\tGaze point Y [MCS px]\n"
      "1\tEye Tracker\t10\t20\n9\tEye Tracker\t10\t20\n");
  EXPECT_NE(media.find("\"Gaze point X [MCS px]\" counts from the presented media"),
            std::string::npos)
      << media;
  EXPECT_NE(
      refusal("RecordingTimestamp\tGazePointX (ADCSmm)\tGazePointY (ADCSmm)\n1\t9\t9\n9\t9\t9\n")
          .find("\"GazePointX (ADCSmm)\" is in \"mm\": expected px"),
      std::string::npos);
}

TEST(VendorExport, SmiIdfConverterHasMessagesAndUnknownZeros) {
  const GazeTrace trace = read("smi_idf_converter.txt");
  EXPECT_EQ(trace.format, "SMI BeGaze, binocular");
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(1680, 1050));
  EXPECT_DOUBLE_EQ(trace.screen->size_m.y, 0.297);
  EXPECT_EQ(trace.screen->distance_m, 0.0);  // "Head Distance: 0" means unknown
  ASSERT_EQ(trace.samples.size(), 4u);
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 2.001);
  EXPECT_EQ(trace.rate_Hz, 250.0);
  expectPoint(trace.samples[0].point_px, 840, 530);
  EXPECT_DOUBLE_EQ(*trace.samples[0].pupil_mm, 3.3);
  EXPECT_FALSE(trace.samples[2].point_px);
  EXPECT_FALSE(trace.samples[2].pupil_mm);
}

TEST(VendorExport, SmiBeGazeRawDataHasSeparatorsAndDashes) {
  const GazeTrace trace = read("smi_begaze.csv");
  EXPECT_EQ(trace.format, "SMI BeGaze, binocular");
  ASSERT_EQ(trace.samples.size(), 4u);
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 0.012034);
  expectPoint(trace.samples[0].eyes[0].point_px, 830, 520);
  expectPoint(trace.samples[0].point_px, 840, 530);
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_FALSE(trace.samples[3].point_px);
}

TEST(VendorExport, SmiWithoutItsPreambleIsReadTheSame) {
  std::ifstream file(recording("smi_idf_converter.txt"));
  std::string line, text;
  while (std::getline(file, line)) {
    if (!line.starts_with("##")) text += line + "\n";
  }
  const GazeTrace with = read("smi_idf_converter.txt");
  const GazeTrace without = readTrace(ScratchFile(text).path(), {}, {});
  EXPECT_EQ(without.format, "SMI BeGaze, binocular");
  EXPECT_EQ(without.screen->size_px, glm::ivec2(0));
  ASSERT_EQ(without.samples.size(), with.samples.size());
  for (std::size_t i = 0; i < with.samples.size(); ++i) {
    EXPECT_EQ(without.samples[i].time_s, with.samples[i].time_s);
    EXPECT_EQ(without.samples[i].point_px, with.samples[i].point_px);
    EXPECT_EQ(without.samples[i].pupil_mm, with.samples[i].pupil_mm);
  }
}

TEST(VendorExport, SmiOfBothEyesTogetherIsRecognised) {
  const GazeTrace trace =
      readTrace(ScratchFile("RecordingTime [ms];Trial;Category Binocular;"
                            "Point of Regard Binocular X [px];Point of Regard Binocular Y [px]\n"
                            "10.0;T1;Separator;-;-\n12.0;T1;Fixation;850.0;540.0\n"
                            "20.0;T1;Blink;0.0;0.0\n28.0;T1;Fixation;852.0;542.0\n")
                    .path(),
                {}, {});
  EXPECT_EQ(trace.format, "SMI BeGaze");
  ASSERT_EQ(trace.samples.size(), 3u);
  expectPoint(trace.samples[0].point_px, 850, 540);
  EXPECT_FALSE(trace.samples[1].point_px);
}

std::string whyOf(const std::string& text) {
  return streamTrace(ScratchFile(text).path(), {}, {}, [](const GazeSample&) {}).columns[1].why;
}

TEST(VendorExport, OnlyACompleteTableOfUsualValuesIsCertain) {
  const auto rows = [](const std::string& behind, double scale) {
    std::string text;
    for (int i = 0; i < 800; ++i) {
      text += std::to_string(i / 60.0) + "," + std::to_string(scale * (0.1 + 0.2 * (i / 40 % 5))) +
              "," + std::to_string(scale * (0.2 + 0.3 * (i / 40 % 3)) + 1e-3 * (i % 2)) + behind +
              "\n";
    }
    return text;
  };
  EXPECT_EQ(whyOf("TIME,BPOGX,BPOGY,BPOGV\n" + rows(",1", 1.0)), "certain: a column of Gazepoint");
  EXPECT_EQ(whyOf("TIME,BPOGX,BPOGY\n" + rows("", 1.0)),
            "likely: a column of Gazepoint, which lacks bpogv");
  EXPECT_TRUE(whyOf("TIME,BPOGX,BPOGY,BPOGV\n" + rows(",1", 3.0)).starts_with("doubtful: "));
}

TEST(VendorExport, NamesWithNormAreFractions) {
  for (const std::string_view header :
       {"time,norm_x,norm_y\n", "time,gaze_x_norm,gaze_y_norm\n",
        "time,GazeX normalised,GazeY normalised\n", "time;Gaze X [MCSnorm];Gaze Y\n"}) {
    const std::string bytes = std::string(header) + "0,0.5,0.25\n0.01,0.5,0.25\n";
    if (header.find("MCS") != std::string_view::npos) {
      EXPECT_NE(refusal(bytes).find("presented media"), std::string::npos) << header;
      continue;
    }
    const GazeTrace trace = readTrace(ScratchFile(bytes).path(), {}, {.size_px = {1000, 800}});
    expectPoint(trace.samples[0].point_px, 500, 200);
  }
  // Pupil Labs' norm_pos counts from the lower edge.
  const GazeTrace trace =
      readTrace(ScratchFile("timestamp,norm_pos_x,norm_pos_y\n0,0.5,0.25\n0.01,0.5,0.25\n").path(),
                {}, {.size_px = {1000, 800}});
  expectPoint(trace.samples[0].point_px, 500, 600);
}

TEST(VendorExport, FractionsAndMetresWithoutAUnitAreRefused) {
  std::string fractions = "time,x,y\n", metres = "time,eye_x,eye_y,eye_z\n";
  for (int i = 0; i < 50; ++i) {
    const std::string time = std::to_string(0.01 * i);
    fractions += time + ",0.5" + std::to_string(i) + ",0.4\n";
    metres += time + ",0.031,0.002,0.64\n";
  }
  EXPECT_NE(refusal(fractions).find("give their unit: gaze.units = \"normalised\" or \"deg\""),
            std::string::npos)
      << refusal(fractions);
  EXPECT_NE(refusal(metres).find("it may be \"eye_x\""), std::string::npos) << refusal(metres);
  EXPECT_NE(refusal(metres, {.x = "eye_x", .y = "eye_y"}).find("give their unit"),
            std::string::npos);
  EXPECT_NE(refusal("time,x_m,y_m\n0,0.1,0.1\n0.01,0.1,0.1\n").find("is in \"m\": expected px"),
            std::string::npos);
  // The unit that the user states holds.
  EXPECT_EQ(refusal(fractions, {.units = GazeUnits::normalised}), "not refused");
  EXPECT_EQ(refusal(fractions, {.units = GazeUnits::px}), "not refused");
  // What a gaze map will turn into pixels is not judged.
  EXPECT_EQ(refusal(fractions, {.mapped_later = true}), "not refused");
}

TEST(VendorExport, DegreesWithoutAUnitWarn) {
  std::string degrees = "time,x,y\n";
  for (int i = 0; i < 50; ++i) {
    degrees += std::to_string(0.01 * i) + "," + std::to_string(i - 25) + ",-3.5\n";
  }
  const GazeTrace trace = readTrace(ScratchFile(degrees).path(), {}, {});
  ASSERT_EQ(trace.warnings.size(), 1u);
  EXPECT_NE(trace.warnings[0].find("may be degrees"), std::string::npos);
}

TEST(VendorExport, TheHeaderStatesWhatWasAssumed) {
  const auto header = [](std::string_view bytes, const TraceColumns& columns = {}) {
    return streamTrace(ScratchFile(bytes).path(), columns, {}, [](const GazeSample&) {});
  };
  const TraceHeader plain = header("time,x,y\n0,10,20\n4,11,21\n8,12,22\n");
  ASSERT_EQ(plain.assumed.size(), 2u);
  EXPECT_NE(plain.assumed[0].find("unit of the positions: px"), std::string::npos);
  EXPECT_NE(plain.assumed[1].find("unit of time: 0.001 s"), std::string::npos);
  EXPECT_FALSE(plain.nominal_screen);

  const TraceHeader degrees = header("time_s,x_deg,y_deg\n0,10,20\n0.01,11,21\n");
  EXPECT_TRUE(degrees.nominal_screen);
  EXPECT_EQ(degrees.units, GazeUnits::deg);
  ASSERT_EQ(degrees.assumed.size(), 1u);
  EXPECT_NE(degrees.assumed[0].find("screen: unknown"), std::string::npos);

  EXPECT_TRUE(header("time_s,x_px,y_px\n0,10,20\n0.01,11,21\n").assumed.empty());
}

TEST(VendorExport, MissingColumnsListTheirCandidates) {
  const std::string message = refusal("TIMETICK,LSPOTX,LSPOTY,stimulus\n1,2,3,4\n");
  EXPECT_NE(message.find("no column \"time\": name it with gaze.time; it may be \"TIMETICK\""),
            std::string::npos)
      << message;
  const std::string x =
      refusal("TIMETICK,LSPOTX,LSPOTY,RSPOTX,RSPOTY\n1,2,3,4,5\n", {.time = "TIMETICK"});
  EXPECT_NE(x.find("it may be \"LSPOTX\", \"RSPOTX\""), std::string::npos) << x;
  const std::string timeless = refusal("x_px,y_px\n1,2\n3,4\n");
  EXPECT_NE(timeless.find("if none has the time, give gaze.rate_Hz"), std::string::npos)
      << timeless;
  EXPECT_NE(refusal("0.1,1,2\n0.2,1,2\n").find("the first line has numbers, not names"),
            std::string::npos);
}

TEST(VendorExport, GazepointHasSecondsAndFractionsWithValidity) {
  const GazeTrace trace = readTrace(
      ScratchFile(
          "MEDIA_ID,CNT,TIME(2023/05/12 10:22:33.123),TIMETICK(f=10000000),FPOGX,FPOGY,FPOGV,"
          "BPOGX,BPOGY,BPOGV,BKID,LPMM,LPMMV,RPMM,RPMMV,\n"
          "0,1,0.50000,77,0.1,0.1,1,0.25,0.5,1,0,3.0,1,4.0,1,\n"
          "0,2,0.51667,78,0.1,0.1,1,0.25,0.5,0,0,0,0,4.0,1,\n"
          "0,3,0.53333,79,0.1,0.1,1,0.25,0.5,1,7,3.0,1,4.0,1,\n")
          .path(),
      {}, Screen{.size_px = {1000, 800}, .size_m = {0.5, 0.4}, .distance_m = 0.6});
  EXPECT_EQ(trace.format, "Gazepoint");
  ASSERT_EQ(trace.samples.size(), 3u);
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 0.5);
  expectPoint(trace.samples[0].point_px, 250, 400);  // the best point, not the fixation's
  EXPECT_DOUBLE_EQ(*trace.samples[0].pupil_mm, 3.5);
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_FALSE(trace.samples[1].blink);
  EXPECT_TRUE(trace.samples[2].blink);
}

constexpr double kProLabRate_Hz = 1200.0;

/// Tobii Pro Lab in whole milliseconds, with or without the tracker's own times.
GazeTrace proLab(double rate_Hz, bool tracker_times, int count) {
  std::string text =
      "Recording timestamp [ms]\tSensor\tEyetracker timestamp [\xce\xbcs]\tGaze point X [DACS px]\t"
      "Gaze point Y [DACS px]\n";
  for (int i = 0; i < count; ++i) {
    const double time_s = i / rate_Hz;
    text += std::to_string(static_cast<int>(1e3 * time_s + 1e-9)) + "\tEye Tracker\t" +
            (tracker_times ? std::to_string(900'000'000 + std::lround(1e6 * time_s)) : "") +
            "\t700\t500\n";
  }
  return readTrace(ScratchFile(text).path(), {}, {});
}

TEST(VendorExport, WholeMillisecondsAbove1000HzKeepTheOrderOfTheSamples) {
  constexpr double kQuantum_s = 1.1e-3;  // a millisecond, and what the control loop needs
  for (const bool tracker_times : {true, false}) {
    const GazeTrace trace = proLab(kProLabRate_Hz, tracker_times, 6000);
    ASSERT_EQ(trace.samples.size(), 6000u);
    EXPECT_NEAR(trace.rate_Hz, kProLabRate_Hz, 0.01 * kProLabRate_Hz) << tracker_times;
    double longest_s = 0.0;
    for (std::size_t i = 0; i < trace.samples.size(); ++i) {
      const double true_s = static_cast<double>(i) / kProLabRate_Hz;
      ASSERT_NEAR(trace.samples[i].time_s, true_s, kQuantum_s) << i;
      if (i < 3000) continue;  // settled
      longest_s = std::max(longest_s, trace.samples[i].time_s - trace.samples[i - 1].time_s);
      ASSERT_GT(trace.samples[i].time_s, trace.samples[i - 1].time_s);
    }
    EXPECT_LT(longest_s, 1.05 / kProLabRate_Hz) << tracker_times;  // even, not 1 ms and 0.5 ms
  }
}

TEST(VendorExport, RepeatedTimesBelow1000HzAreRefused) {
  EXPECT_NE(refusal("time_ms,x,y\n0,700,500\n10,700,500\n10,701,500\n20,700,500\n")
                .find("time \"10\" is not after"),
            std::string::npos);
}

TEST(VendorExport, TheRateOfWholeMillisecondsIsTheMean) {
  std::string text = "time_ms,x_px,y_px\n";
  for (int i = 0; i < 600; ++i) text += std::to_string(std::lround(i / 0.06)) + ",700,500\n";
  EXPECT_NEAR(readTrace(ScratchFile(text).path(), {}, {}).rate_Hz, 60.0, 0.01);
}

TEST(VendorExport, TheEyeTribesRawGazeIsReadAndZeroIsDataLoss) {
  const GazeTrace trace = readTrace(
      ScratchFile(
          "timestamp\ttime\tfix\tstate\trawx\trawy\tavgx\tavgy\tpsize\tLrawx\tLrawy\tLavgx"
          "\tLavgy\tLpsize\tRrawx\tRrawy\tRavgx\tRavgy\tRpsize\n"
          "2015-03-02 14:05:10.000\t5000\tTrue\t7\t500\t400\t9\t9\t20\t490\t400\t9\t9\t20\t"
          "510\t400\t9\t9\t20\n"
          "2015-03-02 14:05:10.016\t5016\tTrue\t7\t490\t400\t9\t9\t20\t490\t400\t9\t9\t20\t"
          "0\t0\t0\t0\t0\n"
          "2015-03-02 14:05:10.033\t5033\tFalse\t8\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\n")
          .path(),
      {}, {.size_px = {1920, 1080}});
  EXPECT_EQ(trace.format, "The Eye Tribe, binocular");
  ASSERT_EQ(trace.samples.size(), 3u);
  expectPoint(trace.samples[0].point_px, 500, 400);
  EXPECT_FALSE(trace.samples[1].eyes[1].point_px);
  EXPECT_TRUE(trace.samples[1].point_px);
  EXPECT_FALSE(trace.samples[2].point_px);
  EXPECT_NEAR(trace.samples[2].time_s - trace.samples[0].time_s, 0.033, 1e-9);
}

TEST(VendorExport, TablesOfOtherThingsAreNamed) {
  const auto says = [](const char* table, const char* part) {
    EXPECT_NE(refusal(table).find(part), std::string::npos) << refusal(table);
  };
  says("rt,trial_type,webgazer_data\n5,a,\"[]\"\n", "JSON");
  says("fixation id,start timestamp [ns],fixation x [px],fixation y [px]\n1,2,3,4\n", "fixations");
  says("time(s),gaze_direct_L.x,gaze_direct_L.y,gaze_direct_L.z\n0,0,0,1\n", "gaze.direction");
  says("time_s,yaw,pitch,head_x\n0,0.1,0.2,1\n", "gaze.angles");
  says("t;GazeRay.Direction.x;GazeRay.Direction.y;GazeRay.Direction.z\n0;0;0;1\n", "directions");
  says("time|x|y\n0|1|2\n", "sep=|");
  says("@RELATION gaze\n@ATTRIBUTE time INTEGER\n@DATA\n0,1,2\n", "ARFF");
  says("Time,X,Y\n22.11. 10:22,3,4\n", "gaze.time");
  says("Time,X,Y\n10:22:00,3,4\n10:22:00,3,5\n", "a finer clock with gaze.time");
}

TEST(VendorExport, TittaWritesValidityAsAWord) {
  const GazeTrace trace =
      readTrace(ScratchFile("system_time_stamp\tleft_gaze_point_on_display_area_x\t"
                            "left_gaze_point_on_display_area_y\tleft_gaze_point_valid\n"
                            "1000\t0.5\t0.25\tTrue\n2000\t0.5\t0.25\tFalse\n")
                    .path(),
                {.time = "system_time_stamp"}, {.size_px = {1000, 800}});
  expectPoint(trace.samples[0].point_px, 500, 200);
  EXPECT_FALSE(trace.samples[1].point_px);
}

TEST(VendorExport, ATableOfFixationsIsRefusedAlsoIfItHasTimes) {
  for (const char* header :
       {"TIME,FPOGX,FPOGY,FPOGD,BPOGX,BPOGY", "time,gaze_x,gaze_y,duration,a,b"}) {
    std::string fixations = std::string(header) + "\n", samples = fixations, of_frames = fixations;
    for (int i = 0; i < 600; ++i) {
      const auto row = [&](double time_s, double duration_s) {
        return std::to_string(time_s) + ",0." + std::to_string(200 + i % 7) + ",0.4," +
               std::to_string(duration_s) + ",0.3,0.4\n";
      };
      fixations += row(0.5 * i, 0.15 + 0.04 * (i % 9));
      samples += row(i / 60.0, i % 24 / 60.0);
      of_frames += row(i / 60.0 + (i < 300 ? 0.0 : 5.0), 1.0 / 60.0);  // a pause
    }
    const TraceColumns fractions{.units = GazeUnits::normalised};
    EXPECT_NE(refusal(fixations, fractions).find("fixations or events"), std::string::npos);
    EXPECT_EQ(refusal(samples, fractions), "not refused");
    EXPECT_EQ(refusal(of_frames, fractions), "not refused");
  }
}

TEST(VendorExport, GlassesThatAreNotWornHaveNoGaze) {
  const GazeTrace trace =
      readTrace(ScratchFile("section id,recording id,timestamp [ns],gaze x [px],gaze y [px],worn\n"
                            "a,b,1000000000,700,500,255\na,b,1005000000,700,500,0\n"
                            "a,b,1010000000,700,500,1.0\n")
                    .path(),
                {}, {});
  ASSERT_EQ(trace.samples.size(), 3u);
  EXPECT_TRUE(trace.samples[0].point_px);
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_TRUE(trace.samples[2].point_px);
}

}  // namespace FOCI_FILE
}  // namespace foci
