// HoloLens 2: *_head_hand_eye.csv of Microsoft's Stream Recorder (HoloLens2ForCV). A row has the
// time in 100 ns and the head's transform to the world (4 x 4, row by row). For each hand a flag
// and 26 transforms follow. Then come a flag for gaze, its origin and direction (4 numbers each),
// and its distance. The world is right-handed with y up, in metres; gaze is in the world.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/recording_formats.h"
#include "gaze/sources/swift_number.h"

namespace foci {
namespace {

constexpr std::size_t kTransform = 16, kHand = 1 + 26 * kTransform;
constexpr std::size_t kHeadAt = 1, kGazeAt = kHeadAt + kTransform + 2 * kHand;
constexpr std::size_t kFields = kGazeAt + 1 + 4 + 4 + 1;
constexpr double kTick_s = 1e-7, kRigid = 1e-3, kFarthest_m = 1e5;

class HoloLensReader {
 public:
  HoloLensReader(LineReader& lines, const TraceColumns& columns, const TakeSample& take)
      : lines_(lines),
        take_(take),
        from_head_(columns.space.from_head),
        field_(columns.field.value_or(EyeField{})),
        field_assumed_(!columns.field),
        screen_(headsetScreen(fieldOfBothEyes(field_), columns.pixels_per_degree)) {}

  TraceHeader read() {
    std::string_view line;
    while (lines_.next(line)) {
      if (trimmed(line).empty()) continue;
      if (cut_) throw lines_.error("follows a line that is too short");
      splitFields(line, ',', fields_);
      // The last line may be cut off.
      cut_ = fields_.size() < kFields && rows_ > 1;
      if (cut_) continue;
      ++rows_;
      readRow();
    }
    return header();
  }

 private:
  double number(std::size_t column) const {
    const auto value = fieldNumber(fields_[column]);
    if (!value) {
      throw lines_.error("column " + std::to_string(column + 1) + " = " + shown(fields_[column]) +
                         ": expected a number");
    }
    return *value;
  }

  glm::dvec3 vector(std::size_t column) const {
    return {number(column), number(column + 1), number(column + 2)};
  }

  /// Nothing if the head was not tracked: a transform of zeros, or the identity's rows of it.
  std::optional<HeadInWorld> readHead() const {
    glm::dmat3 turn(0.0);
    glm::dvec3 place_m(0.0);
    for (int row = 0; row < 3; ++row) {
      const std::size_t at = kHeadAt + 4 * static_cast<std::size_t>(row);
      for (int column = 0; column < 3; ++column) {
        turn[column][row] = number(at + static_cast<std::size_t>(column));
      }
      place_m[row] = number(at + 3);
    }
    if (turn == glm::dmat3(0.0)) return std::nullopt;
    const glm::dmat3 product = glm::transpose(turn) * turn;
    double error = std::abs(glm::determinant(turn) - 1.0);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) error = std::max(error, std::abs(product[i][j] - (i == j)));
    }
    if (error > kRigid || !(glm::length(place_m) <= kFarthest_m)) {
      throw lines_.error("columns 2 to 17: expected a rigid transform of the head, row by row");
    }
    return HeadInWorld{.position_m = place_m,
                       .world_from_head = glm::normalize(glm::quat_cast(turn))};
  }

  void readRow() {
    if (fields_.size() < kFields) {
      throw lines_.error(std::to_string(fields_.size()) + " fields: expected " +
                         std::to_string(kFields));
    }
    const double ticks = number(0);
    if (!start_ticks_) start_ticks_ = ticks;
    GazeSample sample{.time_s = kTick_s * (ticks - *start_ticks_)};
    if (last_s_ && !(sample.time_s > *last_s_)) {
      throw lines_.error("time " + shown(fields_[0]) + " is not after the sample before");
    }
    last_s_ = sample.time_s;
    sample.head = readHead();
    const glm::dvec3 direction = vector(kGazeAt + 5);
    if (sample.head && from_head_) {
      sample.direction = kStraightAhead;
      sample.point_px = pointOnScreen_px(screen_, kStraightAhead);
    } else if (sample.head && number(kGazeAt) == 1.0 && glm::length(direction) > 0.0) {
      sample.direction = glm::conjugate(sample.head->world_from_head) * glm::normalize(direction);
      sample.point_px = pointOnScreen_px(screen_, *sample.direction);
    }
    take_(sample);
  }

  TraceHeader header() const {
    const std::string sure = "certain: a column of Stream Recorder";
    TraceHeader header{.format = "HoloLens 2, Stream Recorder",
                       .screen = screen_,
                       .units = GazeUnits::deg,
                       .field = field_,
                       .columns = {{"#1", "time, a unit is 1e-07 s, here from 0", sure},
                                   {"#2 to #17", "transform of the head to the world, m", sure},
                                   {"#18 to #851", "unused", ""},
                                   {"#852", "whether there is gaze", sure},
                                   {"#853 to #856", "unused", ""},
                                   {"#857 to #860", "direction of gaze in the world", sure},
                                   {"#861", "unused", ""}},
                       .gaze_in_world = true};
    if (field_assumed_) {
      header.assumed.push_back("field of the headset: " + exactText(field_.left_deg) +
                               " deg to each side of straight ahead (display.field_deg)");
    }
    return header;
  }

  LineReader& lines_;
  const TakeSample& take_;
  bool from_head_;  // the head's direction stands for gaze
  EyeField field_;
  bool field_assumed_;
  Screen screen_;
  std::vector<std::string_view> fields_{};
  std::optional<double> start_ticks_{}, last_s_{};
  std::size_t rows_ = 0;
  bool cut_ = false;  // the previous line had too few fields
};

/// The table has no header: its 861 numbers a row tell it.
bool isHoloLens(const RecordingFile& file) {
  std::vector<std::string_view> fields;
  splitFields(file.firstLine(), ',', fields);
  return file.isUndescribed() && fields.size() == kFields && parseNumber(fields[0]) &&
         parseNumber(fields[kGazeAt]);
}

}  // namespace

const RecordingFormat kHoloLens{
    .is = isHoloLens,
    .read =
        [](const RecordingFile& file, const Screen&, const TakeSample& take) {
          LineReader lines(file.path());
          return HoloLensReader(lines, file.columns(), take).read();
        },
    .preview = [](const std::filesystem::path&) { return SpacePreview{.has_head = true}; }};

}  // namespace foci
