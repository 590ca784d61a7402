#include "app/replay/replay.h"

#include <future>
#include <memory>

#include "app/graphics/image.h"
#include "app/platform/progress.h"
#include "app/record/later_image.h"
#include "app/replay/replayed_eye.h"
#include "app/study/inputs.h"
#include "app/study/load_scene.h"
#include "app/study/session_settings_of.h"
#include "base/parallel.h"

namespace foci {

const Scene& ReplayedScene::of(const Study& study, Warnings& warnings) {
  if (!scene_) {
    Warnings own;
    scene_ = loadScene(study, own, std::move(file_));
    warnings_ = own.all();
  }
  warnings.include(warnings_);
  return *scene_;
}

RunResult replay(const Study& asked, const std::filesystem::path& out, const std::string& command,
                 unsigned threads, ReplayedScene& shared, const OutputGuard& guard,
                 const std::optional<std::filesystem::path>& heatmap) {
  Warnings warnings;
  const ReplayedGaze gaze = readReplayedGaze(asked, warnings);
  const Study& study = gaze.study;
  const Scene& scene = shared.of(study, warnings);
  ReplayedEye eye(study, gaze, scene, warnings);
  eye.requireSceneInView(scene);
  InputHashes hashes(study, shared.hashed);
  warnings.add(eyeRemark(study));

  RunWriter writer(study, gaze, scene, out, guard, warnings);
  sayAssumptions(study, gaze.trace);
  eye.sayDevice();
  const std::size_t frames = gaze.schedule.frames;
  Progress progress("rendering", "frames", frames);
  LaterImage image;           // without marker
  std::future<void> written;  // the frame before, while this one is rendered
  FrameReading reading;       // destroyed before `written`, which waits for it
  FrameRenderer& renderer = eye.renderer();
  for (std::size_t i = 0; i < frames; ++i) {
    SeenFrame seen;
    RenderedFrame& rendered = eye.seeKept(i, seen);
    reading.finish(renderer);
    if (written.valid()) written.get();
    const std::optional<double> gamma = eye.study().screen.gamma;
    if (!study.output.maps.empty()) {
      renderer.read(rendered);
      writer.addMaps(i, seen, rendered.frame);
    }
    if (seen.record.rendered || !image.valid()) {
      image = rendered.on_gpu
                  ? reading.start(renderer, std::make_shared<RenderedFrame>(cloneOnGpu(rendered)),
                                  gamma)
                  : readyImage(imageOf(rendered.frame, gamma));
    }
    written = std::async(maxThreads() > 1 ? std::launch::async : std::launch::deferred,
                         [&writer, i, seen, image] { writer.add(i, seen, *image.get()); });
    progress.advance(i + 1);
  }
  reading.finish(renderer);
  if (written.valid()) written.get();
  eye.addRemark();
  eye.compareDevices();
  shared.hashed = hashes.get();
  return writer.finish({.command = command,
                        .threads = threads,
                        .device = eye.session().devices(),
                        .gaze = {},
                        .inputs = shared.hashed},
                       heatmap);
}

RunResult replay(const Study& study, const std::filesystem::path& out, const std::string& command,
                 unsigned threads) {
  ReplayedScene scene;
  return replay(study, out, command, threads, scene, OutputGuard());
}

}  // namespace foci
