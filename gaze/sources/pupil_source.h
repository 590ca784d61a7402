// Pupil Core over the network: `pupil:HOST:PORT`.
#pragma once

#include <memory>
#include <optional>

#include "gaze/sources/live_source.h"

namespace foci {

/// Asks Pupil Remote (ZeroMQ REQ, "SUB_PORT") for the port of its data and subscribes to `gaze.`.
/// Where nobody answers, or the data stop for two seconds, it asks again, for ever. The sender's
/// clock is set against ours by the message that came soonest.
class PupilSource : public LiveSource {
 public:
  /// @param host    a name or an address
  /// @param screen  with all of its quantities known
  /// @throws InputError where host or port cannot be one
  PupilSource(const std::string& host, int port, const Screen& screen);
  ~PupilSource() override;

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override;
  std::string status() const override;

 private:
  struct Sockets;
  void ask(double now_s);
  void subscribe(double now_s);
  void receive(double now_s, std::vector<GazeSample>& samples);

  std::string host_;
  int port_;
  Screen screen_;
  std::unique_ptr<Sockets> sockets_;
  double since_s_ = 0.0;  // when it asked, or last heard
  std::optional<double> offset_s_{}, last_s_{};
  std::optional<double> interval_s_{};  // usual one between samples
};

}  // namespace foci
