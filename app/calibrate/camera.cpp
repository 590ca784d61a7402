// `foci calibrate camera`: the board from images, a video or a device.
#include <algorithm>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "app/calibrate/options.h"
#include "app/calibrate/windows.h"
#include "base/input_error.h"
#include "calibration/calibration_file.h"
#include "calibration/camera/camera.h"

namespace foci {
namespace {

constexpr int kMaxFrames = 100'000;
constexpr std::size_t kMaxViews = 60;  // of a video; more cost time and tell no more
constexpr double kMovedShare = 0.03;   // of the image's width, to count as another view

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

struct Seen {
  std::vector<BoardView> views;
  glm::ivec2 size_px{0, 0};
  int images = 0;
};

void look(const cv::Mat& image, const Board& board, bool only_moved, Seen& seen) {
  ++seen.images;
  auto view = findBoard(image, board);
  if (!view) return;
  if (only_moved && !seen.views.empty()) {
    double moved = 0.0;
    const auto& last = seen.views.back().image_px;
    for (std::size_t i = 0; i < std::min(last.size(), view->image_px.size()); ++i) {
      moved = std::max(moved, glm::length(last[i] - view->image_px[i]));
    }
    if (moved < kMovedShare * image.cols) return;
  }
  seen.views.push_back(std::move(*view));
}

void lookAtStream(cv::VideoCapture& stream, int frames, const Board& board, Seen& seen) {
  cv::Mat image;
  for (int i = 0; i < frames && seen.views.size() < kMaxViews && stream.read(image); ++i) {
    seen.size_px = {image.cols, image.rows};
    look(image, board, true, seen);
  }
}

}  // namespace

void calibrateCamera(const CalibrateCameraOptions& options) {
  const Board board = boardOf(options);
  Seen seen;
  const int sources =
      (options.images.empty() ? 0 : 1) + (options.video.empty() ? 0 : 1) + (options.device ? 1 : 0);
  if (sources != 1) throw InputError("calibrate camera", "one of --images, --video, --device");
  for (const std::string& file : options.images) {
    const bool there = std::filesystem::is_regular_file(file);  // else OpenCV says so, too
    const cv::Mat image = there ? cv::imread(file, cv::IMREAD_GRAYSCALE) : cv::Mat();
    if (image.empty()) throw InputError(file, "not an image that can be read");
    const glm::ivec2 size_px{image.cols, image.rows};
    if (seen.size_px.x != 0 && size_px != seen.size_px) {
      throw InputError(file, "another size than the images before: one camera, one setting");
    }
    seen.size_px = size_px;
    look(image, board, false, seen);
  }
  if (!options.video.empty() || options.device) {
    cv::VideoCapture stream;
    if (options.device) {
      stream.open(*options.device);
    } else {
      stream.open(options.video.string());
    }
    if (!stream.isOpened() && options.device) {
      throw std::runtime_error("camera " + std::to_string(*options.device) + " does not open");
    }
    if (!stream.isOpened())
      throw InputError(options.video.string(), "not a video that can be read");
    if (options.device || options.window) {
      const auto next = [&](cv::Mat& image) {
        ++seen.images;
        return stream.read(image) && !image.empty();
      };
      auto views = watchBoardInWindow(next, board, seen.size_px);
      if (!views) {
        std::fprintf(stderr, "left without a calibration\n");
        return;
      }
      seen.views = std::move(*views);
    } else {
      lookAtStream(stream, kMaxFrames, board, seen);
    }
  }

  const std::string where = options.device           ? "camera " + std::to_string(*options.device)
                            : options.images.empty() ? options.video.string()
                                                     : options.images.front();
  CameraFit fit;
  try {
    fit = fitCamera(seen.views, seen.size_px);
  } catch (const InputError& error) {
    throw InputError(where, error.what());
  }
  if (!options.out.empty()) writeWhole(options.out, cameraToml(fit.camera));
  const CameraModel& camera = fit.camera;
  if (options.json) {
    std::printf("{\"views\": %zu, \"images\": %d, \"size_px\": [%d, %d], \"focal_px\": %s, ",
                seen.views.size(), seen.images, camera.size_px.x, camera.size_px.y,
                exactText(camera.focal_px).c_str());
    std::printf("\"principal_px\": %s, \"focal_sd_px\": %s, \"rms_px\": %s, \"covered\": %s, ",
                exactText(camera.principal_px).c_str(), exactText(camera.focal_sd_px).c_str(),
                exactText(camera.rms_px).c_str(), exactText(fit.covered).c_str());
    std::printf("\"distortion\": [");
    for (std::size_t i = 0; i < 5; ++i) {
      std::printf("%s%s", i ? ", " : "", exactText(camera.distortion[i]).c_str());
    }
    std::printf("]}\n");
    return;
  }
  std::printf("%zu views of the board in %d images of %d x %d px\n", seen.views.size(), seen.images,
              camera.size_px.x, camera.size_px.y);
  std::printf("focal length %.1f +- %.1f, %.1f +- %.1f px, centre %.1f, %.1f px\n",
              camera.focal_px.x, camera.focal_sd_px.x, camera.focal_px.y, camera.focal_sd_px.y,
              camera.principal_px.x, camera.principal_px.y);
  std::printf("reprojection %.3f px RMS; corners seen, over the image:\n", camera.rms_px);
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 8; ++column) {
      std::printf(" %5d", fit.coverage[row * 8 + column]);
    }
    std::printf("\n");
  }
}

}  // namespace foci
