// Replaces the calibration windows where foci is built without windows (FOCI_WINDOW=OFF).
#include <stdexcept>

#include "app/calibrate/windows.h"

namespace foci {
namespace {

constexpr const char* kNoWindow =
    "foci was built without windows: use --pairs, --headless or --images";

}  // namespace

std::optional<GazeWindowResult> calibrateGazeInWindow(const CalibrateGazeOptions&, const Screen&,
                                                      const std::optional<WebcamPlace>&,
                                                      const std::optional<Lens>&) {
  throw std::runtime_error(kNoWindow);
}

std::optional<ScreenCalibration> calibrateScreenInWindow(const ScreenCalibration&,
                                                         std::optional<glm::dvec2>, bool) {
  throw std::runtime_error(kNoWindow);
}

std::optional<std::vector<BoardView>> watchBoardInWindow(const NextImage&, const Board&,
                                                         glm::ivec2&) {
  throw std::runtime_error(kNoWindow);
}

}  // namespace foci
