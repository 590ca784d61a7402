// Rows of a recording as samples: its columns get a meaning, and each row becomes a sample.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/column_names.h"
#include "gaze/sources/recording_formats.h"
#include "gaze/sources/row_times.h"
#include "gaze/sources/table_row.h"

namespace foci {
namespace {

// Degrees and fractions keep their meaning on any screen. This one stands in for an unknown screen.
const Screen kNominalScreen{.size_px = {1000, 1000}, .size_m = {1.0, 1.0}, .distance_m = 1.0};

std::string pointed(std::string text) {
  std::ranges::replace(text, ',', '.');
  return text;
}

/// Judges positions without a stated unit.
class PlainPositions {
 public:
  void add(const glm::dvec2& point_px) {
    ++count_;
    const bool whole = point_px == glm::floor(point_px);
    tiny_ += !whole && glm::all(glm::lessThan(glm::abs(point_px), glm::dvec2(2.0)));
    negative_ += point_px.x < 0.0 || point_px.y < 0.0;
  }

  /// No tracker looks at the corner pixel for half of a recording.
  bool areFractions() const { return tiny_ >= 2 && 2 * tiny_ >= count_; }
  bool areAroundZero() const { return count_ >= 20 && 4 * negative_ >= count_; }

 private:
  std::size_t count_ = 0, tiny_ = 0, negative_ = 0;
};

/// The decimals of each row's last number. A writer with a fixed number of them writes fewer only
/// where the file is cut off.
class LastDecimals {
 public:
  void add(std::string_view text) {
    if (isAbsent(text)) return;
    const std::size_t point = text.find_first_of(".,");
    fixed_ = fixed_ && latest_ == usual_;
    latest_ = point == text.npos ? 0 : text.size() - point - 1;
    if (rows_++ == 0) usual_ = latest_;
  }

  /// In the latest row, if all rows before have the same number.
  bool areFewer() const { return rows_ > kEnough && fixed_ && latest_ < usual_; }

 private:
  static constexpr std::size_t kEnough = 64;  // rows that end in no 0 by chance: a thousandth

  std::size_t rows_ = 0, usual_ = 0, latest_ = 0;
  bool fixed_ = true;
};

/// A column of few values that is no part of a sample.
struct WatchedColumn {
  static constexpr std::size_t kMostValues = 12, kShortest = 100;

  std::size_t column = 0;
  std::vector<std::string> values{};          // in order of appearance
  bool in_blocks = true;                      // each value in rows one after another
  std::size_t rows = 0, shortest = SIZE_MAX;  // of this block; of the blocks before

  /// @return whether another block begins
  bool changes(std::string_view value) {
    ++rows;
    if (value.empty() || (!values.empty() && values.back() == value)) return false;
    in_blocks = values.size() < kMostValues && std::ranges::find(values, value) == values.end();
    if (!in_blocks) return false;
    if (!values.empty()) shortest = std::min(shortest, rows);
    rows = 0;
    values.emplace_back(value);
    return values.size() > 1;
  }

  /// Whether the values may be people or recordings. The parts of an experiment are none.
  bool mayBePeople(std::string_view name) const {
    if (values.size() < 2 || std::min(shortest, rows) < kShortest) return false;
    const std::string key = lowered(name);
    for (const std::string_view part :
         {"trial",    "block",    "cond",  "stim",    "image", "picture", "page",    "task",
          "phase",    "event",    "label", "word",    "item",  "target",  "marker",  "message",
          "aoi",      "scene",    "media", "video",   "state", "fix",     "sacc",    "count",
          "frame",    "section",  "round", "level",   "class", "text",    "trigger", "button",
          "response", "movement", "type",  "pursuit", "blink", "valid"}) {
      if (key.find(part) != key.npos) return false;
    }
    const bool numbers = std::ranges::all_of(
        values, [](const std::string& value) { return parseNumber(value).has_value(); });
    return !numbers || key.ends_with("id") || key.ends_with("name") || isWordOf(kParts, key);
  }

