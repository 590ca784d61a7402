#include "gaze/sources/xdf.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace {

constexpr double kRate_Hz = 100.0;
constexpr int kSampleCount = 200;
const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};

template <class Number>
std::string bytesOfNumber(Number value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string chunk(std::uint16_t tag, const std::string& content) {
  return "\x04" + bytesOfNumber(static_cast<std::uint32_t>(content.size() + 2)) +
         bytesOfNumber(tag) + content;
}

std::string header(std::uint32_t id, const std::string& name, const std::string& type,
                   const std::string& format, const std::string& channels, int count) {
  return chunk(2, bytesOfNumber(id) + "<?xml version=\"1.0\"?><info><name>" + name +
                      "</name><type>" + type + "</type><channel_count>" + std::to_string(count) +
                      "</channel_count><nominal_srate>100</nominal_srate><channel_format>" +
                      format + "</channel_format><desc><channels>" + channels +
                      "</channels></desc></info>");
}

/// Gaze in fractions of the screen. The tracker's clock is 5 s behind the recorder's and 0.1 %
/// slow.
std::string xdf(bool second_gaze_stream = false) {
  std::string file =
      "XDF:" + chunk(1, "<?xml version=\"1.0\"?><info><version>1.0</version></info>");
  file += header(7, "Tracker", "Gaze", "float32",
                 "<channel><label>gaze_x</label><unit>normalized</unit></channel>"
                 "<channel><label>gaze_y</label><unit>normalized</unit></channel>",
                 2);
  file += header(8, "Events", "Markers", "string", "<channel><label>event</label></channel>", 1);
  if (second_gaze_stream) file += header(9, "Other", "eyes", "double64", "", 1);
  for (const double at_s : {0.0, 1.0, 2.0}) {
    const double offset_s = 5.0 + 0.001 * at_s;
    file += chunk(4, bytesOfNumber(std::uint32_t{7}) + bytesOfNumber(at_s + offset_s) +
                         bytesOfNumber(offset_s));
  }
  std::string samples = bytesOfNumber(std::uint32_t{7}) + "\x01" +
                        static_cast<char>(static_cast<unsigned char>(kSampleCount));
  for (int i = 0; i < kSampleCount; ++i) {
    // Every second sample leaves its time to the rate.
    samples += i % 2 == 0 ? "\x08" + bytesOfNumber(i / kRate_Hz) : std::string(1, '\0');
    samples += bytesOfNumber(0.25f + 0.001f * static_cast<float>(i)) + bytesOfNumber(0.5f);
  }
  file += chunk(3, samples);
  file += chunk(3, bytesOfNumber(std::uint32_t{8}) + "\x01\x01\x08" + bytesOfNumber(1.0) +
                       "\x01\x05" + "start");
  return file + chunk(6, bytesOfNumber(std::uint32_t{7}) + "<info></info>");
}

TEST(Xdf, ReadsItsGazeStreamOnTheRecordersClock) {
  const GazeTrace trace = readTrace(ScratchFile(xdf()).path(), {}, kScreen);
  ASSERT_EQ(trace.samples.size(), static_cast<std::size_t>(kSampleCount));
  constexpr double kFloat_px = 1e-3;
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{150}}) {
    const double time_s = static_cast<double>(i) / kRate_Hz;
    EXPECT_NEAR(trace.samples[i].time_s, time_s + 5.0 + 0.001 * time_s, 1e-9);
    ASSERT_TRUE(trace.samples[i].point_px);
    EXPECT_NEAR(trace.samples[i].point_px->x, 250.0 + static_cast<double>(i), kFloat_px);
    EXPECT_NEAR(trace.samples[i].point_px->y, 250.0, kFloat_px);
  }
  EXPECT_EQ(trace.format.substr(0, 21), "XDF, stream \"Tracker\"");
}

TEST(Xdf, TextsAreMarkersOnTheRecordersClock) {
  std::string file = xdf();
  // A second stream of texts, two channels a sample, whose clock is 10 s behind.
  file += header(11, "Answers", "Markers", "string", "", 2);
  file += chunk(4, bytesOfNumber(std::uint32_t{11}) + bytesOfNumber(10.5) + bytesOfNumber(10.0));
  file += chunk(3, bytesOfNumber(std::uint32_t{11}) + "\x01\x01\x08" + bytesOfNumber(-9.5) +
                       "\x01\x06" + "answer" + "\x01\x03" + "y\tn");
  const GazeTrace trace = readTrace(ScratchFile(file).path(), {}, kScreen);
  ASSERT_EQ(trace.markers.size(), 2u);
  EXPECT_EQ(trace.markers[0].text, "answer y n");
  EXPECT_NEAR(trace.markers[0].time_s, 0.5, 1e-9);
  EXPECT_EQ(trace.markers[1].text, "start");
  EXPECT_NEAR(trace.markers[1].time_s, 1.0, 1e-9);
}

TEST(Xdf, AsksWhichStreamOfTwo) {
  const ScratchFile file(xdf(true));
  try {
    readTrace(file.path(), {}, kScreen);
    FAIL() << "took one of two streams";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("gaze.stream"), std::string::npos) << error.what();
  }
  TraceColumns columns;
  columns.stream = "Tracker";
  EXPECT_EQ(readTrace(file.path(), columns, kScreen).samples.size(),
            static_cast<std::size_t>(kSampleCount));
  columns.stream = "Events";
  EXPECT_THROW(readTrace(file.path(), columns, kScreen), InputError);
}

TEST(Xdf, SaysThatAFileHasNoStreams) {
  try {
    readTrace(ScratchFile("XDF:").path(), {}, kScreen);
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no streams"), std::string::npos) << error.what();
  }
}

TEST(Xdf, RefusesEveryFileThatIsCutOffInAChunk) {
  const std::string whole = xdf();
  for (std::size_t size = 5; size < whole.size(); size += 37) {
    try {
      readTrace(ScratchFile(whole.substr(0, size)).path(), {}, kScreen);
    } catch (const InputError&) {
      continue;
    }
    // Only a cut behind the last sample leaves a whole table.
    EXPECT_GT(size, whole.size() - 100) << size;
  }
}

TEST(Xdf, RefusesChannelsThatAFileCannotHave) {
  std::string broken = xdf();
  broken.replace(broken.find("<channel_count>2<"), 17, "<channel_count>9<");
  EXPECT_THROW(readTrace(ScratchFile(broken).path(), {}, kScreen), InputError);
}

}  // namespace
}  // namespace foci
