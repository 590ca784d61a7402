// Neon's native recording folder, as the Companion app writes it (docs.pupil-labs.com/neon) and as
// pl-neon-recording reads it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace foci {

/// The files of a native recording that hold gaze and the eyes, and whether the glasses are worn:
/// `gaze_200hz.raw` with `.time` where Pupil Cloud has computed it, else `gaze psN.raw` for N = 1,
/// 2, ... Empty if `path` is no such folder, nor one of its files of gaze.
std::vector<std::filesystem::path> neonNativeFiles(const std::filesystem::path& path);

struct NeonTable {
  std::vector<std::string> columns{};
  std::vector<double> values{};  ///< row after row; NaN: absent
};

/// The gaze of a native recording, with the columns of Neon's exports. `gaze` begins each sample
/// with x and y as 32-bit floats, pixels of the scene camera; `time` has nanoseconds as 64-bit
/// integers; `worn` a byte, 0 where nobody wears the glasses. `eye_state` has 14 floats and more:
/// the left pupil's diameter (mm), the eyeball's centre (mm) and the direction of its optical axis
/// in the frame of the scene camera, then those of the right eye.
/// @param path  as `neonNativeFiles` takes it
/// @throws InputError if a file is missing, or if the files do not belong together
NeonTable readNeonNative(const std::filesystem::path& path);

}  // namespace foci