  static constexpr std::string_view kParts =
      "session sess visit day run file filename group code nr no number who";
};

class RowReader {
 public:
  RowReader(Rows& rows, const TraceColumns& columns, const Screen& fallback, const TakeSample& take)
      : rows_(rows),
        given_(columns),
        stated_(rows.before().screen),
        screen_(screenInForce(stated_, fallback)),
        layout_(recogniseTable(rows, columns)),
        units_(columns.units         ? *columns.units
               : rows.before().units ? *rows.before().units
                                     : layout_.units.value_or(GazeUnits::px)),
        row_(rows, layout_, columns, screen_, units_),
        times_(layout_, row_, rows, columns, take) {
    if (layout_.headless) rows_.readNamesAsRow();
    units_stated_ = columns.units || rows.before().units || layout_.units ||
                    layout_.hasDirections() || columns.mapped_later || layout_.space;
    judges_px_ = units_ == GazeUnits::px && !columns.units && !isInSpace() && !columns.mapped_later;
    if (layout_.space) {
      field_ = columns.field.value_or(EyeField{});
      screen_ = headsetScreen(fieldOfBothEyes(*field_), columns.pixels_per_degree);
    }
    if ((units_ == GazeUnits::deg || units_ == GazeUnits::relative || isInSpace()) &&
        !isMetric(screen_)) {
      screen_ = kNominalScreen;
      nominal_ = true;
    }
    if (units_ == GazeUnits::normalised && !(screen_.size_px.x > 0 && screen_.size_px.y > 0)) {
      screen_.size_px = kNominalScreen.size_px;
      nominal_ = true;
    }
    rows_.survey(1, [&] { refuseExtraFields(); });
    std::size_t columns_used = layout_.columns;
    for (const std::size_t column : layout_.groups.watched) {
      watched_.push_back({.column = column});
      columns_used = std::max(columns_used, column + 1);
    }
    rows_.limitTo(columns_used);
  }

  TraceHeader read() {
    while (rows_.next()) readRow();
    finishGroups();
    times_.finish();
    TraceHeader header{{.format = layout_.format,
                        .screen = nominal_ || field_ ? screen_ : stated_,
                        .field = field_,
                        .pupil_unit = layout_.pupil_unit},
                       isInSpace() ? GazeUnits::deg : units_,
                       layout_.readings,
                       layout_.space && layout_.space->in_world};
    header.nominal_screen = nominal_;
    if (eyes_seen_[0] && eyes_seen_[1]) header.format += ", binocular";
    state(header);
    return header;
  }

 private:
  void readRow() {
    if (broken_) throw *broken_;
    // The last line may be cut off. `broken_` refuses any line behind it.
    if (!row_.isComplete() && taken_ > 1 && !layout_.rows.column) {
      broken_ = row_.tooShort(layout_.columns - 1);
      return;
    }
    if (row_.isComplete() && !rows_.areNumbers()) last_decimals_.add(row_.lastField());
    ++taken_;
    if (!row_.isSample() || !layout_.groups.isEmpty()) {
      if (!row_.isSample() || !isOfGroup()) return;
    }
    readResolution();
    readSample(sample_);
    if (layout_.groups.isEmpty()) return times_.add(sample_);
    if (!watched_.empty() && beginsAnew()) return;
    addOfGroup();
  }

  /// Whether the clock is set back where a watched column changes. The column then tells recordings
  /// apart.
  bool beginsAnew() {
    constexpr double kFewRows = 8.0;
    if (watched_rows_++ == 0) watch_from_ = watch_last_ = sample_.time_s;
    const double back = watch_last_ - sample_.time_s, span = watch_last_ - watch_from_;
    const bool is_back = back * static_cast<double>(watched_rows_) > kFewRows * span && back > 0.0;
    watch_last_ = sample_.time_s;
    bool begins = false;
    for (WatchedColumn& watched : watched_) {
      if (!watched.changes(valueAt(watched.column)) || !is_back || begins) continue;
      begins = true;
      layout_.groups.people.push_back(watched.column);
      people_.push_back(watched.values);
    }
    std::erase_if(watched_, [](const WatchedColumn& watched) { return !watched.in_blocks; });
    if (begins) watched_.clear();
    return begins;
  }

  std::string_view valueAt(std::size_t column) const {
    return column < rows_.size() ? rows_.text(column) : std::string_view();
  }

