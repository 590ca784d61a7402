// EyeNavGS: walks through Gaussian scenes in a headset, with both eyes' gaze (Ding et al. 2025,
// github.com/symmru/EyeNavGS_Rutgers_Dataset). Rows of the left and the right eye alternate; two of
// them are a sample at the left row's time. FOV1 to FOV4 are the left, right, lower and upper
// limits of the eye's view, radians, as signed angles. Gaze poses look along -z, in the scene's
// axes. (0, 0, 0) with the unit quaternion means that the eye tracker was off.
//
// Places are in the scene's units. scene_setting.csv beside the file, or gaze.head_scale_m, says
// how many metres a unit has. Its quaternion T turns the scene upright: T p is level. Poses are in
// the scene's own axes, so T only shows which way is up.

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/recording_formats.h"
#include "gaze/sources/space_layout.h"
#include "gaze/sources/swift_number.h"

namespace foci {
namespace {

constexpr std::string_view kHeader =
    "ViewIndex,FOV1,FOV2,FOV3,FOV4,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,"
    "QuaternionZ,QuaternionW,GazePosX,GazePosY,GazePosZ,GazeQX,GazeQY,GazeQZ,GazeQW,Timestamp";
constexpr std::size_t kColumns = 20;
constexpr double kUnitQuaternion = 0.05;  // quaternions of three decimals
constexpr double kMaxPlace = 1e5;         // scene's units
constexpr double kMaxStamp_s = 1e6;       // of a recording that begins at 0

/// A row: one eye.
struct EyeRow {
  std::size_t side = 0;
  std::array<double, 4> fov_rad{};
  glm::dvec3 position{0.0}, gaze_position{0.0};
  glm::dquat head{};
  std::optional<glm::dquat> gaze{};  // absent: of length 0, as in a blink
  double time_s = 0.0;

  /// The eye tracker was off if the pose is that of no turn at the origin.
  bool hasGaze() const {
    return gaze && (gaze_position != glm::dvec3(0.0) ||
                    glm::dvec3(gaze->x, gaze->y, gaze->z) != glm::dvec3(0.0));
  }
};

/// The properties of a scene in scene_setting.csv.
struct SceneSetting {
  glm::dquat level_from_scene{1.0, 0.0, 0.0, 0.0};
  double units_per_m = 1.0;
};

/// "user105_bicycle.csv" walked through "bicycle".
std::string sceneOf(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t mark = stem.find_last_of('_');
  return mark == stem.npos ? stem : stem.substr(mark + 1);
}

std::optional<SceneSetting> settingBeside(const std::filesystem::path& recording) {
  const std::filesystem::path file = recording.parent_path() / "scene_setting.csv";
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  const std::string scene = sceneOf(recording);
  LineReader lines(file);
  std::string_view line;
  std::vector<std::string_view> fields, parts;
  while (lines.next(line)) {
    splitFields(line, ',', fields);
    if (fields.size() != 4 || fields[0] != scene) continue;
    splitFields(fields[1], ',', parts);
    std::array<double, 4> q{};
    const auto units_per_m = fieldNumber(fields[2]);
    bool good = parts.size() == 4 && units_per_m && *units_per_m > 0.0;
    for (std::size_t i = 0; good && i < 4; ++i) {
      const auto number = fieldNumber(parts[i]);
      good = number.has_value();
      if (good) q[i] = *number;
    }
    const glm::dquat level(q[3], q[0], q[1], q[2]);
    if (!good || std::abs(glm::length(level) - 1.0) > kUnitQuaternion) {
      throw lines.error("expected scene, \"x, y, z, w\", units per metre, \"x,y,z\"");
    }
    return SceneSetting{.level_from_scene = glm::normalize(level), .units_per_m = *units_per_m};
  }
  return std::nullopt;
}

class EyeNavGsReader {
 public:
  EyeNavGsReader(LineReader& lines, const TraceColumns& columns, const TakeSample& take)
      : lines_(lines), given_(columns), take_(take), setting_(settingBeside(lines.fileName())) {
    scale_m_ = setting_ ? 1.0 / setting_->units_per_m : given_.space.head_scale_m;
  }

