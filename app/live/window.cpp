#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "app/live/live_window.h"
#include "app/live/remote_control.h"
#include "app/platform/interrupt.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "app/record/gaze_marker.h"
#include "base/file.h"

namespace foci {
namespace {

constexpr double kFirst_s = 8.0;  // how long the first hint stays
// Until the window is drawn again without a new frame.
constexpr double kPanel_s = 1.0 / 30.0, kIdle_s = 0.5;
constexpr double kSteer_s = 1.0 / 60.0;  // between looks at keys that are down
constexpr double kTimeline_s = 3.0;      // how long it stays after its last use
constexpr int kMirror_px = 800;          // the longer side of the window beside a headset

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

}  // namespace

LiveWindow::~LiveWindow() {
  open_ = false;
  if (headset_) headset_->stop();
}

void LiveWindow::openWindow(const Study& study, const LiveOptions& options) {
  std::optional<glm::ivec2> size_px;
  if (options.headset) {
    size_px = glm::ivec2(kMirror_px);
  } else if (study.display.kind ==
             DisplayKind::headset) {  // a headset's field has not the shape of a monitor
    const glm::dvec2 image_px(study.imageSize_px());
    size_px = glm::ivec2(kMirror_px / std::max(image_px.x, image_px.y) * image_px);
  } else if (options.window) {
    size_px = study.imageSize_px();
  }
  window_.emplace(options.title, size_px, options.monitor);
  ImGui::GetIO().ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;  // our keys would act twice
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
  open_file_ = options.open;
  const auto wake = [this] {
    if (open_) Window::wake();
  };
  if (options.headset) {
    openWindow(study, options);
    openHeadset(study, wake);
  }
  screen_ = study.screenInForce();
  if (study.eye.path.empty()) {
    steering_.emplace(LivePose(*study.eye.position_m, *study.eye.look_at_m, study.eye.up));
  }
  controls_ = {.change = [this](const auto& name, const auto& toml) { change(name, toml); },
               .set_objects = [this](auto objects) { renderer_->setObjects(std::move(objects)); },
               .toggle_record = [this] { toggleRecord(); },
               .screenshot = [this] { screenshot(); },
               .add_marker = [this] { renderer_->addMarker("panel"); },
               .hold_gaze = [this] { holdGaze(); },
               .save_study = [this] { renderer_->saveStudy(unusedName(".toml")); },
               .show_outside = [this] { toggleOutside(); }};
  NamedSource source =
      headset_ ? headset_->gaze(study, screen_) : openLiveSource(options.source, study);
  LiveHeadAt head;
  if (headset_) head = [this](const Study& now, double) { return headset_->headNext(&now); };
  if (source.study) {  // the recording's head moves the eye
    study = *source.study;
    screen_ = source.screen;
    steering_.reset();
    head = [this](const Study&, double time_s) {
      return LiveHead{.in_scene = feed_->playback().head(time_s)};
    };
  }
  feed_.emplace(std::move(source), clock_);
  // The scene loads while the window opens.
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
          return leaving_ ? "ok" : answerTo(command, *renderer_);
        });
    std::fprintf(stderr, "listening at port %d\n", socket_->port());
  }
}

