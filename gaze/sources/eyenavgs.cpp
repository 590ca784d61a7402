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
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/text.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

constexpr std::string_view kHeader =
    "ViewIndex,FOV1,FOV2,FOV3,FOV4,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,"
    "QuaternionZ,QuaternionW,GazePosX,GazePosY,GazePosZ,GazeQX,GazeQY,GazeQZ,GazeQW,Timestamp";
constexpr std::size_t kPlaceAt = 5, kHeadTurnAt = 8, kGazePlaceAt = 12, kGazeTurnAt = 15,
                      kTimeAt = 19;
constexpr double kUnitQuaternion = 0.05;  // quaternions of three decimals
constexpr double kMaxPlace = 1e5;         // scene's units
constexpr double kMaxStamp_ms = 1e9;      // of a recording that begins at 0

/// The numbers of a row: one eye.
using EyeRow = std::array<double, 20>;

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
    const auto units_per_m = parseNumber(fields[2]);
    bool good = parts.size() == 4 && units_per_m && *units_per_m > 0.0;
    for (std::size_t i = 0; good && i < 4; ++i) {
      const auto number = parseNumber(parts[i]);
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

/// Rows of both eyes as samples, in the scene's units.
class EyeNavGsRows {
 public:
  /// @param from_head  without gaze, an eye's origin is its place
  EyeNavGsRows(const std::filesystem::path& file, bool from_head)
      : lines_(file, std::string(kHeader), true), from_head_(from_head) {}

  NumberRows read() {
    std::optional<EyeRow> first;  // waits for the other eye
    while (lines_.next()) {
      const EyeRow row = readRow();
      if (!field_) field_ = fieldOf(row);
      if (first && row[0] != (*first)[0]) {
        // The eyes are half of the distance between them away from the middle, which is the head's
        // place. A lone eye's row cannot tell the middle.
        pass(*first, row);
        first.reset();
      } else {
        first = row;
      }
    }
    if (field_ && gazes_ == 0 && !from_head_) {
      throw InputError(
          lines_.fileName(),
          "no gaze: GazePos and GazeQ are 0, 0, 0 in every row, so the eye tracker was off; "
          "expected a recording with gaze, or gaze.from_head = true, which takes the head's "
          "direction for gaze");
    }
    std::vector<std::string> names = worldColumnNames();
    for (const std::string eye : {"left ", "right "}) {
      for (const char* part : {"x", "y", "z", "qx", "qy", "qz", "qw"}) names.push_back(eye + part);
    }
    return {lines_.fileName(), std::move(names), std::move(values_)};
  }

  const NamedTable& lines() const { return lines_; }
  EyeField field() const { return field_.value_or(EyeField{}); }

 private:
  /// Places and stamps are bounded, quaternions have the length 1, or 0 where gaze is lost.
  EyeRow readRow() {
    EyeRow row{};
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool place =
          (i >= kPlaceAt && i < kHeadTurnAt) || (i >= kGazePlaceAt && i < kGazeTurnAt);
      const double max = i == 0         ? 1.0
                         : i < kPlaceAt ? 1.5
                         : place        ? kMaxPlace
                         : i < kTimeAt  ? 1.1
                                        : kMaxStamp_ms;
      row[i] = lines_.needed(i, -max, max);
    }
    if (row[0] != 0.0 && row[0] != 1.0) {
      throw lines_.error("ViewIndex = " + exactText(row[0]) + ": expected 0 (left) or 1 (right)");
    }
    for (const std::size_t at : {kHeadTurnAt, kGazeTurnAt}) {
      const double length = glm::length(glm::dvec4(row[at], row[at + 1], row[at + 2], row[at + 3]));
      if (std::abs(length - 1.0) <= kUnitQuaternion || (at == kGazeTurnAt && length == 0.0))
        continue;
      throw lines_.error("columns " + std::to_string(at + 1) + " to " + std::to_string(at + 4) +
                         ": expected a quaternion x, y, z, w of length 1");
    }
    return row;
  }

  EyeField fieldOf(const EyeRow& row) const {
    const double left = row[1], right = row[2], down = row[3], up = row[4];
    if (!(left < 0.0 && right > 0.0 && down < 0.0 && up > 0.0)) {
      throw lines_.error(
          "FOV1 to FOV4: expected angles to the left (below 0), right, down (below "
          "0) and up, rad");
    }
    EyeField field{.left_deg = -glm::degrees(left),
                   .right_deg = glm::degrees(right),
                   .up_deg = glm::degrees(up),
                   .down_deg = -glm::degrees(down)};
    if (row[0] == 1.0) std::swap(field.left_deg, field.right_deg);
    return field;
  }

  /// The eye tracker was off if the quaternion is 0, or the pose that of no turn at the origin.
  static bool hasGaze(const EyeRow& row) {
    const auto any = [&](std::size_t from, std::size_t to) {
      return std::any_of(row.begin() + static_cast<std::ptrdiff_t>(from),
                         row.begin() + static_cast<std::ptrdiff_t>(to),
                         [](double number) { return number != 0.0; });
    };
    return any(kGazeTurnAt, kTimeAt) && any(kGazePlaceAt, kTimeAt - 1);
  }

  void pass(const EyeRow& first, const EyeRow& second) {
    values_.push_back(first[kTimeAt]);
    for (std::size_t i = kPlaceAt; i < kHeadTurnAt; ++i)
      values_.push_back(0.5 * (first[i] + second[i]));
    values_.insert(values_.end(), first.begin() + kHeadTurnAt, first.begin() + kGazePlaceAt);
    for (const EyeRow* eye :
         {first[0] == 0.0 ? &first : &second, first[0] == 0.0 ? &second : &first}) {
      const bool has_gaze = !from_head_ && hasGaze(*eye);
      gazes_ += has_gaze;
      for (std::size_t i = 0; i < 7; ++i) {
        const bool origin = from_head_ && i < 3;
        values_.push_back(origin     ? (*eye)[kPlaceAt + i]
                          : has_gaze ? (*eye)[kGazePlaceAt + i]
                                     : std::numeric_limits<double>::quiet_NaN());
      }
    }
  }

  NamedTable lines_;
  bool from_head_;
  std::vector<double> values_{};
  std::optional<EyeField> field_{};
  std::size_t gazes_ = 0;
};