  /// Whether the row is of the person that the study chooses, of the first person, and of the eye
  /// tracker.
  bool isOfGroup() {
    const RowGroups& groups = layout_.groups;
    for (const ValueColumn& only : groups.only) {
      const std::string_view value = valueAt(only.at);
      if (value == only.values[0]) continue;
      note(other_values_, value);
      const auto number = rows_.areNumbers() ? rows_.number(only.at) : std::nullopt;
      if (!number || number != parseNumber(only.values[0])) return false;
    }
    any_chosen_ = true;
    people_.resize(groups.people.size());
    for (std::size_t i = 0; i < people_.size(); ++i) {
      note(people_[i], valueAt(groups.people[i]));
      if (people_[i].size() > 1) return false;
    }
    const auto isOfDevice = [&](const ValueColumn& device) {
      const std::string_view value = valueAt(device.at);
      return std::ranges::find(device.values, value) != device.values.end();
    };
    const bool is_foreign = (groups.device && !row_.hasGaze() && !isOfDevice(*groups.device)) ||
                            (groups.foreign_if_blank && row_.isBlank());
    foreign_ += is_foreign;
    return !is_foreign;
  }

  static void note(std::vector<std::string>& values, std::string_view value) {
    constexpr std::size_t kMaxValues = 1000;
    if (value.empty() || values.size() >= kMaxValues) return;
    if (!values.empty() && values.front() == value) return;
    if (std::ranges::find(values, value) == values.end()) values.emplace_back(value);
  }

  /// Passes the sample on: with the other eye's row, and without foreign rows before it.
  void addOfGroup() {
    const RowGroups& groups = layout_.groups;
    if (groups.eye) return addEye();
    if (!groups.foreign_within) return times_.add(sample_);
    constexpr std::size_t kMaxPending = 1 << 16;
    if (!row_.hasGaze() && pending_.size() < kMaxPending) {
      pending_.push_back(sample_);
      return;
    }
    addPending(sample_.time_s);
    times_.add(sample_);
    last_gaze_ = sample_.time_s;
  }

  /// Rows without gaze before a sample. Between two samples of a usual interval, they are foreign;
  /// in data loss, those at whole intervals are the eye tracker's.
  void addPending(double until) {
    const double interval = *layout_.groups.foreign_within;
    constexpr double kNear = 0.2;  // of an interval
    const bool none_lost = last_gaze_ && until - *last_gaze_ <= 1.5 * interval;
    double last = 0.0;
    for (const GazeSample& sample : pending_) {
      const double steps = last_gaze_ ? (sample.time_s - *last_gaze_) / interval : 0.0;
      const bool whole = std::abs(steps - std::round(steps)) < kNear && std::round(steps) > last;
      if (none_lost || (last_gaze_ && !whole)) {
        ++foreign_;
        continue;
      }
      last = std::round(steps);
      times_.add(sample);
    }
    pending_.clear();
  }

  /// Two rows of two eyes, at times nearer than half of an interval, are one sample.
  void addEye() {
    const RowGroups& groups = layout_.groups;
    const std::string_view value = valueAt(*groups.eye);
    if (value != groups.eyes[0] && value != groups.eyes[1]) {
      ++of_neither_;
      return;
    }
    const std::size_t side = value == groups.eyes[0] ? 0 : 1;
    GazeSample own = sample_;
    own.eyes = {};
    own.eyes[side] = {.point_px = own.point_px,
                      .direction = own.direction,
                      .pupil_mm = own.pupil_mm,
                      .pupil_own = own.pupil_own};
    // Eyes measured in turn are half an interval apart, to the rounding of the times: not a pair.
    constexpr double kPaired = 0.4;
    if (first_eye_ && side != first_side_ &&
        own.time_s - first_eye_->time_s <= kPaired * groups.eye_interval) {
      GazeSample& both = *first_eye_;
      both.eyes[side] = own.eyes[side];
      both.blink = both.blink && own.blink;
      if (own.pupil_mm)
        both.pupil_mm = 0.5 * (both.pupil_mm.value_or(*own.pupil_mm) + *own.pupil_mm);
      passEyes();
      return;
    }
    passEyes();
    first_eye_ = own;
    first_side_ = side;
  }

  void passEyes() {
    if (!first_eye_) return;
    GazeSample& sample = *first_eye_;
    noteEyes(sample);
    if (isInSpace()) {
      sample.direction = meanDirection(sample.eyes);
      sample.point_px =
          sample.direction ? pointOnScreen_px(screen_, *sample.direction) : std::nullopt;
    } else {
      combineEyes(sample);
    }
    times_.add(sample);
    first_eye_.reset();
  }

  void noteEyes(const GazeSample& sample) {
    for (std::size_t side : {0, 1}) {
      eyes_seen_[side] |= sample.eyes[side].point_px || sample.eyes[side].direction;
    }
  }

