#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRate_Hz = 100.0;
constexpr double kClock_s = 1e-6;  // the bound on times against the simulated truth
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
                   const std::string& format, const std::string& channels, int count,
                   double rate_Hz = kRate_Hz) {
  return chunk(2, bytesOfNumber(id) + "<?xml version=\"1.0\"?><info><name>" + name +
                      "</name><type>" + type + "</type><channel_count>" + std::to_string(count) +
                      "</channel_count><nominal_srate>" + std::to_string(rate_Hz) +
                      "</nominal_srate><channel_format>" + format +
                      "</channel_format><desc><channels>" + channels + "</channels></desc></info>");
}

const std::string kPoint =
    "<channel><label>gaze_x</label><unit>normalized</unit></channel>"
    "<channel><label>gaze_y</label><unit>normalized</unit></channel>";

std::string gazeHeader(std::uint32_t id = 7, double rate_Hz = kRate_Hz) {
  return "XDF:" + chunk(1, "<?xml version=\"1.0\"?><info><version>1.0</version></info>") +
         header(id, "Tracker", "Gaze", "float32", kPoint, 2, rate_Hz);
}

/// A computer's clock. Both clocks of a recording are functions of the true time.
struct Clock {
  double start_s = 0.0;  // what it shows at time 0
  double drift = 0.0;
  double operator()(double true_s) const { return start_s + (1.0 + drift) * true_s; }
};

/// What LabRecorder writes: it measures the offset to the stream's clock, and stores it with the
/// time of the measurement on the stream's clock (`now - offset`).
std::string clockOffset(std::uint32_t id, const Clock& recorder, const Clock& stream, double true_s,
                        double error_s = 0.0) {
  const double now_s = recorder(true_s);
  const double offset_s = now_s - stream(true_s) + error_s;
  return chunk(4, bytesOfNumber(id) + bytesOfNumber(now_s - offset_s) + bytesOfNumber(offset_s));
}

std::string gazeSample(double stamp_s, int i) {
  return "\x08" + bytesOfNumber(stamp_s) +
         bytesOfNumber(0.25f + 0.001f * static_cast<float>(i % 500)) + bytesOfNumber(0.5f);
}

std::string gazeChunk(const std::vector<double>& stamps_s, std::uint32_t id = 7) {
  std::string samples =
      bytesOfNumber(id) + "\x04" + bytesOfNumber(static_cast<std::uint32_t>(stamps_s.size()));
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    samples += gazeSample(stamps_s[i], static_cast<int>(i));
  }
  return chunk(3, samples);
}

std::string marker(std::uint32_t id, double stamp_s, const std::string& text) {
  return chunk(3, bytesOfNumber(id) + "\x01\x01\x08" + bytesOfNumber(stamp_s) + "\x01" +
                      static_cast<char>(static_cast<unsigned char>(text.size())) + text);
}

