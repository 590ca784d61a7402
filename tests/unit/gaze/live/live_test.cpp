// Tests of the live sources. The Pupil source talks to a sender in this thread, over the loopback
// device.
#include <gtest/gtest.h>

#define MSGPACK_NO_BOOST
#include <chrono>
#include <cmath>
#include <msgpack.hpp>
#include <random>
#include <thread>
#include <zmq.hpp>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/live/live_source.h"
#include "gaze/live/pupil_source.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;
const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};

void packVector(msgpack::packer<msgpack::sbuffer>& packer, const glm::dvec3& v) {
  packer.pack_array(3);
  for (int axis : {0, 1, 2}) packer.pack(v[axis]);
}

/// A binocular message as Pupil sends it, in the frame of its camera (y down, z forward, mm).
/// @param integers  with integer keys, as older senders write
std::string datum(const GazeSample& sample, bool integers) {
  msgpack::sbuffer buffer;
  msgpack::packer packer(buffer);
  const auto camera = [](const glm::dvec3& v) { return glm::dvec3(v.x, -v.y, -v.z); };
  const auto key = [&](int eye) {
    if (integers) {
      packer.pack(eye);
    } else {
      packer.pack(std::to_string(eye));
    }
  };
  packer.pack_map(6);
  packer.pack("norm_pos");
  packer.pack(std::vector<double>{0.5, 0.5});
  packer.pack("topic");
  packer.pack("gaze.3d.01.");
  packer.pack("timestamp");
  packer.pack(sample.time_s);
  packer.pack("confidence");
  packer.pack(sample.confidence.value_or(1.0));
  for (const bool normals : {true, false}) {
    packer.pack(normals ? "gaze_normals_3d" : "eye_centers_3d");
    packer.pack_map(2);
    for (const int eye : {0, 1}) {  // 0 is the right eye
      const EyeSample& side = sample.eyes[eye == 0];
      key(eye);
      packVector(packer, normals ? camera(*side.direction) : 1e3 * camera(*side.origin_m));
    }
  }
  return {buffer.data(), buffer.size()};
}

GazeSample lookingAt(double time_s, const glm::dvec3& target_m) {
  GazeSample sample{.time_s = time_s};
  for (const std::size_t side : {0, 1}) {
    sample.eyes[side].origin_m = glm::dvec3(side == 0 ? -0.03 : 0.03, 0, 0);
    sample.eyes[side].direction = glm::normalize(target_m - *sample.eyes[side].origin_m);
  }
  return sample;
}

TEST(ParsePupilMessage, ReadsBothStylesOfKeys) {
  const GazeSample sent = lookingAt(12.5, {0.1, 0.05, -0.6});
  for (const bool integers : {false, true}) {
    const auto sample = parsePupilMessage("gaze.3d.01.", datum(sent, integers), kScreen);
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->time_s, 12.5);
    EXPECT_EQ(sample->confidence, 1.0);
    for (const std::size_t side : {0, 1}) {
      EXPECT_LT(glm::distance(*sample->eyes[side].direction, *sent.eyes[side].direction),
                kRounding);
      EXPECT_LT(glm::distance(*sample->eyes[side].origin_m, *sent.eyes[side].origin_m), kRounding);
    }
    EXPECT_NEAR(sample->point_px->x, 700, 1.0);
    EXPECT_NEAR(sample->point_px->y, 150, 1.0);
  }
}

TEST(ParsePupilMessage, TwoDimensionalDataAreFractionsFromTheBottomLeft) {
  msgpack::sbuffer buffer;
  msgpack::packer packer(buffer);
  packer.pack_map(3);
  packer.pack("timestamp");
  packer.pack(3);
  packer.pack("confidence");
  packer.pack(0.8f);
  packer.pack("norm_pos");
  packer.pack(std::vector<double>{0.25, 0.9});
  const std::string_view bytes(buffer.data(), buffer.size());
  EXPECT_LT(glm::distance(*parsePupilMessage("gaze.2d.0.", bytes, kScreen)->point_px,
                          glm::dvec2(250, 50)),
            kRounding);
  EXPECT_FALSE(parsePupilMessage("pupil.0", bytes, kScreen));
}

