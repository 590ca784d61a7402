// The times of a table's rows: their unit, their order, and rows that share a time.
#pragma once

#include <optional>
#include <vector>

#include "base/input_error.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/clock_guess.h"
#include "gaze/sources/clock_times.h"
#include "gaze/sources/rows_seen.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/table_row.h"

namespace foci {

/// Gives each sample its time in seconds, and passes the samples on in order of time. Samples wait
/// until the unit of time is known, and until the next one shows that no two are swapped.
class RowTimes {
 public:
  /// @param row  at the sample's row in `read` and `add`; all arguments outlive the object
  RowTimes(TableLayout& layout, const TableRow& row, const Rows& rows, const TraceColumns& columns,
           const TakeSample& take);

  /// Of the latest row, in the file's unit. @throws InputError
  double read();
  /// Seconds; 0 while the unit is unknown.
  double seconds(double time) const { return clock_known_ ? time * layout_.time_scale_s : 0.0; }

  /// @param sample  its time is that of `read`
  /// @throws InputError if its place in time is not clear
  void add(const GazeSample& sample);

  /// Passes on the samples that wait. @throws InputError
  void finish();

  /// What was assumed about the times.
  void state(TraceHeader& header) const;

 private:
  double readClockTime();
  bool takeRepeat(const GazeSample& sample);
  InputError backwards(const GazeSample& sample) const;
  void order(GazeSample& sample);
  void settle(bool at_end);
  void emit(GazeSample& sample);

  TableLayout& layout_;
  const TableRow& row_;
  const Rows& rows_;
  const TraceColumns& given_;
  const TakeSample& take_;
  FineClock fine_clock_{};
  std::optional<ClockTimes> clock_times_{};  // the times are texts
  bool clock_known_ = false;
  std::optional<ClockGuess> guess_{};
  bool settled_ = false;                      // the unit of time; until then samples are held
  std::optional<GazeSample> newest_{};        // waits for the next one
  std::optional<double> first_{}, before_{};  // times of the first one, and of the one before
  std::optional<InputError> first_repeat_{};  // of a time
  std::size_t copies_ = 0, swapped_ = 0, waits_ = 0, counted_ = 0, ordered_ = 0;
  std::optional<WholeTimes> spread_{};  // times repeat
  std::vector<GazeSample> held_{};
};

}  // namespace foci
