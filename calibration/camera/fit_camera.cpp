#include "calibration/camera/fit_camera.h"

#include <ceres/rotation.h>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "base/input_error.h"
#include "calibration/solve.h"

#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#include <opencv2/objdetect/charuco_detector.hpp>
#else
#include <opencv2/aruco/charuco.hpp>
#endif

namespace foci {
namespace {

constexpr const char* kWhere = "camera calibration";
constexpr std::size_t kMinViews = 3;        // Zhang 2000: fewer leave the camera open
constexpr std::size_t kMinViewCorners = 6;  // of a view
constexpr double kHuber_px = 1.0;     // farther off, a corner is more likely misplaced than noisy
constexpr double kKnownFocal = 0.05;  // deviation over focal length that is still a calibration
constexpr double kSignificant = 2.0;  // deviations that a term of distortion must reach
constexpr double kUsualFocal = 1.2;   // of the image's width, where the closed form fails
constexpr int kFirstDistortion = 4;   // index among the camera's parameters

constexpr int kCameraParameters = 9;  // fx fy cx cy k1 k2 p1 p2 k3

/// Pixels of the direction (x, y, 1), as `CameraModel` states it.
/// @param camera  `kCameraParameters` numbers
/// @param px  two numbers, the result
template <typename T>
void projectTo(const T* camera, const T& x, const T& y, T* px) {
  const T r2 = x * x + y * y;
  const T radial = T(1.0) + r2 * (camera[4] + r2 * (camera[5] + r2 * camera[8]));
  px[0] =
      camera[0] * (x * radial + T(2.0) * camera[6] * x * y + camera[7] * (r2 + T(2.0) * x * x)) +
      camera[2];
  px[1] =
      camera[1] * (y * radial + T(2.0) * camera[7] * x * y + camera[6] * (r2 + T(2.0) * y * y)) +
      camera[3];
}

struct Reprojection {
  glm::dvec2 board_m, image_px;

  template <typename T>
  bool operator()(const T* camera, const T* pose, T* residual) const {
    const T board[3] = {T(board_m.x), T(board_m.y), T(0.0)};
    T p[3];
    ceres::AngleAxisRotatePoint(pose, board, p);
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i];
    if (p[2] < T(1e-6)) return false;
    T px[2];
    projectTo(camera, T(p[0] / p[2]), T(p[1] / p[2]), px);
    residual[0] = px[0] - T(image_px.x);
    residual[1] = px[1] - T(image_px.y);
    return true;
  }
};

/// The camera and the board's pose in each view.
struct Unknowns {
  std::array<double, kCameraParameters> camera{};
  std::vector<std::array<double, 6>> poses;  // angle-axis, then translation, of each view
};

/// Whether a focal length is possible for a webcam or a laboratory camera.
bool isPlausible(double focal_px, const glm::ivec2& size_px) {
  return focal_px > 0.1 * size_px.x && focal_px < 20.0 * size_px.x;
}

/// Starts from Zhang's closed form for the camera and from each view's pose under it.
Unknowns startOf(std::span<const BoardView> views, const glm::ivec2& size_px) {
  std::vector<std::vector<cv::Point3f>> board(views.size());
  std::vector<std::vector<cv::Point2f>> image(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].board_m.size() < kMinViewCorners)
      throw InputError(kWhere, "a view with few corners");
    for (std::size_t i = 0; i < views[v].board_m.size(); ++i) {
      const glm::vec2 b(views[v].board_m[i]), p(views[v].image_px[i]);
      board[v].emplace_back(b.x, b.y, 0.0f);
      image[v].emplace_back(p.x, p.y);
    }
  }
  cv::Mat start = cv::initCameraMatrix2D(board, image, {size_px.x, size_px.y}, 0.0);
  for (int axis = 0; axis < 2; ++axis) {
    double& focal_px = start.at<double>(axis, axis);
    if (!isPlausible(focal_px, size_px)) focal_px = kUsualFocal * size_px.x;
  }
  Unknowns unknowns;
  unknowns.camera = {start.at<double>(0, 0), start.at<double>(1, 1), 0.5 * size_px.x,
                     0.5 * size_px.y};
  for (std::size_t v = 0; v < views.size(); ++v) {
    cv::Vec3d rotation, translation;
    cv::solvePnP(board[v], image[v], start, cv::noArray(), rotation, translation);
    unknowns.poses.push_back(
        {rotation[0], rotation[1], rotation[2], translation[0], translation[1], translation[2]});
    if (translation[2] <= 0.0) throw InputError(kWhere, "a view behind the camera");
  }
  return unknowns;
}

