// The window of `foci live`. It shows each frame as soon as it is rendered, and turns keys into
// changes of the study. Nothing here takes longer than a buffer swap.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <future>
#include <memory>
#include <stdexcept>

#include "app/live/headset_display.h"
#include "app/live/options.h"
#include "app/live/panel.h"
#include "app/live/pose.h"
#include "app/live/record.h"
#include "app/live/remote_control.h"
#include "app/live/renderer.h"
#include "app/platform/interrupt.h"
#include "app/platform/output_files.h"
#include "app/platform/remote_socket.h"
#include "app/platform/warnings.h"
#include "app/record/gaze_marker.h"
#include "app/study/study_words.h"
#include "app/window/window.h"
#include "base/file.h"

namespace foci {
namespace {

constexpr double kFirst_s = 8.0, kNotice_s = 4.0;  // how long hints and notices stay
constexpr double kPanel_s = 1.0 / 30.0,
                 kIdle_s = 0.5;  // until the window is drawn again without a new frame
constexpr int kMirror_px = 800;  // the longer side of the window beside a headset
constexpr double kTurn_rad_per_px = 0.002, kFocusStep_D = 0.25;

std::string quoted(std::string_view name) { return '"' + std::string(name) + '"'; }

/// The name after `now`; after the last one the first.
template <class Names>
std::string nextOf(const Names& names, std::string_view now) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == now) return quoted(names[(i + 1) % names.size()]);
  }
  return quoted(names[0]);
}

/// The GPU that shows the window, if frames may be rendered on it.
SharedGpu gpuOf(Window& window, RenderDevice device) {
  if (device == RenderDevice::cpu) return nullptr;
  try {
    auto context = window.sharedContext();
    return context ? std::make_shared<GpuDevice>(std::move(context)) : nullptr;
  } catch (const GpuError&) {
    return nullptr;
  }
}

class LiveWindow {
 public:
  LiveWindow(const Study& study, const LiveOptions& options, std::optional<SceneFile>&& scene);
  ~LiveWindow() {
    open_ = false;
    if (headset_) headset_->stop();
  }
  LiveWindow(const LiveWindow&) = delete;
  LiveWindow& operator=(const LiveWindow&) = delete;

  LiveSummary run();

 private:
  void openWindow(const Study& study, const LiveOptions& options);
  void openHeadset(Study& study, const std::function<void()>& wake);
  void takeFrames();
  void requireRecord();
  void point();
  bool keys();
  void key(int key);
  void moveEye(int key);
  void turnEye();
  void sendPose();
  void draw();
  void showFrame();
  void shown(double swap_s);
  void change(const std::string& name, const std::string& toml) { renderer_->change(name, toml); }
  void toggle(const char* name, bool now) { change(name, now ? "false" : "true"); }
  void toggleRecord();
  void screenshot();
  void placeObject();

  LiveClock clock_;
  Screen screen_;
  std::optional<LivePose> pose_;  // absent: the study moves the eye
  LiveControls controls_;
  LiveSummary summary_;
  FrameGraph graph_;
  std::atomic<bool> open_ = false;
  std::optional<Window> window_;
  std::optional<Texture> texture_;
  std::optional<HeadsetDisplay> headset_;
  std::optional<GazeFeed> feed_;
  std::optional<LiveRenderer> renderer_;
  std::promise<SharedGpu> gpu_;         // for the renderer, which waits for it; destroyed before it
  std::shared_ptr<LiveFrame> frame_;    // shown last
  std::shared_ptr<LiveRecord> record_;  // of that frame
  std::future<std::string> starting_;   // the record of `--record`
  bool is_new_ = false;                 // not shown yet
  double period_s_ = 1.0 / 60.0, last_swap_s_ = 0.0, image_swap_s_ = 0.0;
  std::string notice_;
  double notice_since_s_ = -kNotice_s;
  bool panel_ = false, help_ = false;
  std::atomic<bool> leaving_ = false;
  glm::dvec2 cursor_px_{0.0};
  bool clicked_ = false;  // the left button was down
  std::future<void> saving_;
  std::optional<RemoteSocket> socket_;  // last: its threads call the others
};

void LiveWindow::openWindow(const Study& study, const LiveOptions& options) {
  std::optional<glm::ivec2> size_px;
  if (options.headset) {
    size_px = glm::ivec2(kMirror_px);
  } else if (options.window) {
    size_px = study.imageSize_px();
  }
  window_.emplace("foci live", size_px, options.monitor);
  open_ = true;
  texture_.emplace();
  period_s_ = 1.0 / window_->refresh_Hz();
}

