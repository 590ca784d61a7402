#include "calibration/camera/fit_camera.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#include <opencv2/objdetect/aruco_dictionary.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

namespace foci {
namespace FOCI_FILE {

constexpr int kSquare_px = 80;
const Board kCharuco{.corners = {6, 4}, .square_m = 0.03, .marker_m = 0.022};

/// A ChArUco board as calib.io and OpenCV before 4.6 print it: the first square is black, and the
/// white squares hold the markers of the dictionary in their order, row by row.
cv::Mat printedBoard() {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_250);
  const int marker_px = static_cast<int>(kSquare_px * *kCharuco.marker_m / kCharuco.square_m);
  const glm::ivec2 squares = kCharuco.corners + 1;
  cv::Mat board(squares.y * kSquare_px, squares.x * kSquare_px, CV_8UC1, cv::Scalar(255));
  int id = 0;
  for (int y = 0; y < squares.y; ++y) {
    for (int x = 0; x < squares.x; ++x) {
      const cv::Rect square(x * kSquare_px, y * kSquare_px, kSquare_px, kSquare_px);
      if ((x + y) % 2 == 0) {
        board(square) = cv::Scalar(0);
        continue;
      }
      cv::Mat marker;
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
      dictionary.generateImageMarker(id++, marker_px, marker);
#else
      cv::aruco::drawMarker(dictionary, id++, marker_px, marker);
#endif
      const int edge = (kSquare_px - marker_px) / 2;
      marker.copyTo(board(cv::Rect(square.x + edge, square.y + edge, marker_px, marker_px)));
    }
  }
  return board;
}

TEST(Board, FindsTheCornersOfACharucoBoardSeenAtATilt) {
  const cv::Mat printed = printedBoard();
  // From the print to the image, pixel centres at whole numbers.
  const cv::Matx33d tilt(1.05, 0.12, 60.0, -0.06, 0.98, 70.0, 1.2e-4, 0.8e-4, 1.0);
  cv::Mat image;
  cv::warpPerspective(printed, image, tilt, {800, 600}, cv::INTER_AREA, cv::BORDER_CONSTANT,
                      cv::Scalar(255));
  cv::GaussianBlur(image, image, {}, 0.8);
  const auto view = findBoard(image, kCharuco);
  ASSERT_TRUE(view);
  EXPECT_EQ(view->board_m.size(), 24u);
  for (std::size_t i = 0; i < view->board_m.size(); ++i) {
    // The corner between two squares of the print lies half a pixel before the next one's centre.
    const glm::dvec2 at_px = view->board_m[i] / kCharuco.square_m * double{kSquare_px} - 0.5;
    const cv::Vec3d seen = tilt * cv::Vec3d(at_px.x, at_px.y, 1.0);
    const glm::dvec2 expected_px = glm::dvec2(seen[0], seen[1]) / seen[2] + 0.5;
    EXPECT_NEAR(view->image_px[i].x, expected_px.x, 0.25) << i;
    EXPECT_NEAR(view->image_px[i].y, expected_px.y, 0.25) << i;
  }
}

TEST(Board, IsAbsentWhereTheImageShowsNone) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::setRNGSeed(1);
  cv::randu(noise, 0, 255);
  EXPECT_FALSE(findBoard(noise, kCharuco));
  EXPECT_FALSE(findBoard(noise, {}));
}

}  // namespace FOCI_FILE
}  // namespace foci
