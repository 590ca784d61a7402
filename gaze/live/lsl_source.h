// Live gaze of the Lab Streaming Layer (github.com/sccn/liblsl): `lsl` or `lsl:NAME`.
#pragma once

#include <atomic>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "gaze/live/live_source.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// foci loads the library when a source is created, so it runs without the library otherwise.
inline constexpr const char* kLslLibrary = "liblsl.so.2";

/// A stream on the local network. Its channels have the meaning that the same labels and units have
/// in an XDF file. A sender that stops may come back. The library measures the sender's clock
/// (lsl_time_correction). If the sender's times are on another clock after all, or the library
/// gets no answer, `SenderClock` estimates it.
class LslSource final : public LiveSource {
 public:
  /// Seeks the stream for two seconds, and waits as long for its description and for its clock.
  /// @param stream   its name; empty: the only stream of gaze (`LslStream::isGaze`)
  /// @param columns  as for a recording
  /// @param screen   that points in fractions or degrees lie on
  /// @throws InputError if liblsl is not installed, if there is no such stream or more than one, or
  ///   if its channels cannot be read as gaze
  LslSource(const std::string& stream, TraceColumns columns, const Screen& screen,
            const std::string& library = kLslLibrary);
  ~LslSource() override;

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override { return pushed_.rate_Hz(); }
  std::string status() const override;
  SenderFacts sender() const override;

 private:
  struct Inlet;
  struct Pulled;
  void run(const std::stop_token& stop);
  /// @param values  rows of the stream's columns
  void read(std::vector<double> values, const TakeSample& take) const;
  void take(const Pulled& pulled);
  bool readSome(const Pulled& pulled, std::size_t begin, std::size_t end,
                std::vector<GazeSample>& samples);

  TraceColumns columns_;
  Screen screen_;
  std::unique_ptr<Inlet> inlet_;
  PushedSource pushed_;                      // on the library's clock, which runs as ours does
  std::atomic<double> ahead_s_ = -INFINITY;  // of our clock before the library's
  std::optional<double> given_s_{};          // time of the latest sample
  mutable std::mutex mutex_{};
  std::size_t unread_ = 0;  // samples that are no gaze
  std::string why_{};
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