/// The study is then on the headset's displays, and the window shows what the left eye sees.
void LiveWindow::openHeadset(Study& study, const std::function<void()>& wake) {
  headset_.emplace(study, window_->sharedContext(), clock_, wake);
  study = headset_->studyHere(std::move(study));
  const glm::dvec2 eye_px(headset_->facts().eye_px);
  window_->resize(glm::ivec2(kMirror_px / std::max(eye_px.x, eye_px.y) * eye_px));
  const HeadsetFacts& facts = headset_->facts();
  say("headset " + facts.headset + ", by " + facts.runtime +
      (facts.asks_gaze ? ": its gaze is one line of sight, without vergence and pupil" : ""));
}

LiveWindow::LiveWindow(const Study& asked, const LiveOptions& options,
                       std::optional<SceneFile>&& scene) {
  Study study = asked;
  const auto wake = [this] {
    if (open_) Window::wake();
  };
  if (options.headset) {
    openWindow(study, options);
    openHeadset(study, wake);
  }
  screen_ = study.screenInForce();
  if (study.eye.path.empty()) {
    pose_.emplace(*study.eye.position_m, *study.eye.look_at_m, study.eye.up);
  }
  controls_ = {.change = [this](const auto& name, const auto& toml) { change(name, toml); },
               .set_objects = [this](auto objects) { renderer_->setObjects(std::move(objects)); },
               .toggle_record = [this] { toggleRecord(); },
               .screenshot = [this] { screenshot(); },
               .add_marker = [this] { renderer_->addMarker("panel"); },
               .save_study = [this] { renderer_->saveStudy(unusedName(".toml")); }};
  feed_.emplace(headset_ ? headset_->gaze(study, screen_) : openLiveSource(options.source, study),
                clock_);
  // The scene loads while the window opens.
  std::function<LiveHead(const Study*)> head;
  if (headset_) head = [this](const Study* moved) { return headset_->headNext(moved); };
  renderer_.emplace(study, *feed_, clock_, options.command, options.threads, wake, std::move(scene),
                    gpu_.get_future(), head);
  if (!window_) openWindow(study, options);
  gpu_.set_value(gpuOf(*window_, study.render.device));
  if (headset_) headset_->start(*renderer_);
  if (options.record) starting_ = renderer_->startRecord(*options.record);
  if (!options.socket.empty()) {
    socket_.emplace(
        options.socket,
        [this](const std::string& command) -> std::optional<std::string> {
          if (command.starts_with("gaze ")) return feed_->push(std::string_view(command).substr(5));
          return std::nullopt;
        },
        [this](const std::string& command) {
          if (command == "leave") leaving_ = true;
          return leaving_ ? "ok" : answerTo(command, *renderer_, clock_);
        });
    std::fprintf(stderr, "listening at port %d\n", socket_->port());
  }
}

LiveSummary LiveWindow::run() {
  noteInterrupts();
  draw();
  while (!leaving_ && !isInterrupted()) {
    const double wait_s = panel_ || help_ ? kPanel_s : kIdle_s;
    if (!window_->wait(std::min(last_swap_s_ + wait_s - clock_.now_s(), 0.1))) break;
    requireRecord();
    point();
    const bool pressed = keys();
    takeFrames();
    if (is_new_ || pressed || clock_.now_s() >= last_swap_s_ + wait_s) draw();
  }
  socket_.reset();
  if (headset_) {
    headset_->stop();
    takeFrames();
  }
  if (renderer_->take(clock_.now_s())) ++summary_.dropped;
  record_ = nullptr;
  renderer_->finish(summary_.records, summary_.failed_records);
  summary_.reception = feed_->reception();
  if (saving_.valid()) saving_.wait();
  return summary_;
}

void LiveWindow::takeFrames() {
  if (!headset_) {
    if (auto next = renderer_->take(clock_.now_s() + period_s_)) {
      frame_ = std::move(next);
      is_new_ = true;
    }
    return;
  }
  for (auto& next : headset_->takeShown()) {
    frame_ = std::move(next);
    shown(*frame_->timing.swap_s);
    is_new_ = true;
  }
  if (const std::string ended = headset_->ended(); !ended.empty() && !leaving_) {
    say(ended);
    leaving_ = true;
  }
}

/// Ends the run if the record of `--record` could not begin.
void LiveWindow::requireRecord() {
  if (!starting_.valid() ||
      starting_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;
  }
  if (const std::string failure = starting_.get(); !failure.empty()) {
    throw std::runtime_error(failure);
  }
}

