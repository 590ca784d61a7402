// The window of `foci calibrate screen`. A bank card gives the size of a pixel, the blind spot or a
// tape the distance, and stripes beside a plain patch gamma.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/calibrate/windows.h"
#include "app/window/window.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/screen/screen_size.h"

namespace foci {
namespace {

constexpr glm::ivec2 kWindow_px{1280, 720};
constexpr glm::vec3 kBackground{0.93f};
constexpr ImU32 kBlack = IM_COL32(20, 20, 20, 255), kRed = IM_COL32(190, 20, 20, 255);
constexpr ImU32 kCard = IM_COL32(90, 130, 190, 255);
constexpr double kGuess_px_per_m = 3780.0;  // 96 dpi
constexpr double kDotSpeed_m_per_s = 0.03;  // 3 deg/s at 0.6 m: half a degree in a reaction time
constexpr double kDotStart_m = 0.04;        // where outward runs start: 4 deg at 0.6 m
constexpr double kInsideSpot = 1.2;         // inward runs start at this multiple of the last offset
constexpr std::size_t kRuns = 6;
constexpr int kHalfLight = 188;  // the level at which sRGB emits half the light (IEC 61966-2-1)

enum class Stage { card, distance, blind_spot, by_hand, gamma, result };

ImVec2 at(double x, double y) { return {static_cast<float>(x), static_cast<float>(y)}; }

class ScreenWindow {
 public:
  ScreenWindow(const ScreenCalibration& start, std::optional<glm::dvec2> edid_m, bool window)
      : found_(start),
        window_("foci: calibrate screen",
                window ? std::optional<glm::ivec2>(kWindow_px) : std::nullopt),
        edid_m_(edid_m ? edid_m : window_.monitorSize_m()) {
    found_.screen.size_px = window_.monitorSize_px();
    if (found_.screen.size_m.x > 0.0) {
      px_per_m_ = found_.screen.size_px.x / found_.screen.size_m.x;
    } else if (edid_m_) {
      px_per_m_ = found_.screen.size_px.x / edid_m_->x;
    }
    if (found_.screen.distance_m <= 0.0) found_.screen.distance_m = defaultScreen().distance_m;
  }

  std::optional<ScreenCalibration> run() {
    while (window_.begin(kBackground)) {
      if (Window::isPressed(GLFW_KEY_ESCAPE, true)) return std::nullopt;
      line_ = 0.06 * window_.size_px().y;
      const bool go_on = step();
      window_.end();
      if (!go_on) return found_;
    }
    return std::nullopt;
  }

 private:
  bool step();
  void fitCard();
  void chooseDistance();
  void runBlindSpot();
  void enterDistance();
  void matchGamma();
  bool showResult();

  void say(const std::string& text, ImU32 colour = kBlack) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    ImGui::GetForegroundDrawList()->AddText(
        at(0.5 * (window_.size_px().x - static_cast<double>(size.x)), line_), colour, text.c_str());
    line_ += 34.0;
  }
  /// Steps of the arrow keys, ten at a time with shift.
  static double arrows() {
    const double by = ImGui::GetIO().KeyShift ? 10.0 : 1.0;
    return by * ((Window::isPressed(GLFW_KEY_RIGHT, true) ? 1.0 : 0.0) -
                 (Window::isPressed(GLFW_KEY_LEFT, true) ? 1.0 : 0.0));
  }
  void enter(Stage stage) {
    stage_ = stage;
    constexpr const char* kNames[] = {"card",    "distance", "blind spot",
                                      "by hand", "gamma",    "result"};
    std::fprintf(stderr, "screen: %s\n", kNames[static_cast<int>(stage)]);
  }

