#include <gtest/gtest.h>

#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kClock_s = 1e-9;  // rounding of milliseconds to seconds

const std::string kHead = "** CONVERTED FROM a.edf\n\nMSG\t5 DISPLAY_COORDS 0 0 99 49\n";

GazeTrace read(const std::string& bytes) { return readTrace(ScratchFile(bytes).path(), {}, {}); }

std::string refusal(const std::string& bytes) {
  return refusalBy([&] { read(bytes); });
}

TEST(EyeLinkAsc, TakesTheMeanOfTheEyesAndDoesNotJumpToOne) {
  const GazeTrace trace = read(kHead +
                               "START\t10 \tLEFT\tRIGHT\tSAMPLES\tEVENTS\n"
                               "10\t 10.0\t 20.0\t 800\t 20.0\t 30.0\t 900\t.....\n"
                               "MSG\t11 99\n"
                               "11\t   .\t   .\t 0\t 20.0\t 30.0\t 900\t.C...\n"
                               "12\t   .\t   .\t 0\t   .\t   .\t 0\t.C.C.\nEND\t12\n");
  ASSERT_EQ(trace.samples.size(), 3u);
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(15, 25));
  EXPECT_EQ(*trace.samples[1].point_px, glm::dvec2(15, 25));
  EXPECT_EQ(*trace.samples[1].eyes[1].point_px, glm::dvec2(20, 30));
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_FALSE(trace.samples[2].point_px);
  EXPECT_FALSE(trace.samples[2].blink);
  EXPECT_FALSE(trace.samples[0].pupil_mm);
  EXPECT_EQ(trace.samples[0].eyes[0].pupil_own, 800.0);
  EXPECT_EQ(trace.samples[0].eyes[1].pupil_own, 900.0);
  EXPECT_FALSE(trace.samples[1].eyes[0].pupil_own);
  EXPECT_EQ(trace.format, "EyeLink ASC, binocular");
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(100, 50));
}

TEST(EyeLinkAsc, TakesTheStudysMissingScaleAndOffset) {
  const ScratchFile file(kHead +
                         "START\t10 \tLEFT\n10\t5\t20\t1\t...\n11\t-32768\t-32768\t0\t...\n"
                         "12\t5\t-32768\t0\t...\nEND\t12\n");
  const GazeTrace trace =
      readTrace(file.path(), {.missing = -32768.0, .scale = {2, -1}, .offset = {1, 40}}, {});
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(11, 20));
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_FALSE(trace.samples[2].point_px);
}

TEST(EyeLinkAsc, PutsTheSecondOfTwoEqualTimeStampsHalfAMillisecondLater) {
  const GazeTrace trace = read(kHead +
                               "START\t10 \tRIGHT\n10\t1\t1\t1\t...\n10\t2\t2\t1\t...\n"
                               "11\t3\t3\t1\t...\n11\t4\t4\t1\t...\nEND\t11\n");
  ASSERT_EQ(trace.samples.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(trace.samples[i].time_s, 0.010 + 0.0005 * static_cast<double>(i), kClock_s);
  }
  EXPECT_EQ(trace.rate_Hz, 2000.0);
}

TEST(EyeLinkAsc, ReadsBlocksWithDifferentEyesAndSkipsOtherLines) {
  const GazeTrace trace = read(kHead +
                               "START\t10 \tRIGHT\n10\t1\t2\t1\t...\n11\t1\t2\t1\t...\nEND\t11\n"
                               "12\t99\t99\t99\t...\n   7.1\t8.2\nINPUT\t15\t0\n"
                               "START\t20 \tLEFT\tRIGHT\n20\t3\t4\t1\t5\t6\t1\t.....\n"
                               "21\t3\t4\t1\t5\t6\t1\t.....\nEND\t21\n");
  ASSERT_EQ(trace.samples.size(), 4u);
  EXPECT_EQ(*trace.samples[1].point_px, glm::dvec2(1, 2));
  EXPECT_EQ(*trace.samples[2].point_px, glm::dvec2(4, 5));
}

