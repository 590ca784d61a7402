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
  bool (*is)(const ColumnNames&) = nullptr;  ///< instead of origins
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
                                      .millimetres = true,
                                      .is = isOfProGlasses},
                                     {.name = "GazeBaseVR",
                                      .axes = "right-up-forward",
                                      .needs = "n",
                                      .angles = {"Ex", "Ey"},
                                      .both_angles = {"x", "y"},
                                      .origin = "cEA",
                                      .time = "n",
                                      .time_scale_s = 1e-3}};

std::optional<std::size_t> columnOf(const ColumnNames& names, std::string_view pattern,
                                    std::size_t side = 0) {
  return names.find(keysOf(pattern, side));
}

ColumnsAt<2> anglesOf(const ColumnNames& names, const std::array<std::string_view, 2>& patterns,
                      std::size_t side) {
  const auto right = columnOf(names, patterns[0], side), up = columnOf(names, patterns[1], side);
  return right && up ? ColumnsAt<2>({*right, *up}) : std::nullopt;
}

/// Nothing for a table of another vendor.
std::optional<SpaceLayout> sightsOf(const SpaceVendor& vendor, const ColumnNames& names) {
  if (!vendor.needs.empty() && !names.find(vendor.needs)) return std::nullopt;
  const AxisConvention axes = *AxisConvention::named(vendor.axes);
  SpaceLayout space{.axes = axes,
                    .head_axes = axes,
                    .origin_scale_m = vendor.millimetres ? 1e-3 : 1.0,
                    .angle_scale_rad = vendor.radians ? 1.0 : glm::radians(1.0),
                    .tangents = vendor.tangents,
                    .scale = {vendor.yaw_to_left ? -1.0 : 1.0, 1.0}};
  for (std::size_t side : {0, 1}) {
    SightAt& sight = space.eyes[side];
    sight.direction = names.findTriple(vendor.direction, side);
    sight.angles = anglesOf(names, vendor.angles, side);
    if (sight.hasSight()) sight.origin = names.findTriple(vendor.origin, side);
    const bool is_sure = sight.origin || !vendor.needs_origin || (vendor.is && vendor.is(names));
    if ((vendor.needs_both && !sight.hasSight()) || !is_sure) return std::nullopt;
    sight.validity = columnOf(names, vendor.validity, side);
  }
  if (vendor.needs_both || !space.hasSight()) {
    space.both.angles = anglesOf(names, vendor.both_angles, 0);
    if (space.both.hasSight()) space.depth_m = columnOf(names, vendor.depth);
  }
  return space.hasSight() ? std::optional(space) : std::nullopt;
}

/// Recorders with SRanipal write its own clock in ms, or that of .NET.
void takeSranipalClock(const ColumnNames& names, TableLayout& layout) {
  const auto clock = names.find("timestamp time");
  if (clock && names.text(*clock).ends_with("(100ns)")) {
    layout.time = clock;
    layout.time_scale_s = 1e-7;
  } else if (clock && names.key(*clock) == "timestamp" && names.unit(*clock).empty()) {
    layout.time_scale_s = 1e-3;
  }
}

}  // namespace

bool takeSpaceVendor(const ColumnNames& names, const TraceColumns& given, TableLayout& layout) {
  for (const SpaceVendor& vendor : kSpaceVendors) {
    layout.space = sightsOf(vendor, names);
    if (!layout.space) continue;
    layout.format = vendor.name;
    layout.validity_code = vendor.code;
    if (names.find("sensor")) layout.rows = {.column = names.find("sensor"), .only = "Eye Tracker"};
    for (std::size_t side : {0, 1}) {
      layout.eyes[side].pupil_mm = columnOf(names, vendor.pupil_mm, side);
    }
    if (!given.time.empty()) return true;
    layout.time = columnOf(names, vendor.time);
    if (layout.time) {
      layout.time_scale_s =
          vendor.time_scale_s > 0.0 ? vendor.time_scale_s : names.secondsPerUnit(*layout.time);
    }
    if (vendor.code == ValidityCode::gaze_bits) takeSranipalClock(names, layout);
    if (given.time_scale_s) layout.time_scale_s = *given.time_scale_s;
    return true;
  }
  return false;
}

}  // namespace foci
