// Tests of each vendor's format: on a few rows as the vendor writes them, and on real files if
// present.
#include <gtest/gtest.h>

#include <cmath>

#include "base/input_error.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/bids.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;
const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};

GazeTrace read(std::string_view bytes) { return readTrace(ScratchFile(bytes).path(), {}, kScreen); }

TEST(Cyclopean, DoesNotJumpWhenAnEyeIsMissing) {
  Cyclopean eyes;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(*eyes.combine(0.01 * i, glm::dvec2(100, 50), glm::dvec2(140, 60)),
              glm::dvec2(120, 55));
  }
  EXPECT_LT(glm::distance(*eyes.combine(1.0, glm::dvec2(100, 50), {}), glm::dvec2(120, 55)),
            kRounding);
  EXPECT_LT(glm::distance(*eyes.combine(1.1, {}, glm::dvec2(140, 60)), glm::dvec2(120, 55)),
            kRounding);
  EXPECT_FALSE(eyes.combine(1.2, {}, {}));
  EXPECT_EQ(*Cyclopean().combine(0.0, glm::dvec2(100, 50), {}), glm::dvec2(100, 50));
}

TEST(ReadTable, GuessesTheUnitOfTimeFromTheRate) {
  EXPECT_EQ(read("time,x,y\n0,1,1\n4,1,1\n8,1,1\n").rate_Hz, 250.0);
  EXPECT_EQ(read("timestamp,x,y\n0,1,1\n1000,1,1\n2000,1,1\n").rate_Hz, 1000.0);
  EXPECT_EQ(read("t,x,y\n0,1,1\n0.02,1,1\n0.04,1,1\n").rate_Hz, 50.0);
}

TEST(ReadTable, KeepsBothEyes) {
  const GazeTrace trace =
      read("time_s\tx_left\ty_left\tx_right\ty_right\n0\t10\t20\t30\t40\n0.01\tnan\tnan\t30\t40\n");
  EXPECT_EQ(trace.format, "TSV, binocular");
  EXPECT_EQ(*trace.samples[0].eyes[0].point_px, glm::dvec2(10, 20));
  EXPECT_EQ(*trace.samples[0].eyes[1].point_px, glm::dvec2(30, 40));
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(20, 30));
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_EQ(*trace.samples[1].point_px, glm::dvec2(20, 30));
}

TEST(ReadTobii, LabTablesKeepTheEyeTrackersRows) {
  const GazeTrace trace = read(
      "Recording timestamp [\xce\xbcs]\tSensor\tRecording resolution width\tRecording resolution "
      "height\tGaze point X [DACS px]\tGaze point Y [DACS px]\tGaze point left X [DACS px]\tGaze "
      "point left Y [DACS px]\tPupil diameter left [mm]\tValidity left\n"
      "1000\tMouse\t1680\t1050\t\t\t\t\t\t\n"
      "2000\tEye Tracker\t1680\t1050\t100\t200\t90\t210\t3,21\tValid\n"
      "10333\tEye Tracker\t1680\t1050\t\t\t5\t6\t3,2\tInvalid\n");
  EXPECT_EQ(trace.format, "Tobii Pro Lab");
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(1680, 1050));
  ASSERT_EQ(trace.samples.size(), 2u);
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 0.002);
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(100, 200));
  EXPECT_EQ(*trace.samples[0].eyes[0].point_px, glm::dvec2(90, 210));
  EXPECT_DOUBLE_EQ(*trace.samples[0].pupil_mm, 3.21);
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
}

TEST(ReadTobii, SdkTuplesAreFractionsOfTheScreen) {
  const std::string header =
      "device_time_stamp,left_gaze_point_on_display_area,left_gaze_point_validity,"
      "left_pupil_diameter,right_gaze_point_on_display_area,right_gaze_point_validity\n";
  const GazeTrace trace = read(header +
                               "1000,\"(0.5, 0.5)\",1,3.5,\"(0.25, 1.0)\",1\n"
                               "12111,\"(nan, nan)\",0,nan,\"(0.25, 1.0)\",1\n");
  EXPECT_EQ(trace.format, "Tobii Pro SDK, binocular");
  EXPECT_EQ(*trace.samples[0].eyes[1].point_px, glm::dvec2(480, 1080));
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(720, 810));
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_NEAR(trace.rate_Hz, 90.0, 0.01);
  EXPECT_THROW(read(header + "1000,0.5,1,3,\"(1, 1)\",1\n2000,\"(0, 0)\",1,3,\"(1, 1)\",1\n"),
               InputError);
}

