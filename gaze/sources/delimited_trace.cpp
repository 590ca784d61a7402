#include "gaze/sources/delimited_trace.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/number.h"
#include "base/text.h"
#include "gaze/geometry/cyclopean.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/table_preamble.h"
#include "gaze/sources/table_row.h"

namespace foci {
namespace {

constexpr double kMaxTime_s = 1e11;  // up to here a double resolves 20 us

// Degrees and fractions keep their meaning on any screen. This one stands in for an unknown screen.
const Screen kNominalScreen{.size_px = {1000, 1000}, .size_m = {1.0, 1.0}, .distance_m = 1.0};

bool isMetric(const Screen& screen) {
  return screen.size_px.x > 0 && screen.size_px.y > 0 && screen.size_m.x > 0.0 &&
         screen.size_m.y > 0.0 && screen.distance_m > 0.0;
}

class TableReader {
 public:
  TableReader(LineReader& lines, const TraceColumns& columns, const Screen& fallback,
              const TakeSample& take, const std::string& header)
      : lines_(lines), take_(take), preamble_{.screen = fallback} {
    readHeader(columns, header);
  }

  TraceHeader read() {
    std::string_view line;
    while (lines_.next(line)) {
      if (!trimmed(line).empty()) readLine(line);
    }
    settleClock();
    TraceHeader header{.format = layout_.format, .screen = preamble_.screen};
    if (eyes_seen_[0] && eyes_seen_[1]) header.format += ", binocular";
    return header;
  }

 private:
  void readLine(std::string_view line) {
    if (broken_) throw lines_.error("follows a line that is too short");
    row_->split(line);
    // The last line may be cut off. `broken_` refuses any line behind it.
    if ((broken_ = !row_->isComplete() && taken_ > 1 && !layout_.kind)) return;
    ++taken_;
    if (layout_.kind && row_->field(*layout_.kind) != layout_.sample_kind) return;
    readResolution();
    readSample(sample_);
    passOn();
  }

  void readHeader(const TraceColumns& columns, const std::string& given) {
    std::string_view line = given;
    bool found = !given.empty();
    while (!found && lines_.next(line)) {
      if (line.starts_with('#')) readPreambleLine(lines_, line, preamble_);
      found = !trimmed(line).empty() && !line.starts_with('#');
    }
    if (!found) throw InputError(lines_.fileName(), "empty: expected a header line and samples");
    layout_ = recogniseTable(lines_, line, columns, preamble_);
    const GazeUnits units = columns.units     ? *columns.units
                            : preamble_.units ? *preamble_.units
                                              : layout_.units.value_or(GazeUnits::px);
    Screen& screen = preamble_.screen;
    if ((units == GazeUnits::deg || layout_.hasDirections()) && !isMetric(screen))
      screen = kNominalScreen;
    if (units == GazeUnits::normalised && !(screen.size_px.x > 0 && screen.size_px.y > 0)) {
      screen.size_px = kNominalScreen.size_px;
    }
    clock_known_ = layout_.time_scale_s > 0.0;
    row_.emplace(lines_, layout_, screen, units);
    if (layout_.headless) readLine(line);
  }

  void readResolution() {
    if (!layout_.width_px || !layout_.height_px || resolution_known_) return;
    const auto width = parseNumber(row_->field(*layout_.width_px));
    const auto height = parseNumber(row_->field(*layout_.height_px));
    if (!width || !height) return;
    const auto pixels = [&](std::size_t column) {
      return static_cast<int>(
          numberIn(lines_, "resolution", row_->field(column), 16, 16384, "16 to 16384 px"));
    };
    preamble_.screen.size_px = {pixels(*layout_.width_px), pixels(*layout_.height_px)};
    resolution_known_ = true;
  }

  double readTime() {
    if (!layout_.time) return static_cast<double>(counted_++) / layout_.rate_Hz;
    const auto time = row_->number(*layout_.time);
    if (!time || std::abs(*time) * std::max(layout_.time_scale_s, 1e-9) > kMaxTime_s) {
      row_->fail(*layout_.time, "expected a time");
    }
    return *time;
  }

  void readSample(GazeSample& sample) {
    row_->read(sample);
    sample.time_s = readTime();  // in the file's unit, until the unit of time is known
    if (!layout_.x && !layout_.hasDirections()) {
      sample.point_px =
          cyclopean_.combine(sample.time_s * (clock_known_ ? layout_.time_scale_s : 0.0),
                             sample.eyes[0].point_px, sample.eyes[1].point_px);
    }
    if (sample.blink) sample.point_px.reset();
    for (std::size_t side : {0, 1}) {
      eyes_seen_[side] |= sample.eyes[side].point_px || sample.eyes[side].direction;
    }
  }

  /// Checks the order of the sample just read. Passes samples on once the unit of time is known.
  void passOn() {
    GazeSample& sample = sample_;
    if (last_time_ && sample.time_s <= *last_time_) {
      throw lines_.error("time " + shown(row_->field(*layout_.time)) +
                         " is not after the sample before");
    }
    last_time_ = sample.time_s;
    if (clock_known_) {
      sample.time_s *= layout_.time_scale_s;
      take_(sample);
      return;
    }
    constexpr std::size_t kEnoughSamples = 128;  // for the usual interval between samples
    held_.push_back(sample);
    if (held_.size() == kEnoughSamples) settleClock();
  }

  void settleClock() {
    if (!clock_known_) layout_.time_scale_s = likelyScale_s();
    clock_known_ = true;
    for (GazeSample& sample : held_) {
      sample.time_s *= layout_.time_scale_s;
      take_(sample);
    }
    held_.clear();
  }

  /// The unit of time that gives the rate of an eye tracker.
  double likelyScale_s() const {
    constexpr double kMinRate_Hz = 5.0, kMaxRate_Hz = 20'000.0;
    std::vector<double> intervals;
    for (std::size_t i = 1; i < held_.size(); ++i) {
      intervals.push_back(held_[i].time_s - held_[i - 1].time_s);
    }
    if (intervals.empty()) return 1.0;
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    for (const double scale_s : {1.0, 1e-3, 1e-6, 1e-9}) {
      const double rate_Hz = 1.0 / (*middle * scale_s);
      if (rate_Hz >= kMinRate_Hz && rate_Hz <= kMaxRate_Hz) return scale_s;
    }
    return 1.0;
  }

  LineReader& lines_;
  const TakeSample& take_;
  TablePreamble preamble_;
  TableLayout layout_{};
  std::optional<TableRow> row_{};
  GazeSample sample_{};  // of the latest row
  Cyclopean cyclopean_{};
  bool clock_known_ = false, resolution_known_ = false;
  std::optional<double> last_time_{};
  std::vector<GazeSample> held_{};
  std::size_t taken_ = 0, counted_ = 0;
  bool broken_ = false;  // the previous line had too few fields
  std::array<bool, 2> eyes_seen_{};
};

}  // namespace

TraceHeader readDelimitedTrace(LineReader& lines, const TraceColumns& columns,
                               const Screen& fallback_screen, const TakeSample& take,
                               const std::string& header) {
  return TableReader(lines, columns, fallback_screen, take, header).read();
}

}  // namespace foci
