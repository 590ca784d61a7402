#include "gaze/sources/trace_reader.h"

#include <gtest/gtest.h>

#include <random>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;  // a handful of double operations

const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};

GazeTrace read(std::string_view bytes, const TraceColumns& columns = {},
               const Screen& screen = kScreen) {
  return readTrace(ScratchFile(bytes).path(), columns, screen);
}

std::string refusal(std::string_view bytes, const TraceColumns& columns = {},
                    const Screen& screen = kScreen) {
  try {
    read(bytes, columns, screen);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  return "not refused";
}

void expectRefusal(std::string_view bytes, std::string_view part, const TraceColumns& columns = {},
                   const Screen& screen = kScreen) {
  const std::string message = refusal(bytes, columns, screen);
  EXPECT_NE(message.find(part), std::string::npos) << message << "\n  wanted: " << part;
}

// On a busy machine samples have irregular times of arrival.
TEST(ReadTable, TimesOfArrivalNeedARate) {
  const ScratchFile file("time_s,x,y\n0,1,1\n0.000001,1,1\n0.000002,1,1\n0.03,1,1\n0.030001,1,1\n");
  EXPECT_THROW(readTrace(file.path(), {}, kScreen), InputError);
  const GazeTrace trace = readTrace(file.path(), {}, kScreen, 100.0);
  EXPECT_EQ(trace.rate_Hz, 100.0);
  EXPECT_EQ(trace.samples[3].time_s, 0.03);
  EXPECT_THROW(readTrace(file.path(), {}, kScreen, 1e6), InputError);
}

TEST(ReadTable, TakesEveryDelimiterAndLineEnd) {
  for (const std::string_view text :
       {"time_s\tx_px\ty_px\n0\t1.5\t2\n0.01\t3\t4\n", "time_s,x_px,y_px\n0,1.5,2\n0.01,3,4",
        "time_s;x_px;y_px\r\n0;1.5;2\r\n0.01;3;4\r\n",
        "\xef\xbb\xbftime_s , x_px , y_px\n\n0, 1.5, +2\n 0.01 ,3,4\n\n",
        "\"time_s\",\"x_px\",\"y_px\"\n\"0\",\"1.5\",\"2\"\n0.01,3,4\n"}) {
    const GazeTrace trace = read(text);
    ASSERT_EQ(trace.samples.size(), 2u) << text;
    EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(1.5, 2));
    EXPECT_EQ(*trace.samples[1].point_px, glm::dvec2(3, 4));
    EXPECT_EQ(trace.samples[1].time_s, 0.01);
    EXPECT_EQ(trace.rate_Hz, 100.0);
  }
}

TEST(ReadTable, ADelimiterInQuotesIsPartOfTheField) {
  const GazeTrace trace = read("note,time,x,y\n\"a,b\",0,1,2\n\"\"\"c\"\", d\",0.02,3,4\n");
  EXPECT_EQ(*trace.samples[1].point_px, glm::dvec2(3, 4));
}

TEST(ReadTable, ColumnsAreNamedOrRecognised) {
  TraceColumns named{.time = "T", .x = "right x", .y = "right y", .pupil = "p", .blink = "shut"};
  named.time_scale_s = 0.001;
  const GazeTrace trace =
      read("p,right y,right x,T,shut\n3.5,2,1,100,0\n0,2,1,104,1\nNaN,.,n/a,108,0\n", named);
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 0.1);
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(1, 2));
  EXPECT_EQ(trace.samples[0].pupil_mm, 3.5);
  EXPECT_FALSE(trace.samples[0].blink);
  EXPECT_TRUE(trace.samples[1].blink);
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_FALSE(trace.samples[1].pupil_mm);
  EXPECT_FALSE(trace.samples[2].point_px);
  EXPECT_EQ(trace.rate_Hz, 250.0);
}