LiveSummary LiveWindow::run() {
  noteInterrupts();
  draw();
  while (!leaving_ && !isInterrupted()) {
    const bool animated = panel_ || help_ || outside_ || !frame_ || showsTimeline();
    const double wait_s = animated ? kPanel_s : kIdle_s;
    const double until_s = std::min(last_swap_s_ + wait_s - clock_.now_s(), 0.1);
    if (!window_->wait(moves_ || steered_ ? std::min(until_s, kSteer_s) : until_s)) break;
    requireRecord();
    point();
    const bool pressed = keys();
    openDropped();
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
  if (!isReady(starting_)) return;
  if (const std::string failure = starting_.get(); !failure.empty()) {
    throw std::runtime_error(failure);
  }
}

void LiveWindow::toggleRecord() {
  if (renderer_->state().record) {
    renderer_->stopRecord();
  } else {
    renderer_->startRecord(unusedName(""));
  }
}

/// While it pauses, or was just used, or the mouse is below.
bool LiveWindow::showsTimeline() const {
  constexpr double kLower = 0.85;  // share of the window
  const TracePlayer* player = feed_->player();
  if (!player || !frame_) return false;
  const bool below = window_->hovered() && window_->cursor_px().y > kLower * window_->size_px().y;
  return panel_ || below || !player->state().plays || clock_.now_s() < used_s_ + kTimeline_s;
}

/// Opens a file that was dropped on the window, on a thread, and leaves for it.
void LiveWindow::openDropped() {
  const auto dropped = window_->takeDropped();
  if (!dropped.empty() && open_file_ && !headset_ && !next_.valid()) {
    renderer_->tell("opening " + dropped.front().filename().string());
    next_ = std::async(std::launch::async,
                       [open = open_file_, file = dropped.front(), now = renderer_->state().study] {
                         return open(file, now);
                       });
  }
  if (!isReady(next_)) return;
  try {
    summary_.next = next_.get();
    leaving_ = true;
  } catch (const std::exception& error) {
    renderer_->tell(error.what());
  }
}

void LiveWindow::screenshot() {
  if (!frame_ || (saving_.valid() && !isReady(saving_))) return;  // one at a time
  const std::filesystem::path file = unusedName(".png");
  renderer_->tell("image in " + file.string());
  saving_ =
      std::async(std::launch::async, [this, image = renderer_->pixelsOf(frame_), file]() mutable {
        try {
          writeText(file, pngOf(*image.get().get()));
        } catch (const std::exception& error) {
          renderer_->tell(error.what());
        }
      });
}

void LiveWindow::draw() {
  if (frame_ && !frame_->texture && in_texture_ != frame_->plain.get()) {
    in_texture_ = frame_->plain.get();
    texture_->set(in_texture_->size_px, in_texture_->rgb.data());
  }
  const bool has_panels = panel_ || help_ || showsTimeline();
  if (!window_->begin(glm::vec3(0.0f), has_panels)) leaving_ = true;
  const LiveState state = renderer_->state();
  if (frame_) showFrame(state.study);
  const double now_s = clock_.now_s();
  if (state.notice != notice_) {
    notice_ = state.notice;
    notice_since_s_ = now_s;
  }
  const PanelContent content{.state = state,
                             .frame = frame_.get(),
                             .source = feed_->status(),
                             .holds_gaze = feed_->holds(),
                             .outside = outside_ != nullptr,
                             .graph = graph_,
                             .summary = summary_,
                             .now_s = now_s};
  float lower_px = 0.0f;
  if (showsTimeline()) lower_px = drawTimeline(*feed_->player(), feed_->playback());
  if (lower_px > 0.0f && ImGui::IsAnyItemActive()) used_s_ = now_s;
  if (panel_) drawPanel(content, controls_, lower_px, panel_);
  if (help_) drawHelp(feed_->player() != nullptr, help_);
  drawNotices(content, now_s - notice_since_s_ < kNotice_s ? notice_ : "", now_s < kFirst_s,
              lower_px);
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

/// The scene from outside, behind the frame.
void LiveWindow::showOutside() {
  if (isReady(outside_scene_)) {
    try {
      OutsideScene scene = outside_scene_.get();
      const LivePose camera = cameraBehind(scene.last, renderer_->state().study.eye.up);
      outside_ = std::make_unique<OutsideView>(std::move(scene), camera);
    } catch (const std::future_error&) {  // the renderer has told why there is none
    }
  }
  if (!outside_) return;
  const glm::ivec2 window_px = window_->frameBufferSize_px();
  outside_->update(window_px);
  const auto& image = outside_->image();
  if (!image) return;
  if (in_outside_texture_ != image) {
    if (!outside_texture_) outside_texture_.emplace();
    outside_texture_->set(image->size_px, image->rgb.data());
    in_outside_texture_ = image;
  }
  outside_texture_->fill({.size_px = window_px});
  constexpr int kInset = 4;  // of the window's width and height; chosen by hand
  const glm::ivec2 inset_px = Area::inside(window_px / kInset, area_.size_px).size_px;
  area_ = {{window_px.x - inset_px.x, 0}, inset_px};
  drawObserver(trail_, feed_->playback().path_m, frame_->record, outside_->view(), area_);
}

/// Fills the window, or its corner above the outside view. A headset's view keeps its shape. On a
/// screen the image is the study's whole screen; in a window of two such screens, one for each eye.
void LiveWindow::showFrame(const Study& study) {
  const bool of_headset = study.display.kind == DisplayKind::headset;
  const int views = headset_ ? 2 : 1;
  GpuTexture* const on_gpu = frame_->texture.get();
  const glm::ivec2 image_px = on_gpu ? on_gpu->size_px() : in_texture_->size_px;
  const glm::ivec2 view_px = image_px / glm::ivec2(views, 1);
  const glm::ivec2 window_px = window_->frameBufferSize_px();
  const Area both = Area::inside(window_px, viewsAcross(study.output.view) * screen_.size_px);
  area_ = of_headset                  ? Area::inside(window_px, view_px)
          : both.size_px == window_px ? both
                                      : Area::inside(window_px, screen_.size_px);
  showOutside();
  if (on_gpu) {
    texture_->fillFrom(on_gpu->beginShow(), image_px, area_, views);
    on_gpu->endShow();
  } else {
    texture_->fill(area_, views);
  }
  drawGazeRings(frame_->markers_px, !isFixating(frame_->record), view_px, area_);
  if (panel_ && !headset_) drawObjects(frame_->lines_px, image_px, area_);
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
  trail_.add(frame_->record, screen_);
  summary_.landings.add(frame_->record, timing.state_s, timing.in_full, swap_s);
  graph_.add(sample_ms, render_ms, 1e3 * (swap_s - timing.render_end_s));
  // The first frame after a record closes it.
  const auto record = frame_->record_file.lock();
  if (record_ && record_ != record) record_->close();
  record_ = record;
  if (record_) record_->add(frame_);
}

LiveSummary runLive(const Study& study, const LiveOptions& options,
                    std::optional<SceneFile> scene) {
  LiveWindow window(study, options, std::move(scene));
  return window.run();
}

}  // namespace foci
