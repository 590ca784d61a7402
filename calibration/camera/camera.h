// A camera's focal length, centre and distortion from views of a board (Zhang 2000; Brown's
// distortion).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace cv {
class Mat;
}

namespace foci {

/// Pixels from a direction (x, y, 1) in the camera frame, y down:
///   x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2), y' alike with p1, p2
///   exchanged, px = focal x' + principal; pixel centres at +0.5.
struct CameraModel {
  glm::ivec2 size_px{0, 0};
  glm::dvec2 focal_px{0.0};
  glm::dvec2 principal_px{0.0};
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3, OpenCV's order
  glm::dvec2 focal_sd_px{0.0};         ///< from the fit's covariance
  double rms_px = 0.0;                 ///< of the reprojection
};

/// The image of a point in the camera frame, z > 0. Pixels.
glm::dvec2 projectByCamera(const CameraModel& camera, const glm::dvec3& p_camera);

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

/// Corners to a fraction of a pixel; absent where the board is not to be seen.
std::optional<BoardView> findBoard(const cv::Mat& image, const Board& board);

struct CameraFit {
  CameraModel camera;
  std::vector<double> view_rms_px;  ///< a view each
  std::array<int, 48>
      coverage{};        ///< corners in each cell of an 8 x 6 grid over the image, row-major
  double covered = 0.0;  ///< share of the cells with any
};

/// Reprojection minimised by Ceres under Huber's loss; terms of distortion that the views do not
/// determine to better than their own size are left out.
/// @throws InputError with fewer than 3 views, or where focal length is not determined within 5 %
///   (the board never tilted, or always small)
CameraFit fitCamera(std::span<const BoardView> views, const glm::ivec2& size_px);

std::string cameraToml(const CameraModel& camera);

/// @throws InputError by file and key
CameraModel readCamera(const std::filesystem::path& file);

}  // namespace foci
