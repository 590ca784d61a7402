#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

const Screen kScreen{.size_px = {1600, 1200}, .size_m = {1.6, 1.2}, .distance_m = 1.0};
constexpr int kSamples = 400;

class NeonNative : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  /// @param more_B  bytes of a sample behind x and y
  void write(std::size_t more_B) const {
    std::ofstream raw(folder_ / "gaze ps1.raw", std::ios::binary);
    std::ofstream time(folder_ / "gaze ps1.time", std::ios::binary);
    std::ofstream worn(folder_ / "worn ps1.raw", std::ios::binary);
    for (int i = 0; i < kSamples; ++i) {
      const float point_px[] = {100.5f + 2.0f * static_cast<float>(i), 600.0f};
      const std::int64_t time_ns = 1'700'000'000'000'000'000 + 5'000'000LL * i;
      raw.write(reinterpret_cast<const char*>(point_px), sizeof point_px);
      raw << std::string(more_B, 'x');
      time.write(reinterpret_cast<const char*>(&time_ns), sizeof time_ns);
      worn.put(i == 7 ? '\0' : '\xff');
    }
  }

  fs::path folder_ = fs::temp_directory_path() / ("foci_neon_" + std::to_string(getpid()));
};

TEST_F(NeonNative, IsReadByFolderOrFile) {
  for (const std::size_t more_B : {0, 12}) {
    write(more_B);
    for (const fs::path& path : {folder_, folder_ / "gaze ps1.raw"}) {
      const GazeTrace trace = readTrace(path, {}, kScreen);
      EXPECT_EQ(trace.format, "Neon, native recording");
      ASSERT_EQ(trace.samples.size(), static_cast<std::size_t>(kSamples));
      EXPECT_NEAR(trace.rate_Hz, 200.0, 0.01);  // a double has 0.2 us of a date
      ASSERT_TRUE(trace.samples[10].point_px);
      EXPECT_EQ(*trace.samples[10].point_px, glm::dvec2(120.5, 600.0));
      EXPECT_FALSE(trace.samples[7].point_px);  // nobody wears the glasses
    }
  }
  EXPECT_EQ(companionsOf(folder_).size(), 3u);
  EXPECT_EQ(companionsOf(folder_ / "gaze ps1.raw").size(), 2u);
}

TEST_F(NeonNative, TakesTheFileOf200HzWhereThereIsOne) {
  write(0);
  std::ofstream raw(folder_ / "gaze_200hz.raw", std::ios::binary);
  std::ofstream time(folder_ / "gaze_200hz.time", std::ios::binary);
  for (int i = 0; i < kSamples; ++i) {
    const float point_px[] = {50.5f + static_cast<float>(i), 300.0f};
    const std::int64_t time_ns = 1'700'000'000'000'000'000 + 5'000'000LL * i;
    raw.write(reinterpret_cast<const char*>(point_px), sizeof point_px);
    time.write(reinterpret_cast<const char*>(&time_ns), sizeof time_ns);
  }
  raw.close();
  time.close();
  for (const fs::path& path : {folder_, folder_ / "gaze_200hz.raw"}) {
    const GazeTrace trace = readTrace(path, {}, kScreen);
    ASSERT_EQ(trace.samples.size(), static_cast<std::size_t>(kSamples));
    EXPECT_EQ(*trace.samples[10].point_px, glm::dvec2(60.5, 300.0));
  }
  fs::remove(folder_ / "gaze_200hz.time");
  EXPECT_NE(refusalBy([&] { readTrace(folder_, {}, kScreen); }).find("gaze_200hz.time"),
            std::string::npos);
}

