#include "gaze/sources/space_formats.h"

#include <string_view>

namespace foci {
namespace {

/// The names of the columns whose keys are `before` + a letter of `letters` + `behind`.
template <std::size_t N>
std::optional<ColumnList<N>> columnsOf(const ColumnNames& names, const std::string& before,
                                       std::string_view letters, const std::string& behind = {}) {
  ColumnList<N> list{};
  for (std::size_t i = 0; i < N; ++i) {
    std::string key = before;
    key += letters[i];
    key += behind;
    const auto column = names.find({std::string_view(key)});
    if (!column) return std::nullopt;
    list[i] = names.text(*column);
  }
  return list;
}

std::string columnOf(const ColumnNames& names, const std::string& key) {
  const auto column = names.find({std::string_view(key)});
  return column ? std::string(names.text(*column)) : std::string();
}

std::optional<SpaceFormat> sranipal(const ColumnNames& names) {
  SpaceFormat format{.name = "SRanipal",
                     .validity_code = ValidityCode::gaze_bits,
                     .time = columnOf(names, "timestamp")};
  format.columns.axes = "left-up-forward";
  format.columns.origin_scale_m = 1e-3;
  for (std::size_t side : {0, 1}) {
    const std::string eye = side == 0 ? "l" : "r";
    const auto direction = columnsOf<3>(names, "gazedirect" + eye, "xyz");
    if (!direction) return std::nullopt;
    SightColumns& sight = format.columns.eyes[side];
    sight.direction = *direction;
    sight.origin = columnsOf<3>(names, "gazeorigin" + eye, "xyz").value_or(ColumnList<3>{});
    format.validity[side] = columnOf(names, "eyevalid" + eye);
    format.pupil_mm[side] = columnOf(names, "pupildiameter" + eye);
  }
  const std::size_t clock =
      names.find("timestamp").value_or(names.find("time").value_or(names.size()));
  if (clock < names.size() && names.text(clock).ends_with("(100ns)")) {
    format.time = names.text(clock);
    format.time_scale_s = 1e-7;
  } else if (clock < names.size() && names.key(clock) == "timestamp" && names.unit(clock).empty()) {
    format.time_scale_s = 1e-3;
  }
  return format;
}

std::optional<SpaceFormat> tobiiGlasses(const ColumnNames& names) {
  SpaceFormat format{.name = "Tobii Pro Lab, glasses"};
  format.columns.axes = "left-up-forward";
  format.columns.origin_scale_m = 1e-3;
  for (std::size_t side : {0, 1}) {
    const std::string eye = side == 0 ? "left" : "right";
    const auto direction = columnsOf<3>(names, "gazedirection" + eye, "xyz");
    const auto origin = columnsOf<3>(names, "pupilposition" + eye, "xyz");
    if (!direction || !origin) return std::nullopt;
    SightColumns& sight = format.columns.eyes[side];
    sight.direction = *direction;
    sight.origin = *origin;
    format.validity[side] = columnOf(names, "validity" + eye);
    format.pupil_mm[side] = columnOf(names, "pupildiameter" + eye);
  }
  return format;
}

std::optional<SpaceFormat> gazeBaseVr(const ColumnNames& names) {
  if (!names.find("n") || !names.find("clx")) return std::nullopt;
  SpaceFormat format{.name = "GazeBaseVR", .time = columnOf(names, "n"), .time_scale_s = 1e-3};
  format.columns.axes = "right-up-forward";
  format.columns.both.angles = columnsOf<2>(names, "", "xy").value_or(ColumnList<2>{});
  for (std::size_t side : {0, 1}) {
    const std::string eye = side == 0 ? "l" : "r";
    const auto angles = columnsOf<2>(names, eye, "xy");
    const auto origin = columnsOf<3>(names, "c" + eye, "xyz");
    if (!angles || !origin) return std::nullopt;
    format.columns.eyes[side].angles = *angles;
    format.columns.eyes[side].origin = *origin;
  }
  return format;
}

std::optional<SpaceFormat> aria(const ColumnNames& names) {
  SpaceFormat format{.name = "Project Aria", .time = columnOf(names, "trackingtimestamp")};
  if (format.time.empty()) return std::nullopt;
  SpaceColumns& columns = format.columns;
  columns.axes = "left-up-forward";
  columns.angle_units = AngleUnit::rad;
  columns.angles_are_tangents = true;
  const std::string pitch = columnOf(names, "pitchradscpf");
  for (std::size_t side : {0, 1}) {
    const std::string eye = side == 0 ? "left" : "right";
    const std::string yaw = columnOf(names, eye + "yawradscpf");
    std::string own_pitch = columnOf(names, eye + "pitchradscpf");
    if (own_pitch.empty()) own_pitch = pitch;
    if (yaw.empty() || own_pitch.empty()) continue;
    columns.eyes[side].angles = {yaw, own_pitch};
    columns.eyes[side].origin =
        columnsOf<3>(names, "t", "xyz", eye + "eyecpf").value_or(ColumnList<3>{});
  }
  if (const std::string yaw = columnOf(names, "yawradscpf");
      !columns.hasSight() && !yaw.empty() && !pitch.empty()) {
    columns.both.angles = {yaw, pitch};
    columns.depth = columnOf(names, "depth");
  }
  return columns.hasSight() ? std::optional(format) : std::nullopt;
}

}  // namespace

std::optional<SpaceFormat> spaceFormatOf(const ColumnNames& names) {
  if (auto format = aria(names)) return format;
  if (auto format = sranipal(names)) return format;
  if (auto format = tobiiGlasses(names)) return format;
  return gazeBaseVr(names);
}

}  // namespace foci
