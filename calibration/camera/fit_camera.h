// Fits a camera to views of a board (Zhang 2000).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calibration/camera/board.h"
#include "calibration/camera/camera.h"

namespace foci {

struct CameraFit {
  CameraModel camera;
  std::vector<double> view_rms_px;  ///< one for each view
  /// Corners in each cell of the image (`coverageCell`).
  std::array<int, static_cast<std::size_t>(kCoverageCells.x* kCoverageCells.y)> coverage{};
  double covered = 0.0;  ///< share of the cells with a corner
};

/// Ceres minimises the reprojection error under Huber's loss. Terms of distortion smaller than two
/// of their deviations are left out.
/// @throws InputError with fewer than 3 views, with a view behind the camera, or where focal length
///   is not determined within 5 % (the board never tilted, or always small)
CameraFit fitCamera(std::span<const BoardView> views, const glm::ivec2& size_px);

}  // namespace foci
