#include "app/live/renderer.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/live/objects.h"
#include "app/record/gaze_marker.h"
#include "app/study/framing.h"
#include "app/study/load_scene.h"
#include "app/study/session_settings_of.h"
#include "app/study/study_text.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "render/lod/moment_tree.h"
#include "render/methods/method.h"
#include "render/methods/quality_level.h"

namespace foci {
namespace {

// Chosen by hand: the frame is ready this long before the window swaps buffers.
constexpr double kMargin_s = 0.0015;
constexpr double kTick_s = 1e-6;     // resolution of `LiveClock`
constexpr double kStill_D_s = 0.05;  // focus that moves no faster is at rest; chosen by hand
// Method auto learns the cost of its quality levels from each render. After so many renders at the
// same level another one brings nothing new.
constexpr int kAlike = 2;
constexpr int kPaused = 5;  // frames in which method auto chooses its quality level
constexpr auto kPause = std::chrono::milliseconds(4);  // between looks at a recording that pauses
constexpr std::size_t kMaxBacklog = 8;  // frames that wait for the disk: 50 MB at 1920 x 1080

std::string sceneName(const Study& study) {
  return study.scene.file ? study.scene.file->filename().string()
                          : "the scene " + study.scene.builtin;
}

/// The image with the frame's gaze markers, made by the first thread that needs it.
LaterImage marked(const LaterImage& plain, const LiveFrame& frame) {
  if (frame.markers_px.empty()) return plain;
  const auto draw = [plain, points_px = frame.markers_px, record = frame.record] {
    auto image = std::make_shared<Image>(*plain.get());
    drawGazeMarkers(points_px, record, *image);
    return std::shared_ptr<const Image>(std::move(image));
  };
  return std::async(std::launch::deferred, draw).share();
}

}  // namespace

std::string methodOfFrame(const Study& study, const FrameRecord& record) {
  const bool jumps = record.eye.state == GazeState::saccade;
  return jumps && !choosesQuality(study.render.method) ? "pinhole" : study.render.method;
}

LiveRenderer::LiveRenderer(const Study& study, GazeFeed& feed, const LiveClock& clock,
                           std::string command, unsigned threads, std::function<void()> ready,
                           std::optional<SceneFile> scene, std::future<SharedGpu> gpu,
                           LiveHeadAt head)
    : study_(study),
      feed_(feed),
      clock_(clock),
      command_(std::move(command)),
      threads_(threads),
      ready_(std::move(ready)),
      head_(std::move(head)),
      state_{.study = study},
      thread_([this, scene = std::move(scene),
               gpu = std::move(gpu)](const std::stop_token& stop) mutable {
        run(stop, std::move(scene), std::move(gpu));
      }) {}

LiveRenderer::~LiveRenderer() = default;

std::shared_ptr<LiveFrame> LiveRenderer::take(double next_s) {
  std::shared_ptr<LiveFrame> frame;
  {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    frame = std::exchange(laid_ready_, nullptr);
    if (frame) next_swap_s_ = next_s;
  }
  if (frame) {
    feed_.begin();
    changed_.notify_all();
  }
  return frame;
}

std::future<std::string> LiveRenderer::post(std::function<void()> action) {
  const auto answer = std::make_shared<std::promise<std::string>>();
  {
    const std::lock_guard lock(mutex_);
    commands_.push_back([this, answer, action = std::move(action)] {
      std::string failure;
      try {
        action();
      } catch (const std::exception& error) {
        failure = error.what();
      }
      {
        const std::lock_guard inner(mutex_);
        if (!failure.empty()) state_.notice = failure;
      }
      publish();
      answer->set_value(failure);
    });
  }
  changed_.notify_all();
  return answer->get_future();
}

std::future<std::string> LiveRenderer::change(const std::string& key, const std::string& toml) {
  return post([this, key, toml] {
    if (head_ && !feed_.player() && key == "output.view") {
      throw InputError(key, "does not change in a headset, which shows both eyes");
    }
    changeLive(study_, *session_, key, toml);
    if (key.starts_with("eye.")) noteView();
    if (const std::string remark = eyeRemark(study_); !remark.empty()) tell(remark);
    // The next frame is the first with the new value. Its time is not before now.
    if (state_.record) {
      state_.record->add(Change{std::max(now_s(), last_frame_s_ + kTick_s), key, toml});
    }
  });
}

std::future<std::string> LiveRenderer::placeObject(const glm::dvec2& point_px) {
  return post([this, point_px] {
    const auto point_m = session_->surfaceUnder_m(last_frame_s_, point_px);
    if (!point_m) throw std::runtime_error("no surface under the pointer");
    std::vector<NamedShape>& objects = study_.scene.objects;
    objects.push_back(objectAt(*point_m, glm::distance(*point_m, last_.eye_m), objects));
    tell(objects.back().name + " placed; F2 saves the study");
  });
}

std::future<std::string> LiveRenderer::setObjects(std::vector<NamedShape> objects) {
  return post([this, objects = std::move(objects)] { study_.scene.objects = objects; });
}

std::future<std::string> LiveRenderer::saveStudy(const std::filesystem::path& file) {
  return post([this, file] {
    writeText(file, annotatedStudyToml(study_, file.parent_path(), "Saved by foci live."));
    tell("study in " + file.string());
  });
}

std::future<std::string> LiveRenderer::startRecord(const std::filesystem::path& folder) {
  return post([this, folder] {
    if (state_.record) throw std::runtime_error("a record is running");
    std::string device = session_->deviceOf(study_.render.method);
    auto record = std::make_shared<LiveRecord>(folder, study_, feed_.screen(), feed_.rate_Hz(),
                                               command_, threads_, device);
    for (const auto* warnings : {&feed_.warnings(), &warnings_.all()}) {
      for (const std::string& warning : *warnings) record->addWarning(warning);
    }
    devices_ = std::move(device);
    if (TracePlayer* const player = feed_.player()) {
      player->takePoints();
      record->play(feed_.playback().file, player->point());
    }
    // A replay of the record knows nothing of what happened before.
    news_.clear();
    feed_.take(news_);
    session_start_s_ = wholeMicroseconds(std::max(now_s(), last_frame_s_ + kTick_s));
    if (head_) {
      record->add(beginPath(session_start_s_));
      session_->changeSettings(sessionSettingsOf(study_));
    }
    session_->restart(session_start_s_);
    const GazeSample first{.time_s = session_start_s_};
    session_->push(first);
    record->add(first);
    if (feed_.holds()) record->addMarker(session_start_s_, "gaze is held");
    last_sample_s_ = session_start_s_;
    dropped_before_ = feed_.reception().dropped;
    const std::lock_guard lock(mutex_);
    state_.record = std::move(record);
    state_.notice = "recording to " + folder.string();
  });
}

std::future<std::string> LiveRenderer::stopRecord() {
  return post([this] {
    if (!state_.record) throw std::runtime_error("no record is running");
    const auto failure = state_.record->failure();
    closeRecord();
    if (failure) throw std::runtime_error(*failure);
  });
}

/// Tells the record what rendered its frames so far.
void LiveRenderer::noteDevices() {
  if (!state_.record) return;
  std::string devices = session_->devices();
  if (devices == devices_) return;
  state_.record->setDevices(devices);
  devices_ = std::move(devices);
}

void LiveRenderer::closeRecord() {
  if (!state_.record) return;
  noteDevices();  // the GPU may have failed while it was read
  // The record holds every sample that arrived before its end.
  feed_.waitForPoll();
  takeGaze();
  pushGaze();
  state_.record->setReception(receptionSince(session_start_s_));
  const std::lock_guard lock(mutex_);
  state_.notice = "record in " + state_.record->folder().string();
  closing_.push_back(std::exchange(state_.record, nullptr));
}

std::future<LaterImage> LiveRenderer::pixelsOf(std::shared_ptr<const LiveFrame> frame) {
  const auto answer = std::make_shared<std::promise<LaterImage>>();
  auto image = answer->get_future();
  post([this, answer, frame = std::move(frame)] {
    if (frame->image.valid()) {
      answer->set_value(frame->image);
      return;
    }
    session_->renderer().read(*frame->on_gpu);
    answer->set_value(
        marked(readyImage(imageOf(frame->on_gpu->frame, study_.screen.gamma)), *frame));
  });
  return image;
}

std::future<OutsideScene> LiveRenderer::outside() {
  const auto answer = std::make_shared<std::promise<OutsideScene>>();
  post([this, answer] {
    RenderRequest request = session_->requestOf(textOf(QualityLevel::sharp), last_);
    request.stereo = StereoView::mono;
    request.split = false;
    request.eyes.resize(1);
    RenderSettings& settings = request.eyes[0].settings;
    settings = {.defocus = {}, .lighting = settings.lighting};
    answer->set_value(
        {session_->cloneRenderer(), std::move(request), std::max(threads_, 2u) - 1, last_});
  });
  return answer->get_future();
}

double LiveRenderer::addMarker(const std::string& text) {
  const double time_s = now_s();
  const std::lock_guard lock(mutex_);
  state_.notice = "event marker: " + text + (state_.record ? "" : " (no record is running)");
  if (state_.record) state_.record->addMarker(time_s, text);
  return time_s;
}

LiveState LiveRenderer::state() const {
  GazeReception reception = feed_.reception();
  const std::lock_guard lock(mutex_);
  LiveState state = state_;
  state.reception = std::move(reception);
  if (feed_.player()) state.playing = feed_.player()->state();
  return state;
}

/// How the gaze of the record has arrived.
GazeReception LiveRenderer::receptionSince(double start_s) const {
  GazeReception reception = feed_.reception();
  reception.dropped -= dropped_before_;
  std::erase_if(reception.unused, [&](const UnusedGaze& time) { return time.to_s < start_s; });
  if (reception.clock) {
    std::vector<ClockStep>& steps = reception.clock->latest_steps;
    const std::size_t before =
        std::erase_if(steps, [&](const ClockStep& step) { return step.time_s < start_s; });
    reception.clock->steps -= std::min(before, reception.clock->steps);
  }
  return reception;
}

void LiveRenderer::tell(const std::string& notice) {
  const std::lock_guard lock(mutex_);
  state_.notice = notice;
}

void LiveRenderer::noteEnd(LiveRecord& record) {
  if (const auto failure = record.end()) {
    failed_records_.push_back("the record in " + record.folder().string() +
                              " is incomplete: " + *failure);
  } else {
    records_.push_back(record.folder());
  }
}

void LiveRenderer::finish(std::vector<std::filesystem::path>& records,
                          std::vector<std::string>& failed) {
  thread_.request_stop();
  thread_.join();
  for (const auto& record : closing_) noteEnd(*record);
  records = records_;
  failed = failed_records_;
}

void LiveRenderer::sayOpening(const std::string& what) {
  const std::lock_guard lock(mutex_);
  state_.opening = what;
}

void LiveRenderer::publish() {
  const std::lock_guard lock(mutex_);
  state_.study = study_;
}

/// Notes whether the eye sees the scene, after a change of its place. An eye on a path finds its
/// own way.
void LiveRenderer::noteView() {
  const bool in_view = head_ || !study_.eye.path.empty() || isSceneInView(study_, outlined());
  const std::lock_guard lock(mutex_);
  state_.in_view = in_view;
}

void LiveRenderer::run(const std::stop_token& stop, std::optional<SceneFile>&& file,
                       std::future<SharedGpu>&& gpu) {
  try {
    sayOpening("opening " + sceneName(study_));
    scene_ = loadScene(study_, warnings_, std::move(file));
    sayOpening("preparing " + sceneName(study_));
    outline_ = outlineOf(*scene_);
    noteView();
    const double scene_m = boxWithoutStrays(outlined().position_m()).longest();
    {
      const std::lock_guard lock(mutex_);
      state_.scene_m = scene_m;
      state_.methods = methodsFor(*scene_);
    }
    const SharedGpu window_gpu = gpu.valid() ? gpu.get() : nullptr;
    session_start_s_ = now_s();
    if (head_) beginPath(session_start_s_);
    session_ = std::make_unique<Session>(sessionSettingsOf(study_), *scene_, feed_.screen(),
                                         feed_.rate_Hz(), session_start_s_, window_gpu);
    shows_textures_ = window_gpu && session_->renderer().gpu() == window_gpu;
    say("renders on " + session_->deviceOf(study_.render.method));
    sayOpening("rendering the first frame");
    renderFrames(stop);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  if (session_) reading_.finish(session_->renderer());
  closeRecord();
  std::deque<Command> never;  // their promises break
  {
    const std::lock_guard lock(mutex_);
    never.swap(commands_);
  }
  never.clear();
  ready_();
}

void LiveRenderer::renderFrames(const std::stop_token& stop) {
  tbb::task_arena arena(static_cast<int>(threads_));
  while (waitForRoom(stop)) {
    std::shared_ptr<LiveFrame> frame;
    arena.execute([&] { frame = renderFrame(); });
    {
      const std::lock_guard lock(mutex_);
      state_.last = frame->record;
      if (const std::string remark = session_->deviceRemark(); remark != device_remark_) {
        state_.notice = device_remark_ = remark;
        if (!remark.empty()) {
          warnings_.add(remark);
          if (state_.record) state_.record->addWarning(remark);
        }
      }
      noteDevices();
      laid_ready_ = std::move(frame);
    }
    ready_();
  }
}

/// Whether another frame may differ from the last one. While a recording pauses, none does after
/// the first few but those that the refiner has rendered.
bool LiveRenderer::hasNews() const {
  const bool goes_on = (last_.rendered || paused_frames_ == 0) &&
                       (paused_frames_ < kPaused || methodInfo(study_.render.method).incremental);
  return now_s() > last_frame_s_ || goes_on || (refiner_ && refiner_->done() != refined_);
}

/// Waits until the last frame has been taken and the next one is due. Carries out commands.
/// @return false to stop
bool LiveRenderer::waitForRoom(const std::stop_token& stop) {
  const double cost_s = cost_s_.contains(last_method_) ? cost_s_.at(last_method_) : 0.0;
  while (!stop.stop_requested()) {
    std::deque<Command> commands;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stop, [&] { return !laid_ready_ || !commands_.empty(); });
      if (!laid_ready_ && commands_.empty()) {
        const auto start = clock_.at(next_swap_s_ - cost_s - kMargin_s);
        changed_.wait_until(lock, stop, start, [&] { return !commands_.empty(); });
      }
      const bool busy = state_.record && state_.record->backlog() > kMaxBacklog;
      if (busy && commands_.empty()) {  // the disk is slower than the rendering
        changed_.wait_for(lock, stop, std::chrono::milliseconds(5), [] { return false; });
        continue;
      }
      std::swap(commands, commands_);
    }
    reading_.finish(session_->renderer());
    if (commands.empty() && !hasNews()) {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, stop, kPause, [&] { return !commands_.empty(); });
      continue;
    }
    if (commands.empty()) return !stop.stop_requested();
    for (const Command& command : commands) command();
    paused_frames_ = 0;
    // A record is destroyed once it is written or has failed: its destructor would wait.
    std::erase_if(closing_, [this](const auto& record) {
      if (!record->finished()) return false;
      noteEnd(*record);
      return true;
    });
  }
  return false;
}