TEST(ReadTobii, SdkColumnsInSpaceAreTheTuplesInSpace) {
  // In millimetres of the user coordinate system; 3D columns of an invalid origin do not count.
  const GazeTrace tuples = read(
      "device_time_stamp,left_gaze_point_on_display_area,"
      "left_gaze_point_in_user_coordinate_system,left_gaze_point_validity,"
      "left_gaze_origin_in_user_coordinate_system,left_gaze_origin_validity\n"
      "1000,\"(0.5, 0.5)\",\"(0, 150, 0)\",1,\"(-30, 150, 640)\",1\n"
      "12111,\"(0.5, 0.4)\",\"(0, 180, 0)\",1,\"(-30, 150, 640)\",0\n");
  const GazeTrace columns = read(
      "device_time_stamp,left_gaze_point_on_display_area_x,left_gaze_point_on_display_area_y,"
      "left_gaze_point_in_user_coordinate_system_x,left_gaze_point_in_user_coordinate_system_y,"
      "left_gaze_point_in_user_coordinate_system_z,left_gaze_point_validity,"
      "left_gaze_origin_in_user_coordinate_system_x,left_gaze_origin_in_user_coordinate_system_y,"
      "left_gaze_origin_in_user_coordinate_system_z,left_gaze_origin_validity\n"
      "1000,0.5,0.5,0,150,0,1,-30,150,640,1\n"
      "12111,0.5,0.4,0,180,0,1,-30,150,640,0\n");
  EXPECT_EQ(columns.format, tuples.format);
  for (std::size_t i : {0, 1}) {
    const EyeSample &a = tuples.samples[i].eyes[0], &b = columns.samples[i].eyes[0];
    EXPECT_EQ(a.point_px, b.point_px);
    EXPECT_EQ(a.origin_m, b.origin_m);
    EXPECT_EQ(a.direction, b.direction);
  }
  const EyeSample& eye = columns.samples[0].eyes[0];
  EXPECT_EQ(*eye.origin_m, glm::dvec3(-0.03, 0.15, 0.64));
  EXPECT_NEAR(glm::distance(*eye.direction, glm::normalize(glm::dvec3(30, 0, -640))), 0.0, 1e-12);
  EXPECT_FALSE(columns.samples[1].eyes[0].origin_m);
}

TEST(ReadPupil, LinesOfSightBecomePointsAndLowConfidenceIsDataLoss) {
  std::string text =
      "gaze_timestamp,world_index,confidence,norm_pos_x,norm_pos_y,base_data,gaze_normal0_x,"
      "gaze_normal0_y,gaze_normal0_z,gaze_normal1_x,gaze_normal1_y,gaze_normal1_z,"
      "eye_center0_3d_x,eye_center0_3d_y,eye_center0_3d_z\n"
      "10.0,0,0.9,0.5,0.5,a,0.1,0.0,0.995,-0.1,0.0,0.995,20,15,-20\n"
      "10.01,0,0.2,0.5,0.5,a,0.1,0.0,0.995,-0.1,0.0,0.995,20,15,-20\n"
      "10.02,0,1.0,0.5,0.5,a,0.0,0.1,0.995,,,,20,15,-20\n";
  const GazeTrace trace = read(text);
  EXPECT_EQ(trace.format, "Pupil Core export, binocular");
  // Lines of sight are degrees, whatever screen is known.
  const TraceHeader header =
      streamTrace(ScratchFile(text).path(), {}, {}, [](const GazeSample&) {});
  EXPECT_EQ(header.units, GazeUnits::deg);
  EXPECT_TRUE(header.nominal_screen);
  // Straight ahead is the screen's centre. The camera's y points down, as the screen's does.
  EXPECT_LT(glm::distance(*trace.samples[0].point_px, glm::dvec2(960, 540)), kRounding);
  EXPECT_EQ(trace.samples[0].confidence, 0.9);
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_GT(trace.samples[2].point_px->y, 600.0);
  EXPECT_FALSE(trace.samples[2].eyes[0].direction);
  EXPECT_LT(glm::distance(*trace.samples[0].eyes[1].origin_m, glm::dvec3(0.02, -0.015, 0.02)),
            kRounding);
  EXPECT_LT(trace.samples[0].eyes[1].direction->z, -0.9);
}

