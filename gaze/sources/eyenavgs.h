// EyeNavGS: walks through Gaussian scenes in a headset, with both eyes' gaze (Ding et al. 2025,
// github.com/symmru/EyeNavGS_Rutgers_Dataset).
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Whether a table's header is that of EyeNavGS.
bool isEyeNavGs(std::string_view header);

/// Metres per unit of the scene of a recording, if scene_setting.csv beside it says so.
/// @throws InputError if that file is broken
std::optional<double> eyeNavGsSceneScale_m(const std::filesystem::path& recording);

/// Reads a file of EyeNavGS. Rows of the left and the right eye alternate; two of them are a sample
/// at the left row's time. `FOV1..4` are the left, right, lower and upper limits of the eye's view,
/// radians, as signed angles. Gaze poses look along -z, in the scene's axes. (0, 0, 0) with the
/// unit quaternion means that the eye tracker was off.
///
/// Places are in the scene's units. `scene_setting.csv` beside the file, or `columns.space.
/// head_scale_m`, says how many metres a unit has. Its quaternion T turns the scene upright: T p is
/// level. Poses are in the scene's own axes, so T only shows which way is up.
/// @param lines  at the file's first line
TraceHeader readEyeNavGs(LineReader& lines, const TraceColumns& columns, const TakeSample& take);

}  // namespace foci
