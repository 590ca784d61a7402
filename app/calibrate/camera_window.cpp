// The window of `foci calibrate camera`: the camera's image as in a mirror, the corners found,
// and where in the image the board has not been yet.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "app/calibrate/windows.h"
#include "app/window/window.h"

namespace foci {
namespace {

constexpr glm::ivec2 kWindow_px{1280, 720};
constexpr glm::vec3 kBackground{0.2f};
constexpr double kMovedShare = 0.03;  // of the image's width, to count as another view
constexpr double kEnough = 0.7;       // of the cells; then the space key's hint turns green
constexpr ImU32 kWhite = IM_COL32(240, 240, 240, 255), kGreen = IM_COL32(60, 220, 90, 255);
constexpr ImU32 kSeen = IM_COL32(60, 220, 90, 60), kUnseen = IM_COL32(230, 60, 40, 60);
constexpr int kColumns = 8, kRows = 6;

}  // namespace

std::optional<std::vector<BoardView>> watchBoardInWindow(const NextImage& next, const Board& board,
                                                         glm::ivec2& size_px) {
  Window window("foci: calibrate camera", kWindow_px);
  Texture texture;
  std::vector<BoardView> views;
  std::array<bool, kColumns * kRows> covered{};
  cv::Mat image, mirrored;
  bool running = true;
  BoardView last;
  while (window.begin(kBackground)) {
    if (ImGui::IsKeyPressed(GLFW_KEY_ESCAPE)) return std::nullopt;
    if (running && (running = next(image))) {
      size_px = {image.cols, image.rows};
      const auto view = findBoard(image, board);
      last = view.value_or(BoardView{});
      double moved_px = views.empty() ? 1e9 : 0.0;
      for (std::size_t i = 0; view && !views.empty() && i < view->image_px.size(); ++i) {
        if (i >= views.back().image_px.size()) break;
        moved_px = std::max(moved_px, glm::length(view->image_px[i] - views.back().image_px[i]));
      }
      if (view && moved_px >= kMovedShare * size_px.x) {
        views.push_back(*view);
        std::fprintf(stderr, "view %zu\n", views.size());
        for (const glm::dvec2& px : view->image_px) {
          const glm::ivec2 cell = glm::clamp(
              glm::ivec2(px / glm::dvec2(size_px) * glm::dvec2(kColumns, kRows)), {0, 0}, {7, 5});
          const int at = cell.y * kColumns + cell.x;
          covered[static_cast<std::size_t>(at)] = true;
        }
      }
      cv::flip(image, mirrored, 1);
      cv::cvtColor(mirrored, mirrored,
                   image.channels() == 1 ? cv::COLOR_GRAY2RGB : cv::COLOR_BGR2RGB);
      texture.set(size_px, mirrored.data);
    }
    if (size_px.x == 0) return views;
    const glm::dvec2 area = window.size_px();
    const double scale = std::min(area.x / size_px.x, (area.y - 90.0) / size_px.y);
    const glm::dvec2 shown = scale * glm::dvec2(size_px);
    const glm::dvec2 corner(0.5 * (area.x - shown.x), 90.0);
    // Like a mirror: the image's left is the observer's.
    const auto place = [&](const glm::dvec2& px) {
      const glm::dvec2 p = corner + glm::dvec2(shown.x - scale * px.x, scale * px.y);
      return ImVec2(static_cast<float>(p.x), static_cast<float>(p.y));
    };
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    const ImVec2 right = place({0.0, static_cast<double>(size_px.y)});
    draw->AddImage(texture.id(), place({static_cast<double>(size_px.x), 0.0}), right);
    const glm::dvec2 cell = glm::dvec2(size_px) / glm::dvec2(kColumns, kRows);
    for (int y = 0; y < kRows; ++y) {
      for (int x = 0; x < kColumns; ++x) {
        const int at = y * kColumns + x;
        draw->AddRectFilled(place(cell * glm::dvec2(x + 1, y)), place(cell * glm::dvec2(x, y + 1)),
                            covered[static_cast<std::size_t>(at)] ? kSeen : kUnseen);
      }
    }
    for (const glm::dvec2& px : last.image_px) draw->AddCircleFilled(place(px), 4.0f, kGreen);

    const auto count = static_cast<double>(std::count(covered.begin(), covered.end(), true));
    const double share = count / (kColumns * kRows);
    char text[160];
    std::snprintf(text, sizeof text,
                  "%zu views, %.0f %% of the image covered. Tilt the board, go to the "
                  "corners, near and far.",
                  views.size(), 100.0 * share);
    draw->AddText({20.0f, 14.0f}, kWhite, text);
    draw->AddText({20.0f, 48.0f}, share >= kEnough && views.size() >= 8 ? kGreen : kWhite,
                  running ? "Space: enough.   Escape: leave."
                          : "The images have ended.   Space: calibrate.   Escape: leave.");
    const bool enough = ImGui::IsKeyPressed(GLFW_KEY_SPACE, false);
    window.end();
    if (enough) return views;
  }
  return std::nullopt;
}

}  // namespace foci