TEST(ReadTable, AnyTableWithTwoEyesIsMapped) {
  // Blanks between the fields, -1 for data loss, the origin in the centre, y up, pupils in
  // hundredths of a millimetre.
  TraceColumns columns{.time = "clock", .confidence = "sure"};
  columns.eyes = {{{.x = "XL", .y = "YL", .pupil = "PL"}, {.x = "XR", .y = "YR", .pupil = "PR"}}};
  columns.time_scale_s = 0.001;
  columns.missing = -1.0;
  columns.scale = {1.0, -1.0};
  columns.offset = {500.0, 250.0};
  columns.pupil_scale_mm = 0.01;
  const GazeTrace trace = read(
      "clock  XL YL XR YR PL PR sure x y\n0 -10 20 10 20 300 500 1 7 7\n"
      "10 -1 -1 10 20 -1 500 1 7 7\n20 -10 20 10 20 300 500 0.2 7 7\n",
      columns);
  ASSERT_EQ(trace.samples.size(), 3u);
  EXPECT_EQ(*trace.samples[0].eyes[0].point_px, glm::dvec2(490, 230));
  EXPECT_EQ(*trace.samples[0].eyes[1].point_px, glm::dvec2(510, 230));
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(500, 230));
  EXPECT_DOUBLE_EQ(*trace.samples[0].pupil_mm, 4.0);
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_EQ(*trace.samples[1].point_px, glm::dvec2(500, 230));  // the left eye is 20 px aside
  EXPECT_DOUBLE_EQ(*trace.samples[1].pupil_mm, 5.0);
  EXPECT_FALSE(trace.samples[2].point_px);
  EXPECT_EQ(trace.format, "text, binocular");
}

TEST(ReadTable, NeitherNamesNorClockAreNeeded) {
  TraceColumns columns{.x = "#2", .y = "#3"};
  columns.rate_Hz = 50.0;
  for (const std::string_view text :
       {"7,10,20\n7,11,20\n7,12,20\n", "a,b,c\n7,10,20\n7,11,20\n7,12,20\n"}) {
    const GazeTrace trace = read(text, columns);
    ASSERT_EQ(trace.samples.size(), 3u);
    EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(10, 20));
    EXPECT_DOUBLE_EQ(trace.samples[2].time_s, 0.04);
  }
  // The rate in the file's first line also replaces a clock. A column of time is preferred.
  EXPECT_EQ(read("# sampling_Hz=200\nx,y\n1,2\n3,4\n").rate_Hz, 200.0);
  EXPECT_EQ(read("# sampling_Hz=200\ntime_s,x,y\n0,1,2\n0.01,3,4\n").rate_Hz, 100.0);
  expectRefusal("7,10,20\n", "no column \"#4\": expected #1 to #3",
                {.time = "#1", .x = "#2", .y = "#4"});
  expectRefusal("# sampling_Hz=0\nx,y\n1,2\n", "sampling_Hz = \"0\": expected 5 to 20000");
  TraceColumns half;
  half.eyes[0].x = "a";
  expectRefusal("t,a,b\n0,1,2\n", "left_x and left_y: expected both or neither", half);
}

TEST(ReadTable, TimeTakesItsUnitFromItsName) {
  EXPECT_DOUBLE_EQ(read("timestamp_us,x,y\n2000000,1,1\n2010000,1,1\n").samples[0].time_s, 2.0);
  EXPECT_DOUBLE_EQ(read("Time_ms,X,Y\n2000,1,1\n2010,1,1\n").samples[0].time_s, 2.0);
}

TEST(ReadTable, DegreesAndFractionsBecomePixelsOfTheScreen) {
  const GazeTrace degrees = read("time_s,x_deg,y_deg\n0,0,0\n0.01,10,5\n");
  EXPECT_EQ(*degrees.samples[0].point_px, glm::dvec2(500, 250));
  const glm::dvec2 expected(500 + 0.6 * std::tan(glm::radians(10.0)) * 2000,
                            250 - 0.6 * std::tan(glm::radians(5.0)) * 2000);
  EXPECT_LT(glm::distance(*degrees.samples[1].point_px, expected), kRounding);
  const GazeTrace fractions =
      read("time,x,y\n0,0.5,1\n0.01,0,0\n", {.units = GazeUnits::normalised});
  EXPECT_EQ(*fractions.samples[0].point_px, glm::dvec2(500, 500));
}