TEST(EyeLinkAsc, EachBlockHasItsOwnCoordinates) {
  const auto block = [](int at, const std::string& coordinates, const std::string& point) {
    const std::string first = std::to_string(at), second = std::to_string(at + 1);
    return "MSG\t" + first + " GAZE_COORDS " + coordinates + "\nSTART\t" + first + " \tLEFT\n" +
           first + "\t" + point + "\t1\t...\n" + second + "\t" + point + "\t1\t...\nEND\t" +
           second + "\n";
  };
  // The middle of the screen, in three resolutions and with another origin.
  const GazeTrace trace =
      read("** CONVERTED FROM a.edf\n" + block(100, "0 0 1023 767", "512\t384") +
           block(9000, "0.00 0.00 1279.00 1023.00", "640\t512") +
           block(20000, "-960 -540 959 539", "0\t0"));
  ASSERT_EQ(trace.samples.size(), 6u);
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(1024, 768));
  for (const GazeSample& sample : trace.samples) {
    EXPECT_NEAR(sample.point_px->x, 512.0, 1e-9) << sample.time_s;
    EXPECT_NEAR(sample.point_px->y, 384.0, 1e-9) << sample.time_s;
  }
  ASSERT_EQ(trace.assumed.size(), 1u);
  EXPECT_NE(trace.assumed[0].find("1024 x 768 and of 1920 x 1080 px"), std::string::npos)
      << trace.assumed[0];
}

TEST(EyeLinkAsc, APauseBetweenBlocksIsNoGapOfTheClock) {
  std::string text = kHead;
  for (const int start : {10'000, 400'000}) {
    text += "START\t" + std::to_string(start) + " \tLEFT\n";
    for (int i = 0; i < 300; ++i) {
      text += std::to_string(start + i) + "\t" + std::to_string(20 + i % 50) + "\t" +
              std::to_string(10 + i % 30) + "\t700\t...\n";
    }
    text += "END\t" + std::to_string(start + 300) + "\n";
  }
  const GazeTrace trace = read(text);
  for (std::size_t i = 0; i < trace.samples.size(); ++i) {
    EXPECT_EQ(trace.samples[i].after_pause, i == 300) << i;
  }
  for (const std::string& warning : trace.warnings) {
    EXPECT_EQ(warning.find("a gap of"), std::string::npos) << warning;
    EXPECT_EQ(warning.find("samples a second"), std::string::npos) << warning;
  }
}

TEST(EyeLinkAsc, MessagesBecomeMarkersAndTrials) {
  const ScratchFile file(kHead +
                         "MSG\t8 !CAL CALIBRATION HV9 LR LEFT  GOOD\n"
                         "MSG\t9 !CAL VALIDATION HV9 LR LEFT  FAIR ERROR 0.85 avg. 1.62 max  "
                         "OFFSET 0.22 deg. 4.3,-5.2 pix.\n"
                         "MSG\t10 TRIALID 7 left\n"
                         "START\t10 \tLEFT\nPUPIL\tDIAMETER\n10\t1\t2\t3\t...\n"
                         "MSG\t11 -5 target on\nMSG\t11 RECCFG CR 1000 2 1 L\n"
                         "11\t1\t2\t3\t...\nEND\t12\n"
                         "MSG\t13 !V TRIAL_VAR contrast 0.5 high\nMSG\t14 TRIAL_RESULT 1\n"
                         "MSG\t20 TRIALID 8\nMSG\t22 the end\n");
  const TraceHeader header = streamTrace(file.path(), {}, {}, [](const GazeSample&) {});
  EXPECT_EQ(header.pupil_unit, "arbitrary");
  ASSERT_EQ(header.columns.size(), 1u);
  EXPECT_NE(header.columns[0].meaning.find("diameter of the pupil"), std::string::npos);
  ASSERT_EQ(header.trials.size(), 2u);
  EXPECT_EQ(header.trials[0].name, "7 left");
  EXPECT_EQ(header.trials[0].first_s, 0.010);
  EXPECT_EQ(header.trials[0].last_s, 0.014);
  EXPECT_EQ(header.trials[0].result, "1");
  ASSERT_EQ(header.trials[0].variables.size(), 1u);
  EXPECT_EQ(header.trials[0].variables[0].first, "contrast");
  EXPECT_EQ(header.trials[0].variables[0].second, "0.5 high");
  EXPECT_EQ(header.trials[1].last_s, 0.022);
  std::string markers;
  for (const TraceMarker& marker : header.markers) markers += marker.text + "; ";
  EXPECT_EQ(markers, "TRIALID 7 left; -5 target on; TRIAL_RESULT 1; TRIALID 8; the end; ");
  ASSERT_EQ(header.calibrations.size(), 2u);
  EXPECT_EQ(header.calibrations[0].grade, "good");
  EXPECT_FALSE(header.calibrations[0].mean_deg);
  EXPECT_EQ(header.calibrations[1].kind, "validation");
  EXPECT_EQ(header.calibrations[1].targets, "HV9");
  EXPECT_EQ(header.calibrations[1].eye, "left");
  EXPECT_EQ(header.calibrations[1].grade, "fair");
  EXPECT_EQ(header.calibrations[1].mean_deg, 0.85);
  EXPECT_EQ(header.calibrations[1].max_deg, 1.62);
}