TEST(ReadNeon, NanosecondsPixelsAndBlinks) {
  const GazeTrace trace = read(
      "section id,recording id,timestamp [ns],gaze x [px],gaze y [px],worn,fixation id,blink "
      "id,azimuth [deg],elevation [deg]\n"
      "a,b,1700000000000000000,800.5,600.25,1,1,,0.1,0.2\n"
      "a,b,1700000000005000000,801.5,601.25,1,1,7,0.1,0.2\n");
  EXPECT_EQ(trace.format, "Neon export");
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(800.5, 600.25));
  EXPECT_TRUE(trace.samples[1].blink);
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_NEAR(trace.rate_Hz, 200.0, 0.1);
  ASSERT_EQ(trace.warnings.size(), 1u);
  EXPECT_NE(trace.warnings[0].find("a scene camera on the head"), std::string::npos);
}

TEST(ReadGazeBase, DegreesAndItsValidity) {
  const GazeTrace trace =
      read("n,x,y,val,xT,yT,dP,lab\n0,1.5,-2,0,NaN,NaN,300,1\n1,1.6,-2,4,NaN,NaN,300,1\n");
  EXPECT_EQ(trace.format, "GazeBase");
  EXPECT_EQ(trace.rate_Hz, 1000.0);
  EXPECT_LT(
      glm::distance(eccentricity_deg(kScreen, *trace.samples[0].point_px), glm::dvec2(1.5, -2)),
      kRounding);
  EXPECT_FALSE(trace.samples[1].point_px);
}

TEST(ReadSmi, ReadsTheScreenAndTakesZerosForDataLoss) {
  const GazeTrace trace = read(
      "## [BeGaze]\n## Converted from:\tx.idf\n## Calibration Area:\t1680\t1050\n"
      "## Stimulus Dimension [mm]:\t474\t297\n## Head Distance [mm]:\t700\n"
      "Time\tType\tTrial\tL POR X [px]\tL POR Y [px]\tL Mapped Diameter [mm]\tR POR X [px]\tR POR "
      "Y "
      "[px]\n"
      "5000000\tSMP\t1\t100.00\t200.00\t3.40\t110.00\t200.00\n"
      "5001000\tMSG\t1\t# Message: stimulus.png\n"
      "5002000\tSMP\t1\t0.00\t0.00\t0.00\t0.00\t0.00\n");
  EXPECT_EQ(trace.format, "SMI BeGaze, binocular");
  ASSERT_EQ(trace.samples.size(), 2u);
  EXPECT_EQ(trace.screen->size_px, glm::ivec2(1680, 1050));
  EXPECT_DOUBLE_EQ(trace.screen->size_m.x, 0.474);
  EXPECT_DOUBLE_EQ(trace.screen->distance_m, 0.7);
  EXPECT_EQ(*trace.samples[0].point_px, glm::dvec2(105, 200));
  EXPECT_DOUBLE_EQ(*trace.samples[0].pupil_mm, 3.4);
  EXPECT_FALSE(trace.samples[1].point_px);
  EXPECT_EQ(trace.rate_Hz, 500.0);
}

/// Writes a recording as `foci trace convert` does. @return the file of the first eye
std::filesystem::path convert(const std::vector<GazeSample>& samples, const TraceHeader& header,
                              const std::filesystem::path& folder) {
  const BidsNames names(folder / "sub-01_task-look_physio.tsv.gz");
  BidsContents contents;
  for (const GazeSample& sample : samples) contents.add(sample);
  for (const auto& side : contents.recordings()) {
    BidsTable table(names.ofEye(side, "physio.tsv.gz"), contents, side);
    for (const GazeSample& sample : samples) table.add(sample);
    table.finish();
    std::ofstream(names.ofEye(side, "physio.json"))
        << bidsPhysioJson(header, contents, side, 500.0);
  }
  std::ofstream(names.ofTask("events.json")) << bidsEventsJson(*header.screen);
  EXPECT_TRUE(statesScreen(names.ofTask("events.json"), *header.screen));
  return names.ofEye(contents.recordings()[0], "physio.tsv.gz");
}

class Bids : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("foci_bids_" + std::to_string(getpid()));
};