  ScreenCalibration found_;
  Window window_;
  std::optional<glm::dvec2> edid_m_;
  double px_per_m_ = kGuess_px_per_m;
  Stage stage_ = Stage::card;
  double line_ = 0.0;
  std::vector<BlindSpotRun> runs_;
  std::optional<double> run_start_s_;
  std::string trouble_;
  int level_ = kHalfLight;
};

void ScreenWindow::fitCard() {
  say("Hold a bank card flat against the screen and fit the blue frame to it.");
  say("Left and right arrow, with shift ten at a time, or drag its corner.   Space: it fits.");
  const glm::dvec2 corner(60.0, 0.22 * window_.size_px().y);
  if (ImGui::IsMouseDown(0)) {
    const double width_px = window_.cursor_px().x - corner.x;
    if (width_px > 60.0) px_per_m_ = width_px / kBankCard_m.x;
  }
  px_per_m_ += arrows() / kBankCard_m.x;
  px_per_m_ = std::clamp(px_per_m_, 700.0, 30000.0);

  const glm::dvec2 size = kBankCard_m * px_per_m_;
  ImDrawList* draw = ImGui::GetBackgroundDrawList();
  draw->AddRectFilled(at(corner.x, corner.y), at(corner.x + size.x, corner.y + size.y), kCard,
                      12.0f);
  draw->AddCircleFilled(at(corner.x + size.x, corner.y + size.y), 7.0f, kBlack);
  found_.screen.size_m = glm::dvec2(found_.screen.size_px) / px_per_m_;
  say(printed("%.0f px wide: %.0f px/m (%.0f dpi), screen %.1f x %.1f cm", size.x, px_per_m_,
              px_per_m_ * 0.0254, 100.0 * found_.screen.size_m.x, 100.0 * found_.screen.size_m.y));
  if (edid_m_) {
    const double off = disagreement(found_.screen.size_m, *edid_m_);
    say(printed("The display states %.1f x %.1f cm, which differs by %.0f %%", 100.0 * edid_m_->x,
                100.0 * edid_m_->y, 100.0 * off),
        off > kEdidTolerance ? kRed : kBlack);
  }
  if (Window::isPressed(GLFW_KEY_SPACE)) {
    found_.size_from = "bank card";
    enter(Stage::distance);
  }
}

void ScreenWindow::chooseDistance() {
  say("How far are your eyes from the screen?");
  say("B: measure it by the blind spot of your left eye (a minute).");
  say("H: measure it with a tape and enter it.");
  if (!trouble_.empty()) say(trouble_, kRed);
  if (Window::isPressed(GLFW_KEY_B)) {
    runs_.clear();
    run_start_s_.reset();
    enter(Stage::blind_spot);
  }
  if (Window::isPressed(GLFW_KEY_H)) enter(Stage::by_hand);
}

void ScreenWindow::runBlindSpot() {
  const bool outwards = runs_.size() % 2 == 0;
  const glm::dvec2 area = window_.size_px();
  const glm::dvec2 cross(0.9 * area.x, 0.55 * area.y);
  say("Cover your right eye. Keep your left eye on the cross.");
  say(printed("Run %zu of %zu. Space: start; space again when the red dot %s.", runs_.size() + 1,
              kRuns, outwards ? "vanishes" : "comes back"));

  ImDrawList* draw = ImGui::GetBackgroundDrawList();
  draw->AddLine(at(cross.x - 12, cross.y), at(cross.x + 12, cross.y), kBlack, 3.0f);
  draw->AddLine(at(cross.x, cross.y - 12), at(cross.x, cross.y + 12), kBlack, 3.0f);
  const double travelled_m =
      run_start_s_ ? kDotSpeed_m_per_s * (window_.time_s() - *run_start_s_) : 0.0;
  const double offset_m =
      outwards ? kDotStart_m + travelled_m : kInsideSpot * runs_.back().offset_m - travelled_m;
  const double x = cross.x - offset_m * px_per_m_;
  if (run_start_s_) draw->AddCircleFilled(at(x, cross.y), 9.0f, kRed, 32);
  if (run_start_s_ && (x < 0.0 || offset_m <= 0.0))
    run_start_s_.reset();  // the observer missed it: repeat the run

  if (!Window::isPressed(GLFW_KEY_SPACE)) return;
  if (!run_start_s_) {
    run_start_s_ = window_.time_s();
    std::fprintf(stderr, "run %zu %s\n", runs_.size() + 1, outwards ? "outwards" : "inwards");
    return;
  }
  runs_.push_back({.offset_m = offset_m, .outwards = outwards});
  run_start_s_.reset();
  if (runs_.size() < kRuns) return;
  try {
    const BlindSpotDistance distance = distanceByBlindSpot(runs_);
    found_.screen.distance_m = distance.distance_m;
    found_.distance_from = printed("blind spot, %zu runs, %zu refused, +-%.0f mm", runs_.size(),
                                   distance.refused.size(), 1000.0 * distance.sd_m);
    trouble_.clear();
    enter(Stage::gamma);
  } catch (const InputError& error) {
    trouble_ = error.what();
    enter(Stage::distance);
  }
}

void ScreenWindow::enterDistance() {
  say("Set the distance from your eyes to the screen: left and right arrow.   Space: done.");
  found_.screen.distance_m =
      std::clamp(found_.screen.distance_m + 0.005 * arrows(), kNearestScreen_m, kFarthestScreen_m);
  say(printed("%.1f cm", 100.0 * found_.screen.distance_m));
  if (Window::isPressed(GLFW_KEY_SPACE)) {
    found_.distance_from = "by hand";
    enter(Stage::gamma);
  }
}

void ScreenWindow::matchGamma() {
  say("Step back or squint, and make the plain patch as bright as the stripes.");
  say("Left and right arrow.   Space: it matches.   S: assume sRGB.");
  level_ = std::clamp(level_ + static_cast<int>(arrows()), 40, 250);
  const glm::dvec2 middle(0.5 * window_.size_px().x, 0.5 * window_.size_px().y);
  ImDrawList* draw = ImGui::GetBackgroundDrawList();
  for (int y = 0; y < 200; ++y) {
    draw->AddRectFilled(at(middle.x - 200, middle.y - 80 + y), at(middle.x, middle.y - 79 + y),
                        y % 2 ? IM_COL32_WHITE : IM_COL32_BLACK);
  }
  draw->AddRectFilled(at(middle.x, middle.y - 80), at(middle.x + 200, middle.y + 120),
                      IM_COL32(level_, level_, level_, 255));
  // (level / 255)^gamma = 1/2: the stripes emit half the light.
  const double gamma = std::log(0.5) / std::log(level_ / 255.0);
  say(printed("gamma %.2f", gamma));
  const bool space = Window::isPressed(GLFW_KEY_SPACE);
  if (space && level_ != kHalfLight) found_.gamma = std::clamp(gamma, 1.0, 4.0);
  if (Window::isPressed(GLFW_KEY_S)) found_.gamma.reset();
  if (space || Window::isPressed(GLFW_KEY_S)) enter(Stage::result);
}

/// Returns false once the observer accepts the result.
bool ScreenWindow::showResult() {
  const Screen& screen = found_.screen;
  say(printed("Screen %.1f x %.1f cm, %d x %d px (%s)", 100.0 * screen.size_m.x,
              100.0 * screen.size_m.y, screen.size_px.x, screen.size_px.y,
              found_.size_from.c_str()));
  say(printed("%.1f cm away (%s)", 100.0 * screen.distance_m, found_.distance_from.c_str()));
  say(printed("%.1f px per degree at the centre",
              px_per_m_ * screen.distance_m * std::tan(glm::radians(1.0))));
  say(found_.gamma ? printed("gamma %.2f", *found_.gamma) : "sRGB as displayed");
  say("Space: keep the result.   R: repeat.   Escape: leave.");
  if (Window::isPressed(GLFW_KEY_R)) enter(Stage::card);
  return !Window::isPressed(GLFW_KEY_SPACE);
}

bool ScreenWindow::step() {
  const Stage stage = stage_;  // the steps change it
  if (stage == Stage::card) fitCard();
  if (stage == Stage::distance) chooseDistance();
  if (stage == Stage::blind_spot) runBlindSpot();
  if (stage == Stage::by_hand) enterDistance();
  if (stage == Stage::gamma) matchGamma();
  return stage != Stage::result || showResult();
}

}  // namespace

std::optional<ScreenCalibration> calibrateScreenInWindow(const ScreenCalibration& start,
                                                         std::optional<glm::dvec2> edid_m,
                                                         bool window) {
  ScreenWindow screen(start, edid_m, window);
  return screen.run();
}

}  // namespace foci
