#include "app/evaluation/chart/cases.h"

#include <initializer_list>
#include <nlohmann/json.hpp>

#include "app/graphics/image.h"
#include "app/platform/json_text.h"
#include "base/text.h"
#include "render/image/image_file.h"
#include "render/methods/method.h"

namespace foci {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kReadme = R"(# Depth-of-field cases of foci

A folder here is a scene, and a folder in it a case: the scene through one aperture. Render cases
with your renderer, list the images in `times.json`, and see them on foci's chart of time against
accuracy. Lengths are metres. Case `CASE` as an example:

1. **Scene**: `SCENE/scene.ply` holds points with normals, sRGB colours and radii (not for a scene
   of Gaussians), `SCENE/gaussians.ply` 3D Gaussians, `SCENE/scene.glb` the mesh, where there is one.
   Colours are the light that leaves the surface: no lamps. `background_linear_rgb` in
   `CASE/case.json` is the light behind everything.
2. **Camera**: `SCENE/transforms.json` (as NeRF and Gaussian tools read it; axes of OpenGL), or the
   COLMAP model `SCENE/colmap`. The files of a scene share one frame. Pixel centres lie at +0.5.
3. **Lens**: `lens` in `CASE/case.json`: a thin lens with the diameter `aperture_m`. The plane at
   `focus_m` along the camera's axis is sharp. `f_number` is the same aperture for a sensor of
   36 mm and a focal length of `focal_length_m`, which is also the distance of the sensor.
   `one_point` states where the most blurred point lies, and the radius of its disc.
4. **Render** the image and, for a check of your camera, the image through a pinhole: EXR in linear
   light (primaries of sRGB), or PNG in sRGB. The pixel filter is close to a Gaussian with a
   standard deviation of 1 px. `SCENE/sharp.exr` and `CASE/reference.exr` show what to expect;
   `SCENE/depth.exr` holds depths along the axis, 0 for the background.
5. **List** the images in `times.json` here; `ms` is the time of one frame with the scene loaded:

       [{"name": "mine", "version": "1.0", "machine": "my computer", "ms": 12.5, "case": "CASE",
         "image": "mine.exr", "sharp": "mine_sharp.exr"}]

6. **Import**: `foci chartOPTIONS --import THIS_FOLDER --out out/chart`
)";

std::string readmeOf(const std::string& scene, const std::string& name,
                     const std::string& options) {
  std::string text = kReadme;
  for (const auto& [word, value] : std::initializer_list<std::pair<std::string, std::string>>{
           {"CASE", name}, {"SCENE", scene}, {"OPTIONS", options}}) {
    text = replaced(text, word, value);
  }
  return text;
}

/// The point of the scene whose disc is the largest that lies on the image.
Json mostBlurredPoint(const SceneInView& seen, const Defocus& lens) {
  Json found;
  float max_px = -1.0f;
  for (const glm::vec3& p_world : seen.scene.position_m()) {
    const glm::vec3 p(seen.view.eye_from_world * glm::vec4(p_world, 1.0f));
    if (-p.z < seen.view.near_m) continue;
    const float radius_px = blurRadius_px(lens, -1.0f / p.z).x;
    const glm::vec2 at = project(seen.view, p), size(seen.view.size_px);
    if (radius_px <= max_px || at != glm::clamp(at, glm::vec2(0.0f), size)) continue;
    max_px = radius_px;
    found = {{"world_m", {p_world.x, p_world.y, p_world.z}},
             {"image_px", {at.x, at.y}},
             {"depth_m", -p.z},
             {"blur_radius_px", radius_px}};
  }
  return found;
}

class SceneExport {
 public:
  SceneExport(const ChartPlan& plan, const ChartScene& scene, OutputFolder& output)
      : plan_(plan), scene_(scene), seen_(scene.make()), output_(output) {}

