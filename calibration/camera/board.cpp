#include "calibration/camera/board.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#include <opencv2/objdetect/charuco_detector.hpp>
#else
#include <opencv2/aruco/charuco.hpp>
#endif

namespace foci {
namespace {

constexpr std::size_t kMinCorners = 6;  // of a ChArUco board that is partly seen
constexpr double kCentre = 0.5;         // OpenCV's pixel centres are whole numbers, ours at +0.5
constexpr double kMovedShare = 0.03;    // of the image's width; chosen by eye

std::optional<BoardView> findChessboard(const cv::Mat& grey, const Board& board) {
  std::vector<cv::Point2f> corners;
  const cv::Size size(board.corners.x, board.corners.y);
  if (!cv::findChessboardCorners(
          grey, size, corners,
          cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK)) {
    return std::nullopt;
  }
  cv::cornerSubPix(grey, corners, {5, 5}, {-1, -1},
                   {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 0.001});
  BoardView view;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto n = static_cast<std::size_t>(board.corners.x);
    view.board_m.push_back(board.square_m * glm::dvec2(i % n, i / n));
    view.image_px.emplace_back(corners[i].x + kCentre, corners[i].y + kCentre);
  }
  return view;
}

std::optional<BoardView> findCharuco(const cv::Mat& grey, const Board& board) {
  const cv::Size squares(board.corners.x + 1, board.corners.y + 1);
  const auto square_m = static_cast<float>(board.square_m);
  const auto marker_m = static_cast<float>(*board.marker_m);
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_250);
  cv::Mat corners, corner_ids;
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
  const cv::aruco::CharucoBoard charuco(squares, square_m, marker_m, dictionary);
  cv::aruco::CharucoDetector(charuco).detectBoard(grey, corners, corner_ids);
  const std::vector<cv::Point3f> board_m = charuco.getChessboardCorners();
#else
  const auto charuco = cv::aruco::CharucoBoard::create(squares.width, squares.height, square_m,
                                                       marker_m, dictionary);
  std::vector<std::vector<cv::Point2f> > markers;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, dictionary, markers, ids);
  if (ids.empty()) return std::nullopt;
  cv::aruco::interpolateCornersCharuco(markers, ids, grey, charuco, corners, corner_ids);
  const std::vector<cv::Point3f>& board_m = charuco->chessboardCorners;
#endif
  if (corners.total() < kMinCorners) return std::nullopt;
  BoardView view;
  for (int i = 0; i < static_cast<int>(corners.total()); ++i) {
    const auto& at = board_m[static_cast<std::size_t>(corner_ids.at<int>(i))];
    const auto& px = corners.at<cv::Point2f>(i);
    view.board_m.emplace_back(at.x, at.y);
    view.image_px.emplace_back(px.x, px.y);  // OpenCV has added the half pixel here
  }
  return view;
}

}  // namespace

std::optional<BoardView> findBoard(const cv::Mat& image, const Board& board) {
  if (image.empty()) return std::nullopt;
  cv::Mat grey;
  if (image.channels() == 1) {
    grey = image;
  } else {
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  }
  return board.marker_m ? findCharuco(grey, board) : findChessboard(grey, board);
}

bool hasMoved(const BoardView& before, const BoardView& now, double width_px) {
  double moved_px = 0.0;
  for (std::size_t i = 0; i < std::min(before.image_px.size(), now.image_px.size()); ++i) {
    moved_px = std::max(moved_px, glm::length(now.image_px[i] - before.image_px[i]));
  }
  return moved_px >= kMovedShare * width_px;
}

std::size_t coverageCell(const glm::dvec2& image_px, const glm::ivec2& size_px) {
  const glm::ivec2 cell =
      glm::clamp(glm::ivec2(image_px / glm::dvec2(size_px) * glm::dvec2(kCoverageCells)),
                 glm::ivec2(0), kCoverageCells - 1);
  return static_cast<std::size_t>(cell.y) * kCoverageCells.x + static_cast<std::size_t>(cell.x);
}

}  // namespace foci
