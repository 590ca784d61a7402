// Finds a flat calibration board in images, and fits a camera to its views (Zhang 2000).
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "calibration/camera/camera.h"

namespace cv {
class Mat;
}

namespace foci {

/// A flat board: a chessboard's inner corners, or a ChArUco board of squares with markers (4 x 4
/// bits).
struct Board {
  glm::ivec2 corners{9, 6};
  double square_m = 0.025;
  std::optional<double> marker_m{};  ///< present: ChArUco, and the corners between its squares
};

/// Corners found in one image.
struct BoardView {
  std::vector<glm::dvec2> board_m;  ///< on the board
  std::vector<glm::dvec2> image_px;
};

/// Corners to a fraction of a pixel; absent where the image does not show the board.
std::optional<BoardView> findBoard(const cv::Mat& image, const Board& board);

/// Whether some corner moved by 3 % of the image's width or more, so that the view gives the fit
/// new information.
bool hasMoved(const BoardView& before, const BoardView& now, double width_px);

/// Coverage of an image is counted in this many columns and rows of cells.
inline constexpr glm::ivec2 kCoverageCells{8, 6};

/// Index of the cell that holds an image point, row by row.
std::size_t coverageCell(const glm::dvec2& image_px, const glm::ivec2& size_px);

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