  void writeScene() {
    const auto write = [&](const char* name, const auto& write_to) {
      output_.write(scene_.id + "/" + name, write_to);
    };
    const SurfelCloud* const surfels = seen_.scene.surfels();
    if (surfels) {
      scene_files_.push_back("../scene.ply");
      write("scene.ply", [&](const fs::path& file) { writePoints(file, *surfels); });
    }
    scene_files_.push_back("../gaussians.ply");
    write("gaussians.ply", [&](const fs::path& file) { writeGaussians(file, seen_.scene); });
    if (scene_.truth == ChartTruth::triangles) {
      scene_files_.push_back("../scene.glb");
      write("scene.glb", [&](const fs::path& file) { writeGlb(file, *surfels->mesh); });
    }
    write("transforms.json", nerfTransforms(seen_.view, "sharp.png", surfels ? "scene.ply" : ""));
    const ColmapModel colmap = colmapModel(seen_.view, "sharp.png", seen_.scene);
    write("colmap/cameras.txt", colmap.cameras);
    write("colmap/images.txt", colmap.images);
    write("colmap/points3D.txt", colmap.points3D);

    Frame sharp;
    RenderSettings pinhole = seen_.settings;
    pinhole.depth = true;
    const std::string by =
        scene_.truth == ChartTruth::triangles ? plan_.reference(scene_, 0.0) : "pinhole";
    makeMethod(by, seen_.scene)->render(seen_.view, pinhole, sharp);
    for (std::size_t i = 0; i < sharp.rgba.size(); ++i) {
      if (sharp.rgba[i].a < 0.5f) sharp.depth_m[i] = 0.0f;
    }
    for (const char* name : {"sharp.exr", "sharp.png"}) {
      write(name, [&](const fs::path& file) { writeImage(file, sharp); });
    }
    write("depth.exr", [&](const fs::path& file) { writeMap(file, sharp.size_px, sharp.depth_m); });
  }

  void writeCase(double blur_px) {
    const double aperture_m = blur_px / seen_.largestBlurThrough_px(1.0);
    const RenderSettings settings = seen_.settingsThrough(aperture_m);
    const std::string method = plan_.reference(scene_, blur_px);
    Frame reference;
    const RenderStats stats =
        makeMethod(method, seen_.scene)->render(seen_.view, settings, reference);
    const Defocus& lens = settings.defocus;
    const glm::vec3& background = settings.lighting.background;
    const double focal_m = kSensorWidth_m * double{seen_.view.focal_px.x} / seen_.view.size_px.x;
    const Json json = {{"case", caseName(scene_, blur_px)},
                       {"key", plan_.key(scene_, blur_px)},
                       {"scene", scene_files_},
                       {"camera", {"../transforms.json", "../colmap"}},
                       {"image_px", {seen_.view.size_px.x, seen_.view.size_px.y}},
                       {"color_space", "linear light, primaries and white of sRGB"},
                       {"background_linear_rgb", {background.r, background.g, background.b}},
                       {"lens",
                        {{"focus_m", 1.0 / double{lens.focus_D}},
                         {"aperture_m", aperture_m},
                         {"f_number", focal_m / aperture_m},
                         {"focal_length_m", focal_m},
                         {"sensor_width_m", kSensorWidth_m},
                         {"formula", "blur radius = blur_radius_px_per_D |1/depth_m - 1/focus_m|"},
                         {"blur_radius_px_per_D", lens.radius_px_per_D.x},
                         {"one_point", mostBlurredPoint(seen_, lens)}}},
                       {"reference",
                        {{"file", "reference.exr"},
                         {"method", method},
                         {"split_half_psnr_dB", jsonNumber(stats.split_half_psnr_dB.value())}}},
                       {"sharp", {{"file", "../sharp.exr"}, {"depth_m", "../depth.exr"}}}};
    const std::string folder = caseName(scene_, blur_px) + "/";
    output_.write(folder + "case.json", jsonText(json, 1) + "\n");
    output_.write(folder + "reference.exr",
                  [&](const fs::path& file) { writeImage(file, reference); });
  }

 private:
  const ChartPlan& plan_;
  const ChartScene& scene_;
  SceneInView seen_;
  OutputFolder& output_;
  Json scene_files_ = Json::array();
};

}  // namespace

std::string caseName(const ChartScene& scene, double blur_px) {
  return scene.id + "/" + decimal(blur_px, 0) + "px";
}

std::vector<fs::path> exportedFiles(const ChartPlan& plan, const fs::path& folder) {
  std::vector<fs::path> files = {folder / "README.md"};
  for (const ChartScene& scene : plan.scenes) {
    for (const char* name :
         {"scene.ply", "gaussians.ply", "scene.glb", "transforms.json", "colmap/cameras.txt",
          "colmap/images.txt", "colmap/points3D.txt", "sharp.exr", "sharp.png", "depth.exr"}) {
      files.push_back(folder / scene.id / name);
    }
    for (const double blur_px : plan.blurs_px) {
      for (const char* name : {"case.json", "reference.exr"}) {
        files.push_back(folder / caseName(scene, blur_px) / name);
      }
    }
  }
  return files;
}

void exportCases(const ChartPlan& plan, const std::string& options, OutputFolder& output,
                 const std::function<void()>& on_step) {
  const ChartScene& first = plan.scenes.front();
  output.write("README.md", readmeOf(first.id, caseName(first, plan.blurs_px.front()), options));
  for (const ChartScene& scene : plan.scenes) {
    SceneExport cases(plan, scene, output);
    cases.writeScene();
    for (const double blur_px : plan.blurs_px) {
      cases.writeCase(blur_px);
      on_step();
    }
  }
}

}  // namespace foci
