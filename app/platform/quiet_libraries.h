// foci reports errors itself, in one line. The libraries that it uses stay silent.
#pragma once

namespace foci {

/// Silences OpenCV and its encoders, unless the environment sets their log levels
/// (OPENCV_LOG_LEVEL, OPENCV_FFMPEG_LOGLEVEL). Libraries without such a switch are silenced where
/// they are called (base/quiet_stderr.h).
void quietLibraries();

}  // namespace foci