/// The sample as the record and its replay will have it.
GazeSample LiveRenderer::asRecorded(GazeSample sample) const {
  // The limits of gaze/sources/table_row.cpp, beyond which a replay would refuse the record.
  constexpr double kMaxPoint_px = 1e5, kMaxPupil_mm = 15.0, kMaxUncertainty_deg = 45.0;
  const auto plausible = [&](std::optional<glm::dvec2>& point_px) {
    if (point_px && !(glm::length(*point_px) <= kMaxPoint_px)) point_px.reset();
  };
  if (sample.blink) sample.point_px.reset();
  plausible(sample.point_px);
  if (sample.pupil_mm && !(*sample.pupil_mm > 0.0 && *sample.pupil_mm <= kMaxPupil_mm)) {
    sample.pupil_mm.reset();
  }
  if (sample.uncertainty_deg) {
    sample.uncertainty_deg = std::clamp(*sample.uncertainty_deg, 0.0, kMaxUncertainty_deg);
  }
  for (EyeSample& eye : sample.eyes) {
    if (!eye.point_px && eye.direction) {
      eye.point_px = pointOnScreen_px(feed_.screen(), *eye.direction);
    }
    plausible(eye.point_px);
    eye = {.point_px = eye.point_px};
  }
  sample.time_s =
      wholeMicroseconds(std::max(sample.time_s, last_sample_s_.value_or(0.0) + kTick_s));
  return sample;
}