/// Adjusts the camera and all poses; the terms of distortion in `left_out` stay 0.
/// @return the variances of the camera's parameters (`variancesOf`)
std::vector<double> adjust(std::span<const BoardView> views, const std::vector<int>& left_out,
                           Unknowns& unknowns) {
  ceres::Problem problem;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t i = 0; i < views[v].board_m.size(); ++i) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Reprojection, 2, kCameraParameters, 6>(
              new Reprojection{views[v].board_m[i], views[v].image_px[i]}),
          new ceres::HuberLoss(kHuber_px), unknowns.camera.data(), unknowns.poses[v].data());
    }
  }
  if (!left_out.empty()) {
    for (int i : left_out) unknowns.camera[static_cast<std::size_t>(i)] = 0.0;
    problem.SetManifold(unknowns.camera.data(),
                        new ceres::SubsetManifold(kCameraParameters, left_out));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 100;
  solve(options, problem, kWhere);
  return variancesOf(problem, unknowns.camera.data());
}

/// Sum of squared reprojection errors, px^2.
double squaredError(const BoardView& view, const std::array<double, kCameraParameters>& camera,
                    const std::array<double, 6>& pose) {
  double sum = 0.0;
  for (std::size_t i = 0; i < view.board_m.size(); ++i) {
    double residual[2];
    const Reprojection cost{view.board_m[i], view.image_px[i]};
    if (!cost(camera.data(), pose.data(), residual)) continue;
    sum += residual[0] * residual[0] + residual[1] * residual[1];
  }
  return sum;
}

/// Terms of distortion that the views do not distinguish from 0.
std::vector<int> insignificantTerms(const std::array<double, kCameraParameters>& camera,
                                    const std::vector<double>& variances, double noise2) {
  std::vector<int> terms;
  for (int i = kFirstDistortion; i < kCameraParameters; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (camera[at] * camera[at] < kSignificant * kSignificant * noise2 * variances[at]) {
      terms.push_back(i);
    }
  }
  return terms;
}

void refuseUnknownFocal(const CameraModel& camera) {
  for (int axis = 0; axis < 2; ++axis) {
    if (isPlausible(camera.focal_px[axis], camera.size_px) &&
        !(camera.focal_sd_px[axis] > kKnownFocal * camera.focal_px[axis])) {
      continue;
    }
    throw InputError(kWhere, "focal length is not determined: tilt the board, and bring it nearer");
  }
}

void countCoverage(std::span<const BoardView> views, CameraFit& fit) {
  for (const BoardView& view : views) {
    for (const glm::dvec2& px : view.image_px) {
      ++fit.coverage[coverageCell(px, fit.camera.size_px)];
    }
  }
  const auto cells = static_cast<double>(fit.coverage.size());
  for (int count : fit.coverage) fit.covered += (count > 0 ? 1.0 : 0.0) / cells;
}

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
  std::vector<std::vector<cv::Point2f>> markers;
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

CameraFit fitCamera(std::span<const BoardView> views, const glm::ivec2& size_px) {
  if (views.size() < kMinViews) {
    throw InputError(kWhere, "the board was found in " + std::to_string(views.size()) +
                                 " images: expected 3 or more");
  }
  Unknowns unknowns = startOf(views, size_px);

  // Adjust everything, then once more without the insignificant terms of distortion.
  CameraFit fit;
  std::vector<int> left_out;
  std::vector<double> variances;
  double square = 0.0, noise2 = 0.0;
  std::size_t corners = 0;
  for (int pass = 0; pass < 2; ++pass) {
    variances = adjust(views, left_out, unknowns);
    fit.view_rms_px.clear();
    square = 0.0;
    corners = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const double view_square = squaredError(views[v], unknowns.camera, unknowns.poses[v]);
      const std::size_t n = views[v].board_m.size();
      fit.view_rms_px.push_back(std::sqrt(view_square / static_cast<double>(n)));
      square += view_square;
      corners += n;
    }
    noise2 = square / (2.0 * static_cast<double>(corners));
    if (variances.empty() || pass == 1) break;
    left_out = insignificantTerms(unknowns.camera, variances, noise2);
    if (left_out.empty()) break;
  }

  CameraModel& camera = fit.camera;
  camera.size_px = size_px;
  camera.focal_px = {unknowns.camera[0], unknowns.camera[1]};
  camera.principal_px = {unknowns.camera[2], unknowns.camera[3]};
  std::copy(unknowns.camera.begin() + kFirstDistortion, unknowns.camera.end(),
            camera.distortion.begin());
  camera.rms_px = std::sqrt(square / static_cast<double>(corners));
  camera.focal_sd_px = glm::dvec2(HUGE_VAL);
  if (!variances.empty()) {
    camera.focal_sd_px = std::sqrt(noise2) * glm::sqrt(glm::dvec2(variances[0], variances[1]));
  }
  refuseUnknownFocal(camera);
  countCoverage(views, fit);
  return fit;
}

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