TEST_F(Bids, RoundTripsTheGazeOfBothEyesTogether) {
  std::vector<GazeSample> samples;
  for (int i = 0; i < 5000; ++i) {
    GazeSample sample{.time_s = 100.0 + 0.002 * i};
    if (i % 10 != 9) sample.point_px = glm::dvec2(500.125 + i, 300.5);
    if (i % 10 == 9) sample.blink = true;
    if (i % 2) sample.pupil_mm = 3.25;
    samples.push_back(sample);
  }
  const auto file =
      convert(samples, {{.format = "test", .screen = kScreen, .assumed = {"unit: px"}}}, folder);
  EXPECT_TRUE(file.string().ends_with("sub-01_task-look_recording-eye1_physio.tsv.gz"));
  const GazeTrace trace = readTrace(file, {}, {});
  EXPECT_EQ(trace.assumed, std::vector<std::string>{"as foci converted it: unit: px"});
  EXPECT_EQ(trace.format, "BIDS eye tracking");
  EXPECT_EQ(trace.rate_Hz, 500.0);
  EXPECT_EQ(trace.screen->size_px, kScreen.size_px);
  EXPECT_EQ(trace.screen->size_m, kScreen.size_m);
  EXPECT_EQ(trace.screen->distance_m, kScreen.distance_m);
  ASSERT_EQ(trace.samples.size(), 5000u);
  EXPECT_EQ(*trace.samples[7].point_px, glm::dvec2(507.125, 300.5));
  EXPECT_EQ(trace.samples[7].pupil_mm, 3.25);
  EXPECT_FALSE(trace.samples[8].pupil_mm);
  EXPECT_TRUE(trace.samples[9].blink);
  EXPECT_DOUBLE_EQ(trace.samples[4999].time_s, 109.998);

  // A packed file that breaks off is refused.
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_THROW(readTrace(file, {}, {}), InputError);
  EXPECT_THROW(BidsNames(folder / "gaze.tsv"), InputError);
}

TEST_F(Bids, EachEyeHasAFileWithoutEmptyColumns) {
  std::vector<GazeSample> samples;
  for (int i = 0; i < 200; ++i) {
    GazeSample sample{.time_s = 0.002 * i};
    for (const std::size_t side : {0, 1}) {
      sample.eyes[side].point_px = glm::dvec2(400.0 + 20.0 * static_cast<double>(side), i);
      sample.eyes[side].pupil_own = 1000.0 + static_cast<double>(side);
    }
    samples.push_back(sample);
  }
  const auto file =
      convert(samples, {{.format = "test", .screen = kScreen, .pupil_unit = "arbitrary"}}, folder);
  const GazeTrace trace = readTrace(file, {}, {});
  EXPECT_EQ(trace.format, "BIDS eye tracking, binocular");
  EXPECT_EQ(*trace.samples[7].eyes[0].point_px, glm::dvec2(400, 7));
  EXPECT_EQ(*trace.samples[7].eyes[1].point_px, glm::dvec2(420, 7));
  EXPECT_EQ(trace.samples[7].eyes[1].pupil_own, 1001.0);
  std::ifstream in(folder / "sub-01_task-look_recording-eye2_physio.json");
  const std::string json{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(json.find("\"RecordedEye\": \"right\""), json.npos) << json;
  EXPECT_NE(json.find("\"arbitrary\""), json.npos) << json;
  EXPECT_EQ(json.find("blink"), json.npos) << json;
  EXPECT_EQ(json.find("StimulusPresentation"), json.npos) << "the screen is in _events.json";
}

TEST(ReadTrace, ReadsEveryVendorsRealFile) {
  const auto folder = gazeData() / "vendors";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const struct {
    const char *file, *format;
    double rate_Hz;
    std::size_t samples;
  } expected[] = {{"tobii_4c.csv", "Tobii Pro SDK, binocular", 90.0, 453},
                  {"pupil_core_gaze_positions.csv", "Pupil Core export, binocular", 237.0, 9302},
                  {"pymovements_gazebase_vr_example.csv", "GazeBaseVR, binocular", 250.6, 10},
                  {"pymovements_judo1000_example.csv", "TSV, binocular", 1000.0, 10},
                  {"pymovements_gaze_with_loss.csv", "CSV", 250.0, 1000},
                  {"eyelink_bino1000.asc", "EyeLink ASC, binocular", 1000.0, 0}};
  for (const auto& [file, format, rate_Hz, samples] : expected) {
    const GazeTrace trace = readTrace(folder / file, {}, kScreen);
    EXPECT_EQ(trace.format, format);
    EXPECT_NEAR(trace.rate_Hz / rate_Hz, 1.0, 0.06) << file;
    if (samples > 0) {
      EXPECT_EQ(trace.samples.size(), samples) << file;
    }
  }
  const GazeTrace tobii = readTrace(folder / "tobii_4c.csv", {}, kScreen);
  EXPECT_NEAR(tobii.samples[0].eyes[0].point_px->x, 1920 * 0.10997918248, 1e-3);
  EXPECT_NEAR(*tobii.samples[0].pupil_mm, 0.5 * (2.97882080078 + 3.37985229492), 1e-9);
}

}  // namespace FOCI_FILE
}  // namespace foci
