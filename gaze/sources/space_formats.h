// Tables of gaze in space that vendors write, recognised by their columns.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "gaze/sources/column_names.h"
#include "gaze/sources/space_settings.h"
#include "gaze/sources/table_layout.h"

namespace foci {

struct SpaceFormat {
  std::string name;  ///< for reports
  SpaceColumns columns{};
  std::array<std::string, 2> validity{}, pupil_mm{};  ///< columns of each eye; may be empty
  ValidityCode validity_code = ValidityCode::below_two;
  std::string time{};  ///< empty: by its usual name
  std::optional<double> time_scale_s{};
};

/// - SRanipal (HTC Vive Pro Eye), as in the recorder of Imaoka et al. (2020) and its offspring:
///   `gaze_direct_L.x`, `gaze_origin_L.x(mm)`, `eye_valid_L`. Its axes are x left, y up, z forward
///   (SRanipal SDK). With Unity's `head.position.x`, `head.rotation.x` ... `.w` the head moves.
/// - Tobii Pro Glasses, exported by Pro Lab: `Gaze direction left X [HUCS norm]`, `Pupil position
///   left X [HUCS mm]`. The head unit's axes are x left, y up, z forward.
/// - GazeBaseVR (Lohr et al. 2023): angles `lx`, `ly`, `rx`, `ry` and `x`, `y` of both eyes, deg;
///   eyes' centres `clx` ... `crz`, m, x right, y up, z forward.
/// - Project Aria's machine perception services: angles whose tangents are those of the direction
///   (x to the left, y up, z forward), of each eye (`left_yaw_rads_cpf`), or of both eyes together
///   with a depth; general and personalised, Gen 1 and 2.
std::optional<SpaceFormat> spaceFormatOf(const ColumnNames& names);

}  // namespace foci