  /// @param sample  its time is in the file's unit
  void combineEyes(GazeSample& sample) {
    sample.point_px = cyclopean_.combine(times_.seconds(sample.time_s), sample.eyes[0].point_px,
                                         sample.eyes[1].point_px);
  }

  /// @throws SeveralPeople, or InputError if no row is of the person that the study chooses
  void finishGroups() {
    const RowGroups& groups = layout_.groups;
    if (groups.eye) passEyes();
    if (groups.foreign_within) addPending(INFINITY);
    for (std::size_t i = 0; i < people_.size(); ++i) {
      if (people_[i].size() < 2) continue;
      throw SeveralPeople(rows_.source(), rows_.names()[groups.people[i]], people_[i]);
    }
    if (groups.only.empty() || any_chosen_) return;
    const std::string others = listOf(other_values_);
    throw InputError(rows_.source(), "no row is of gaze.rows: its column has " +
                                         (others.empty() ? "no other values" : others));
  }

  /// Lines of sight give the points.
  bool isInSpace() const { return layout_.hasDirections() || layout_.space; }

  /// A row with more fields than the header has names: a comma is decimal, or not in quotes.
  void refuseExtraFields() const {
    const std::size_t fields = rows_.sizeUpToText(layout_.names);
    if (fields <= layout_.names || layout_.headless) return;
    throw rows_.error(std::to_string(fields) + " fields where the header has " +
                      std::to_string(layout_.names) +
                      " names: are there decimal commas, or texts without quotes?");
  }

  void readResolution() {
    if (resolution_known_) return;
    std::optional<glm::ivec2> size_px;
    if (layout_.resolution) {
      size_px = resolutionIn(rows_, row_.field(*layout_.resolution));
    } else if (layout_.width_px && layout_.height_px) {
      const std::string_view width = row_.field(*layout_.width_px);
      const std::string_view height = row_.field(*layout_.height_px);
      if (!parseNumber(width) || !parseNumber(height)) return;
      size_px =
          glm::ivec2{pixelsIn(rows_, "resolution", width), pixelsIn(rows_, "resolution", height)};
    }
    if (size_px) screen_.size_px = stated_.size_px = *size_px;
    resolution_known_ = size_px.has_value();
  }

  void readSample(GazeSample& sample) {
    row_.read(sample);
    sample.time_s = times_.read();  // in the file's unit
    if (!layout_.x && !isInSpace()) combineEyes(sample);
    if (sample.blink) sample.point_px.reset();
    head_seen_ |= sample.head.has_value();
    if (judges_px_ && sample.point_px) plain_.add(*sample.point_px);
    noteEyes(sample);
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
      if (!layout_.unknown_unit.empty()) {
        header.warnings.push_back("column " + shown(layout_.unknown_unit) +
                                  " has an unknown unit, taken for px: gaze.scale converts it to "
                                  "gaze.units");
      }
    }
    if (layout_.isPlain() && layout_.units == GazeUnits::normalised && !layout_.y_up &&
        given_.offset == glm::dvec2(0.0)) {
      header.assumed.push_back(
          "origin: upper left corner, y down (y up: gaze.scale = [1, -1], gaze.offset = [0, 1])");
    }
    if (plain_.areAroundZero()) {
      header.warnings.push_back(
          "a quarter of the positions or more are negative, so they may be degrees, or pixels "
          "from the middle of the screen: give gaze.units or gaze.offset");
    }
    if (broken_) {
      header.warnings.emplace_back(kCutOff);
    } else if (rows_.mayBeCut() && last_decimals_.areFewer()) {
      header.warnings.push_back(
          "the last line has no end and fewer decimals than the others, so it may be cut off: is "
          "the file complete?");
    }
    if (const std::string& text = row_.decimalComma(); !text.empty()) {
      header.assumed.push_back("decimal comma: " + shown(text) + " is " + pointed(text));
    }
    if (layout_.of_scene_camera && !given_.mapped_later) {
      header.warnings.push_back(kOfSceneCamera);
    }
    if (const std::string& column = layout_.unused_gaze; !column.empty()) {
      header.warnings.push_back(
          "gaze is read from " +
          (layout_.x ? "column " + shown(rows_.names()[*layout_.x]) : std::string("both eyes")) +
          ", and column " + shown(column) + " is unused: name the gaze with gaze.x and gaze.y");
    }
    if (const std::string& column = layout_.unused_validity; !column.empty()) {
      header.warnings.push_back("column " + shown(column) +
                                " is unused: if it marks data loss, name it with gaze.confidence "
                                "(1 is good) or gaze.blink (0 is good)");
    }
    if (const std::string& column = layout_.doubtful_pupil; !column.empty()) {
      header.warnings.push_back("column " + shown(column) +
                                " is read as the pupil's diameter in mm: gaze.pupil_scale_mm "
                                "converts a radius (2) or another unit of length; an area needs "
                                "another column");
    }
    times_.state(header);
    stateGroups(header);
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

