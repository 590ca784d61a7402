#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "gaze/sources/trace_reader.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

GazeTrace read(const std::string& name, const std::string& text) {
  const fs::path file =
      fs::temp_directory_path() / ("foci_" + std::to_string(getpid()) + "_" + name);
  std::ofstream(file) << text;
  const GazeTrace trace = readTrace(file, {}, {});
  fs::remove(file);
  return trace;
}

/// Glasses look straight ahead, then right: x points left there.
void expectTwoSamples(const GazeTrace& trace) {
  EXPECT_EQ(trace.format, "Tobii Pro Glasses, native recording, binocular");
  ASSERT_EQ(trace.samples.size(), 3u);
  EXPECT_NEAR(trace.samples[1].time_s - trace.samples[0].time_s, 0.02, 1e-9);
  const EyeSample& left = trace.samples[0].eyes[0];
  ASSERT_TRUE(left.direction && left.origin_m);
  EXPECT_NEAR(left.direction->z, -1.0, 1e-9);
  EXPECT_NEAR(left.origin_m->x, -0.03, 1e-9);
  EXPECT_EQ(left.pupil_mm, 3.5);
  EXPECT_NEAR(trace.samples[1].eyes[1].direction->x, 0.6, 1e-9);
  EXPECT_FALSE(trace.samples[2].direction);
}

TEST(TobiiGlasses, LiveDataOfGlasses2) {
  const std::string text =
      R"({"ts":1000000,"s":0,"gidx":1,"pc":[30.0,-10.0,-20.0],"eye":"left"}
{"ts":1000000,"s":0,"gidx":1,"pd":3.5,"eye":"left"}
{"ts":1000000,"s":0,"gidx":1,"gd":[0.0,0.0,1.0],"eye":"left"}
{"ts":1000000,"s":0,"gidx":1,"gd":[0.0,0.0,1.0],"eye":"right"}
{"ts":1000100,"s":0,"gidx":1,"gp":[0.5,0.5],"l":88000}
{"ts":1005000,"s":0,"ac":[0.1,-9.8,0.3]}
{"ts":1020000,"s":0,"gidx":2,"gd":[-0.6,0.0,0.8],"eye":"left"}
{"ts":1020000,"s":0,"gidx":2,"gd":[-0.6,0.0,0.8],"eye":"right"}
{"ts":1040000,"s":1,"gidx":3,"gd":[0.0,0.0,0.0],"eye":"left"}
{"ts":1040000,"s":1,"gidx":3,"gd":[0.0,0.0,0.0],"eye":"right"}
)";
  expectTwoSamples(read("livedata.json", text));
}

TEST(TobiiGlasses, GazeDataOfGlasses3) {
  const std::string eye = R"("gazedirection":[0.0,0.0,1.0],"pupildiameter":3.5})";
  const std::string right = R"({"gazeorigin":[-30.0,0.0,0.0],"gazedirection":[-0.6,0.0,0.8]})";
  const std::string text =
      R"({"type":"gaze","timestamp":0.10,"data":{"gaze2d":[0.5,0.5],"eyeleft":{"gazeorigin":[30.0,0.0,0.0],)" +
      eye + R"(,"eyeright":{"gazeorigin":[-30.0,0.0,0.0],)" + eye + "}}\n" +
      R"({"type":"gaze","timestamp":0.12,"data":{"eyeleft":)" + right + R"(,"eyeright":)" + right +
      "}}\n" + R"({"type":"gaze","timestamp":0.14,"data":{}})" + "\n";
  expectTwoSamples(read("gazedata", text));
}

}  // namespace FOCI_FILE
}  // namespace foci
