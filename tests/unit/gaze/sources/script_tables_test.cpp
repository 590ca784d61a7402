// Tables of Pupil Core, iMotions and scripts: units in names, empty columns, ticks, NaN.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"
#include "tests/unit/gaze/sources/read_tables.h"

namespace foci {
namespace FOCI_FILE {

TEST(ScriptTable, PupilCoresSurfacesCountFromTheLowerEdge) {
  const GazeTrace trace =
      readTrace(ScratchFile("world_timestamp,world_index,gaze_timestamp,x_norm,y_norm,x_scaled,"
                            "y_scaled,on_surf,confidence\n"
                            "10.0,0,10.001,0.5,0.25,0.1,0.05,True,0.9\n"
                            "10.0,0,10.006,1.25,0.25,0.25,0.05,False,0.9\n"
                            "10.0,0,10.011,0.5,0.25,0.1,0.05,True,0.2\n")
                    .path(),
                {}, {.size_px = {1000, 800}});
  EXPECT_EQ(trace.format, "Pupil Core surface");
  ASSERT_EQ(trace.assumed.size(), 1u);
  EXPECT_NE(trace.assumed[0].find("screen.size_px"), std::string::npos) << "the surface's size";
  EXPECT_DOUBLE_EQ(trace.samples[0].time_s, 10.001);
  expectPoint(trace.samples[0].point_px, 500, 600);
  expectPoint(trace.samples[1].point_px, 1250, 600);  // beside the surface
  EXPECT_FALSE(trace.samples[2].point_px);            // not confident
}

TEST(ScriptTable, PupilCoreIn2dHasEmptyDirections) {
  const std::string header =
      "gaze_timestamp,world_index,confidence,norm_pos_x,norm_pos_y,base_data,eye_center0_3d_x,"
      "eye_center0_3d_y,eye_center0_3d_z,gaze_normal0_x,gaze_normal0_y,gaze_normal0_z,"
      "gaze_normal1_x,gaze_normal1_y,gaze_normal1_z\n";
  const ScratchFile file(header +
                         "\n10,0,0.9,0.5,0.25,a,,,,,,,,,\n10.01,0,0.9,0.25,0.75,a,,,,,,,,,\n");
  const GazeTrace trace = readTrace(file.path(), {}, {.size_px = {1000, 800}});
  EXPECT_EQ(trace.format, "Pupil Core export");
  ASSERT_EQ(trace.samples.size(), 2u);
  expectPoint(trace.samples[0].point_px, 500, 600);
  expectPoint(trace.samples[1].point_px, 250, 200);
  const TraceHeader read = streamTrace(file.path(), {}, {}, [](const GazeSample&) {});
  EXPECT_EQ(read.units, GazeUnits::normalised);
  EXPECT_EQ(read.columns[3].meaning,
            "horizontal position of gaze, fractions of the screen from its lower left corner");
  for (std::size_t column = 6; column < 15; ++column) {
    EXPECT_EQ(read.columns[column].meaning, "unused") << column;
  }
  EXPECT_NE(refusal(header).find("0 samples"), std::string::npos) << refusal(header);
}

TEST(ScriptTable, FractionsWithoutAnOriginAreAssumedToCountDown) {
  for (const std::string names : {"norm_x,norm_y", "x_norm,y_norm", "x [normalised],y [norm]"}) {
    const ScratchFile file("t_s," + names + "\n0,0.5,0.25\n0.01,0.25,0.75\n");
    const auto assumes = [&](const TraceColumns& columns) {
      const TraceHeader read = streamTrace(file.path(), columns, {}, [](const GazeSample&) {});
      EXPECT_EQ(read.columns[1].meaning.find("upper left") == std::string::npos,
                columns.offset != glm::dvec2(0.0));
      return std::ranges::any_of(read.assumed, [](const std::string& phrase) {
        return phrase.starts_with("origin: upper left corner, y down");
      });
    };
    EXPECT_TRUE(assumes({})) << names;
    EXPECT_FALSE(assumes({.scale = {1.0, -1.0}, .offset = {0.0, 1.0}})) << names;
  }
}

TEST(ScriptTable, MinutesAreSecondsAndPerCentNeedsAScale) {
  const auto first = [](const std::string& header) {
    const ScratchFile file(header + ",x_px,y_px\n60,1,2\n60.001,1,2\n");
    return readTrace(file.path(), {}, {}).samples[0].time_s;
  };
  EXPECT_DOUBLE_EQ(first("time [s]"), 60.0);
  EXPECT_DOUBLE_EQ(first("time (min)"), 3600.0);
  const std::string rows = "\n0,50,50\n0.01,50,50\n";
  for (const std::string names : {"time_s,x [%],y [%]", "time_s,x_percent,y_percent"}) {
    EXPECT_NE(refusal(names + rows).find("is in \"%\": expected px"), std::string::npos)
        << refusal(names + rows);
  }
  const std::string named = "time_s,x_pct,y_pct" + rows;
  EXPECT_NE(refusal(named, {.x = "x_pct", .y = "y_pct"}).find("gaze.scale"), std::string::npos);
  const GazeTrace scaled = readTrace(
      ScratchFile(named).path(),
      {.x = "x_pct", .y = "y_pct", .units = GazeUnits::normalised, .scale = glm::dvec2(0.01)},
      {.size_px = {1000, 800}});
  expectPoint(scaled.samples[0].point_px, 500, 400);
}

TEST(ScriptTable, TicksOf100NanosecondsAreTold) {
  const auto ticks = [](double first, int rows) {
    std::string text = "timestamp,x_px,y_px\n";
    for (int i = 0; i < rows; ++i) {
      text += std::to_string(static_cast<long long>(first + 1e7 / 60.0 * i)) + ",1,2\n";
    }
    return text;
  };
  constexpr double kSlack_Hz = 0.02;                    // a double of 18 digits resolves 128 ticks
  for (const double first : {0.0, 638e15, 1.335e17}) {  // from 0; of .NET; of Windows' FILETIME
    const ScratchFile file(ticks(first, 200));
    EXPECT_NEAR(readTrace(file.path(), {}, {}).rate_Hz, 60.0, kSlack_Hz) << first;
    EXPECT_NEAR(readTrace(file.path(), {.time_scale_s = 1e-7}, {}).rate_Hz, 60.0, kSlack_Hz);
  }
}

TEST(ScriptTable, IMotionsHasBothEyesBelowItsPreamble) {
  const GazeTrace trace = readTrace(
      ScratchFile("#INFO,\n#Study name,Test\n#DATA,\nRow,Timestamp,ET_GazeLeftx,ET_GazeLefty,"
                  "ET_GazeRightx,ET_GazeRighty\n1,1000,100,50,110,60\n2,1010,-1,-1,110,60\n")
          .path(),
      {}, {});
  EXPECT_EQ(trace.format, "iMotions, binocular");
  expectPoint(trace.samples[0].point_px, 105, 55);
  EXPECT_FALSE(trace.samples[1].eyes[0].point_px);
  EXPECT_DOUBLE_EQ(trace.samples[1].time_s, 1.01);
}

TEST(ScriptTable, NamesInALaterLineAreHintedAt) {
  EXPECT_NE(refusal("Recording of P01\n\ntime_s,x_px,y_px\n0,1,2\n").find("begin them with #"),
            std::string::npos);
  EXPECT_EQ(refusal("# Recording of P01\n\ntime_s,x_px,y_px\n0,1,2\n0.01,1,2\n"), "not refused");
  EXPECT_EQ(refusal("frame,x,y\n0,1,2\n").find("a later line"), std::string::npos);
}

TEST(ScriptTable, AColumnNamedGazeComesBeforeAPlainOne) {
  const ScratchFile file("time_s,x,y,gaze_x,gaze_y\n0,1,2,3,4\n0.01,1,2,3,4\n");
  expectPoint(readTrace(file.path(), {}, {}).samples[0].point_px, 3, 4);
  expectPoint(readTrace(file.path(), {.x = "x", .y = "y"}, {}).samples[0].point_px, 1, 2);
}

TEST(ScriptTable, NaNAsWindowsPrintsItIsDataLoss) {
  for (const std::string word :
       {"-nan", "-nan(ind)", "nan(IND)", "1.#QNAN", "-1.#IND", "NULL", "#N/A"}) {
    const GazeTrace trace = readTrace(
        ScratchFile("time_s,x_px,y_px\n0,1,2\n0.01," + word + "," + word + "\n").path(), {}, {});
    EXPECT_FALSE(trace.samples[1].point_px) << word;
  }
  EXPECT_NE(refusal("time_s,x_px,y_px\n0,1,2\n0.01,inf,inf\n").find("expected a number"),
            std::string::npos);
}

TEST(ScriptTable, WarnsOfAPupilWhoseNameIsOfNoDiameterInMillimetres) {
  const auto warned = [](const std::string& name, double scale_mm) {
    const ScratchFile file("time_s\tx_px\ty_px\t" + name + "\n0\t10\t20\t2\n0.01\t11\t20\t2\n");
    for (const std::string& warning :
         readTrace(file.path(), {.pupil = name, .pupil_scale_mm = scale_mm}, {}).warnings) {
      if (warning.find("\"" + name + "\" is read as the pupil's diameter in mm") != warning.npos) {
        return true;
      }
    }
    return false;
  };
  for (const char* name : {"pupil_radius_mm", "pupil_px", "pupil_area_mm2", "pupil_cm"}) {
    EXPECT_TRUE(warned(name, 1.0)) << name;
  }
  EXPECT_TRUE(warned("pupil_area_mm2", 2.0));
  EXPECT_FALSE(warned("pupil_radius_mm", 2.0));
  EXPECT_FALSE(warned("pupil_px", 0.1));
  for (const char* name : {"pupil_mm", "pupil", "size_of_pupil", "Diameter [mm]"}) {
    EXPECT_FALSE(warned(name, 1.0)) << name;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
