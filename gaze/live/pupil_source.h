// Live gaze from Pupil Core over the network: `pupil:HOST:PORT`.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>

#include "gaze/live/live_source.h"
#include "gaze/live/sender_clock.h"

namespace foci {

/// Reads a message with a topic such as "gaze.3d.01.", "gaze.3d.0." or "gaze.2d.0.". With 3D data,
/// the point is where the mean line of sight meets the screen. With 2D data, it is `norm_pos` as
/// fractions of the screen (origin bottom-left). The keys of the two eyes are "0" and "1", or the
/// same as integers; eye 0 is the right one. A sample of a confidence below 0.6 has no point.
/// @param payload  a msgpack map
/// @param screen   with known size and distance
/// @return a sample on the sender's clock; nothing if the topic is not gaze or the payload is
/// damaged
std::optional<GazeSample> parsePupilMessage(std::string_view topic, std::string_view payload,
                                            const Screen& screen);

/// Asks Pupil Remote for the port of its data (ZeroMQ REQ, "SUB_PORT") and subscribes to "gaze.".
/// The loss of one eye is no sample while the other has gaze.
/// If no answer comes, or no sample can be used for two seconds, it asks again, without end.
class PupilSource : public LiveSource {
 public:
  /// @param host    a name or an address
  /// @param screen  with known size and distance
  /// @throws InputError if host or port are malformed
  PupilSource(const std::string& host, int port, const Screen& screen);
  ~PupilSource() override;

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override;
  std::string status() const override;
  SenderFacts sender() const override;

 private:
  struct Sockets;
  void ask(double now_s);
  void subscribe(double now_s);
  void receive(double now_s, std::vector<GazeSample>& samples);
  bool isLossOfOneEye(std::string_view topic, bool has_point, double now_s);
  void note(const GazeSample& sample, double now_s);

  std::string host_;
  int port_;
  Screen screen_;
  std::unique_ptr<Sockets> sockets_;
  double since_s_ = 0.0;  // time of the latest request, or of the latest sample that was used
  // When an eye's latest message had gaze; at first, both may have.
  std::optional<std::array<double, 2>> seen_s_{};
  double alone_s_ = -INFINITY;  // time of the latest message of one eye
  SenderClock clock_{};
  std::size_t unread_ = 0;              // messages of gaze that are damaged
  std::optional<double> last_s_{};      // time of the latest sample
  std::optional<double> interval_s_{};  // usual time between samples
};

}  // namespace foci