TEST(ReadTable, TheFirstLineOverridesTheFallbackScreen) {
  const GazeTrace trace = read(
      "# units=deg screen_width_px=800 viewing_distance_m=0.5 subject=7\n"
      "time_s,x,y\n0,0,0\n0.01,0,0\n");
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(800, 500));
  EXPECT_EQ(trace.screen->distance_m, 0.5);
  EXPECT_EQ(trace.screen->size_m, kScreen.size_m);
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(400, 250));
}

TEST(ReadTable, RefusesMissingFilesColumnsAndPositions) {
  expectRefusal("", "empty");
  expectRefusal("\n\n", "empty");
  expectRefusal("time,x,y\n", "0 samples");
  expectRefusal("time,x,y\n0,1,1\n", "1 sample:");
  expectRefusal("time,x,y\n0,,\n0.01,NaN,nan\n", "no sample has a position");
  expectRefusal(
      "time,xx,y\n0,1,1\n",
      ":1: no column \"x\": name it with gaze.x; the columns are \"time\", \"xx\", \"y\"");
  expectRefusal("a,gaze_lx,b\n", "no column \"gaze_rx\": the nearest is \"gaze_lx\"",
                {.time = "a", .x = "gaze_rx"});
  expectRefusal("0.0,1,2\n0.1,1,2\n", "no column \"time\"");
  EXPECT_THROW(readTrace("/nonexistent/trace.tsv", {}, kScreen), InputError);
  EXPECT_THROW(readTrace(std::filesystem::temp_directory_path(), {}, kScreen), InputError);
}

TEST(ReadTable, RefusesValuesThatNoRecordingHas) {
  expectRefusal("time,x,y\n0,1,1\n0.01,1,1\n0.01,2,1\n", ":4: time \"0.01\" is not after");
  // The first of the repeated times, with what to do.
  expectRefusal("time,x,y\n0.0,1,1\n0.0,2,1\n0.01,1,1\n0.01,2,1\n", ":3: time \"0.0\"");
  expectRefusal("time,x,y\n0.0,1,1\n0.0,2,1\n0.01,1,1\n", "remove one of the two rows");
  expectRefusal("time,x,y\n0.01,1,1\n0.02,1,1\n0.01,1,1\n", ":4: time \"0.01\" is not after");
  expectRefusal("time,x,y\n0,1,1\n0.01,1,1\n0.02,1\n0.03,1,1\n", ":4: 2 fields: expected 3");
  expectRefusal("time,x,y\n0,abc,1\n", ":2: column 2 = \"abc\": expected a number");
  expectRefusal("time,x,y\n0,1e999,1\n", "expected a number");
  expectRefusal("time,x,y\n0,inf,1\n", "expected a number");
  expectRefusal("time,x,y\n0,1e30,1\n", "too far from any screen");
  expectRefusal("time,x_deg,y_deg\n0,90,1\n", "too far from any screen");
  expectRefusal("time,x,y\nNaN,1,1\n", "expected a time");
  expectRefusal("time,x,y\n1e300,1,1\n", "too large a time");
  expectRefusal("time,x,y\n0,1\n", ":2: 2 fields: expected 3 at least");
  expectRefusal("time_s,x,y\n0,1,1\n4,1,1\n8,1,1\n", "is the unit of time right?");
  expectRefusal("time,x,y\n0,1,1\n0.000001,1,1\n", "is the unit of time right?");
  expectRefusal("time,x,y\n0,1,1\n0.01,1,1\n0.02,1,1\n9e9,1,1\n", "at most a day");
  expectRefusal("time,x,y,pupil_mm\n0,1,1,1063\n", "diameter");
  expectRefusal("time,x,y,blink\n0,1,1,maybe\n", "expected 0 or 1");
  expectRefusal("time,x_px,y_deg\n0,1,1\n", "different units");
  expectRefusal("# units=furlongs\ntime,x,y\n0,1,1\n", "expected px, deg, normalised or relative");
  expectRefusal("# screen_width_px=1e9\ntime,x,y\n", ":1: screen_width_px = \"1e9\"");
}