/// The head's path begins anew: a replay of a record knows no earlier pose.
HeadRow LiveRenderer::beginPath(double time_s) {
  const HeadInWorld head = head_(study_, time_s).in_scene;
  last_pose_s_ = time_s;
  study_.eye.recorded = EyePath(std::vector<TrackedPose>{
      {.position_m = head.position_m, .world_from_eye = head.world_from_head}});
  return {.time_s = time_s, .head = head};
}

/// Moves the eye to where the head is when the frame is shown.
LiveHead LiveRenderer::followHead(double time_s, double now_s) {
  for (const GazeSample& sample : news_) {
    if (feed_.player() && sample.head && sample.time_s < time_s) {
      addPose(sample.time_s, *sample.head);
    }
  }
  // While a recording pauses, frames have later times, but the head rests.
  LiveHead head = head_(study_, std::min(time_s, now_s));
  head.displays = study_.headsetEyes();
  addPose(time_s, head.in_scene);
  return head;
}

/// The next pose of the head's path, which the record has too.
void LiveRenderer::addPose(double time_s, const HeadInWorld& head) {
  if (time_s <= last_pose_s_) return;
  last_pose_s_ = time_s;
  study_.eye.recorded->add({.time_s = time_s - session_start_s_,
                            .position_m = head.position_m,
                            .world_from_eye = head.world_from_head});
  if (state_.record) state_.record->add(HeadRow{.time_s = time_s, .head = head});
}