TEST_F(NeonNative, EyeStateHasPupilsAndBothEyes) {
  write(0);
  {
    std::ofstream raw(folder_ / "eye_state ps1.raw", std::ios::binary);
    std::ofstream time(folder_ / "eye_state ps1.time", std::ios::binary);
    for (int i = 0; i < kSamples / 2; ++i) {
      // Right, down and forward of the scene camera: the left eye looks up, the right one ahead.
      const float numbers[] = {3.5f,  -32.0f, 10.0f, -30.0f, 0.0f, -0.6f, 0.8f, 4.5f, 31.0f,
                               11.0f, -29.0f, 0.0f,  0.0f,   1.0f, 0.1f,  0.2f};  // of the eyelids
      const std::int64_t time_ns = 1'700'000'000'000'000'000 + 5'000'000LL * i + 1'000'000;
      raw.write(reinterpret_cast<const char*>(numbers), sizeof numbers);
      time.write(reinterpret_cast<const char*>(&time_ns), sizeof time_ns);
    }
  }
  const GazeTrace trace = readTrace(folder_, {}, kScreen);
  const GazeSample& sample = trace.samples[10];
  constexpr double kFloat = 1e-6;
  EXPECT_EQ(*sample.point_px, glm::dvec2(120.5, 600.0));  // gaze is no axis of an eye
  EXPECT_NEAR(*sample.eyes[0].pupil_mm, 3.5, kFloat);
  EXPECT_NEAR(*sample.eyes[1].pupil_mm, 4.5, kFloat);
  EXPECT_NEAR(*sample.pupil_mm, 4.0, kFloat);
  EXPECT_LT(glm::distance(*sample.eyes[0].direction, glm::dvec3(0.0, 0.6, -0.8)), kFloat);
  EXPECT_LT(glm::distance(*sample.eyes[1].direction, glm::dvec3(0.0, 0.0, -1.0)), kFloat);
  EXPECT_LT(glm::distance(*sample.eyes[0].origin_m, glm::dvec3(-0.032, -0.010, 0.030)), kFloat);
  // The eyes' file ends in the middle.
  EXPECT_FALSE(trace.samples.back().eyes[0].direction);
  EXPECT_FALSE(trace.samples.back().pupil_mm);
  EXPECT_TRUE(trace.samples.back().point_px);
  EXPECT_EQ(companionsOf(folder_).size(), 5u);
}

TEST_F(NeonNative, NamesAPartThatIsMissing) {
  write(0);
  const auto refusal = [&] { return refusalBy([&] { readTrace(folder_, {}, kScreen); }); };
  // Another stream shows that there was a second part.
  std::ofstream(folder_ / "imu ps2.raw") << "x";
  EXPECT_NE(refusal().find("gaze ps2.raw"), std::string::npos) << refusal();
  std::ofstream(folder_ / "gaze ps2.raw") << std::string(80, '\0');
  EXPECT_NE(refusal().find("gaze ps2.time"), std::string::npos) << refusal();
  fs::rename(folder_ / "gaze ps1.raw", folder_ / "lost.raw");
  EXPECT_NE(refusal().find("gaze ps1.raw"), std::string::npos) << refusal();
}

TEST_F(NeonNative, RefusesFilesThatDoNotBelongTogether) {
  write(0);
  fs::resize_file(folder_ / "gaze ps1.raw", 8 * kSamples - 4);
  EXPECT_THROW(readTrace(folder_, {}, kScreen), InputError);
  fs::resize_file(folder_ / "gaze ps1.time", 0);
  EXPECT_THROW(readTrace(folder_, {}, kScreen), InputError);
  fs::remove(folder_ / "gaze ps1.time");
  EXPECT_THROW(readTrace(folder_, {}, kScreen), InputError);
}

// As pl-rec-export writes it: without the columns of Pupil Cloud's export.
TEST(NeonExport, ATableWithoutRecordingIdIsRead) {
  std::string text = "timestamp [ns],gaze x [px],gaze y [px],worn\n";
  for (int i = 0; i < 100; ++i) {
    text += std::to_string(1'700'000'000'000'000'000 + 5'000'000LL * i) + "," +
            std::to_string(100 + i) + ",600.5," + (i == 7 ? "0" : "1") + "\n";
  }
  const GazeTrace trace = readTrace(ScratchFile(text).path(), {}, kScreen);
  EXPECT_EQ(trace.format, "Neon export");
  EXPECT_FALSE(trace.samples[7].point_px);
  EXPECT_EQ(*trace.samples[8].point_px, glm::dvec2(108.0, 600.5));
  EXPECT_NEAR(trace.rate_Hz, 200.0, 0.01);
}

}  // namespace FOCI_FILE
}  // namespace foci
