#include "calibration/camera/camera.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cmath>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/input_error.h"
#include "calibration/calibration_file.h"

namespace foci {
namespace {

constexpr std::size_t kMinViews = 3;
constexpr std::size_t kMinCorners = 6;
constexpr double kHuber_px = 1.0;
constexpr double kFocalKnown = 0.05;  // deviation over focal length that is still a calibration
constexpr int kCameraParameters = 9;  // fx fy cx cy k1 k2 p1 p2 k3
constexpr double kCentre = 0.5;       // OpenCV counts pixel centres as whole numbers

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

/// Variances of the camera's parameters, those of `fixed` ones 0; empty where the views do not
/// determine them.
std::vector<double> variancesOf(ceres::Problem& problem, const double* camera) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  // What is not determined shall show as a large variance, not as an error.
  options.min_reciprocal_condition_number = 1e-60;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  std::vector<double> block(kCameraParameters * kCameraParameters), variances;
  const std::vector<std::pair<const double*, const double*>> wanted{{camera, camera}};
  if (!covariance.Compute(wanted, &problem) ||
      !covariance.GetCovarianceBlock(camera, camera, block.data())) {
    return {};
  }
  for (int i = 0; i < kCameraParameters; ++i) variances.push_back(block[i * kCameraParameters + i]);
  return variances;
}

}  // namespace

glm::dvec2 projectByCamera(const CameraModel& camera, const glm::dvec3& p_camera) {
  const double parameters[kCameraParameters] = {
      camera.focal_px.x,     camera.focal_px.y,    camera.principal_px.x,
      camera.principal_px.y, camera.distortion[0], camera.distortion[1],
      camera.distortion[2],  camera.distortion[3], camera.distortion[4]};
  glm::dvec2 px;
  projectTo(parameters, p_camera.x / p_camera.z, p_camera.y / p_camera.z, &px.x);
  return px;
}

std::optional<BoardView> findBoard(const cv::Mat& image, const Board& board) {
  if (image.empty()) return std::nullopt;
  cv::Mat grey;
  if (image.channels() == 1) {
    grey = image;
  } else {
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  }
  BoardView view;
  if (!board.marker_m) {
    std::vector<cv::Point2f> corners;
    const cv::Size size(board.corners.x, board.corners.y);
    if (!cv::findChessboardCorners(grey, size, corners,
                                   cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE |
                                       cv::CALIB_CB_FAST_CHECK)) {
      return std::nullopt;
    }
    cv::cornerSubPix(grey, corners, {5, 5}, {-1, -1},
                     {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 0.001});
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto n = static_cast<std::size_t>(board.corners.x);
      view.board_m.push_back(board.square_m * glm::dvec2(i % n, i / n));
      view.image_px.emplace_back(corners[i].x + kCentre, corners[i].y + kCentre);
    }
    return view;
  }

  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_250);
  const auto charuco = cv::aruco::CharucoBoard::create(
      board.corners.x + 1, board.corners.y + 1, static_cast<float>(board.square_m),
      static_cast<float>(*board.marker_m), dictionary);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, dictionary, markers, ids);
  if (ids.empty()) return std::nullopt;
  cv::Mat corners, corner_ids;
  cv::aruco::interpolateCornersCharuco(markers, ids, grey, charuco, corners, corner_ids);
  if (corners.total() < kMinCorners) return std::nullopt;
  for (int i = 0; i < static_cast<int>(corners.total()); ++i) {
    const auto& at = charuco->chessboardCorners[static_cast<std::size_t>(corner_ids.at<int>(i))];
    const auto& px = corners.at<cv::Point2f>(i);
    view.board_m.emplace_back(at.x, at.y);
    view.image_px.emplace_back(px.x + kCentre, px.y + kCentre);
  }
  return view;
}

