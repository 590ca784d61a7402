// The window of `foci calibrate gaze`: a dot shrinks to its mark at each calibration target and
// then at each validation target; the result shows the accuracy at each.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <cstdio>
#include <memory>
#include <utility>

#include "app/calibrate/windows.h"
#include "app/window/window.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/gaze_map/target_session.h"

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

/// The shrinking dot draws the eye to the mark in its centre.
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
  GazeWindow(const CalibrateGazeOptions& options, const Screen& screen,
             std::unique_ptr<WebcamSource> webcam)
      : options_(options),
        webcam_(std::move(webcam)),
        window_("foci: calibrate gaze",
                options.window ? std::optional<glm::ivec2>(kWindow_px) : std::nullopt) {
    // The measured size belongs to all pixels of the screen; a window covers some of them.
    const glm::dvec2 m_per_px = screen.size_m / glm::dvec2(screen.size_px);
    screen_ = {.size_px = glm::ivec2(window_.size_px()),
               .size_m = window_.size_px() * m_per_px,
               .distance_m = screen.distance_m};
    frame_ = {.units = MapUnits::deg, .screen = screen_};
  }

  std::optional<GazeWindowResult> run() {
    while (window_.begin(kBackground)) {
      if (Window::isPressed(GLFW_KEY_ESCAPE, true)) return std::nullopt;
      readTracker();
      const bool go_on = step();
      window_.end();
      if (!go_on) return result_;
    }
    return std::nullopt;
  }

 private:
  /// One sample of the tracker.
  struct Look {
    double time_s = 0.0;
    std::optional<glm::dvec2>
        gaze_deg{};  ///< a webcam's by the nominal map, to see whether the eye rests
    std::optional<WebcamView> view{};
  };

  bool step();
  void begin(Stage stage, int count);
  bool showTarget();
  void readTracker();
  void add(const Look& look);
  void finish();
  void drawResult();

  const CalibrateGazeOptions& options_;
  std::unique_ptr<WebcamSource> webcam_;  // absent: the mouse
  Window window_;
  Screen screen_;
  GazeFrame frame_;
  Stage stage_ = Stage::welcome;
  std::optional<TargetSession> session_;
  std::vector<Look> looks_;  // new in this frame
  bool eye_in_view_ = false, playing_ = false;
  std::vector<glm::dvec2> targets_deg_;
  TargetSession::Step shown_{};
  std::size_t announced_ = 0;  // target, on standard error
  std::vector<GazePair> fitted_;
  std::vector<WebcamPair> views_, fitted_views_;
  GazeWindowResult result_;
  std::string failure_;
};

void GazeWindow::begin(Stage stage, int count) {
  stage_ = stage;
  targets_deg_.clear();
  for (const glm::dvec2& place : shuffled(targetLayout(count), options_.seed)) {
    targets_deg_.push_back(fromPixels(frame_, screen_, place * glm::dvec2(screen_.size_px)));
  }
  session_.emplace(targets_deg_, options_.manual);
  views_.clear();
  shown_ = {};
  announced_ = targets_deg_.size();
}

/// Takes the tracker's new samples.
void GazeWindow::readTracker() {
  looks_.clear();
  if (!webcam_) {
    Look& look = looks_.emplace_back();
    look.time_s = window_.time_s();
    if (window_.hovered()) look.gaze_deg = fromPixels(frame_, screen_, window_.cursor_px());
  } else {
    static const WebcamMap rough = nominalWebcamMap();
    std::vector<GazeSample> samples;
    webcam_->poll(window_.time_s(), samples);
    for (const WebcamFrame& frame : webcam_->takeFrames()) {
      if (!playing_) std::fprintf(stderr, "%s: first frame\n", webcam_->status().c_str());
      playing_ = true;
      Look& look = looks_.emplace_back();
      look.time_s = frame.time_s;
      look.view = frame.record.view;
      if (look.view) {
        look.gaze_deg =
            glm::degrees(glm::atan(pointOnScreen_m(rough, *look.view) / screen_.distance_m));
      }
    }
    const bool in_session = stage_ == Stage::fitting || stage_ == Stage::validating;
    if (webcam_->ended() && in_session) {
      failure_ = "The video ended before the last target.";
      stage_ = Stage::failed;
      std::fprintf(stderr, "%s\n", failure_.c_str());
    }
  }
  if (!looks_.empty()) eye_in_view_ = looks_.back().gaze_deg.has_value();
}

void GazeWindow::add(const Look& look) {
  const std::size_t before = session_->pairs().size();
  shown_ = session_->update(look.time_s, look.gaze_deg);
  if (session_->pairs().size() > before) {
    views_.push_back({look.view, look.time_s, session_->pairs().back().target});
  }
}

