#include "gaze/sources/delimited_trace.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/number.h"
#include "base/text.h"
#include "gaze/geometry/cyclopean.h"
#include "gaze/sources/clock_guess.h"
#include "gaze/sources/clock_times.h"
#include "gaze/sources/empty_directions.h"
#include "gaze/sources/rows_seen.h"
#include "gaze/sources/swift_number.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/table_preamble.h"
#include "gaze/sources/table_row.h"

namespace foci {
namespace {

constexpr double kMaxTime_s = 1e11;  // up to here a double resolves 20 us

// Degrees and fractions keep their meaning on any screen. This one stands in for an unknown screen.
const Screen kNominalScreen{.size_px = {1000, 1000}, .size_m = {1.0, 1.0}, .distance_m = 1.0};

std::string pointed(std::string text) {
  std::replace(text.begin(), text.end(), ',', '.');
  return text;
}

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
      if (!trimmed(line).empty() && line.front() != '#') readLine(line);
    }
    settleClock();
    TraceHeader header{.format = layout_.format,
                       .screen = preamble_.screen,
                       .units = isInSpace() ? GazeUnits::deg : units_,
                       .field = field_,
                       .columns = layout_.readings,
                       .gaze_in_world = layout_.space && layout_.space->in_world,
                       .nominal_screen = nominal_};
    if (eyes_seen_[0] && eyes_seen_[1]) header.format += ", binocular";
    state(header);
    return header;
  }

 private:
  void readLine(std::string_view line) {
    if (broken_) throw *broken_;
    if (taken_ == 0 && !layout_.headless) refuseExtraFields(line);
    row_->split(line);
    // The last line may be cut off. `broken_` refuses any line behind it.
    if (!row_->isComplete() && taken_ > 1 && !layout_.rows.column) {
      broken_ = row_->tooShort(layout_.columns - 1);
      return;
    }
    if (row_->isComplete()) last_decimals_.add(row_->lastField());
    ++taken_;
    if (!row_->isSample()) return;
    readResolution();
    readSample(sample_);
    passOn();
  }

  /// Lines of sight give the points.
  bool isInSpace() const { return layout_.hasDirections() || layout_.space; }

  /// A row with more fields than the header has names: a comma is decimal, or not in quotes.
  void refuseExtraFields(std::string_view line) const {
    std::vector<std::string_view> fields;
    splitRow(line, layout_.delimiter, fields);
    while (!fields.empty() && trimmed(fields.back()).empty()) fields.pop_back();
    if (fields.size() <= layout_.names) return;
    throw lines_.error(std::to_string(fields.size()) + " fields where the header has " +
                       std::to_string(layout_.names) +
                       " names: are there decimal commas, or texts without quotes?");
  }

  void readHeader(const TraceColumns& columns, const std::string& given) {
    std::string_view line = given;
    bool found = !given.empty();
    while (!found && lines_.next(line)) {
      if (readSeparatorLine(line, preamble_)) continue;
      preamble_.tobii_studio |= startsTobiiStudio(line);
      if (preamble_.tobii_studio && readTobiiStudioLine(lines_, line, preamble_)) continue;
      if (line.starts_with('#')) readPreambleLine(lines_, line, preamble_);
      found = !trimmed(line).empty() && !line.starts_with('#');
    }
    if (!found) throw InputError(lines_.fileName(), "empty: expected a header line and samples");
    layout_ = recogniseTable(lines_, line, columns, preamble_);
    std::string first_row;
    if (layout_.camera_axes && !layout_.headless) {
      first_row = nextRow();
      leaveOutEmptyDirections(layout_, first_row);
    }
    mapped_later_ = columns.mapped_later;
    scale_given_ = columns.time_scale_s.has_value();
    units_ = columns.units     ? *columns.units
             : preamble_.units ? *preamble_.units
                               : layout_.units.value_or(GazeUnits::px);
    units_stated_ = columns.units || preamble_.units || layout_.units || layout_.hasDirections() ||
                    columns.mapped_later || layout_.space;
    Screen& screen = preamble_.screen;
    if (layout_.space) {
      field_ = columns.field.value_or(EyeField{});
      field_assumed_ = !columns.field;
      screen = headsetScreen(fieldOfBothEyes(*field_), columns.pixels_per_degree);
    }
    if ((units_ == GazeUnits::deg || isInSpace()) && !isMetric(screen)) {
      screen = kNominalScreen;
      nominal_ = true;
    }
    if (units_ == GazeUnits::normalised && !(screen.size_px.x > 0 && screen.size_px.y > 0)) {
      screen.size_px = kNominalScreen.size_px;
      nominal_ = true;
    }
    clock_known_ = layout_.time_scale_s > 0.0;
    row_.emplace(lines_, layout_, screen, units_);
    if (layout_.headless) readLine(line);
    if (!trimmed(first_row).empty()) {
      readLine(std::string_view(first_row).substr(0, first_row.size() - kNumberPadding));
    }
  }

  /// A copy of the next line that is not blank, with the bytes behind it that `swiftNumber` reads;
  /// blanks at the end of the file.
  std::string nextRow() {
    std::string row;
    std::string_view line;
    while (trimmed(row).empty() && lines_.next(line)) row = line;
    return row.append(kNumberPadding, ' ');
  }

  void readResolution() {
    if (resolution_known_) return;
    if (layout_.resolution) {
      const auto size_px = resolutionIn(lines_, row_->field(*layout_.resolution));
      if (size_px) preamble_.screen.size_px = *size_px;
      resolution_known_ = size_px.has_value();
      return;
    }
    if (!layout_.width_px || !layout_.height_px) return;
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
    if (clock_times_) return readClockTime();
    const auto time = row_->number(*layout_.time);
    if (!time && !last_time_ && ClockTimes().seconds(row_->field(*layout_.time))) {
      startClockTimes();
      return readClockTime();
    }
    if (time && std::abs(*time) * std::max(layout_.time_scale_s, 1e-9) > kMaxTime_s) {
      row_->fail(*layout_.time,
                 "too large a time: is its unit right (gaze.time_scale_s; 1e-7 for .NET's ticks)?");
    }
    if (!time && isAmbiguousDate(row_->field(*layout_.time))) {
      row_->fail(*layout_.time,
                 "a date whose first number may be the day or the month: write the year first, as "
                 "2026-11-26 10:00:00.123");
    }
    if (!time) {
      row_->fail(*layout_.time,
                 "expected a time in numbers, as 2026-11-26T10:00:00.123 or as 10:00:00.123; "
                 "another column can be named with gaze.time");
    }
    const auto fine_us = layout_.fine_time ? row_->number(*layout_.fine_time) : std::nullopt;
    return fine_us ? fine_clock_.time_ms(*time, 1e-3 * *fine_us) : *time;
  }

  /// The first time is a date, or a time of day.
  void startClockTimes() {
    if (scale_given_) {
      row_->fail(*layout_.time, "a clock's time is in seconds: expected no gaze.time_scale_s");
    }
    clock_times_.emplace();
    clock_known_ = true;
    layout_.time_scale_s = 1.0;
  }

  double readClockTime() {
    const auto time_s = clock_times_->seconds(row_->field(*layout_.time));
    if (!time_s) row_->fail(*layout_.time, "expected a time of the same form as the first");
    return *time_s;
  }

  void stateClockTimes(TraceHeader& header) const {
    if (!clock_times_) return;
    ColumnReading& reading = header.columns[*layout_.time];
    reading.meaning = clock_times_->hasDates() ? "time, a date and a time of day" : "time of day";
    reading.why = "certain: its fields state the format";
    if (clock_times_->passesMidnight()) {
      header.assumed.push_back("clock: passes midnight where it steps back by over half a day");
    }
  }

  void readSample(GazeSample& sample) {
    row_->read(sample);
    sample.time_s = readTime();  // in the file's unit, until the unit of time is known
    if (!layout_.x && !isInSpace()) {
      sample.point_px =
          cyclopean_.combine(sample.time_s * (clock_known_ ? layout_.time_scale_s : 0.0),
                             sample.eyes[0].point_px, sample.eyes[1].point_px);
    }
    if (sample.blink) sample.point_px.reset();
    head_seen_ |= sample.head.has_value();
    if (!units_stated_ && sample.point_px) plain_.add(*sample.point_px);
    for (std::size_t side : {0, 1}) {
      eyes_seen_[side] |= sample.eyes[side].point_px || sample.eyes[side].direction;
    }
  }

  void stateField(TraceHeader& header) const {
    if (!field_assumed_) return;
    header.assumed.push_back("field of the headset: " + exactText(field_->left_deg) +
                             " deg to each side of straight ahead (display.field_deg)");
  }

  void requireHead() const {
    if (!layout_.space || !layout_.space->hasHead() || head_seen_) return;
    throw InputError(lines_.fileName(),
                     "no sample has a head pose: all are absent or 0 (gaze.head_quaternion, "
                     "gaze.head_angles, gaze.head_euler, gaze.head_position)");
  }

  /// States what was assumed. @throws InputError if the positions contradict it
  void state(TraceHeader& header) const {
    if (!units_stated_) {
      if (plain_.areFractions()) {
        throw InputError(lines_.fileName(),
                         "positions such as fractions: half of them lie within 2 px of the corner; "
                         "give their unit: gaze.units = \"normalised\" or \"deg\" (radians: "
                         "\"deg\" with gaze.scale = [57.29578, 57.29578])");
      }
      header.assumed.push_back("unit of the positions: px (gaze.units)");
      if (plain_.areAroundZero()) {
        header.warnings.push_back(
            "a quarter of the positions or more are negative, so they may be degrees, or pixels "
            "from the middle of the screen: give gaze.units or gaze.offset");
      }
    }
    if (broken_) {
      header.warnings.push_back("the last line is cut off and left out: is the file complete?");
    } else if (!lines_.isEnded() && last_decimals_.areFewer()) {
      header.warnings.push_back(
          "the last line has no end and fewer decimals than the others, so it may be cut off: is "
          "the file complete?");
    }
    if (const std::string& text = row_->decimalComma(); !text.empty()) {
      header.assumed.push_back("decimal comma: " + shown(text) + " is " + pointed(text));
    }
    if (spread_) {
      header.warnings.push_back(
          "times are whole milliseconds and repeat: foci spreads the samples evenly; export the "
          "times in microseconds");
    }
    if (layout_.of_scene_camera && !mapped_later_) {
      header.warnings.push_back(
          "positions are those of a scene camera on the head: foci takes its view for the screen, "
          "which holds only for a head at rest; a gaze map (foci calibrate gaze) corrects this");
    }
    if (fine_clock_.isUsed()) {
      header.assumed.push_back(
          "intervals: those of the tracker's own clock, since times are whole milliseconds");
    }
    if (const std::string& column = layout_.unused_validity; !column.empty()) {
      header.warnings.push_back("column " + shown(column) +
                                " is unused: if it marks data loss, name it with gaze.confidence "
                                "(1 is good) or gaze.blink (0 is good)");
    }
    stateClockTimes(header);
    if (clock_guess_) stateClockGuess(*clock_guess_, header);
    requireHead();
    stateField(header);
    if (nominal_) {
      header.assumed.push_back(
          "screen: unknown (--screen-px, --screen-m, --distance-m); only the unit of the file is "
          "shown");
    }
  }

  /// Checks the order of the sample just read. Passes samples on once the clock is known.
  void passOn() {
    GazeSample& sample = sample_;
    const bool repeats =
        last_time_ && sample.time_s == *last_time_ && sample.time_s == std::floor(sample.time_s);
    if (last_time_ && sample.time_s <= *last_time_) {
      const bool equal = sample.time_s == *last_time_;
      const InputError error = lines_.error(
          "time " + shown(row_->field(*layout_.time)) + " is not after the sample before: " +
          (equal ? "remove one of the two rows, or name a finer clock with gaze.time"
                 : "if the clock starts anew in each trial, write a file for each, or name a clock "
                   "that runs on with gaze.time"));
      if (!repeats || (settled_ && !spread_)) {
        throw equal && first_repeat_ && !spread_ ? *first_repeat_ : error;
      }
      if (!first_repeat_) first_repeat_ = error;
    }
    last_time_ = sample.time_s;
    if (settled_) {
      take(sample);
      return;
    }
    constexpr std::size_t kEnoughSamples = 128;  // for the usual interval between samples
    held_.push_back(sample);
    if (held_.size() == kEnoughSamples) settleClock();
  }

  /// Chooses the unit of time, and how repeated times are told apart.
  /// @throws InputError if times repeat without a reason
  void settleClock() {
    if (settled_) return;
    if (!clock_known_) {
      clock_guess_ = guessClock(held_);
      layout_.time_scale_s = clock_guess_->scale_s;
    }
    settled_ = true;
    if (first_repeat_) {
      spread_.emplace((held_.back().time_s - held_.front().time_s) /
                      static_cast<double>(held_.size() - 1));
      // Above 1000 Hz, whole milliseconds cannot but repeat.
      if (layout_.time_scale_s != 1e-3 ||
          !(spread_->interval() > 0.0 && spread_->interval() < 1.0)) {
        throw *first_repeat_;
      }
    }
    for (GazeSample& sample : held_) take(sample);
    held_.clear();
  }

  /// @param sample  its time is in the file's unit
  void take(GazeSample& sample) {
    if (spread_) sample.time_s = spread_->time(sample.time_s);
    sample.time_s *= layout_.time_scale_s;
    take_(sample);
  }

  LineReader& lines_;
  const TakeSample& take_;
  TablePreamble preamble_;
  TableLayout layout_{};
  std::optional<TableRow> row_{};
  GazeSample sample_{};  // of the latest row
  Cyclopean cyclopean_{};
  PlainPositions plain_{};
  GazeUnits units_ = GazeUnits::px;
  bool units_stated_ = false;  // by the user, the file or its format
  bool mapped_later_ = false;
  std::optional<EyeField> field_{};  // of a headset
  bool field_assumed_ = false, head_seen_ = false;
  bool nominal_ = false;  // `kNominalScreen` stands in
  FineClock fine_clock_{};
  std::optional<ClockTimes> clock_times_{};  // the times are texts
  bool clock_known_ = false, scale_given_ = false, resolution_known_ = false;
  std::optional<ClockGuess> clock_guess_{};
  bool settled_ = false;                      // the unit of time; until then samples are held
  std::optional<InputError> first_repeat_{};  // of a time
  std::optional<WholeTimes> spread_{};        // times repeat
  std::optional<double> last_time_{};
  std::vector<GazeSample> held_{};
  std::size_t taken_ = 0, counted_ = 0;
  std::optional<InputError> broken_{};  // the latest line has too few fields
  LastDecimals last_decimals_{};
  std::array<bool, 2> eyes_seen_{};
};

}  // namespace

TraceHeader readDelimitedTrace(LineReader& lines, const TraceColumns& columns,
                               const Screen& fallback_screen, const TakeSample& take,
                               const std::string& header) {
  return TableReader(lines, columns, fallback_screen, take, header).read();
}

}  // namespace foci
