// The window of `foci calibrate gaze`: a dot that shrinks to its mark at each target, the same on
// other targets for validation, then the result by target.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <cstdio>

#include "app/base/input_error.h"
#include "app/calibrate_windows.h"
#include "app/window.h"
#include "calibration/target_session.h"

namespace foci {
namespace {

constexpr glm::ivec2 kWindow_px{1280, 720};
constexpr glm::vec3 kBackground{0.5f};
constexpr int kValidationTargets = 4;
constexpr float kLargeDot_px = 26.0f, kSmallDot_px = 7.0f;
constexpr ImU32 kBlack = IM_COL32(20, 20, 20, 255), kWhite = IM_COL32(245, 245, 245, 255);
constexpr ImU32 kRed = IM_COL32(180, 30, 30, 255), kRedVeil = IM_COL32(180, 30, 30, 50);

enum class Stage { welcome, fitting, validating, result, failed };

ImVec2 at(const glm::dvec2& p) { return {static_cast<float>(p.x), static_cast<float>(p.y)}; }

void centredText(const Window& window, double y_share, ImU32 colour, const std::string& text) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const glm::dvec2 area = window.size_px();
  ImGui::GetForegroundDrawList()->AddText(
      {0.5f * (static_cast<float>(area.x) - size.x), static_cast<float>(y_share * area.y)}, colour,
      text.c_str());
}

/// The dot shrinks to draw the eye, the mark in its centre holds it.
void drawTarget(const glm::dvec2& px, const TargetSession::Step& step) {
  ImDrawList* draw = ImGui::GetBackgroundDrawList();
  const float radius =
      kLargeDot_px + (kSmallDot_px - kLargeDot_px) * static_cast<float>(step.shrink);
  draw->AddCircleFilled(at(px), radius, kBlack, 48);
  draw->AddCircleFilled(at(px), 2.5f, kWhite, 16);
  if (step.collecting) draw->AddCircle(at(px), radius + 5.0f, kWhite, 48, 2.0f);
}

class GazeWindow {
 public:
  GazeWindow(const CalibrateGazeOptions& options, const Screen& screen)
      : options_(options),
        window_("foci: calibrate gaze",
                options.window ? std::optional<glm::ivec2>(kWindow_px) : std::nullopt) {
    // The screen's size holds for the whole of its pixels; a window shows a part.
    const glm::dvec2 m_per_px = screen.size_m / glm::dvec2(screen.size_px);
    screen_ = {.size_px = glm::ivec2(window_.size_px()),
               .size_m = window_.size_px() * m_per_px,
               .distance_m = screen.distance_m};
    frame_ = {.units = MapUnits::deg, .screen = screen_};
  }

  std::optional<GazeReport> run() {
    while (window_.begin(kBackground)) {
      if (ImGui::IsKeyPressed(GLFW_KEY_ESCAPE)) return std::nullopt;
      const bool go_on = step();
      window_.end();
      if (!go_on) return report_;
    }
    return std::nullopt;
  }

 private:
  bool step();
  void begin(Stage stage, int count);
  bool follow();
  void finish();
  void drawResult();
  std::optional<glm::dvec2> gaze() const {
    if (!window_.hovered()) return std::nullopt;
    return fromPixels(frame_, screen_, window_.cursor_px());
  }