TEST(ReadTable, WarnsOfALastLineThatIsCutOff) {
  std::string text = "time_s,x_px,y_px\n";
  for (int i = 0; i < 80; ++i) {
    const double time_s = 0.01 * i;
    text += decimal(time_s, 2) + "," + decimal(400 + 3 * (i % 7), 1) + "," +
            decimal(300 + 2 * (i % 5), 1) + "\n";
  }
  const auto warnings = [](const std::string& all) { return read(all).warnings; };
  EXPECT_EQ(warnings(text).size(), 0u);
  EXPECT_EQ(warnings(text + "0.80,402.0,301.5").size(), 0u) << "no line end alone means nothing";
  EXPECT_EQ(warnings(text + "0.80,402.0,nan").size(), 0u);
  EXPECT_EQ(warnings(text + "# the end\n").size(), 0u) << "a comment";
  EXPECT_EQ(warnings(text + "0.80,402.0,30\n").size(), 0u);
  for (const char* cut : {"0.80,402.0,30", "0.80,402.0", "0.8"}) {
    const auto said = warnings(text + cut);
    ASSERT_EQ(said.size(), 1u) << cut;
    EXPECT_NE(said[0].find("cut off"), std::string::npos) << said[0];
  }
}

TEST(ReadTable, RefusesBinaryAndEndlessLines) {
  expectRefusal(std::string_view("time,x,y\n0,1,1\n0.01,\0,1\n", 25), ":3: binary");
  expectRefusal(std::string(1 << 20, 'a'), "over 64 KiB");
  expectRefusal("time,x,y\n" + std::string(1 << 20, '1'), ":2: a line over 64 KiB");
  expectRefusal("time,x,y\r0,1,2\r1,2,3\r", ":1: lines end in CR: expected LF or CRLF");
  expectRefusal("time\x1b,x\ry,y\n", "no column");
}

