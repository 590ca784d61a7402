// Renders a PLY point cloud from 2 m in front of its origin, through a 4 mm pupil focused at a
// given distance:
//   render_ply SCENE.ply FOCUS_METRES OUT.png
#include <cstdlib>
#include <exception>
#include <iostream>

#include <foci/render/image/image_file.h>
#include <foci/render/methods/method.h>
#include <foci/render/scene/io/open_scene.h>

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::cerr << "usage: render_ply SCENE.ply FOCUS_METRES OUT.png\n";
    return 2;
  }
  char* end = nullptr;
  const double focus_m = std::strtod(argv[2], &end);
  if (*end != '\0' || !(focus_m > 0.0)) {
    std::cerr << "FOCUS_METRES " << argv[2] << ": expected metres above 0, or inf\n";
    return 2;
  }
  const glm::vec3 eye_m{0.0f, 0.0f, 2.0f};
  const foci::Scene scene = foci::openScene(argv[1], 1.0, eye_m).scene;
  const glm::mat4 eye_from_world =
      foci::eyeFromWorld(eye_m, glm::vec3{0.0f}, glm::vec3{0.0f, 1.0f, 0.0f});
  const foci::View view = foci::viewOfCamera(eye_from_world, {640, 480}, glm::radians(40.0));
  foci::RenderSettings settings;
  settings.defocus =
      foci::defocusOfLens(0.004, view.focal_px, 1.0 / focus_m, foci::DistanceAlong::sight);

  foci::Frame frame;
  const auto method = foci::makeMethod("auto", scene);
  const foci::RenderStats stats = method->render(view, settings, frame);
  foci::writeImage(argv[3], frame);
  std::cout << scene.position_m().size() << " surfels, " << stats.ms << " ms\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