TEST(EyeLinkAsc, SaysWhichLinesAConversionHasLeftOut) {
  const std::string samples = "10\t 512.0\t 384.0\t 800.0\t...\n11\t 512.0\t 384.0\t 800.0\t.C.\n";
  for (const std::string& text : {samples, "** CONVERTED FROM a.edf\n" + samples}) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find("START, SAMPLES, EBLINK and MSG GAZE_COORDS"), std::string::npos)
        << message;
  }
  EXPECT_NE(refusal(kHead + "START\t10 \tLEFT\nSBLINK L 11\nEND\t12\n").find("edf2asc -e"),
            std::string::npos);
  // The study may still name its columns.
  const ScratchFile file(samples);
  EXPECT_EQ(readTrace(file.path(), {.time = "#1", .x = "#2", .y = "#3", .time_scale_s = 1e-3}, {})
                .samples.size(),
            2u);
}

TEST(EyeLinkAsc, MarksBlinksThatEndAndBlinksThatDoNot) {
  std::string text = kHead + "START\t10 \tLEFT\n";
  for (int i = 10; i < 30; ++i) {
    if (i == 12) text += "SBLINK L 12\n";
    if (i == 16) text += "EBLINK L 12\t15\t4\n";
    if (i == 27) text += "SBLINK L 27\n";
    text += std::to_string(i) + "\t50\t20\t700\t...\n";
  }
  const GazeTrace trace = read(text);
  for (int i = 10; i < 30; ++i) {
    const GazeSample& sample = trace.samples[static_cast<std::size_t>(i - 10)];
    EXPECT_EQ(sample.blink, (i >= 12 && i <= 15) || i >= 27) << i;
    EXPECT_EQ(sample.point_px.has_value(), !sample.blink) << i;
  }
}

TEST(EyeLinkAsc, ABlinkOfOneEyeCountsUnlessItIsTooLongForABlink) {
  const auto recording = [](int from, int to) {
    std::string text = kHead + "START\t0 \tLEFT\tRIGHT\n";
    for (int i = 0; i < 3000; ++i) {
      if (i == from) text += "SBLINK L " + std::to_string(from) + "\n";
      if (i == to + 1) {
        text += "EBLINK L " + std::to_string(from) + "\t" + std::to_string(to) + "\t0\n";
      }
      text += std::to_string(i) + "\t.\t.\t0\t5\t6\t7\t.....\n";
    }
    return read(text + "END\t3000\n");
  };
  const GazeTrace brief = recording(100, 200);
  EXPECT_FALSE(brief.samples[99].blink);
  EXPECT_TRUE(brief.samples[100].blink && brief.samples[200].blink);
  EXPECT_FALSE(brief.samples[201].blink);
  const GazeTrace one_eye = recording(0, 2998);
  EXPECT_FALSE(one_eye.samples[150].blink);
  EXPECT_EQ(*one_eye.samples[150].point_px, glm::dvec2(5, 6));
}

TEST(EyeLinkAsc, PrefersGazeCoordinatesAndTakesASizeForALastPixel) {
  const std::string samples = "START\t10 \tLEFT\n10\t15\t25\t1\t...\n11\t15\t25\t1\t...\n";
  EXPECT_EQ(
      read("MSG\t1 GAZE_COORDS 0.00 0.00 1920.00 1080.00\n" + kHead + samples).screen->size_px,
      glm::ivec2(1920, 1080));
  EXPECT_EQ(read("MSG\t1 DISPLAY_COORDS = 0 0 639 479\n" + samples).screen->size_px,
            glm::ivec2(640, 480));
  const GazeTrace shifted = read(kHead + "MSG\t6 GAZE_COORDS 10 20 109 119\n" + samples);
  EXPECT_EQ(shifted.screen->size_px, glm::ivec2(100, 100));
  EXPECT_EQ(*shifted.samples[0].point_px, glm::dvec2(5, 5));
}

TEST(EyeLinkAsc, TakesMetresAndDistanceFromTheFallback) {
  const ScratchFile file(kHead + "START\t1 \tLEFT\n1\t1\t2\t3\t.\n2\t1\t2\t3\t.\n");
  const Screen fallback{.size_px = {640, 480}, .size_m = {0.5, 0.3}, .distance_m = 0.6};
  const Screen screen = *readTrace(file.path(), {}, fallback).screen;
  EXPECT_EQ(screen.size_px, glm::ivec2(100, 50));
  EXPECT_EQ(screen.size_m, fallback.size_m);
  EXPECT_EQ(screen.distance_m, fallback.distance_m);
}