const Clock kRecorder{.start_s = 1000.0};
// Of a computer that started a week before, 20 ppm fast.
const Clock kTracker{.start_s = 605'800.0, .drift = 2e-5};

std::vector<double> trueTimes(int count, double from_s = 0.0) {
  std::vector<double> times_s;
  for (int i = 0; i < count; ++i) times_s.push_back(from_s + i / kRate_Hz);
  return times_s;
}

std::vector<double> onClock(const Clock& clock, std::vector<double> times_s) {
  for (double& time_s : times_s) time_s = clock(time_s);
  return times_s;
}

GazeTrace readBytes(const std::string& bytes, const TraceColumns& columns = {}) {
  return readTrace(ScratchFile(bytes).path(), columns, kScreen);
}

void expectTimes(const GazeTrace& trace, const std::vector<double>& true_s) {
  ASSERT_EQ(trace.samples.size(), true_s.size());
  for (std::size_t i = 0; i < true_s.size(); ++i) {
    ASSERT_NEAR(trace.samples[i].time_s, kRecorder(true_s[i]), kClock_s) << i;
  }
}

TEST(Xdf, TimesAreThoseOfTheRecordersClock) {
  // Markers come from a third computer.
  const Clock stimuli{.start_s = 33.0, .drift = -1e-4};
  std::string file = gazeHeader() + header(8, "Stimuli", "Markers", "string", "", 1, 0.0);
  const std::vector<double> true_s = trueTimes(3000);
  file += gazeChunk(onClock(kTracker, true_s));
  for (const double at_s : {0.5, 5.5, 10.5, 15.5, 20.5, 25.5}) {
    file += clockOffset(7, kRecorder, kTracker, at_s) + clockOffset(8, kRecorder, stimuli, at_s);
    file += marker(8, stimuli(at_s), "shown");
  }
  const GazeTrace trace = readBytes(file);
  expectTimes(trace, true_s);
  EXPECT_EQ(trace.format.substr(0, 21), "XDF, stream \"Tracker\"");
  ASSERT_EQ(trace.markers.size(), 6u);
  EXPECT_NEAR(trace.markers[0].time_s, kRecorder(0.5), kClock_s);
  EXPECT_NEAR(trace.markers[5].time_s, kRecorder(25.5), kClock_s);
  constexpr double kFloat_px = 1e-3;
  EXPECT_NEAR(trace.samples[150].point_px->x, 400.0, kFloat_px);
  EXPECT_NEAR(trace.samples[150].point_px->y, 250.0, kFloat_px);
}

TEST(Xdf, WildClockOffsetsChangeNothing) {
  for (const double wild_s : {0.05, -0.7, 3.0, -700.0, 4e5}) {
    for (const int wild : {0, 1, 3, 7}) {
      std::string file = gazeHeader();
      for (int i = 0; i < 8; ++i) {
        file += clockOffset(7, kRecorder, kTracker, 0.5 + 5.0 * i, i == wild ? wild_s : 0.0);
      }
      const std::vector<double> true_s = trueTimes(4000);
      SCOPED_TRACE(testing::Message() << wild_s << " s, offset " << wild);
      expectTimes(readBytes(file + gazeChunk(onClock(kTracker, true_s))), true_s);
    }
  }
}

TEST(Xdf, EachLifeOfATrackersClockHasItsOffset) {
  // The tracker's computer starts again after 20 s: its clock falls back, or jumps ahead.
  for (const double start_s : {3.0, 605'790.0, 2e6}) {
    const Clock again{.start_s = start_s, .drift = -3e-5};
    std::string file = gazeHeader();
    for (const double at_s : {0.5, 5.5, 10.5, 15.5}) {
      file += clockOffset(7, kRecorder, kTracker, at_s);
    }
    for (const double at_s : {30.5, 35.5, 40.5}) {
      file += clockOffset(7, kRecorder, again, at_s);
    }
    std::vector<double> true_s = trueTimes(1800);
    std::vector<double> stamps_s = onClock(kTracker, true_s);
    for (const double time_s : trueTimes(1500, 29.0)) {
      true_s.push_back(time_s);
      stamps_s.push_back(again(time_s));
    }
    SCOPED_TRACE(start_s);
    const GazeTrace trace = readBytes(file + gazeChunk(stamps_s));
    expectTimes(trace, true_s);
    EXPECT_TRUE(std::ranges::any_of(trace.assumed, [](const std::string& phrase) {
      return phrase.find("was reset") != std::string::npos;
    }));
  }
}

TEST(Xdf, JitterGoesAndGapsStay) {
  std::vector<double> true_s = trueTimes(1000);
  for (const double time_s : trueTimes(1000, 10.37)) true_s.push_back(time_s);
  std::vector<double> stamps_s = onClock(kTracker, true_s);
  constexpr double kJitter_s = 0.004;
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    stamps_s[i] += kJitter_s * std::sin(2.39996 * static_cast<double>(i));  // golden angle: even
  }
  std::string file = gazeHeader();
  for (const double at_s : {0.5, 5.5, 10.5}) file += clockOffset(7, kRecorder, kTracker, at_s);
  const GazeTrace trace = readBytes(file + gazeChunk(stamps_s));
  ASSERT_EQ(trace.samples.size(), true_s.size());
  for (std::size_t i = 0; i < true_s.size(); ++i) {
    ASSERT_NEAR(trace.samples[i].time_s, kRecorder(true_s[i]), 0.01 * kJitter_s) << i;
  }
}

TEST(Xdf, AnUnevenStreamKeepsItsTimes) {
  // A webcam that states 30 Hz and gives what the light allows.
  std::vector<double> true_s;
  double time_s = 0.0;
  for (int i = 0; i < 600; ++i) {
    true_s.push_back(time_s);
    time_s += i < 300 ? 0.033 : 0.05 + 0.01 * std::sin(i * 0.05);
  }
  const std::string file = gazeHeader(7, 30.0) + clockOffset(7, kRecorder, kTracker, 0.5) +
                           clockOffset(7, kRecorder, kTracker, 20.5) +
                           gazeChunk(onClock(kTracker, true_s));
  expectTimes(readBytes(file), true_s);
}

TEST(Xdf, ASampleWithoutATimeFollowsTheOneBefore) {
  std::string samples = bytesOfNumber(std::uint32_t{7}) + "\x01\x64";
  for (int i = 0; i < 100; ++i) {
    const std::string sample = gazeSample(i / kRate_Hz, i);
    samples += i % 2 == 0 ? sample : '\0' + sample.substr(9);
  }
  const GazeTrace trace = readBytes(gazeHeader() + chunk(3, samples));
  ASSERT_EQ(trace.samples.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_NEAR(trace.samples[i].time_s, static_cast<double>(i) / kRate_Hz, kClock_s);
  }
  EXPECT_TRUE(std::ranges::any_of(trace.assumed, [](const std::string& assumed) {
    return assumed.find("no clock offsets") != std::string::npos;
  }));
}

TEST(Xdf, MarkersAreTextsOfAllChannelsOrNumbers) {
  std::string file = gazeHeader() + gazeChunk(trueTimes(200));
  file += header(11, "Answers", "Markers", "string", "", 2, 0.0);
  file += chunk(3, bytesOfNumber(std::uint32_t{11}) + "\x01\x01\x08" + bytesOfNumber(1.5) +
                       "\x01\x06" + "answer" + "\x01\x03" + "y\tn");
  file += header(12, "EyeTrackerPort", "Markers", "int32", "", 1, 0.0);
  file += chunk(3, bytesOfNumber(std::uint32_t{12}) + "\x01\x01\x08" + bytesOfNumber(0.5) +
                       bytesOfNumber(std::int32_t{42}));
  const GazeTrace trace = readBytes(file);
  ASSERT_EQ(trace.markers.size(), 2u);
  EXPECT_EQ(trace.markers[0].text, "42");
  EXPECT_EQ(trace.markers[0].time_s, 0.5);
  EXPECT_EQ(trace.markers[1].text, "answer y n");
}

TEST(Xdf, StreamsOfOneNameHaveNumbers) {
  const std::string file = gazeHeader() + header(9, "Events", "Markers", "string", "", 1, 0.0) +
                           header(3, "Tracker", "Gaze", "float32", kPoint, 2) +
                           gazeChunk(trueTimes(200)) + gazeChunk(trueTimes(300, 50.0), 3);
  for (const char* stream : {"", "Tracker"}) {
    const std::string refusal = refusalBy([&] { readBytes(file, {.stream = stream}); });
    EXPECT_NE(refusal.find("gaze.stream"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("#1 \"Tracker\", #2 \"Events\" (texts, not numbers), #3 \"Tracker\""),
              std::string::npos)
        << refusal;
  }
  EXPECT_EQ(readBytes(file, {.stream = "#1"}).samples.size(), 200u);
  EXPECT_EQ(readBytes(file, {.stream = "#3"}).samples.size(), 300u);
  EXPECT_THROW(readBytes(file, {.stream = "#2"}), InputError);
  EXPECT_THROW(readBytes(file, {.stream = "#4"}), InputError);
}

TEST(Xdf, APackedFileIsTheSameRecording) {
  const std::string bytes = gazeHeader() + gazeChunk(trueTimes(200));
  const ScratchFile file("");
  const gzFile out = gzopen(file.path().c_str(), "wb");
  gzwrite(out, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(out);
  EXPECT_EQ(readTrace(file.path(), {}, kScreen).samples.size(), 200u);
}

std::string channel(const std::string& label, const std::string& eye, const std::string& unit) {
  return "<channel><label>" + label + "</label>" + (eye.empty() ? "" : "<eye>" + eye + "</eye>") +
         "<type>any</type>" + (unit.empty() ? "" : "<unit>" + unit + "</unit>") + "</channel>";
}

/// A stream of doubles that are the same in each sample.
std::string stream(const std::string& channels, const std::vector<double>& values) {
  std::string file = "XDF:" + header(7, "Tracker", "Gaze", "double64", channels,
                                     static_cast<int>(values.size()), 0.0);
  std::string samples = bytesOfNumber(std::uint32_t{7}) + "\x01\x64";
  for (int i = 0; i < 100; ++i) {
    samples += "\x08" + bytesOfNumber(i / kRate_Hz);
    for (const double value : values) samples += bytesOfNumber(value);
  }
  return file + chunk(3, samples);
}

TEST(Xdf, KnowsTheChannelsOfPupilCapturesRelay) {
  std::string channels = channel("confidence", "both", "normalized") +
                         channel("norm_pos_x", "both", "normalized") +
                         channel("norm_pos_y", "both", "normalized");
  for (const std::string axis : {"x", "y", "z"}) {
    channels += channel("gaze_point_3d_" + axis, "both", "mm");
  }
  for (const std::string eye : {"0", "1"}) {
    const std::string side = eye == "0" ? "right" : "left";
    for (const std::string axis : {"x", "y", "z"}) {
      channels += channel("eye_center" + eye + "_3d_" + axis, side, "mm");
    }
  }
  for (const std::string eye : {"0", "1"}) {
    const std::string side = eye == "0" ? "right" : "left";
    for (const std::string axis : {"x", "y", "z"}) {
      channels += channel("gaze_normal" + eye + "_" + axis, side, "mm");
    }
  }
  for (const std::string eye : {"0", "1"}) {
    channels += channel("diameter" + eye + "_3d", eye == "0" ? "right" : "left", "mm");
  }
  const double nan = std::nan("");
  const GazeTrace in_space =
      readBytes(stream(channels, {0.9, 0.25, 0.75, 1,    2,   300, 20,  15,  -20, -40,
                                  16,  -20,  0.0,  -0.6, 0.8, 0.0, 0.0, 1.0, 3.5, 4.5}));
  const GazeSample& sample = in_space.samples[5];
  EXPECT_LT(glm::distance(*sample.eyes[0].direction, glm::dvec3(0.0, 0.0, -1.0)), 1e-9);
  EXPECT_LT(glm::distance(*sample.eyes[1].direction, glm::dvec3(0.0, 0.6, -0.8)), 1e-9);
  EXPECT_EQ(sample.eyes[0].pupil_mm, 4.5);
  EXPECT_EQ(sample.eyes[1].pupil_mm, 3.5);
  EXPECT_EQ(sample.confidence, 0.9);
  // Mapped in two dimensions, and counted from the lower left corner.
  const GazeTrace flat =
      readBytes(stream(channels, {0.9, 0.25, 0.75, nan, nan, nan, nan, nan, nan, nan,
                                  nan, nan,  nan,  nan, nan, nan, nan, nan, nan, nan}));
  EXPECT_EQ(*flat.samples[5].point_px, glm::dvec2(250.0, 125.0));
}

TEST(Xdf, KnowsTheChannelsOfEyeLinksRelay) {
  std::string channels;
  for (const char* label :
       {"leftEyeX", "leftEyeY", "rightEyeX", "rightEyeY", "leftPupilArea", "rightPupilArea",
        "pixelsPerDegreeX", "pixelsPerDegreeY", "eyelink_timestamp", "LSL_timestamp"}) {
    channels += channel(label, "", "");
  }
  const GazeTrace both = readBytes(stream(channels, {400, 200, 420, 220, 900, 950, 34, 34, 7, 8}));
  EXPECT_EQ(*both.samples[5].point_px, glm::dvec2(410.0, 210.0));
  EXPECT_EQ(*both.samples[5].eyes[1].point_px, glm::dvec2(420.0, 220.0));
  // An eye that is not recorded is 0, one that is not seen -32768.
  for (const double none : {0.0, -32768.0}) {
    const GazeTrace left = readBytes(stream(channels, {400, 200, none, none, 9, 0, 34, 34, 7, 8}));
    EXPECT_FALSE(left.samples[5].eyes[1].point_px);
    EXPECT_EQ(*left.samples[5].point_px, glm::dvec2(400.0, 200.0));
  }
}

TEST(Xdf, ChannelsOfOneLabelAreThoseOfTheirEyes) {
  const std::string channels = channel("x", "both", "pixels") + channel("y", "both", "pixels") +
                               channel("PupilDiameter", "left", "millimeters") +
                               channel("PupilDiameter", "right", "millimeters");
  const GazeTrace trace = readBytes(stream(channels, {400, 200, 3.0, 4.0}));
  EXPECT_EQ(trace.samples[5].eyes[0].pupil_mm, 3.0);
  EXPECT_EQ(trace.samples[5].eyes[1].pupil_mm, 4.0);
}

TEST(Xdf, NeonsPixelsAreThoseOfItsSceneCamera) {
  const auto channels = [](const std::string& space) {
    std::string text;
    for (const char* label : {"x", "y"}) {
      text.append("<channel><label>").append(label).append("</label><unit>pixels</unit>") +=
          "<coordinate_system>" + space + "</coordinate_system></channel>";
    }
    return text;
  };
  const auto warnings = [&](const std::string& name, const std::string& space) {
    return readBytes("XDF:" + header(7, name, "Gaze", "float32", channels(space), 2) +
                     gazeChunk(trueTimes(64)))
        .warnings;
  };
  const auto of_camera = [](const std::string& warning) {
    return warning.find("scene camera") != std::string::npos;
  };
  EXPECT_TRUE(std::ranges::any_of(warnings("Phone_Neon Gaze", ""), of_camera));
  EXPECT_TRUE(std::ranges::any_of(warnings("Tracker", "image-space"), of_camera));
  EXPECT_FALSE(std::ranges::any_of(warnings("Tracker", ""), of_camera));
}

TEST(Xdf, AFileThatIsCutOffHasItsFirstSamples) {
  const std::string before = gazeHeader() + gazeChunk(trueTimes(100));
  const std::string whole = before + gazeChunk(trueTimes(100, 1.0));
  const auto isSaid = [](const GazeTrace& trace) {
    return std::ranges::any_of(trace.warnings, [](const std::string& warning) {
      return warning.find("the file is cut off") != std::string::npos;
    });
  };
  EXPECT_FALSE(isSaid(readBytes(whole)));
  std::size_t samples = 100;
  for (std::size_t size = before.size() + 1; size < whole.size(); ++size) {
    const GazeTrace trace = readBytes(whole.substr(0, size));
    EXPECT_GE(trace.samples.size(), samples) << size;
    EXPECT_TRUE(isSaid(trace)) << size;
    samples = trace.samples.size();
  }
  EXPECT_EQ(samples, 199u);
  const std::string refusal = refusalBy([&] { readBytes(before.substr(0, 100)); });
  EXPECT_NE(refusal.find("no streams"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("cut off"), std::string::npos) << refusal;
}

TEST(Xdf, RefusesWhatIsNoRecording) {
  const std::string head = gazeHeader();
  std::string channels = head + gazeChunk(trueTimes(100));
  channels.replace(channels.find("<channel_count>2<"), 17, "<channel_count>9<");
  const std::string texts = "XDF:" + header(7, "Tracker", "Gaze", "string", kPoint, 2, kRate_Hz);
  std::string short_chunk =
      head + chunk(3, bytesOfNumber(std::uint32_t{7}) + "\x01\x09\x08") + gazeChunk(trueTimes(100));
  const std::pair<std::string, const char*> cases[] = {
      {"XDF:", "no streams"},
      {texts, "\"Tracker\" (texts, not numbers)"},
      {channels, "a sample without a time"},
      {short_chunk, "ends too early"},
      {head + chunk(3, bytesOfNumber(std::uint32_t{5}) + "\x01\x01"), "before the header"},
      {head + chunk(4, bytesOfNumber(std::uint32_t{7}) + bytesOfNumber(0.0) + bytesOfNumber(0.0)) +
           chunk(4, bytesOfNumber(std::uint32_t{7}) + bytesOfNumber(0.1) + bytesOfNumber(0.6)) +
           gazeChunk(trueTimes(100)),
       "half a second in a second"},
  };
  for (const auto& [bytes, part] : cases) {
    const std::string refusal = refusalBy([&bytes = bytes] { readBytes(bytes); });
    EXPECT_NE(refusal.find(part), std::string::npos) << refusal << "\n  wanted: " << part;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
