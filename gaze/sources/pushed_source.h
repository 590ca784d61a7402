// Live gaze that another program pushes: an experiment hands over the samples of its tracker's own
// library, with the tracker's times.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/sources/live_source.h"

namespace foci {

class PushedSource : public LiveSource {
 public:
  /// @param rate_Hz  nominal rate of the samples
  explicit PushedSource(double rate_Hz) : rate_Hz_(rate_Hz) {}

  /// Takes samples `TIME X Y [PUPIL]` with `;` between them: seconds on any clock, px on the
  /// screen, mm. `nan` in X or Y means data loss. May be called on any thread.
  /// @return how many samples there were
  /// @throws InputError if one is wrong, or not later than the one before; none is then taken
  std::size_t push(std::string_view samples);

  /// The same for samples whose times are on the sender's clock.
  /// @throws InputError if one is not later than the one before; none is then taken
  void push(const std::vector<GazeSample>& samples);

  /// Whether samples have come in the last two seconds.
  bool isHeard() const;

  /// The first sample sets the offset between both clocks. The fastest sample since corrects it:
  /// the shortest transmission delay counts as 0. After a pause of two seconds, the offset is set
  /// anew.
  void poll(double now_s, std::vector<GazeSample>& samples) override;

  double rate_Hz() const override { return rate_Hz_; }
  std::string status() const override;

 private:
  double rate_Hz_;
  mutable std::mutex mutex_{};
  std::vector<GazeSample> waiting_{};  // on the sender's clock
  std::optional<double> sent_s_{};     // the last sample's time on the sender's clock
  std::optional<double> offset_s_{}, given_s_{};
  double heard_s_ = 0.0;  // when samples came last
};

}  // namespace foci