  TraceHeader read() {
    std::string_view line;
    while (lines_.next(line)) {
      if (trimmed(line).empty()) continue;
      if (cut_) throw *cut_;
      splitFields(line, ',', fields_);
      // The last line may be cut off.
      if (fields_.size() < kColumns && rows_ > 1) {
        cut_ = tooShort();
        continue;
      }
      const EyeRow row = readRow();
      if (rows_++ == 0) setField(row);
      if (first_ && row.side != first_->side) {
        pass(*first_, &row);
        first_.reset();
      } else {
        if (first_) pass(*first_, nullptr);
        first_ = row;
      }
    }
    if (first_) pass(*first_, nullptr);
    if (rows_ > 0 && gazes_ == 0) {
      throw InputError(
          lines_.fileName(),
          "no gaze: GazePos and GazeQ are 0, 0, 0 in every row, so the eye tracker was off; "
          "expected a recording with gaze, or gaze.from_head = true, which takes the head's "
          "direction for gaze");
    }
    return header();
  }

 private:
  double number(std::size_t column, double limit) const {
    const std::string_view text = fields_[column];
    const auto value = fieldNumber(text);
    if (!value || !(std::abs(*value) <= limit)) {
      throw lines_.error("column " + std::to_string(column + 1) + " = " + shown(text) +
                         ": expected a number up to " + significant(limit));
    }
    return *value;
  }

  glm::dvec3 place(std::size_t column) const {
    return {number(column, kMaxPlace), number(column + 1, kMaxPlace),
            number(column + 2, kMaxPlace)};
  }

  /// @return nothing for a quaternion of zeros
  std::optional<glm::dquat> rotation(std::size_t column) const {
    const glm::dquat q(number(column + 3, 1.1), number(column, 1.1), number(column + 1, 1.1),
                       number(column + 2, 1.1));
    if (glm::length(q) == 0.0) return std::nullopt;
    if (std::abs(glm::length(q) - 1.0) > kUnitQuaternion) {
      throw notUnit(column);
    }
    return glm::normalize(q);
  }

  InputError notUnit(std::size_t column) const {
    return lines_.error("columns " + std::to_string(column + 1) + " to " +
                        std::to_string(column + 4) +
                        ": expected a quaternion x, y, z, w of length 1");
  }

  InputError tooShort() const {
    return lines_.error(std::to_string(fields_.size()) + " fields: expected 20");
  }

  EyeRow readRow() const {
    if (fields_.size() < kColumns) throw tooShort();
    const double side = number(0, 1.0);
    if (side != 0.0 && side != 1.0) {
      throw lines_.error("ViewIndex = " + shown(fields_[0]) + ": expected 0 (left) or 1 (right)");
    }
    EyeRow row{.side = static_cast<std::size_t>(side)};
    for (std::size_t i = 0; i < 4; ++i) row.fov_rad[i] = number(1 + i, 1.5);
    row.position = place(5);
    const auto head = rotation(8);
    if (!head) throw notUnit(8);
    row.head = *head;
    row.gaze_position = place(12);
    row.gaze = rotation(15);
    row.time_s = 1e-3 * number(19, 1e3 * kMaxStamp_s);
    return row;
  }

  void setField(const EyeRow& row) {
    const auto& [left, right, down, up] = row.fov_rad;
    if (!(left < 0.0 && right > 0.0 && down < 0.0 && up > 0.0)) {
      throw lines_.error(
          "FOV1 to FOV4: expected angles to the left (below 0), right, down (below "
          "0) and up, rad");
    }
    EyeField field{.left_deg = -glm::degrees(left),
                   .right_deg = glm::degrees(right),
                   .up_deg = glm::degrees(up),
                   .down_deg = -glm::degrees(down)};
    if (row.side == 1) std::swap(field.left_deg, field.right_deg);
    field_ = given_.field.value_or(field);
    screen_ = headsetScreen(fieldOfBothEyes(field_), given_.pixels_per_degree);
  }

  /// @param other  the other eye's row of the same moment; null: missing
  void pass(const EyeRow& row, const EyeRow* other) {
    GazeSample sample{.time_s = row.time_s};
    if (last_s_ && !(sample.time_s > *last_s_)) {
      throw lines_.error("time " + exactText(1e3 * sample.time_s) +
                         " is not after the sample before: was the recording started twice? "
                         "Write a file for each");
    }
    last_s_ = sample.time_s;
    // The eyes are half of the distance between them away from the middle, which is the head's
    // place. A lone eye's row cannot tell the middle.
    if (!other) return;
    sample.head = HeadInWorld{.position_m = 0.5 * scale_m_ * (row.position + other->position),
                              .world_from_head = row.head};
    const glm::dquat head_from_world = glm::conjugate(row.head);
    for (const EyeRow* each : {&row, other}) {
      EyeSample& eye = sample.eyes[each->side];
      if (given_.space.from_head) {
        eye.origin_m = head_from_world * (scale_m_ * each->position - sample.head->position_m);
        continue;
      }
      if (!each->hasGaze()) continue;
      eye.origin_m = head_from_world * (scale_m_ * each->gaze_position - sample.head->position_m);
      eye.direction = head_from_world * (*each->gaze * glm::dvec3(0.0, 0.0, -1.0));
    }
    sample.direction = given_.space.from_head ? kStraightAhead : meanDirection(sample.eyes);
    if (sample.direction) sample.point_px = pointOnScreen_px(screen_, *sample.direction);
    gazes_ += sample.direction.has_value();
    take_(sample);
  }

