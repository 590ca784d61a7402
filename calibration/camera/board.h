// A flat calibration board, found in an image.
#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

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

}  // namespace foci