TEST(EyeLinkAsc, WhatItsHeaderContradictsIsSaid) {
  const std::string two = "\t1\t2\t3\t4\t5\t6";
  EXPECT_NE(refusal(kHead + "START\t10 \tLEFT\n10" + two + "\t.....\nEND\t10\n").find("2 eyes"),
            std::string::npos);
  EXPECT_NE(refusal(kHead + "START\t10 \tLEFT\n10" + two + "\nEND\t10\n").find("2 eyes"),
            std::string::npos);
  const auto warnings = [&](const std::string& rate) {
    std::string text = kHead + "START\t10 \tLEFT\nSAMPLES\tGAZE\tLEFT\tVEL\tRATE\t" + rate + "\n";
    for (int i = 0; i < 400; ++i) text += std::to_string(10 + 2 * i) + "\t5\t6\t7\t0\t0\t0\t...\n";
    return read(text + "END\t900\n").warnings;
  };
  EXPECT_NE(warnings("1000.00").at(0).find("rate is 1000 Hz, but there are 500"),
            std::string::npos);
  for (const std::string& warning : warnings("500.00")) {
    EXPECT_EQ(warning.find("rate"), std::string::npos) << warning;
  }
}

TEST(EyeLinkAsc, RefusesDamageByLine) {
  const std::string start = kHead + "START\t10 \tLEFT\n";
  const std::pair<std::string, const char*> cases[] = {
      {kHead, "0 samples"},
      {start + "10\t1\t2\n", ":5: 3 values in a sample: expected 4"},
      {start + "10\tx\t2\t3\t.\n", "\"x\": expected a number"},
      {start + "10\t1\t2\t3\t.\n9\t1\t2\t3\t.\n", "\"9\" ms is not after"},
      {start + "10\t1\t2\t3\t.\n10\t1\t2\t3\t.\n10\t1\t2\t3\t.\n", ":7: time \"10\" ms"},
      {start + "10\t1e30\t2\t3\t.\n", "\"1e30\": too far from any screen"},
      {start + "10\t1\t-2e5\t3\t.\n", "\"-2e5\": too far from any screen"},
      {start + "SBLINK X 10\n", "expected L or R"},
      {start + "EBLINK L 10\n", "nothing: expected a number"},
      {start + "SAMPLES\tHREF\tLEFT\n", "expected GAZE"},
      {kHead + "START\t10\n10\t1\t2\t3\t.\n", "expected LEFT or RIGHT"},
      {kHead + "MSG\t6 GAZE_COORDS 0 0 1e9 5\n", "expected a screen of 16 to 16384"},
      {kHead + "MSG\t6 GAZE_COORDS 0 0\n", "expected a number"},
      {start + "1e99\t1\t2\t3\t.\n2e99\t1\t2\t3\t.\n", "samples a second"},
  };
  for (const auto& [text, part] : cases) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find(part), std::string::npos) << message << "\n  wanted: " << part;
  }
}

TEST(EyeLinkAsc, WarnsOfALastLineThatIsCutOff) {
  const std::string start = kHead + "START\t10 \tLEFT\n10\t1\t2\t3\t.\n11\t1\t2\t3\t.\n";
  for (const char* cut : {"12", "12\t1\t2", "12\t1\t2\n", "SBLINK", "EBLINK L 10", "EBLINK L 10 1",
                          "MSG\t6 GAZE_COORDS 0 0"}) {
    const GazeTrace trace = read(start + cut);
    EXPECT_EQ(trace.samples.size(), 2u) << cut;
    ASSERT_EQ(trace.warnings.size(), 1u) << cut;
    EXPECT_NE(trace.warnings[0].find("last line is cut off"), std::string::npos) << cut;
  }
  EXPECT_NE(refusal(start + "12\t1\n13\t1\t2\t3\t.\n").find(":7: 2 values"), std::string::npos);
  EXPECT_NE(read(start + "12\t1\t2\t3\t.\n").warnings.at(0).find("no END"), std::string::npos);
  EXPECT_TRUE(read(start + "END\t12").warnings.empty());
}

struct RealFile {
  const char* name;
  const char* format;
  std::size_t samples;
  double rate_Hz, first_s, last_s;
  glm::ivec2 screen_px;
};

