// Live gaze that another program pushes: an experiment hands over the samples of its tracker's own
// library, with the tracker's times.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/live/live_source.h"
#include "gaze/live/sender_clock.h"

namespace foci {

/// The samples `TIME X Y [PUPIL]` of a text with `;` between them: seconds on any clock, px on the
/// screen, mm. `nan` in X or Y means data loss.
/// @throws InputError if one is wrong, or not later than the one before
std::vector<GazeSample> samplesOfText(std::string_view text);

class PushedSource : public LiveSource {
 public:
  /// @param rate_Hz         nominal rate of the samples
  /// @param clock_measured  as of `SenderClock`
  explicit PushedSource(double rate_Hz, bool clock_measured = false)
      : rate_Hz_(rate_Hz), clock_(clock_measured) {}

  /// Takes samples that arrive together. May be called from any thread.
  /// @param now_s  on the clock of `poll`
  /// @return how many samples it drops: of these, or of earlier ones that were in doubt
  std::size_t push(const std::vector<GazeSample>& samples, double now_s);

  /// Whether samples have been used in the last two seconds.
  bool isHeard() const;

  void poll(double now_s, std::vector<GazeSample>& samples) override;

  double rate_Hz() const override { return rate_Hz_; }
  std::string status() const override;
  SenderFacts sender() const override;

 private:
  double rate_Hz_;
  mutable std::mutex mutex_{};
  SenderClock clock_;
  std::vector<GazeSample> waiting_{};  // on our clock
  std::optional<double> heard_s_{};    // when samples were used last
  double polled_s_ = 0.0;
};

}  // namespace foci
