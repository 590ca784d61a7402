// Replays a recording into frames: what the eye sees ten times a second, as PFM files.
//     replay_recording SCENE.ply GAZE.tsv OUT_FOLDER
#include <cstdio>
#include <filesystem>

#include <foci/app/session/session.h>
#include <foci/base/input_error.h>
#include <foci/gaze/sources/trace_reader.h>
#include <foci/render/image/image_file.h>
#include <foci/render/scene/io/open_scene.h>

int main(int argc, char** argv) try {
  if (argc != 4) throw foci::InputError("replay_recording", "expected SCENE GAZE OUT_FOLDER");
  foci::SessionSettings settings;
  settings.observer.pupil_mm = 6.0;
  settings.path = foci::EyePath({{.position_m = {0, 0, 0}, .look_at_m = {0, 0, -1}, .up = {}}});
  settings.output.size_px = {640, 360};
  const foci::Scene scene = foci::openScene(argv[1], 1.0, glm::vec3(0.0f)).scene;
  const foci::GazeTrace trace = foci::readTrace(argv[2], {}, settings.screen);
  const double start_s = trace.samples.front().time_s, end_s = trace.samples.back().time_s;
  foci::Session session(settings, scene, *trace.screen, trace.rate_Hz, start_s);

  std::filesystem::create_directories(argv[3]);
  auto sample = trace.samples.begin();
  for (int i = 0; start_s + 0.1 * i <= end_s; ++i) {
    const double time_s = start_s + 0.1 * i;
    for (; sample != trace.samples.end() && sample->time_s <= time_s; ++sample) {
      session.push(*sample);
    }
    foci::FrameRecord record = session.look(time_s);
    const foci::Frame& frame = session.render(settings.method, record);
    foci::writeImage(std::filesystem::path(argv[3]) / (std::to_string(i) + ".pfm"), frame);
    std::printf("%.1f s: focus %.2f D\n", time_s, record.eye.focus_D);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