// Any bytes give either an InputError of one line, or a trace that keeps the promises of readTrace.
TEST(ReadTrace, ThrowsNothingButInputErrorsOnDamagedFiles) {
  std::mt19937_64 bits(1);
  std::string asc = "** CONVERTED\nMSG\t1 GAZE_COORDS 0 0 99 99\nSTART\t10 \tLEFT\tRIGHT\n";
  for (int i = 10; i < 30; ++i) {
    asc += std::to_string(i) + "\t 1.5\t 2.5\t 3\t 4\t .\t 5\t.....\n";
    if (i == 15) asc += "SBLINK L 15\n";
    if (i == 20) asc += "EBLINK L 15\t19\t5\n";
  }
  std::string table = "# units=deg screen_width_px=100\ntime_s\tx\ty\tblink\n";
  for (int i = 0; i < 20; ++i) table += std::to_string(0.01 * i) + "\t\"1\"\t-1e0\t0\n";
  for (const std::string& whole : {asc, table}) {
    int accepted = 0;
    for (int round = 0; round < 600; ++round) {
      std::string bytes = whole;
      if (round % 3 == 0) bytes.resize(bits() % bytes.size());
      for (std::uint64_t n = bits() % 4; n > 0 && !bytes.empty(); --n) {
        const std::size_t at = bits() % bytes.size();
        const char letters[] = "0129.-eE\t\n\r,;\"#LR\xff ";
        bytes[at] = round % 2 ? static_cast<char>(bits()) : letters[bits() % 20];
      }
      try {
        const GazeTrace trace = read(bytes);
        ++accepted;
        ASSERT_GE(trace.samples.size(), 2u);
        ASSERT_TRUE(trace.screen);
        for (std::size_t i = 1; i < trace.samples.size(); ++i) {
          ASSERT_GT(trace.samples[i].time_s, trace.samples[i - 1].time_s);
        }
      } catch (const InputError& error) {
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
    EXPECT_GT(accepted, 0);
  }
}

TEST(ReadTable, AFirstLineMayStateTheSeparator) {
  for (const std::string separator : {";", ",", "|", "\t"}) {
    std::string text = "sep=,\r\ntime_s,x,y\r\n0,500,501\r\n0.01,502,503\r\n";
    for (std::size_t at = 0; (at = text.find(',', at)) != text.npos; ++at) {
      text.replace(at, 1, separator);
    }
    const GazeTrace trace = readTrace(ScratchFile(text).path(), {}, kScreen);
    ASSERT_EQ(trace.samples.size(), 2u);
    EXPECT_EQ(*trace.samples[1].point_px, glm::dvec2(502.0, 503.0));
  }
}

TEST(ReadTable, ALineBreakInQuotesIsNamed) {
  const std::string row = "0,500,500,\"a\"\n", cause = "a quote is left open at line 3";
  expectRefusal("time_s,x,y,note\n" + row + "0.01,500,500,\"two\nlines\"\n" + row, cause);
  expectRefusal("time_s,x,y,note\n" + row + "0.01,500,500,\"two\nlines, a, b, c\"\n", cause);
  expectRefusal("note,time_s,x,y\n\"a\",0,1,1\n\"two\nlines\",0.01,1,1\n\"a\",0.02,1,1\n", cause);
  EXPECT_EQ(refusal("time_s,x,y\n0,1\n").find("quote"), std::string::npos);
}

TEST(ReadTable, RadiansNeedTheirNameOrAScale) {
  const std::string rows = "\n0,0.1,0.1\n0.01,0.1,0.2\n";
  const auto expectRead = [&](const std::string& header, const TraceColumns& columns) {
    const GazeTrace trace = readTrace(ScratchFile(header + rows).path(), columns, kScreen);
    const glm::dvec2 second_deg = eccentricity_deg(kScreen, *trace.samples[1].point_px);
    EXPECT_LT(glm::distance(second_deg, glm::degrees(glm::dvec2(0.1, 0.2))), 1e-6) << header;
  };
  expectRead("time_s,x_rad,y_rad", {});
  expectRead("time_s,a_rad,b_rad", {.x = "a_rad", .y = "b_rad"});
  expectRead("time_s,x_rad,y_rad", {.units = GazeUnits::deg, .scale = glm::dvec2(57.29578)});
  expectRefusal("time_s,x,y" + rows, "gaze.scale = [57.29578, 57.29578]");
}

TEST(ReadTrace, ReadsTheLabelledRecordings) {
  const auto folder = gazeData() / "labelled";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const GazeTrace image = readTrace(folder / "andersson2017/img_TH34_img_Europe.tsv", {}, {});
  EXPECT_EQ(image.samples.size(), 4988u);
  EXPECT_EQ(image.rate_Hz, 500.0);
  EXPECT_EQ(image.screen->size_px, glm::ivec2(1024, 768));
  EXPECT_EQ(image.screen->distance_m, 0.67);
  EXPECT_EQ(*image.samples[0].point_px, glm::dvec2(522.05, 372.41));
  const GazeTrace degrees = readTrace(folder / "irf/S1.tsv", {}, kScreen);
  EXPECT_EQ(degrees.samples.size(), 81003u);
  const glm::dvec2 first_deg = eccentricity_deg(kScreen, *degrees.samples[0].point_px);
  EXPECT_LT(glm::distance(first_deg, glm::dvec2(0.234, -3.091)), kRounding);
}

}  // namespace FOCI_FILE
}  // namespace foci
