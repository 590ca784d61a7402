// `foci calibrate camera`: fits a camera to a board in images, in a video or before a device.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "app/calibrate/options.h"
#include "app/calibrate/windows.h"
#include "app/platform/output_files.h"
#include "base/input_error.h"
#include "base/quiet_stderr.h"
#include "calibration/calibration_file.h"
#include "calibration/camera/fit_camera.h"
#include "gaze/webcam/webcam_frames.h"

namespace foci {
namespace {

constexpr int kMaxFrames = 100'000;
constexpr std::size_t kMaxViews = 60;  // of a video; chosen by hand, since more views cost time

glm::ivec2 gridOf(const std::string& option, const std::string& text) {
  int w = 0, h = 0, used = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &w, &h, &used) != 2 ||
      used != static_cast<int>(text.size()) || w < 3 || h < 3 || w > 40 || h > 40) {
    throw InputError(option, text.substr(0, 40) + ": expected WxH, each 3 to 40");
  }
  return {w, h};
}

Board boardOf(const CalibrateCameraOptions& options) {
  if (!(options.square_mm >= 1.0 && options.square_mm <= 1000.0)) {
    throw InputError("--square-mm", exactText(options.square_mm) + ": expected 1 to 1000");
  }
  Board board{.corners = gridOf("--board", options.board), .square_m = options.square_mm / 1000.0};
  if (!options.charuco.empty()) {
    if (!(options.marker_mm > 0.0 && options.marker_mm < options.square_mm)) {
      throw InputError("--marker-mm",
                       exactText(options.marker_mm) + ": expected below --square-mm");
    }
    board.corners = gridOf("--charuco", options.charuco) - 1;
    board.marker_m = options.marker_mm / 1000.0;
  }
  return board;
}

/// The views of the board, and where they come from.
struct Views {
  std::vector<BoardView> views;
  glm::ivec2 size_px{0, 0};
  int images = 0;  // searched
};

Views viewsInImages(const std::vector<std::string>& files, const Board& board) {
  Views found;
  for (const std::string& file : files) {
    cv::Mat image;
    {
      const QuietStderr quiet;
      image = readPhotograph(file);
    }
    if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
    const glm::ivec2 size_px{image.cols, image.rows};
    if (found.size_px.x != 0 && size_px != found.size_px) {
      throw InputError(file,
                       "not of the size of the images before: expected one camera and one setting");
    }
    found.size_px = size_px;
    ++found.images;
    if (auto view = findBoard(image, board)) found.views.push_back(std::move(*view));
  }
  return found;
}

/// The next frame; of a camera, within ten seconds.
bool waitForFrame(WebcamFrames& frames, cv::Mat& image) {
  using namespace std::chrono_literals;
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (!frames.next(image)) {
    if (!frames.isCamera() || std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

/// A view of the video counts once the board has moved.
Views viewsInStream(WebcamFrames& frames, const Board& board) {
  Views found;
  cv::Mat image;
  while (found.images < kMaxFrames && found.views.size() < kMaxViews &&
         waitForFrame(frames, image)) {
    found.size_px = {image.cols, image.rows};
    ++found.images;
    auto view = findBoard(image, board);
    if (!view) continue;
    if (found.views.empty() || hasMoved(found.views.back(), *view, image.cols)) {
      found.views.push_back(std::move(*view));
    }
  }
  return found;
}

/// @return nullopt where the observer left the window
std::optional<Views> viewsInVideo(const CalibrateCameraOptions& options, const Board& board) {
  WebcamFrames frames({options.device, options.video});
  if (!options.device && !options.window) return viewsInStream(frames, board);
  Views found;
  const auto next = [&](cv::Mat& image) {
    ++found.images;
    return waitForFrame(frames, image);
  };
  auto views = watchBoardInWindow(next, board, found.size_px);
  if (!views) return std::nullopt;
  found.views = std::move(*views);
  return found;
}

void printJson(const Views& found, const CameraFit& fit) {
  const CameraModel& camera = fit.camera;
  std::printf("{\"views\": %zu, \"images\": %d, \"size_px\": %s, \"focal_px\": %s, ",
              found.views.size(), found.images, exactText(camera.size_px).c_str(),
              exactText(camera.focal_px).c_str());
  std::printf("\"principal_px\": %s, \"focal_sd_px\": %s, \"rms_px\": %s, \"covered\": %s, ",
              exactText(camera.principal_px).c_str(), exactText(camera.focal_sd_px).c_str(),
              exactText(camera.rms_px).c_str(), exactText(fit.covered).c_str());
  std::printf("\"distortion\": %s}\n", exactText(camera.distortion).c_str());
}

void printText(const Views& found, const CameraFit& fit) {
  const CameraModel& camera = fit.camera;
  std::printf("%zu views of the board in %d images of %d x %d px\n", found.views.size(),
              found.images, camera.size_px.x, camera.size_px.y);
  std::printf("focal length %.1f +- %.1f, %.1f +- %.1f px, centre %.1f, %.1f px\n",
              camera.focal_px.x, camera.focal_sd_px.x, camera.focal_px.y, camera.focal_sd_px.y,
              camera.principal_px.x, camera.principal_px.y);
  std::printf("reprojection %.3f px RMS; corners in each part of the image:\n", camera.rms_px);
  for (std::size_t cell = 0; cell < fit.coverage.size(); ++cell) {
    const bool last = (cell + 1) % static_cast<std::size_t>(kCoverageCells.x) == 0;
    std::printf(" %5d%s", fit.coverage[cell], last ? "\n" : "");
  }
}

}  // namespace

void calibrateCamera(const CalibrateCameraOptions& options) {
  std::vector<std::filesystem::path> inputs(options.images.begin(), options.images.end());
  inputs.push_back(options.video);
  OutputFiles files(OutputGuard({options.out}, inputs, options.overwrite));
  const Board board = boardOf(options);
  const int sources =
      (options.images.empty() ? 0 : 1) + (options.video.empty() ? 0 : 1) + (options.device ? 1 : 0);
  if (sources != 1) {
    throw InputError("calibrate camera", "expected one of --images, --video, --device");
  }
  const std::optional<Views> found =
      options.images.empty() ? viewsInVideo(options, board) : viewsInImages(options.images, board);
  if (!found) {
    std::fprintf(stderr, "left without a calibration\n");
    return;
  }

  const std::string where = options.device           ? "camera " + std::to_string(*options.device)
                            : options.images.empty() ? options.video.string()
                                                     : options.images.front();
  CameraFit fit;
  try {
    fit = fitCamera(found->views, found->size_px);
  } catch (const InputError& error) {
    throw InputError(where, error.what());
  }
  if (!options.out.empty()) files.write(options.out, cameraToml(fit.camera));
  files.commit();
  if (options.json) {
    printJson(*found, fit);
  } else {
    printText(*found, fit);
  }
}

}  // namespace foci