/// Takes the samples that have arrived. @return the time up to which they have
double LiveRenderer::takeGaze() {
  news_.clear();
  const double now_s = feed_.take(news_);
  // Those before were measured before the record began.
  std::erase_if(news_, [&](const GazeSample& each) { return each.time_s < session_start_s_; });
  for (GazeSample& each : news_) {
    each = asRecorded(each);
    last_sample_s_ = each.time_s;
  }
  return now_s;
}

/// Gives them to the eye. A head's pose up to their times is known, as it is in the replay.
void LiveRenderer::pushGaze() {
  if (TracePlayer* const player = feed_.player()) {
    for (const PlayPoint& point : player->takePoints()) {
      if (state_.record) state_.record->add(point);
    }
  }
  for (const GazeSample& sample : news_) {
    session_->push(sample);
    if (!state_.record) continue;
    state_.record->add(sample);
    if (!sample.head) continue;
    state_.record->add(HeadRow{.time_s = sample.time_s,
                               .of_sample = true,
                               .inferred = sample.inferred,
                               .head = *sample.head});
  }
}

/// Under a frame-time budget, has the refiner render at full quality. It renders the frame of an
/// eye at rest, and ahead of time the frame of a focus that will come to rest.
/// @return whether rendering the request again would bring nothing new
bool LiveRenderer::refine(const RenderRequest& request, const FrameRecord& record) {
  if (!request.hasTimeBudget()) {
    refiner_.reset();
    return false;
  }
  if (session_->renderer().gpu() && last_.stats.full_quality) {  // every frame is in full
    if (refiner_) refiner_->want({});
    return request == last_request_;
  }
  if (!refiner_) {
    // It leaves one core to the frame loop, which would wait for its own work behind the refiner's.
    refiner_ = std::make_unique<Refiner>(session_->cloneRenderer(), std::max(threads_, 2u) - 1);
  }
  const bool same = request == last_request_;
  if (!request.sameViews(last_request_)) {
    refiner_->want({});
  } else if (record.eye.state != GazeState::saccade) {  // the same requests are wanted after it
    const double moved_D = std::abs(record.eye.focus_D - last_.eye.focus_D);
    const bool rests = paused_frames_ > 0 || moved_D <= kStill_D_s * (record.time_s - last_.time_s);
    const RenderRequest at_rest = session_->requestAtRest(last_method_, record);
    std::vector<RenderRequest> wanted;
    if ((rests || request == at_rest) && !session_->hasFullQuality(request))
      wanted.push_back(request);
    if (request != at_rest) wanted.push_back(at_rest);
    refiner_->want(std::move(wanted));
  }
  const std::uint64_t refined = refiner_->done();
  const bool news = refined != std::exchange(refined_, refined);
  if (session_->hasFullQuality(request)) return same;
  if (auto rendered = refiner_->take(request)) {
    session_->adopt(request, *rendered);
    refiner_->reuse(std::move(*rendered));
    return false;
  }
  return same && !news && alike_ >= kAlike;
}

