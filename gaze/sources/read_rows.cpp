#include "gaze/sources/read_rows.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/number.h"
#include "base/text.h"
#include "gaze/geometry/cyclopean.h"
#include "gaze/sources/row_times.h"
#include "gaze/sources/rows_seen.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/table_row.h"

namespace foci {
namespace {

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

class RowReader {
 public:
  RowReader(Rows& rows, const TraceColumns& columns, const TakeSample& take)
      : rows_(rows),
        given_(columns),
        screen_(rows.before().screen),
        layout_(recogniseTable(rows, columns)),
        row_(rows, layout_, screen_, unitsOf(rows, layout_, columns)),
        times_(layout_, row_, rows, columns, take) {
    if (layout_.headless) rows_.readNamesAsRow();
    units_ = unitsOf(rows, layout_, columns);
    units_stated_ = columns.units || rows.before().units || layout_.units ||
                    layout_.hasDirections() || columns.mapped_later || layout_.space;
    if (layout_.space) {
      field_ = columns.field.value_or(EyeField{});
      screen_ = headsetScreen(fieldOfBothEyes(*field_), columns.pixels_per_degree);
    }
    if ((units_ == GazeUnits::deg || isInSpace()) && !isMetric(screen_)) {
      screen_ = kNominalScreen;
      nominal_ = true;
    }
    if (units_ == GazeUnits::normalised && !(screen_.size_px.x > 0 && screen_.size_px.y > 0)) {
      screen_.size_px = kNominalScreen.size_px;
      nominal_ = true;
    }
    rows_.survey(1, [&] { refuseExtraFields(); });
    rows_.limitTo(layout_.columns);
  }

  TraceHeader read() {
    while (rows_.next()) readRow();
    times_.finish();
    TraceHeader header{.format = layout_.format,
                       .screen = screen_,
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
  static GazeUnits unitsOf(const Rows& rows, const TableLayout& layout,
                           const TraceColumns& columns) {
    return columns.units         ? *columns.units
           : rows.before().units ? *rows.before().units
                                 : layout.units.value_or(GazeUnits::px);
  }

  void readRow() {
    if (broken_) throw *broken_;
    // The last line may be cut off. `broken_` refuses any line behind it.
    if (!row_.isComplete() && taken_ > 1 && !layout_.rows.column) {
      broken_ = row_.tooShort(layout_.columns - 1);
      return;
    }
    if (row_.isComplete() && !rows_.areNumbers()) last_decimals_.add(row_.lastField());
    ++taken_;
    if (!row_.isSample()) return;
    readResolution();
    readSample(sample_);
    times_.add(sample_);
  }

  /// Lines of sight give the points.
  bool isInSpace() const { return layout_.hasDirections() || layout_.space; }

  /// A row with more fields than the header has names: a comma is decimal, or not in quotes.
  void refuseExtraFields() const {
    std::size_t fields = rows_.size();
    while (fields > 0 && rows_.text(fields - 1).empty()) --fields;
    if (fields <= layout_.names || layout_.headless) return;
    throw rows_.error(std::to_string(fields) + " fields where the header has " +
                      std::to_string(layout_.names) +
                      " names: are there decimal commas, or texts without quotes?");
  }

  void readResolution() {
    if (resolution_known_) return;
    if (layout_.resolution) {
      const auto size_px = resolutionIn(rows_, row_.field(*layout_.resolution));
      if (size_px) screen_.size_px = *size_px;
      resolution_known_ = size_px.has_value();
      return;
    }
    if (!layout_.width_px || !layout_.height_px) return;
    const auto width = parseNumber(row_.field(*layout_.width_px));
    const auto height = parseNumber(row_.field(*layout_.height_px));
    if (!width || !height) return;
    const auto pixels = [&](std::size_t column) {
      return static_cast<int>(
          numberIn(rows_, "resolution", row_.field(column), 16, 16384, "16 to 16384 px"));
    };
    screen_.size_px = {pixels(*layout_.width_px), pixels(*layout_.height_px)};
    resolution_known_ = true;
  }

  void readSample(GazeSample& sample) {
    row_.read(sample);
    sample.time_s = times_.read();  // in the file's unit
    if (!layout_.x && !isInSpace()) {
      sample.point_px = cyclopean_.combine(times_.seconds(sample.time_s), sample.eyes[0].point_px,
                                           sample.eyes[1].point_px);
    }
    if (sample.blink) sample.point_px.reset();
    head_seen_ |= sample.head.has_value();
    if (!units_stated_ && sample.point_px) plain_.add(*sample.point_px);
    for (std::size_t side : {0, 1}) {
      eyes_seen_[side] |= sample.eyes[side].point_px || sample.eyes[side].direction;
    }
  }

  void requireHead() const {
    if (!layout_.space || !layout_.space->hasHead() || head_seen_) return;
    throw InputError(rows_.source(),
                     "no sample has a head pose: all are absent or 0 (gaze.head_quaternion, "
                     "gaze.head_angles, gaze.head_euler, gaze.head_position)");
  }

  /// States what was assumed. @throws InputError if the positions contradict it
  void state(TraceHeader& header) const {
    if (!units_stated_) {
      if (plain_.areFractions()) {
        throw InputError(rows_.source(),
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
    } else if (rows_.mayBeCut() && last_decimals_.areFewer()) {
      header.warnings.push_back(
          "the last line has no end and fewer decimals than the others, so it may be cut off: is "
          "the file complete?");
    }
    if (const std::string& text = row_.decimalComma(); !text.empty()) {
      header.assumed.push_back("decimal comma: " + shown(text) + " is " + pointed(text));
    }
    if (layout_.of_scene_camera && !given_.mapped_later) {
      header.warnings.push_back(
          "positions are those of a scene camera on the head: foci takes its view for the screen, "
          "which holds only for a head at rest; a gaze map (foci calibrate gaze) corrects this");
    }
    if (const std::string& column = layout_.unused_validity; !column.empty()) {
      header.warnings.push_back("column " + shown(column) +
                                " is unused: if it marks data loss, name it with gaze.confidence "
                                "(1 is good) or gaze.blink (0 is good)");
    }
    times_.state(header);
    requireHead();
    if (field_ && !given_.field) {
      header.assumed.push_back("field of the headset: " + exactText(field_->left_deg) +
                               " deg to each side of straight ahead (display.field_deg)");
    }
    if (nominal_) {
      header.assumed.push_back(
          "screen: unknown (--screen-px, --screen-m, --distance-m); only the unit of the file is "
          "shown");
    }
  }

  Rows& rows_;
  const TraceColumns& given_;
  Screen screen_;
  TableLayout layout_;
  TableRow row_;
  RowTimes times_;
  GazeSample sample_{};  // of the latest row
  Cyclopean cyclopean_{};
  PlainPositions plain_{};
  GazeUnits units_ = GazeUnits::px;
  bool units_stated_ = false;        // by the user, the file or its format
  std::optional<EyeField> field_{};  // of a headset
  bool head_seen_ = false, resolution_known_ = false;
  bool nominal_ = false;  // `kNominalScreen` stands in
  std::size_t taken_ = 0;
  std::optional<InputError> broken_{};  // the latest line has too few fields
  LastDecimals last_decimals_{};
  std::array<bool, 2> eyes_seen_{};
};

}  // namespace

TraceHeader readRows(Rows& rows, const TraceColumns& columns, const TakeSample& take) {
  return RowReader(rows, columns, take).read();
}

}  // namespace foci