  const CalibrateGazeOptions& options_;
  Window window_;
  Screen screen_;
  GazeFrame frame_;
  Stage stage_ = Stage::welcome;
  std::optional<TargetSession> session_;
  std::vector<glm::dvec2> targets_deg_;
  std::size_t said_ = 0;
  std::vector<GazePair> fitted_;
  GazeReport report_;
  std::string failure_;
};

void GazeWindow::begin(Stage stage, int count) {
  stage_ = stage;
  targets_deg_.clear();
  for (const glm::dvec2& place : shuffled(targetLayout(count), options_.seed)) {
    targets_deg_.push_back(fromPixels(frame_, screen_, place * glm::dvec2(screen_.size_px)));
  }
  session_.emplace(targets_deg_, options_.manual);
  said_ = targets_deg_.size();
}

/// True while targets are left.
bool GazeWindow::follow() {
  if (ImGui::IsKeyPressed(GLFW_KEY_SPACE, false)) session_->confirm();
  ImGui::SetMouseCursor(ImGuiMouseCursor_None);
  const TargetSession::Step step = session_->update(window_.time_s(), gaze());
  if (session_->done()) return false;
  const glm::dvec2 px = toPixels(frame_, screen_, targets_deg_[step.target]);
  drawTarget(px, step);
  if (step.gaze_missing) centredText(window_, 0.62, kRed, "No eye in view: waiting");
  if (said_ != step.target) {
    said_ = step.target;
    std::fprintf(stderr, "%s target %zu of %zu at %.0f,%.0f px\n",
                 stage_ == Stage::fitting ? "calibration" : "validation", step.target + 1,
                 targets_deg_.size(), px.x, px.y);
  }
  return true;
}

void GazeWindow::finish() {
  try {
    report_.fit = fitGazeMap(fitted_, frame_);
    report_.accuracy = measureAccuracy(session_->pairs(), frame_, &report_.fit.map);
    report_.validated = true;
    stage_ = Stage::result;
  } catch (const InputError& error) {
    failure_ = error.what();
    stage_ = Stage::failed;
  }
  std::fprintf(stderr, "%s\n", stage_ == Stage::result ? "result" : failure_.c_str());
}

void GazeWindow::drawResult() {
  ImDrawList* draw = ImGui::GetBackgroundDrawList();
  for (const TargetMeasures& t : report_.accuracy.targets) {
    const glm::dvec2 target = toPixels(frame_, screen_, t.target);
    draw->AddCircle(at(target), 14.0f, kBlack, 32, 2.0f);
    draw->AddCircleFilled(at(target), 2.5f, kBlack);
    if (!t.mean) continue;
    const glm::dvec2 seen = toPixels(frame_, screen_, *t.mean);
    const double px_per_deg =
        screen_.size_px.x / screen_.size_m.x * screen_.distance_m * glm::radians(1.0);
    draw->AddLine(at(target), at(seen), kRed, 2.0f);
    draw->AddCircleFilled(
        at(seen), static_cast<float>(px_per_deg * t.measures.sd_deg.value_or(0.0)), kRedVeil, 48);
    draw->AddCircleFilled(at(seen), 5.0f, kRed);
    char text[60];
    std::snprintf(text, sizeof text, "%.2f deg", t.measures.accuracy_deg.value_or(0.0));
    draw->AddText(at(target + glm::dvec2(20.0, -30.0)), kBlack, text);
  }
  const GazeMeasures& all = report_.accuracy.overall;
  char text[200];
  std::snprintf(text, sizeof text, "%s: accuracy %.2f deg, worst target %.2f deg",
                std::string(nameOf(gradeOf(report_.accuracy))).c_str(),
                all.accuracy_deg.value_or(0.0), report_.accuracy.worst_deg.value_or(0.0));
  centredText(window_, 0.04, kBlack, text);
  std::snprintf(text, sizeof text, "precision %.2f deg RMS-S2S, %.2f deg SD; model %s",
                all.rms_s2s_deg.value_or(0.0), all.sd_deg.value_or(0.0),
                std::string(nameOf(report_.fit.map.model)).c_str());
  centredText(window_, 0.09, kBlack, text);
}

/// False once the observer accepts.
bool GazeWindow::step() {
  const bool space = ImGui::IsKeyPressed(GLFW_KEY_SPACE, false);
  switch (stage_) {
    case Stage::welcome:
      centredText(window_, 0.40, kBlack, "Look at the centre of each dot until it moves on.");
      centredText(window_, 0.46, kBlack,
                  options_.manual ? "Press the space key while you look at it."
                                  : "It moves on by itself; the space key hurries it.");
      centredText(window_, 0.52, kBlack, "Space: start.   Escape: leave at any time.");
      centredText(window_, 0.58, gaze() ? kBlack : kRed,
                  gaze() ? "Gaze is there." : "No eye in view.");
      if (space) begin(Stage::fitting, options_.targets);
      return true;
    case Stage::fitting:
      if (!follow()) {
        fitted_ = session_->pairs();
        begin(Stage::validating, kValidationTargets);
      }
      return true;
    case Stage::validating:
      if (!follow()) finish();
      return true;
    case Stage::result:
      drawResult();
      centredText(window_, 0.93, kBlack, "Space: keep it.   R: once more.   Escape: leave.");
      if (ImGui::IsKeyPressed(GLFW_KEY_R, false)) stage_ = Stage::welcome;
      return !space;
    case Stage::failed:
      centredText(window_, 0.45, kRed, failure_);
      centredText(window_, 0.52, kBlack, "R: once more.   Escape: leave.");
      if (ImGui::IsKeyPressed(GLFW_KEY_R, false)) stage_ = Stage::welcome;
      return true;
  }
  return true;
}

}  // namespace

std::optional<GazeReport> calibrateGazeInWindow(const CalibrateGazeOptions& options,
                                                const Screen& screen) {
  GazeWindow window(options, screen);
  return window.run();
}

}  // namespace foci
