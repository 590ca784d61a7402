// Tables of gaze in space that vendors write, recognised by their columns:
// - SRanipal (HTC Vive Pro Eye), as in the recorder of Imaoka et al. (2020) and its offspring:
//   `gaze_direct_L.x`, `gaze_origin_L.x(mm)`, `eye_valid_L`. Its axes are x left, y up, z forward
//   (SRanipal SDK). With Unity's `head.position.x`, `head.rotation.x` ... `.w` the head moves.
// - Tobii Pro Glasses, exported by Pro Lab: `Gaze direction left X [HUCS norm]`, `Pupil position
//   left X [HUCS mm]`. The head unit's axes are x left, y up, z forward.
// - GazeBaseVR (Lohr et al. 2023): angles `lx`, `ly`, `rx`, `ry` and `x`, `y` of both eyes, deg;
//   eyes' centres `clx` ... `crz`, m, x right, y up, z forward.
// - Project Aria's machine perception services, general and personalised (x to the left, y up, z
//   forward). Gen 1: angles whose tangents are those of the direction, of each eye
//   (`left_yaw_rads_cpf`), or of both eyes together with a depth. Gen 2, with a pitch for each eye:
//   angles, direction (sin yaw cos pitch, sin pitch, cos yaw cos pitch), as in projectaria_tools
//   (core/mps/EyeGazeReader.cpp); the combined direction is then exactly the eyes' mean.
#include <string_view>

#include "gaze/sources/column_names.h"
#include "gaze/sources/table_layout.h"

