// A method of one's own: `grey` renders by `sweep`, without colour. It stands among the methods.
//   own_method SCENE.ply OUT.png
#include <exception>
#include <iostream>

#include <foci/render/image/image_file.h>
#include <foci/render/methods/method.h>
#include <foci/render/scene/io/open_scene.h>

class Grey : public foci::Method {
 public:
  explicit Grey(const foci::SurfelCloud& cloud) : sweep_(foci::makeMethod("sweep", cloud)) {}

 private:
  foci::RenderStats renderFrame(const foci::View& view, const foci::RenderSettings& settings,
                                foci::Frame& frame) override {
    const foci::RenderStats stats = sweep_->render(view, settings, frame);
    for (glm::vec4& pixel : frame.rgba) {
      const float luminance = glm::dot(glm::vec3(pixel), glm::vec3(0.2126f, 0.7152f, 0.0722f));
      pixel = glm::vec4(glm::vec3(luminance), pixel.a);
    }
    return stats;
  }
  std::unique_ptr<foci::Method> sweep_;
};

int main(int argc, char** argv) try {
  if (argc != 3) throw std::invalid_argument("usage: own_method SCENE.ply OUT.png");
  foci::registerMethod({{"grey", "sweep without colour", "this program", foci::MethodFamily::own},
                        foci::makeAs<Grey>});
  for (const foci::MethodInfo& method : foci::methods()) std::cout << method.name << '\n';
  const foci::Scene scene = foci::openScene(argv[1], 1.0, glm::vec3(0, 0, 2)).scene;
  const glm::mat4 eye = foci::eyeFromWorld({0, 0, 2}, {0, 0, 0}, {0, 1, 0});
  foci::Frame frame;
  foci::makeMethod("grey", scene)->render(foci::viewOfCamera(eye, {64, 48}, 0.7), {}, frame);
  foci::writeImage(argv[2], frame);
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
