#include "app/platform/quiet_libraries.h"

#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>

namespace foci {

void quietLibraries() {
  // OpenCV reads its own variable before `main`.
  if (!std::getenv("OPENCV_LOG_LEVEL")) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  }
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
}

}  // namespace foci