  TraceHeader header() const {
    const bool eyes = !given_.space.from_head;
    TraceHeader header{.format = eyes ? "EyeNavGS, binocular" : "EyeNavGS, the head alone",
                       .screen = screen_,
                       .units = GazeUnits::deg,
                       .field = field_,
                       .columns = readings(),
                       .gaze_in_world = true,
                       .world_y_up = !setting_ || isUpright(*setting_)};
    if (setting_) {
      header.scene_scale_m = scale_m_;
    } else {
      header.assumed.push_back(
          "places: " + exactText(scale_m_) +
          " m a unit of the scene (gaze.head_scale_m); scene_setting.csv beside the recording "
          "states it");
    }
    if (cut_) {
      header.warnings.push_back("the last line is cut off and left out: is the file complete?");
    }
    return header;
  }

  std::vector<ColumnReading> readings() const {
    const std::string sure = "certain: a column of EyeNavGS";
    const std::string unit = ", a unit is " + significant(scale_m_) + " m";
    const bool eyes = !given_.space.from_head;
    return {
        {"ViewIndex", "0 for the left eye, 1 for the right eye", sure},
        {"FOV1 to FOV4", "limits of the eye's view to the left, right, down and up, rad", sure},
        {"PositionX, Y, Z", "place of the eye in the scene" + unit,
         setting_ ? "certain: scene_setting.csv states the unit" : "a guess: the unit"},
        {"QuaternionX, Y, Z, W", "orientation of the head in the scene", sure},
        {"GazePosX, Y, Z", eyes ? "origin of gaze in the scene" + unit : "unused",
         eyes ? sure : ""},
        {"GazeQX, Y, Z, W", eyes ? "rotation of gaze in the scene, which looks along -z" : "unused",
         eyes ? sure : ""},
        {"Timestamp", "time, a unit is 0.001 s", sure}};
  }

  static bool isUpright(const SceneSetting& setting) {
    constexpr double kUpright = 0.7;  // cosine
    return (setting.level_from_scene * glm::dvec3(0.0, 1.0, 0.0)).y > kUpright;
  }

  LineReader& lines_;
  const TraceColumns& given_;
  const TakeSample& take_;
  std::optional<SceneSetting> setting_;
  double scale_m_ = 1.0;
  std::vector<std::string_view> fields_{};
  EyeField field_{};
  Screen screen_{};
  std::optional<EyeRow> first_{};  // waits for the other eye
  std::optional<double> last_s_{};
  std::size_t rows_ = 0, gazes_ = 0;
  std::optional<InputError> cut_{};  // the latest line has too few fields
};

TraceHeader readEyeNavGs(const RecordingFile& file, const Screen&, const TakeSample& take) {
  LineReader lines(file.path());
  std::string_view header;
  lines.next(header);
  return EyeNavGsReader(lines, file.columns(), take).read();
}

SpacePreview previewEyeNavGs(const std::filesystem::path& file) {
  const auto setting = settingBeside(file);
  return {.has_head = true,
          .scene_scale_m = setting ? std::optional(1.0 / setting->units_per_m) : std::nullopt};
}

std::vector<std::filesystem::path> settingsOf(const std::filesystem::path& file) {
  std::error_code unreadable;
  const std::filesystem::path setting = file.parent_path() / "scene_setting.csv";
  if (!std::filesystem::is_regular_file(setting, unreadable)) return {};
  return {setting};
}

}  // namespace

const RecordingFormat kEyeNavGs{.is =
                                    [](const RecordingFile& file) {
                                      return file.isUndescribed() &&
                                             trimmed(file.firstLine()) == kHeader;
                                    },
                                .read = readEyeNavGs,
                                .companions = settingsOf,
                                .preview = previewEyeNavGs};

}  // namespace foci