namespace foci {
namespace {

/// Columns of each eye, as patterns of `keysOf`; empty: the vendor writes none.
struct SpaceVendor {
  const char* name;
  const char* axes;
  std::string_view needs{};      ///< another column
  std::string_view direction{};  ///< or angles, horizontal and vertical
  std::array<std::string_view, 2> angles{}, both_angles{};
  std::string_view origin{}, validity{}, pupil_mm{}, time{}, depth{};
  bool millimetres = false, radians = false, tangents = false, yaw_to_left = false;
  bool needs_both = true, needs_origin = true;
  ValidityCode code = ValidityCode::below_two;
  double time_scale_s = 0.0;  ///< 0: as its name says
};

const SpaceVendor kSpaceVendors[] = {{.name = "Project Aria",
                                      .axes = "left-up-forward",
                                      .needs = "leftpitchradscpf",
                                      .angles = {"EYEyawradscpf", "EYEpitchradscpf"},
                                      .origin = "tAEYEeyecpf",
                                      .time = "trackingtimestamp",
                                      .radians = true,
                                      .yaw_to_left = true},
                                     {.name = "Project Aria",
                                      .axes = "left-up-forward",
                                      .needs = "trackingtimestamp",
                                      .angles = {"EYEyawradscpf", "pitchradscpf"},
                                      .both_angles = {"yawradscpf", "pitchradscpf"},
                                      .origin = "tAEYEeyecpf",
                                      .time = "trackingtimestamp",
                                      .depth = "depth",
                                      .radians = true,
                                      .tangents = true,
                                      .needs_both = false,
                                      .needs_origin = false},
                                     {.name = "SRanipal",
                                      .axes = "left-up-forward",
                                      .direction = "gazedirectEA",
                                      .origin = "gazeoriginEA",
                                      .validity = "eyevalidE",
                                      .pupil_mm = "pupildiameterE",
                                      .time = "timestamp",
                                      .millimetres = true,
                                      .needs_origin = false,
                                      .code = ValidityCode::gaze_bits},
                                     {.name = "Tobii Pro Lab, glasses",
                                      .axes = "left-up-forward",
                                      .direction = "gazedirectionEYEA",
                                      .origin = "pupilpositionEYEA",
                                      .validity = "validityEYE",
                                      .pupil_mm = "pupildiameterEYE",
                                      .millimetres = true},
                                     {.name = "GazeBaseVR",
                                      .axes = "right-up-forward",
                                      .needs = "n",
                                      .angles = {"Ex", "Ey"},
                                      .both_angles = {"x", "y"},
                                      .origin = "cEA",
                                      .time = "n",
                                      .time_scale_s = 1e-3}};

std::string columnOf(const ColumnNames& names, std::string_view pattern, std::size_t side = 0) {
  const auto column = names.find(keysOf(pattern, side));
  return column ? std::string(names.text(*column)) : std::string();
}

/// x, y and z, or none of them.
ColumnList<3> tripleOf(const ColumnNames& names, std::string_view pattern, std::size_t side) {
  ColumnList<3> list{};
  const auto columns = names.findTriple(pattern, side);
  for (std::size_t i = 0; columns && i < 3; ++i) list[i] = names.text((*columns)[i]);
  return list;
}

ColumnList<2> anglesOf(const ColumnNames& names, const std::array<std::string_view, 2>& patterns,
                       std::size_t side) {
  ColumnList<2> list{columnOf(names, patterns[0], side), columnOf(names, patterns[1], side)};
  return list[0].empty() || list[1].empty() ? ColumnList<2>{} : list;
}

/// Recorders with SRanipal write its own clock in ms, or that of .NET.
void takeSranipalClock(const ColumnNames& names, SpaceFormat& format) {
  const auto clock = names.find("timestamp time");
  if (clock && names.text(*clock).ends_with("(100ns)")) {
    format.time = names.text(*clock);
    format.time_scale_s = 1e-7;
  } else if (clock && names.key(*clock) == "timestamp" && names.unit(*clock).empty()) {
    format.time_scale_s = 1e-3;
  }
}

std::optional<SpaceFormat> formatOf(const SpaceVendor& vendor, const ColumnNames& names) {
  if (!vendor.needs.empty() && !names.find(vendor.needs)) return std::nullopt;
  SpaceFormat format{.name = vendor.name,
                     .validity_code = vendor.code,
                     .time = columnOf(names, vendor.time),
                     .yaw_to_left = vendor.yaw_to_left};
  if (vendor.time_scale_s > 0.0) format.time_scale_s = vendor.time_scale_s;
  SpaceColumns& columns = format.columns;
  columns.axes = vendor.axes;
  columns.origin_scale_m = vendor.millimetres ? 1e-3 : 1.0;
  columns.angle_units = vendor.radians ? AngleUnit::rad : AngleUnit::deg;
  columns.angles_are_tangents = vendor.tangents;
  for (std::size_t side : {0, 1}) {
    SightColumns& sight = columns.eyes[side];
    sight.direction = tripleOf(names, vendor.direction, side);
    sight.angles = anglesOf(names, vendor.angles, side);
    const bool has_sight = sight.hasSight();
    if (has_sight) sight.origin = tripleOf(names, vendor.origin, side);
    if ((vendor.needs_both && !has_sight) || (vendor.needs_origin && sight.origin[0].empty())) {
      return std::nullopt;
    }
    format.validity[side] = columnOf(names, vendor.validity, side);
    format.pupil_mm[side] = columnOf(names, vendor.pupil_mm, side);
  }
  if (vendor.needs_both || !columns.hasSight()) {
    columns.both.angles = anglesOf(names, vendor.both_angles, 0);
    if (columns.both.hasSight()) columns.depth = columnOf(names, vendor.depth);
  }
  if (!columns.hasSight()) return std::nullopt;
  if (vendor.code == ValidityCode::gaze_bits) takeSranipalClock(names, format);
  return format;
}

}  // namespace

std::optional<SpaceFormat> spaceFormatOf(const ColumnNames& names) {
  for (const SpaceVendor& vendor : kSpaceVendors) {
    if (auto format = formatOf(vendor, names)) return format;
  }
  return std::nullopt;
}

}  // namespace foci