std::shared_ptr<LiveFrame> LiveRenderer::renderFrame() {
  auto frame = std::make_shared<LiveFrame>();
  FrameTiming& timing = frame->timing;
  const double now_s = takeGaze();
  timing.render_start_s = clock_.now_s();
  const double time_s =
      std::max({now_s, last_sample_s_.value_or(0.0), wholeMicroseconds(last_frame_s_ + kTick_s)});
  if (head_) frame->head = followHead(time_s, now_s);
  pushGaze();
  frame->record = session_->look(time_s);
  const GazeState state = frame->record.eye.state;
  feed_.look(state != GazeState::lost && state != GazeState::blink);
  const auto onClock_s = [&](double then_s) {  // the run's
    const TracePlayer* player = feed_.player();
    return player ? timing.render_start_s - (now_s - then_s) / player->state().speed : then_s;
  };
  if (frame->record.eye.sample) timing.sample_s = onClock_s(frame->record.eye.sample->time_s);
  timing.state_s = onClock_s(frame->record.eye.state_time_s);
  last_method_ = methodOfFrame(study_, frame->record);
  const RenderRequest request = session_->requestOf(last_method_, frame->record);
  const bool again = refine(request, frame->record);
  // On a GPU the frame would wait for the refiner, which may hold the device.
  std::unique_lock<Gate> first;
  if (refiner_ && !session_->renderer().gpu()) first = std::unique_lock(refiner_->gate());
  RenderedFrame& rendered = session_->renderKept(request, frame->record, again);
  if (!shows_textures_) session_->renderer().read(rendered);
  alike_ = request == last_request_ && frame->record.method == last_.method ? alike_ + 1 : 0;
  fill(*frame, rendered);
  if (first) first.unlock();
  last_request_ = request;
  last_ = frame->record;
  paused_frames_ = time_s > now_s ? paused_frames_ + 1 : 0;
  timing.in_full = frame->record.stats.full_quality && last_method_ == study_.render.method;
  last_frame_s_ = time_s;
  frame->record_file = state_.record;
  timing.render_end_s = clock_.now_s();
  // A frame reused in a saccade costs nothing, but the frame after the landing will.
  if (last_.rendered || last_.eye.state != GazeState::saccade) {
    cost_s_[last_method_] = timing.render_end_s - timing.render_start_s;
  }
  return frame;
}