/// Tells the gaze source where the mouse is, and where it clicks.
void LiveWindow::point() {
  const glm::dvec2 at_px = window_->cursor_px();
  if (window_->rightButton() && !ImGui::GetIO().WantCaptureMouse) turnEye();
  cursor_px_ = at_px;
  const glm::dvec2 on_screen_px = at_px / window_->size_px() * glm::dvec2(screen_.size_px);
  const bool clicks = window_->leftButton() && !ImGui::GetIO().WantCaptureMouse;
  if (clicks && !clicked_ && window_->hovered()) {
    if (const std::string told = feed_->lookedAt(on_screen_px); !told.empty()) {
      renderer_->tell(told);
    }
  }
  clicked_ = clicks;
  if (!window_->hovered()) {
    feed_->pointTo(std::nullopt);
  } else if (!ImGui::GetIO().WantCaptureMouse && !window_->rightButton()) {
    feed_->pointTo(on_screen_px);
  }
}

void LiveWindow::turnEye() {
  const glm::dvec2 by_px = window_->cursor_px() - cursor_px_;
  if (!pose_ || by_px == glm::dvec2(0.0)) return;
  pose_->turn(-kTurn_rad_per_px * by_px);  // the scene follows the mouse
  sendPose();
}

void LiveWindow::sendPose() {
  change("eye.position_m", tomlPoint(pose_->position_m()));
  change("eye.look_at_m", tomlPoint(pose_->look_at_m()));
}

void LiveWindow::moveEye(int key) {
  if (headset_ && key == GLFW_KEY_HOME) headset_->recentre();
  if (!pose_) return;
  const double step_m = liveStep_m(renderer_->state().scene_m);
  switch (key) {
    case GLFW_KEY_LEFT:
      pose_->move({-step_m, 0.0, 0.0});
      break;
    case GLFW_KEY_RIGHT:
      pose_->move({step_m, 0.0, 0.0});
      break;
    case GLFW_KEY_UP:
      pose_->move({0.0, 0.0, step_m});
      break;
    case GLFW_KEY_DOWN:
      pose_->move({0.0, 0.0, -step_m});
      break;
    case GLFW_KEY_PAGE_UP:
      pose_->move({0.0, step_m, 0.0});
      break;
    case GLFW_KEY_PAGE_DOWN:
      pose_->move({0.0, -step_m, 0.0});
      break;
    case GLFW_KEY_HOME:
      pose_->reset();
      break;
    default:
      return;
  }
  sendPose();
}

/// @return whether any key was pressed
bool LiveWindow::keys() {
  const std::vector<int> pressed = window_->takeKeys();
  const std::vector<unsigned> typed = window_->takeTyped();
  if (ImGui::GetIO().WantTextInput) return !pressed.empty();
  for (const int each : pressed) key(each);
  for (const unsigned c : typed) {
    if (c == '?' || c == '/') help_ = !help_;
  }
  return !pressed.empty() || !typed.empty();
}

void LiveWindow::key(int key) {
  const LiveState state = renderer_->state();
  const Study& study = state.study;
  const double focus_D = study.focus.fixed_D.value_or(state.last.eye.focus_D);
  if (key >= GLFW_KEY_1 && key <= GLFW_KEY_8) {
    change("observer.pupil_mm", std::to_string(key - GLFW_KEY_0));
    return;
  }
  switch (key) {
    case GLFW_KEY_ESCAPE:
      leaving_ = true;
      break;
    case GLFW_KEY_F1:
      panel_ = !panel_;
      break;
    case GLFW_KEY_F2:
      controls_.save_study();
      break;
    case GLFW_KEY_O:
      placeObject();
      break;
    case GLFW_KEY_F:
      change("focus.fixed_D", study.focus.fixed_D ? "null" : tomlNumber(focus_D));
      break;
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
      change("focus.fixed_D", tomlNumber(std::min(focus_D + kFocusStep_D, 20.0)));
      break;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      change("focus.fixed_D", tomlNumber(std::max(focus_D - kFocusStep_D, 0.0)));
      break;
    case GLFW_KEY_M:
      toggle("output.marker", study.output.marker);
      break;
    case GLFW_KEY_S:
      toggle("output.split", study.output.split);
      break;
    case GLFW_KEY_V:
      change("output.view", nextOf(studyWords<StereoView>(), studyWord(study.output.view)));
      break;
    case GLFW_KEY_N:
      if (!state.methods.empty()) {
        change("render.method", nextOf(state.methods, study.render.method));
      }
      break;
    case GLFW_KEY_R:
      toggleRecord();
      break;
    case GLFW_KEY_SPACE:
      renderer_->addMarker("space");
      break;
    case GLFW_KEY_P:
      screenshot();
      break;
    default:
      moveEye(key);
  }
}

void LiveWindow::toggleRecord() {
  if (renderer_->state().record) {
    renderer_->stopRecord();
  } else {
    renderer_->startRecord(unusedName(""));
  }
}

/// The panel then shows the object's name and size.
void LiveWindow::placeObject() {
  if (headset_ || !window_->hovered() || ImGui::GetIO().WantCaptureMouse) {
    renderer_->tell(headset_ ? "objects are placed in the window of a screen"
                             : "no surface under the pointer");
    return;
  }
  renderer_->placeObject(window_->cursor_px() / window_->size_px() * glm::dvec2(screen_.size_px));
  panel_ = true;
}

