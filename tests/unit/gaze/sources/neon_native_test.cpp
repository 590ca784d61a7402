#include "gaze/sources/neon_native.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"

namespace foci {
namespace {

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

TEST_F(NeonNative, RefusesFilesThatDoNotBelongTogether) {
  write(0);
  fs::resize_file(folder_ / "gaze ps1.raw", 8 * kSamples - 4);
  EXPECT_THROW(readTrace(folder_, {}, kScreen), InputError);
  fs::resize_file(folder_ / "gaze ps1.time", 0);
  EXPECT_THROW(readTrace(folder_, {}, kScreen), InputError);
  fs::remove(folder_ / "gaze ps1.time");
  EXPECT_THROW(readTrace(folder_, {}, kScreen), InputError);
}

}  // namespace
}  // namespace foci