/// Returns false once all targets are done.
bool GazeWindow::showTarget() {
  if (Window::isPressed(GLFW_KEY_SPACE)) session_->confirm();
  ImGui::SetMouseCursor(ImGuiMouseCursor_None);
  for (const Look& look : looks_) add(look);
  if (session_->done()) return false;
  const TargetSession::Step& step = shown_;
  const glm::dvec2 px = toPixels(frame_, screen_, targets_deg_[step.target]);
  drawTarget(px, step);
  if (step.gaze_missing) centredText(window_, 0.62, kRed, "No eye in view: waiting");
  if (announced_ != step.target) {
    announced_ = step.target;
    std::fprintf(stderr, "%s target %zu of %zu at %.0f,%.0f px\n",
                 stage_ == Stage::fitting ? "calibration" : "validation", step.target + 1,
                 targets_deg_.size(), px.x, px.y);
  }
  return true;
}

void GazeWindow::finish() {
  try {
    GazeReport& report = result_.report;
    if (webcam_) {
      WebcamCalibration& calibration = result_.webcam.emplace();
      calibration.reference = webcam_->reference().value();
      calibration.screen_m = screen_.size_m;
      report = calibrateWebcam(fitted_views_, views_, screen_, calibration.map);
    } else {
      report.fit = fitGazeMap(fitted_, frame_);
      report.accuracy = measureAccuracy(session_->pairs(), frame_, &report.fit.map);
      report.validated = true;
    }
    stage_ = Stage::result;
  } catch (const InputError& error) {
    failure_ = error.what();
    stage_ = Stage::failed;
  }
  std::fprintf(stderr, "%s\n", stage_ == Stage::result ? "result" : failure_.c_str());
}

void GazeWindow::drawResult() {
  const GazeReport& report = result_.report;
  ImDrawList* draw = ImGui::GetBackgroundDrawList();
  for (const TargetMeasures& t : report.accuracy.targets) {
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
    draw->AddText(at(target + glm::dvec2(20.0, -30.0)), kBlack,
                  printed("%.2f deg", t.measures.accuracy_deg.value_or(0.0)).c_str());
  }
  const GazeMeasures& all = report.accuracy.overall;
  centredText(window_, 0.04, kBlack,
              printed("%s: accuracy %.2f deg, worst target %.2f deg",
                      std::string(nameOf(gradeOf(report.accuracy))).c_str(),
                      all.accuracy_deg.value_or(0.0), report.accuracy.worst_deg.value_or(0.0)));
  centredText(window_, 0.09, kBlack,
              printed("precision %.2f deg RMS-S2S, %.2f deg SD; model %s",
                      all.rms_s2s_deg.value_or(0.0), all.sd_deg.value_or(0.0),
                      report.model.empty() ? std::string(nameOf(report.fit.map.model)).c_str()
                                           : report.model.c_str()));
}

/// Returns false once the observer accepts the result.
bool GazeWindow::step() {
  const bool space = Window::isPressed(GLFW_KEY_SPACE);
  switch (stage_) {
    case Stage::welcome:
      centredText(window_, 0.40, kBlack, "Look at the centre of each dot until it moves on.");
      centredText(window_, 0.46, kBlack,
                  options_.manual ? "Press the space key while you look at it."
                                  : "It moves on by itself, or sooner with the space key.");
      centredText(window_, 0.52, kBlack, "Space: start.   Escape: leave at any time.");
      centredText(window_, 0.58, eye_in_view_ ? kBlack : kRed,
                  eye_in_view_ ? "Gaze is in view." : "No eye in view.");
      if (space) begin(Stage::fitting, options_.targets);
      return true;
    case Stage::fitting:
      if (!showTarget()) {
        fitted_ = session_->pairs();
        fitted_views_ = views_;
        begin(Stage::validating, kValidationTargets);
      }
      return true;
    case Stage::validating:
      if (!showTarget()) finish();
      return true;
    case Stage::result:
      drawResult();
      centredText(window_, 0.93, kBlack, "Space: keep the result.   R: repeat.   Escape: leave.");
      if (Window::isPressed(GLFW_KEY_R)) stage_ = Stage::welcome;
      return !space;
    case Stage::failed:
      centredText(window_, 0.45, kRed, failure_);
      centredText(window_, 0.52, kBlack, "R: repeat.   Escape: leave.");
      if (Window::isPressed(GLFW_KEY_R)) stage_ = Stage::welcome;
      return true;
  }
  return true;
}

}  // namespace

std::optional<GazeWindowResult> calibrateGazeInWindow(const CalibrateGazeOptions& options,
                                                      const Screen& screen,
                                                      const std::optional<WebcamPlace>& webcam,
                                                      const std::optional<Lens>& camera) {
  std::unique_ptr<WebcamSource> source;
  if (webcam) {
    source = std::make_unique<WebcamSource>(*webcam, WebcamTracker(camera), WebcamMapping{});
  }
  GazeWindow window(options, screen, std::move(source));
  return window.run();
}

}  // namespace foci