TEST(ParsePupilMessage, LowConfidenceHasNoPointAndDamageGivesNothing) {
  GazeSample sent = lookingAt(1.0, {0, 0, -0.6});
  sent.confidence = 0.3;
  const auto doubtful = parsePupilMessage("gaze.3d.01.", datum(sent, false), kScreen);
  ASSERT_TRUE(doubtful);
  EXPECT_FALSE(doubtful->point_px);
  const std::string whole = datum(lookingAt(1.0, {0, 0, -0.6}), false);
  std::mt19937_64 bits(2);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    if (i % 2) bytes.resize(bits() % bytes.size());
    for (int n = 0; n < 3 && !bytes.empty(); ++n) {
      bytes[bits() % bytes.size()] = static_cast<char>(bits());
    }
    const auto sample = parsePupilMessage("gaze.3d.01.", bytes, kScreen);
    refused += !sample;
    if (sample) {
      EXPECT_TRUE(std::isfinite(sample->time_s));
    }
  }
  EXPECT_GT(refused, 900);
  EXPECT_FALSE(parsePupilMessage("gaze.3d.01.", "\xdd\xff\xff\xff\xff", kScreen));
}

/// Pupil Remote and its publisher. They work only during calls of `pump`.
class Sender {
 public:
  Sender() {
    remote_.set(zmq::sockopt::linger, 0);
    data_.set(zmq::sockopt::linger, 0);
    remote_.bind("tcp://127.0.0.1:*");
    data_.bind("tcp://127.0.0.1:*");
  }
  int port() const { return portOf(remote_); }
  void pump() {
    zmq::message_t request;
    if (!remote_.recv(request, zmq::recv_flags::dontwait)) return;
    EXPECT_EQ(request.to_string_view(), "SUB_PORT");
    remote_.send(zmq::buffer(std::to_string(portOf(data_))), zmq::send_flags::none);
    ++asked;
  }
  void send(const GazeSample& sample, bool integers, const std::string& topic = "gaze.3d.01.") {
    data_.send(zmq::buffer(topic), zmq::send_flags::sndmore);
    data_.send(zmq::buffer(datum(sample, integers)), zmq::send_flags::none);
  }
  int asked = 0;

 private:
  static int portOf(const zmq::socket_t& socket) {
    const std::string address = socket.get(zmq::sockopt::last_endpoint);
    return std::stoi(address.substr(address.rfind(':') + 1));
  }
  zmq::context_t context_{1};
  zmq::socket_t remote_{context_, zmq::socket_type::rep}, data_{context_, zmq::socket_type::pub};
};

/// Samples to play, from a real export if present.
std::vector<GazeSample> samplesToPlay() {
  std::vector<GazeSample> samples;
  const auto file = gazeData() / "vendors" / "pupil_core_gaze_positions.csv";
  if (std::filesystem::exists(file)) {
    for (const GazeSample& sample : readTrace(file, {}, kScreen).samples) {
      if (sample.eyes[0].direction && sample.eyes[1].direction) samples.push_back(sample);
      if (samples.size() == 500) break;
    }
  } else {
    for (int i = 0; i < 500; ++i) {
      GazeSample& sample =
          samples.emplace_back(lookingAt(1000.0 + 0.005 * i, {0.0002 * i, 0, -0.6}));
      sample.point_px =
          pointOnScreen_px(kScreen, *sample.eyes[0].direction + *sample.eyes[1].direction);
    }
  }
  return samples;
}