void LiveWindow::screenshot() {
  if (!frame_) return;
  if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;  // one at a time
  }
  const std::filesystem::path file = unusedName(".png");
  renderer_->tell("image in " + file.string());
  saving_ =
      std::async(std::launch::async, [this, image = renderer_->pixelsOf(frame_), file]() mutable {
        try {
          const auto bytes = pngOf(*image.get().get());
          writeText(file, {bytes.begin(), bytes.end()});
        } catch (const std::exception& error) {
          renderer_->tell(error.what());
        }
      });
}

void LiveWindow::draw() {
  if (is_new_ && !frame_->texture) {
    const Image& image = *frame_->image.get();
    texture_->set(image.size_px, image.rgb.data());
  }
  if (!window_->begin(glm::vec3(0.0f))) leaving_ = true;
  if (frame_) showFrame();
  const LiveState state = renderer_->state();
  const double now_s = clock_.now_s();
  if (state.notice != notice_) {
    notice_ = state.notice;
    notice_since_s_ = now_s;
  }
  const PanelContent content{.state = state,
                             .frame = frame_.get(),
                             .source = feed_->status(),
                             .graph = graph_,
                             .summary = summary_,
                             .now_s = now_s};
  if (panel_ && frame_ && !headset_) {
    drawObjects(frame_->lines_px,
                frame_->texture ? frame_->texture->size_px() : frame_->image.get()->size_px);
  }
  if (panel_) drawPanel(content, controls_, panel_);
  if (help_) drawHelp(help_);
  drawNotices(content, now_s - notice_since_s_ < kNotice_s ? notice_ : "", now_s < kFirst_s);
  if (frame_ && state.study.output.sync_patch > 0) {
    if (is_new_ && !headset_)
      frame_->timing.sync_level = static_cast<int>(summary_.frames % kSyncLevels);
    drawSyncPatch(state.study.output.sync_patch, frame_->timing.sync_level);
  }
  window_->end();
  last_swap_s_ = clock_.now_s();
  if (is_new_ && !headset_) shown(last_swap_s_);
  is_new_ = false;
}

void LiveWindow::showFrame() {
  const glm::ivec2 size_px = window_->frameBufferSize_px();
  const int views = headset_ ? 2 : 1;
  if (!frame_->texture) {
    texture_->fill(size_px, views);
    return;
  }
  GpuTexture& on_gpu = *frame_->texture;
  texture_->fillFrom(on_gpu.beginShow(), on_gpu.size_px(), size_px, views);
  on_gpu.endShow();
  drawGazeRings(frame_->markers_px, !isFixating(frame_->record),
                on_gpu.size_px() / glm::ivec2(views, 1));
}

/// Counts the frame that has just been shown, and gives it to the record.
void LiveWindow::shown(double swap_s) {
  FrameTiming& timing = frame_->timing;
  timing.swap_s = swap_s;
  if (summary_.frames == 0) {
    summary_.first_frame_s = swap_s;
  } else if (!headset_) {
    const auto refreshes = std::lround((swap_s - image_swap_s_) / period_s_);
    timing.repeats = static_cast<int>(std::max(refreshes - 1, 0L));
  }
  image_swap_s_ = swap_s;
  ++summary_.frames;
  summary_.repeated += static_cast<std::uint64_t>(timing.repeats);
  const double render_ms = 1e3 * (timing.render_end_s - timing.render_start_s);
  const double sample_ms = 1e3 * (swap_s - timing.sample_s.value_or(swap_s));
  summary_.render.add(render_ms);
  summary_.render_to_swap.add(1e3 * (swap_s - timing.render_end_s));
  // A silent source has no sample whose age could be told.
  if (timing.sample_s && frame_->record.eye.state != GazeState::lost) {
    summary_.sample_to_swap.add(sample_ms);
    summary_.sample_to_render.add(1e3 * (timing.render_start_s - *timing.sample_s));
    if (timing.display_s)
      summary_.sample_to_display.add(1e3 * (*timing.display_s - *timing.sample_s));
  }
  summary_.landings.add(frame_->record, timing.in_full, swap_s);
  graph_.add(sample_ms, render_ms, 1e3 * (swap_s - timing.render_end_s));
  // The first frame after a record closes it.
  const auto record = frame_->record_file.lock();
  if (record_ && record_ != record) record_->close();
  record_ = record;
  if (record_) record_->add(frame_);
}

}  // namespace

LiveSummary runLive(const Study& study, const LiveOptions& options,
                    std::optional<SceneFile> scene) {
  LiveWindow window(study, options, std::move(scene));
  return window.run();
}

}  // namespace foci