std::vector<ColumnReading> navReadingsOf(bool eyes, bool has_setting, double scale_m) {
  const std::string sure = "certain: a column of EyeNavGS";
  const std::string unit = ", a unit is " + significant(scale_m) + " m";
  return {
      {"ViewIndex", "0 for the left eye, 1 for the right eye", sure},
      {"FOV1 to FOV4", "limits of the eye's view to the left, right, down and up, rad", sure},
      {"PositionX, Y, Z", "place of the eye in the scene" + unit,
       has_setting ? "certain: scene_setting.csv states the unit" : "a guess: the unit"},
      {"QuaternionX, Y, Z, W", "orientation of the head in the scene", sure},
      {"GazePosX, Y, Z", eyes ? "origin of gaze in the scene" + unit : "unused", eyes ? sure : ""},
      {"GazeQX, Y, Z, W", eyes ? "rotation of gaze in the scene, which looks along -z" : "unused",
       eyes ? sure : ""},
      {"Timestamp", "time, a unit is 0.001 s", sure}};
}

TraceHeader readEyeNavGs(const RecordingFile& file, const Screen& fallback_screen,
                         const TakeSample& take) {
  constexpr double kUpright = 0.7;  // cosine
  TraceColumns columns = worldColumns(file.columns(), 1e-3);
  SpaceColumns& space = columns.space;
  EyeNavGsRows reader(file.path(), space.from_head);
  NumberRows rows = reader.read();
  const auto setting = settingBeside(file.path());
  const double scale_m = setting ? 1.0 / setting->units_per_m : file.columns().space.head_scale_m;
  space.head_scale_m = space.origin_scale_m = scale_m;
  for (const std::size_t side : {0, 1}) {
    const std::string eye = side == 0 ? "left " : "right ";
    space.eyes[side].origin = {eye + "x", eye + "y", eye + "z"};
    if (space.from_head) continue;
    space.eyes[side].quaternion = {eye + "qx", eye + "qy", eye + "qz", eye + "qw"};
  }
  if (!columns.field) columns.field = reader.field();
  TraceHeader header = readRows(rows, columns, fallback_screen, take);
  header.format = space.from_head ? "EyeNavGS, the head alone" : "EyeNavGS, binocular";
  header.columns = navReadingsOf(!space.from_head, setting.has_value(), scale_m);
  if (setting) {
    header.world_y_up = (setting->level_from_scene * glm::dvec3(0.0, 1.0, 0.0)).y > kUpright;
    header.scene_scale_m = scale_m;
  } else {
    header.assumed.push_back(
        "places: " + exactText(scale_m) +
        " m a unit of the scene (gaze.head_scale_m); scene_setting.csv beside the recording "
        "states it");
  }
  if (reader.lines().isCut()) header.warnings.emplace_back(kCutOff);
  return header;
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

const RecordingFormat kEyeNavGs{.name = "EyeNavGS",
                                .is =
                                    [](const RecordingFile& file) {
                                      return file.isUndescribed() &&
                                             trimmed(file.firstLine()) == kHeader;
                                    },
                                .read = readEyeNavGs,
                                .companions = settingsOf,
                                .preview = previewEyeNavGs};

}  // namespace foci
