// The window of `foci calibrate camera`: the camera's image as in a mirror, the corners found, and
// the parts of the image that the board has not covered yet.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "app/calibrate/windows.h"
#include "app/window/window.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr glm::ivec2 kWindow_px{1280, 720};
constexpr glm::vec3 kBackground{0.2f};
constexpr double kTextHeight_px = 90.0;  // above the image
// From here on the hint of the space key is green; chosen by hand.
constexpr double kEnoughCoverage = 0.7;
constexpr std::size_t kEnoughViews = 8;
constexpr ImU32 kWhite = IM_COL32(240, 240, 240, 255), kGreen = IM_COL32(60, 220, 90, 255);
constexpr ImU32 kSeen = IM_COL32(60, 220, 90, 60), kUnseen = IM_COL32(230, 60, 40, 60);

class CameraWindow {
 public:
  CameraWindow(const NextImage& next, const Board& board)
      : next_(next), board_(board), window_("foci: calibrate camera", kWindow_px) {}

  std::optional<std::vector<BoardView>> run() {
    while (window_.begin(kBackground)) {
      if (Window::isPressed(GLFW_KEY_ESCAPE, true)) return std::nullopt;
      if (running_) running_ = search();
      if (size_px_.x == 0) return views_;
      showImage();
      showText();
      const bool enough = Window::isPressed(GLFW_KEY_SPACE);
      window_.end();
      if (enough) return views_;
    }
    return std::nullopt;
  }

  glm::ivec2 size_px() const { return size_px_; }

 private:
  /// Finds the board in the next image; false at the end of the images.
  bool search() {
    cv::Mat image;
    if (!next_(image)) return false;
    size_px_ = {image.cols, image.rows};
    const auto view = findBoard(image, board_);
    last_ = view.value_or(BoardView{});
    if (view && (views_.empty() || hasMoved(views_.back(), *view, size_px_.x))) {
      views_.push_back(*view);
      std::fprintf(stderr, "view %zu\n", views_.size());
      for (const glm::dvec2& px : view->image_px) covered_[coverageCell(px, size_px_)] = true;
    }
    cv::Mat mirrored;
    cv::flip(image, mirrored, 1);
    cv::cvtColor(mirrored, mirrored,
                 image.channels() == 1 ? cv::COLOR_GRAY2RGB : cv::COLOR_BGR2RGB);
    texture_.set(size_px_, mirrored.data);
    return true;
  }

  /// The image mirrored, its covered cells, and the corners of the last view.
  void showImage() {
    const glm::dvec2 area = window_.size_px();
    const double scale = std::min(area.x / size_px_.x, (area.y - kTextHeight_px) / size_px_.y);
    const glm::dvec2 shown = scale * glm::dvec2(size_px_);
    const glm::dvec2 corner(0.5 * (area.x - shown.x), kTextHeight_px);
    const auto place = [&](const glm::dvec2& px) {
      const glm::dvec2 p = corner + glm::dvec2(shown.x - scale * px.x, scale * px.y);
      return ImVec2(static_cast<float>(p.x), static_cast<float>(p.y));
    };
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->AddImage(texture_.id(), place({static_cast<double>(size_px_.x), 0.0}),
                   place({0.0, static_cast<double>(size_px_.y)}));
    const glm::dvec2 cell = glm::dvec2(size_px_) / glm::dvec2(kCoverageCells);
    for (std::size_t i = 0; i < covered_.size(); ++i) {
      const glm::ivec2 at(static_cast<int>(i) % kCoverageCells.x,
                          static_cast<int>(i) / kCoverageCells.x);
      draw->AddRectFilled(place(cell * glm::dvec2(at.x + 1, at.y)),
                          place(cell * glm::dvec2(at.x, at.y + 1)), covered_[i] ? kSeen : kUnseen);
    }
    for (const glm::dvec2& px : last_.image_px) draw->AddCircleFilled(place(px), 4.0f, kGreen);
  }

  void showText() const {
    const auto count = static_cast<double>(std::ranges::count(covered_, true));
    const double share = count / static_cast<double>(covered_.size());
    const std::string text = printed(
        "%zu views, %.0f %% of the image covered. Tilt the board, go to the corners, near and far.",
        views_.size(), 100.0 * share);
    const bool enough = share >= kEnoughCoverage && views_.size() >= kEnoughViews;
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->AddText({20.0f, 14.0f}, kWhite, text.c_str());
    draw->AddText({20.0f, 48.0f}, enough ? kGreen : kWhite,
                  running_ ? "Space: calibrate.   Escape: leave."
                           : "The images have ended.   Space: calibrate.   Escape: leave.");
  }

  const NextImage& next_;
  const Board& board_;
  Window window_;
  Texture texture_;
  glm::ivec2 size_px_{0, 0};
  std::vector<BoardView> views_;
  BoardView last_;
  std::array<bool, static_cast<std::size_t>(kCoverageCells.x* kCoverageCells.y)> covered_{};
  bool running_ = true;
};

}  // namespace

std::optional<std::vector<BoardView>> watchBoardInWindow(const NextImage& next, const Board& board,
                                                         glm::ivec2& size_px) {
  CameraWindow window(next, board);
  auto views = window.run();
  size_px = window.size_px();
  return views;
}

}  // namespace foci
