#include "app/replay/replayed_eye.h"

#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "render/methods/quality_level.h"

namespace foci {

ReplayedEye::ReplayedEye(const Study& study, const ReplayedGaze& gaze, const Scene& scene,
                         Warnings& warnings)
    : study_(study),
      gaze_(gaze),
      warnings_(warnings),
      session_(sessionSettingsOf(study), scene, *gaze.trace.screen, gaze.trace.rate_Hz,
               gaze.trace.samples.front().time_s) {
  lookAtSkippedFrames();
}

/// @param known_s  the frame knows the samples up to this time
FrameRecord ReplayedEye::look(double time_s, double known_s) {
  const std::vector<GazeSample>& samples = gaze_.trace.samples;
  const std::vector<Change>& changes = gaze_.changes;
  for (; change_ < changes.size() && changes[change_].time_s <= time_s; ++change_) {
    changeLive(study_, session_, changes[change_].key, changes[change_].toml);
  }
  for (; sample_ < samples.size() && samples[sample_].time_s <= known_s; ++sample_) {
    session_.push(samples[sample_]);
  }
  return session_.look(time_s);
}

const std::string& ReplayedEye::methodOf(std::size_t frame) const {
  const Schedule& schedule = gaze_.schedule;
  return schedule.recorded.empty() ? study_.render.method
                                   : schedule.recorded[schedule.first + frame].method;
}

/// What the eye of a live run did before the first rendered frame counts, too.
void ReplayedEye::lookAtSkippedFrames() {
  const Schedule& schedule = gaze_.schedule;
  for (std::size_t i = 0; i < schedule.first; ++i) {
    FrameRecord record = look(schedule.recorded[i].time_s, schedule.recorded[i].known_s);
    if (study_.observer.pupil == PupilModel::luminance) {
      session_.render(schedule.recorded[i].method, record);
    }
  }
}

void ReplayedEye::requireSceneInView(const Scene& scene) const {
  constexpr std::size_t kMoments = 100, kPoints = 20'000;
  if (!gaze_.trace.samples.front().head) return;
  const std::span<const glm::vec3> all_m = scene.position_m();
  std::vector<glm::vec3> points_m;
  for (std::size_t i = 0; i < all_m.size(); i += 1 + all_m.size() / kPoints) {
    points_m.push_back(all_m[i]);
  }
  const std::size_t frames = gaze_.schedule.frames;
  for (std::size_t i = 0; i < frames; i += 1 + frames / kMoments) {
    if (session_.isInView(gaze_.schedule.time_s(i), points_m)) return;
  }
  throw InputError(study_.gaze.source,
                   "the recorded head never has the scene in view: expected a recording made in "
                   "this scene; state scene.scale_m, gaze.scene_rotation and gaze.scene_offset_m, "
                   "which foci trace info RECORDING --scene SCENE may find");
}

const Frame& ReplayedEye::see(std::size_t frame, SeenFrame& seen) {
  RenderedFrame& rendered = seeKept(frame, seen);
  session_.renderer().read(rendered);
  return rendered.frame;
}

RenderedFrame& ReplayedEye::seeKept(std::size_t frame, SeenFrame& seen) {
  seen.record = look(gaze_.schedule.time_s(frame), gaze_.schedule.known_s(frame));
  RenderedFrame& rendered = session_.renderKept(methodOf(frame), seen.record);
  seen.gaze_px = session_.gazePoints_px(seen.record);
  seen.marker = study_.output.marker;
  return rendered;
}

FrameRecord ReplayedEye::pass(std::size_t frame) {
  FrameRecord record = look(gaze_.schedule.time_s(frame), gaze_.schedule.known_s(frame));
  requireParts(frame);
  session_.pass(methodOf(frame), record);
  return record;
}

void ReplayedEye::requireParts(std::size_t frame) const {
  const std::string& method = methodOf(frame);
  if (choosesQuality(method) && study_.quality.frame_ms) {
    throw InputError("--frames",
                     "the frames depend on the time that they take; expected a study without "
                     "quality.frame_ms (--set quality.frame_ms=null)");
  }
  if (methodInfo(method).incremental) {
    throw InputError("--frames",
                     "method " + method + " needs the previous frame; expected another method");
  }
}

void ReplayedEye::warnOfRounding() {
  warnings_.add("the run was rendered on " + study_.record.device +
                ": the frames may differ from it in rounding");
}

void ReplayedEye::sayDevice() {
  const std::string device = session_.deviceOf(study_.render.method);
  say("renders on " + device);
  const std::string& recorded = study_.record.device;
  const bool same = recorded == device || recorded.starts_with(device + ", then ");
  if (!recorded.empty() && !same) warnOfRounding();
}

void ReplayedEye::addRemark() { warnings_.add(session_.deviceRemark()); }

void ReplayedEye::compareDevices() {
  const std::string& recorded = study_.record.device;
  if (!recorded.empty() && recorded != session_.devices()) warnOfRounding();
}

}  // namespace foci