TEST(PupilSource, ReceivesWhatASenderPlaysAndComesBackAfterASilence) {
  Sender sender;
  PupilSource source("127.0.0.1", sender.port(), kScreen);
  const auto played = samplesToPlay();
  // The receiver's clock is the sender's minus an offset, so the test may take any time.
  const double behind_s = played.front().time_s - 0.5;
  std::vector<GazeSample> received;
  double now_s = 0.0;
  const auto settle = [&] {
    sender.pump();
    source.poll(now_s, received);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  EXPECT_NE(source.status().find("no answer"), std::string::npos);
  for (int i = 0; i < 2000 && sender.asked == 0; ++i) settle();
  ASSERT_EQ(sender.asked, 1);
  // A subscription takes a moment. Earlier messages do not arrive, as with the real Pupil.
  GazeSample probe = lookingAt(behind_s, {0, 0, -0.6});
  for (int i = 0; i < 2000 && received.empty(); ++i) {
    sender.send(probe, false);
    settle();
  }
  ASSERT_FALSE(received.empty());
  received.clear();
  for (std::size_t i = 0; i < played.size(); ++i) {
    sender.send(played[i], i % 2 == 0);
    now_s = std::max(now_s, played[i].time_s - behind_s);
    for (int tries = 0; tries < 2000 && received.size() <= i; ++tries) settle();
  }
  ASSERT_EQ(received.size(), played.size());
  for (std::size_t i = 0; i < played.size(); ++i) {
    EXPECT_EQ(received[i].point_px.has_value(), played[i].point_px.has_value());
    if (played[i].point_px) {
      EXPECT_LT(glm::distance(*received[i].point_px, *played[i].point_px), 1e-6);
    }
    if (i > 0) {
      EXPECT_GT(received[i].time_s, received[i - 1].time_s);
    }
  }
  EXPECT_EQ(source.status().find(", no"), std::string::npos);
  now_s += 3.0;
  for (int i = 0; i < 2000 && sender.asked == 1; ++i) settle();
  EXPECT_EQ(sender.asked, 2);
}

// One wild time, then a clock that is set back, then one that is set ahead.
TEST(PupilSource, FollowsTheClockOfTheSender) {
  Sender sender;
  PupilSource source("127.0.0.1", sender.port(), kScreen);
  std::vector<GazeSample> received;
  double now_s = 0.0;
  const auto settle = [&] {
    sender.pump();
    source.poll(now_s, received);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  for (int i = 0; i < 2000 && sender.asked == 0; ++i) settle();
  for (int i = 0; i < 2000 && received.empty(); ++i) {
    sender.send(lookingAt(100.0, {0, 0, -0.6}), false);
    settle();
  }
  ASSERT_FALSE(received.empty());
  for (int i = 0; i < 20; ++i) settle();  // the others of them are repeated
  const std::size_t repeated = source.sender().dropped;
  received.clear();
  constexpr int kSamples = 300;
  double latest_s = 0.0, longest_s = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    now_s += 0.01;
    const double ahead_s = i == 50 ? 1e6 : i < 100 ? 100.0 : i < 200 ? -900.0 : 5000.0;
    sender.send(lookingAt(now_s + ahead_s, {0, 0, -0.6}), false);
    for (int tries = 0; tries < 3; ++tries) settle();
    if (!received.empty()) latest_s = received.back().time_s;
    if (i > 10) longest_s = std::max(longest_s, now_s - latest_s);
  }
  for (int i = 0; i < 20; ++i) settle();
  EXPECT_EQ(sender.asked, 1);
  EXPECT_EQ(received.size(), kSamples - 1u);
  EXPECT_LT(longest_s, 0.5);
  const SenderFacts facts = source.sender();
  EXPECT_EQ(facts.dropped - repeated, 1u);
  ASSERT_EQ(facts.clock->steps, 2u);
  EXPECT_NEAR(facts.clock->latest_steps[0].ahead_s, -1000.0, 0.05);
  EXPECT_NEAR(facts.clock->latest_steps[1].ahead_s, 5900.0, 0.05);
}

// Pupil Capture sends the loss of an eye at once, and the gaze of the other one ten samples late.
TEST(PupilSource, TheLossOfOneEyeIsNoneWhileTheOtherHasGaze) {
  Sender sender;
  PupilSource source("127.0.0.1", sender.port(), kScreen);
  std::vector<GazeSample> received;
  double now_s = 0.0;
  const auto send = [&](const char* topic, double time_s, double confidence) {
    GazeSample sample = lookingAt(time_s, {0, 0, -0.6});
    sample.confidence = confidence;
    sender.send(sample, false, topic);
  };
  const auto play = [&](double seconds, bool right_eye_has_gaze) {
    for (int i = 0; i < static_cast<int>(seconds / 0.005); ++i) {
      now_s += 0.005;
      sender.pump();
      send("gaze.2d.1.", now_s, 0.1);
      if (right_eye_has_gaze) send("gaze.2d.0.", now_s - 0.052, 0.9);
      if (!right_eye_has_gaze) send("gaze.2d.0.", now_s + 0.001, 0.1);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      source.poll(now_s, received);
    }
  };
  play(1.0, true);
  received.clear();
  const std::size_t dropped = source.sender().dropped;
  play(1.0, true);
  EXPECT_NEAR(static_cast<double>(received.size()), 200.0, 10.0);
  for (const GazeSample& sample : received) EXPECT_TRUE(sample.point_px);
  EXPECT_EQ(source.sender().dropped, dropped);
  received.clear();
  play(1.0, false);  // the loss of both eyes is one
  EXPECT_GT(received.size(), 150u);
  EXPECT_FALSE(received.back().point_px);
}

// One eye's gaze comes ten samples late, from the start or between gaze of both: no clock steps. As
// late a step of the clock under gaze of both eyes is one.
TEST(PupilSource, ALateEyeIsNoStepOfTheClock) {
  constexpr double kPeriod_s = 1.0 / 60.0, kLate_s = 10.0 * kPeriod_s;
  Sender sender;
  PupilSource source("127.0.0.1", sender.port(), kScreen);
  std::vector<GazeSample> received;
  double now_s = 0.0, begin_s = INFINITY, clock_s = 1000.0;
  const auto send = [&](const char* topic, double time_s, double confidence) {
    GazeSample sample = lookingAt(clock_s + time_s, {0, 0, -0.6});
    sample.confidence = confidence;
    sender.send(sample, false, topic);
  };
  const auto play = [&](double seconds, bool both) {
    for (const double end_s = now_s + seconds; now_s < end_s;) {
      now_s += kPeriod_s;
      sender.pump();
      if (both) send("gaze.2d.01.", now_s, 0.9);
      if (!both) send("gaze.2d.0.", now_s, 0.1);
      if (!both && now_s > begin_s) send("gaze.2d.1.", now_s - kLate_s, 0.9);
      std::this_thread::sleep_for(std::chrono::milliseconds(6));
      source.poll(now_s, received);
    }
  };
  for (int i = 0; i < 20 && sender.asked == 0; ++i) play(0.02, false);
  begin_s = now_s + kLate_s;
  play(2.0, false);
  const double rate_Hz = source.rate_Hz();
  EXPECT_GT(received.size(), 80u);
  EXPECT_TRUE(received.back().point_px);
  EXPECT_NEAR(rate_Hz, 60.0, 12.0);
  play(1.0, true);
  play(1.0, false);
  play(2.0, true);
  EXPECT_EQ(source.sender().clock->steps, 0u);
  clock_s -= kLate_s;
  play(1.0, true);
  EXPECT_EQ(source.sender().clock->steps, 1u);
}

// Messages that are thrown away are no sign of life: foci asks again.
TEST(PupilSource, AsksAgainWhileNothingIsUsable) {
  Sender sender;
  PupilSource source("127.0.0.1", sender.port(), kScreen);
  std::vector<GazeSample> received;
  double now_s = 0.0;
  for (int i = 0; i < 2000 && sender.asked < 3; ++i) {
    now_s += 0.01;
    sender.pump();
    sender.send(lookingAt(7.0, {0, 0, -0.6}), false);  // the tracker's clock stands
    source.poll(now_s, received);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(sender.asked, 3);
  EXPECT_LE(received.size(), 1u);
  EXPECT_GT(source.sender().dropped, 100u);
}

TEST(PupilSource, RefusesMalformedAddressesAndNeverWaits) {
  EXPECT_THROW(PupilSource("", 50020, kScreen), InputError);
  EXPECT_THROW(PupilSource("a b;c", 50020, kScreen), InputError);
  EXPECT_THROW(PupilSource("localhost", 0, kScreen), InputError);
  PupilSource source("127.0.0.1", 1, kScreen);
  std::vector<GazeSample> samples;
  for (int i = 0; i < 20; ++i) source.poll(0.5 * i, samples);
  EXPECT_TRUE(samples.empty());
}

TEST(MouseSource, GivesOneSampleForEachNewTime) {
  MouseSource source;
  std::vector<GazeSample> samples;
  source.moveTo(glm::dvec2(3, 4));
  source.poll(1.0, samples);
  source.poll(1.0, samples);
  source.moveTo({});
  source.poll(1.1, samples);
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].point_px, glm::dvec2(3, 4));
  EXPECT_FALSE(samples[1].point_px);
}

}  // namespace FOCI_FILE
}  // namespace foci