  void stateGroups(TraceHeader& header) const {
    for (const WatchedColumn& watched : watched_) {
      const std::string& name = rows_.names()[watched.column];
      if (!watched.mayBePeople(name)) continue;
      header.warnings.push_back(
          "column " + shown(name) + " has " + std::to_string(watched.values.size()) +
          " values, one after another: " + listOf(watched.values) +
          "; if they are people or recordings, read one with gaze.rows = { " + quotedText(name) +
          " = " + quotedText(watched.values.front()) + " }");
    }
    if (!layout_.validity_note.empty()) {
      const bool is_sure = layout_.isPlain() && layout_.validity_code != ValidityCode::below_two;
      (is_sure ? header.assumed : header.warnings).push_back(layout_.validity_note);
    }
    const RowGroups& groups = layout_.groups;
    if (foreign_ > 0) {
      header.assumed.push_back(counted(foreign_, "row") +
                               " without gaze between the samples, as of a mouse, a sensor or an "
                               "event: skipped");
    }
    if (groups.eye) {
      header.assumed.push_back(
          "rows of one eye each, by the column " + shown(rows_.names()[*groups.eye]) + ": " +
          shown(groups.eyes[0]) + " is the left eye" + (groups.eyes_assumed ? ", a guess" : "") +
          (of_neither_ == 0 ? ""
                            : "; rows of neither are left out: " + std::to_string(of_neither_)));
    }
  }

  Rows& rows_;
  const TraceColumns& given_;
  Screen stated_, screen_;
  TableLayout layout_;
  GazeUnits units_;
  TableRow row_;
  RowTimes times_;
  GazeSample sample_{};  // of the latest row
  Cyclopean cyclopean_{};
  PlainPositions plain_{};
  bool units_stated_ = false;        // by the user, the file or its format
  bool judges_px_ = false;           // positions are pixels, but the user does not say so
  std::optional<EyeField> field_{};  // of a headset
  bool head_seen_ = false, resolution_known_ = false;
  bool nominal_ = false;  // `kNominalScreen` stands in
  std::size_t taken_ = 0;
  std::optional<InputError> broken_{};  // the latest line has too few fields
  LastDecimals last_decimals_{};
  std::array<bool, 2> eyes_seen_{};
  std::vector<std::vector<std::string>> people_{};  // values of `RowGroups::people`
  std::vector<WatchedColumn> watched_{};
  std::size_t watched_rows_ = 0;
  double watch_from_ = 0.0, watch_last_ = 0.0;  // times of the first and the latest row
  std::vector<std::string> other_values_{};     // that the study does not choose
  bool any_chosen_ = false;
  std::size_t foreign_ = 0;                // rows
  std::size_t of_neither_ = 0;             // rows of one eye each: of neither eye
  std::vector<GazeSample> pending_{};      // without gaze, since the last one with gaze
  std::optional<double> last_gaze_{};      // its time
  std::optional<GazeSample> first_eye_{};  // waits for the other eye's row
  std::size_t first_side_ = 0;
};

}  // namespace

bool isMetric(const Screen& screen) {
  return screen.size_px.x > 0 && screen.size_px.y > 0 && screen.size_m.x > 0.0 &&
         screen.size_m.y > 0.0 && screen.distance_m > 0.0;
}

Screen screenInForce(Screen screen, const Screen& fallback) {
  for (const int axis : {0, 1}) {
    if (screen.size_px[axis] <= 0) screen.size_px[axis] = fallback.size_px[axis];
    if (screen.size_m[axis] <= 0.0) screen.size_m[axis] = fallback.size_m[axis];
  }
  if (screen.distance_m <= 0.0) screen.distance_m = fallback.distance_m;
  return screen;
}

TraceHeader readRows(Rows& rows, const TraceColumns& columns, const Screen& fallback_screen,
                     const TakeSample& take) {
  return RowReader(rows, columns, fallback_screen, take).read();
}

}  // namespace foci