TEST(EyeLinkAsc, ReadsEveryRealFile) {
  const RealFile files[] = {
      {"eyelink_bino1000.asc",
       "EyeLink ASC, binocular",
       3467,
       1000,
       7427.362,
       7436.443,
       {1024, 768}},
      {"eyelink_binoRemote250.asc",
       "EyeLink ASC, binocular, remote",
       5125,
       250,
       12605.302,
       12630.450,
       {1024, 768}},
      {"eyelink_mono2000.asc",
       "EyeLink ASC, monocular",
       8976,
       2000,
       8258.957,
       8269.2825,
       {1024, 768}},
      {"eyelink_mono500.asc", "EyeLink ASC, monocular", 1834, 500, 7196.720, 7205.384, {1024, 768}},
      {"pymovements_eyelink_binocular_example.asc",
       "EyeLink ASC, binocular",
       368,
       1000,
       1408.660,
       1409.027,
       {1920, 1080}},
  };
  for (const RealFile& file : files) {
    const auto path = gazeData() / "vendors" / file.name;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    const GazeTrace trace = readTrace(path, {}, {});
    EXPECT_EQ(trace.format, file.format) << file.name;
    EXPECT_EQ(trace.samples.size(), file.samples) << file.name;
    EXPECT_EQ(trace.rate_Hz, file.rate_Hz) << file.name;
    EXPECT_NEAR(trace.samples.front().time_s, file.first_s, kClock_s) << file.name;
    EXPECT_NEAR(trace.samples.back().time_s, file.last_s, kClock_s) << file.name;
    EXPECT_EQ(trace.screen->size_px, file.screen_px) << file.name;
  }
}

TEST(EyeLinkAsc, MarksTheBlinkOfARealFile) {
  const auto path = gazeData() / "vendors" / "pymovements_eyelink_binocular_example.asc";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  for (const GazeSample& sample : readTrace(path, {}, {}).samples) {
    // The left eye's blink lasts from ...787 to ...883. The right eye's lies within.
    const bool inside = sample.time_s > 1408.7865 && sample.time_s < 1408.8835;
    EXPECT_EQ(sample.blink, inside) << sample.time_s;
  }
}

TEST(EyeLinkAsc, WarnsOfInaccurateGaze) {
  const auto warnings = [](const std::string& messages) {
    return read(kHead + messages +
                "START\t10 \tLEFT\n10\t1\t2\t3\t...\n11\t1\t2\t3\t...\nEND\t12\n")
        .warnings;
  };
  const auto validation = [](const std::string& result) {
    return "MSG\t8 !CAL VALIDATION HV9 L " + result + "  OFFSET 0.2 deg. 4.3,-5.2 pix.\n";
  };
  const std::string good = validation("LEFT  GOOD ERROR 0.31 avg. 0.75 max");
  const std::string poor = validation("LEFT  POOR ERROR 2.31 avg. 4.75 max");
  const std::string calibration = "MSG\t7 !CAL CALIBRATION HV9 L LEFT  GOOD\n";
  EXPECT_EQ(warnings(calibration + good + poor + "MSG\t9 !CAL VALIDATION HV9 L ABORTED\n"),
            std::vector<std::string>{
                "the last validation of the left eye before a recording block was poor, with a "
                "mean error of 2.31 deg: gaze may lie far beside its target"});
  EXPECT_EQ(warnings(validation("LEFT  POOR")),
            std::vector<std::string>{"the last validation of the left eye before a recording block "
                                     "was poor: gaze may lie far beside its target"});
  EXPECT_EQ(warnings(validation("LEFT  FAIR ERROR 1.31 avg. 1.75 max")).size(), 1u);
  EXPECT_TRUE(warnings(poor + good).empty());
  EXPECT_TRUE(warnings(poor + calibration).empty());
  EXPECT_TRUE(warnings(validation("RIGHT POOR ERROR 2.31 avg. 4.75 max")).empty());
  const auto drift = [](const std::string& deg) {
    return "MSG\t9 DRIFTCORRECT L LEFT  at 50,25  OFFSET " + deg + " deg.  -0.9,11.2 pix.\n";
  };
  EXPECT_TRUE(warnings(good + drift("0.32")).empty());
  EXPECT_TRUE(warnings(drift("3.50") + calibration + good).empty());
  EXPECT_TRUE(
      warnings("MSG\t9 DRIFTCORRECT R RIGHT at 50,25  OFFSET 3.50 deg.  -0.9,11.2 pix.\n").empty());
  EXPECT_EQ(warnings(good + drift("0.32") + drift("3.50")),
            std::vector<std::string>{"1 drift correction over 2 deg, of 3.5 deg at most: the "
                                     "calibration no longer held, so check the gaze nearby"});
}

}  // namespace FOCI_FILE
}  // namespace foci