CameraFit fitCamera(std::span<const BoardView> views, const glm::ivec2& size_px) {
  constexpr const char* kWhere = "camera calibration";
  if (views.size() < kMinViews) {
    throw InputError(kWhere, "the board was found in " + std::to_string(views.size()) +
                                 " images: expected 3 or more");
  }

  // Start from Zhang's closed form and each view's pose.
  std::vector<std::vector<cv::Point3f>> board(views.size());
  std::vector<std::vector<cv::Point2f>> image(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].board_m.size() < kMinCorners) throw InputError(kWhere, "a view with few corners");
    for (std::size_t i = 0; i < views[v].board_m.size(); ++i) {
      const glm::vec2 b(views[v].board_m[i]), p(views[v].image_px[i]);
      board[v].emplace_back(b.x, b.y, 0.0f);
      image[v].emplace_back(p.x, p.y);
    }
  }
  cv::Mat start = cv::initCameraMatrix2D(board, image, {size_px.x, size_px.y}, 0.0);
  const auto plausible = [&](double focal) {
    return focal > 0.1 * size_px.x && focal < 20.0 * size_px.x;
  };
  for (int axis = 0; axis < 2; ++axis) {
    if (!plausible(start.at<double>(axis, axis))) start.at<double>(axis, axis) = 1.2 * size_px.x;
  }
  std::array<double, kCameraParameters> camera{start.at<double>(0, 0), start.at<double>(1, 1),
                                               0.5 * size_px.x, 0.5 * size_px.y};
  std::vector<std::array<double, 6>> poses(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    cv::Vec3d rotation, translation;
    cv::solvePnP(board[v], image[v], start, cv::noArray(), rotation, translation);
    poses[v] = {rotation[0],    rotation[1],    rotation[2],
                translation[0], translation[1], translation[2]};
    if (translation[2] <= 0.0) throw InputError(kWhere, "a view behind the camera");
  }

  // Adjust everything; then, without the terms of distortion that mean nothing, once more.
  std::vector<int> left_out;
  std::vector<double> variances;
  CameraFit fit;
  std::size_t corners = 0;
  double square = 0.0;
  for (int pass = 0; pass < 2; ++pass) {
    ceres::Problem problem;
    for (std::size_t v = 0; v < views.size(); ++v) {
      for (std::size_t i = 0; i < views[v].board_m.size(); ++i) {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Reprojection, 2, kCameraParameters, 6>(
                new Reprojection{views[v].board_m[i], views[v].image_px[i]}),
            new ceres::HuberLoss(kHuber_px), camera.data(), poses[v].data());
      }
    }
    if (!left_out.empty()) {
      for (int i : left_out) camera[static_cast<std::size_t>(i)] = 0.0;
      problem.SetManifold(camera.data(), new ceres::SubsetManifold(kCameraParameters, left_out));
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 100;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    variances = variancesOf(problem, camera.data());

    fit.view_rms_px.clear();
    square = 0.0;
    corners = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      double view_square = 0.0;
      for (std::size_t i = 0; i < views[v].board_m.size(); ++i) {
        double residual[2];
        const Reprojection cost{views[v].board_m[i], views[v].image_px[i]};
        if (!cost(camera.data(), poses[v].data(), residual)) continue;
        view_square += residual[0] * residual[0] + residual[1] * residual[1];
      }
      const std::size_t n = views[v].board_m.size();
      fit.view_rms_px.push_back(std::sqrt(view_square / static_cast<double>(n)));
      square += view_square;
      corners += n;
    }
    if (variances.empty()) break;
    const double noise2 = square / (2.0 * static_cast<double>(corners));
    for (int i : {4, 5, 6, 7, 8}) {
      const double value = camera[static_cast<std::size_t>(i)];
      if (pass == 0 && value * value < 4.0 * noise2 * variances[static_cast<std::size_t>(i)]) {
        left_out.push_back(i);
      }
    }
    if (left_out.empty()) break;
  }
  const double noise = std::sqrt(square / (2.0 * static_cast<double>(corners)));
  CameraModel& model = fit.camera;
  model.size_px = size_px;
  model.focal_px = {camera[0], camera[1]};
  model.principal_px = {camera[2], camera[3]};
  for (std::size_t i = 0; i < 5; ++i) model.distortion[i] = camera[4 + i];
  model.rms_px = std::sqrt(square / static_cast<double>(corners));
  const bool known = !variances.empty();
  if (known) model.focal_sd_px = noise * glm::sqrt(glm::dvec2(variances[0], variances[1]));
  if (!known || !plausible(model.focal_px.x) || !plausible(model.focal_px.y) ||
      model.focal_sd_px.x > kFocalKnown * model.focal_px.x ||
      model.focal_sd_px.y > kFocalKnown * model.focal_px.y) {
    throw InputError(kWhere, "focal length is not determined: tilt the board, and bring it nearer");
  }

  for (const BoardView& view : views) {
    for (const glm::dvec2& px : view.image_px) {
      const glm::ivec2 cell =
          glm::clamp(glm::ivec2(px / glm::dvec2(size_px) * glm::dvec2(8, 6)), {0, 0}, {7, 5});
      const int at = cell.y * 8 + cell.x;
      ++fit.coverage[static_cast<std::size_t>(at)];
    }
  }
  for (int count : fit.coverage) fit.covered += (count > 0 ? 1.0 : 0.0) / 48.0;
  return fit;
}

std::string cameraToml(const CameraModel& camera) {
  std::string text = "# Camera calibrated by foci; pixel centres at +0.5.\n[camera]\n";
  text += "size_px = [" + std::to_string(camera.size_px.x) + ", " +
          std::to_string(camera.size_px.y) + "]\n";
  text += "focal_px = " + exactText(camera.focal_px) + "\n";
  text += "principal_px = " + exactText(camera.principal_px) + "\n";
  text += "distortion = [";
  for (std::size_t i = 0; i < 5; ++i) text += (i ? ", " : "") + exactText(camera.distortion[i]);
  text += "]  # k1, k2, p1, p2, k3\n";
  text += "focal_sd_px = " + exactText(camera.focal_sd_px) + "\n";
  text += "rms_px = " + exactText(camera.rms_px) + "\n";
  return text;
}

CameraModel readCamera(const std::filesystem::path& file) {
  CalibrationFile in(file);
  CameraModel camera;
  camera.size_px = in.size_px("camera.size_px");
  camera.focal_px = in.pair("camera.focal_px", 1.0, 1e6);
  camera.principal_px = in.pair("camera.principal_px", -1e6, 1e6);
  const auto distortion = in.numbers("camera.distortion", 5, -100.0, 100.0);
  std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
  if (in.has("camera.focal_sd_px")) camera.focal_sd_px = in.pair("camera.focal_sd_px", 0.0, 1e6);
  if (in.has("camera.rms_px")) camera.rms_px = in.number("camera.rms_px", 0.0, 1e6);
  in.refuseRest();
  return camera;
}

}  // namespace foci