/// A texture, an image, or both: a record needs the image.
void LiveRenderer::fill(LiveFrame& frame, RenderedFrame& rendered) {
  const std::optional<double> gamma = study_.screen.gamma;
  if (frame.record.rendered) {
    texture_ = nullptr;
    on_gpu_ = nullptr;
    plain_ = {};
  }
  if (rendered.on_gpu && !texture_) {
    texture_ = session_->renderer().textureOf(rendered, gamma);
    if (texture_) on_gpu_ = std::make_shared<RenderedFrame>(cloneOnGpu(rendered));
  }
  if (!plain_.valid() && (!texture_ || state_.record)) {
    plain_ = texture_ ? reading_.start(session_->renderer(), on_gpu_, gamma)
                      : readyImage(imageOf(rendered.frame, gamma));
  }
  frame.texture = texture_;
  frame.on_gpu = on_gpu_;
  if (study_.output.marker) frame.markers_px = session_->gazePoints_px(frame.record);
  frame.plain = plain_;
  if (plain_.valid()) frame.image = marked(plain_, frame);
  if (study_.scene.objects.empty()) return;
  std::vector<glm::vec3> ends_m;
  for (const NamedShape& object : study_.scene.objects) {
    const auto lines_m = linesOf(object);
    ends_m.insert(ends_m.end(), lines_m.begin(), lines_m.end());
  }
  frame.lines_px = session_->linesInImage_px(frame.record.time_s, ends_m);
}

}  // namespace foci
