#include "python/scene.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/study/load_scene.h"
#include "app/study/study.h"
#include "base/input_error.h"
#include "base/mapped_file.h"
#include "python/bindings.h"
#include "python/eye.h"
#include "render/scene/estimation/estimate.h"

namespace py = pybind11;

namespace foci {
namespace {

/// Of the session that looks, whose images nobody sees: it is the quickest to make, and it has no
/// memory of earlier images.
constexpr const char* kLookingMethod = "pinhole";

std::vector<glm::vec3> vectorsOf(const char* argument, const Numbers& array, py::ssize_t rows,
                                 double limit) {
  const double* numbers = tableOf(argument, array, rows, 3);
  std::vector<glm::vec3> vectors(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double number = numbers[3 * i + static_cast<std::size_t>(k)];
      vectors[i][k] = static_cast<float>(inRange(argument, number, -limit, limit));
    }
  }
  return vectors;
}

std::shared_ptr<PythonScene> openFile(const std::filesystem::path& path, double scale_m,
                                      const std::optional<glm::vec3>& viewpoint_m) {
  inRange("scale_m", scale_m, 1e-9, 1e9);
  const py::gil_scoped_release released;
  requireRegularFile(path);
  endOnLostPagesUnlessHandled();
  return std::make_shared<PythonScene>(openScene(path, scale_m, viewpoint_m));
}

std::shared_ptr<PythonScene> fromPoints(const Numbers& position_m,
                                        const std::optional<Numbers>& color,
                                        const std::optional<Numbers>& normal,
                                        const std::optional<Numbers>& radius_m) {
  PointCloud points;
  points.position_m = vectorsOf("position_m", position_m, -1, kFarthest_m);
  if (points.position_m.empty()) throw InputError("position_m", "has no points");
  const auto rows = static_cast<py::ssize_t>(points.position_m.size());
  constexpr float kMidGrey = 0.5f;
  constexpr double kBrightest = 1e6;
  points.color.assign(points.size(), glm::vec3(kMidGrey));
  if (color) points.color = vectorsOf("color", *color, rows, kBrightest);
  for (const glm::vec3& each : points.color) {
    inRange("color", std::min({each.x, each.y, each.z}), 0.0, kBrightest);
  }
  if (normal) points.normal = vectorsOf("normal", *normal, rows, kFarthest_m);
  for (glm::vec3& each : points.normal) {
    const float length = glm::length(each);
    if (length > 0.0f) each /= length;
  }
  if (radius_m) {
    const double* radii = columnOf("radius_m", *radius_m, rows);
    for (py::ssize_t i = 0; i < rows; ++i) {
      points.radius_m.push_back(
          static_cast<float>(inRange("radius_m", radii[i], 0.0, kFarthest_m)));
    }
  }
  const py::gil_scoped_release released;
  return std::make_shared<PythonScene>(
      OpenedScene{.scene = {surfelsFromPoints(std::move(points))}});
}

EyeImage render(PythonScene& scene, const StillEye& eye, const Screen& screen,
                const std::optional<double>& focus_m, const std::optional<glm::dvec2>& gaze_px,
                const std::optional<glm::ivec2>& size_px, const std::string& method,
                const glm::dvec3& background, double shading, double tolerance, bool depth) {
  SessionSettings settings =
      settingsOf(eye, screen, {size_px, method, background, shading, tolerance});
  if (focus_m && gaze_px) throw InputError("focus_m and gaze_px", "give one of them");
  if (focus_m) {
    constexpr double kNearest_m = 0.05;
    inRange("focus_m", *focus_m, kNearest_m, std::numeric_limits<double>::infinity());
    settings.focus.fixed_D = 1.0 / *focus_m;
  }
  glm::dvec2 point_px = 0.5 * glm::dvec2(screen.size_px);
  if (gaze_px) {
    inRange("gaze_px[0]", gaze_px->x, 0.0, screen.size_px.x);
    inRange("gaze_px[1]", gaze_px->y, 0.0, screen.size_px.y);
    point_px = *gaze_px;
  }
  EyeImage image = outsideInterpreter([&] { return scene.render(settings, point_px, depth); });
  const auto& rgba = image.rendered->frame.rgba;
  if (std::ranges::all_of(rgba, [](const glm::vec4& pixel) { return pixel.a <= 0.0f; })) {
    Study study;
    study.eye.position_m = eye.position_m;
    study.eye.look_at_m = eye.look_at_m;
    study.eye.up = eye.up;
    for (const std::string& remark : viewRemarks(study, scene.scene())) warn(remark);
  }
  return image;
}

}  // namespace

PythonScene::PythonScene(OpenedScene&& opened)
    : opened_(std::move(opened)), renderer_(opened_.scene) {}

void renderInto(FrameRenderer& renderer, const RenderRequest& request,
                const std::shared_ptr<RenderedFrame>& frame, FrameRecord& record) {
  renderer.render(request, *frame);
  record.method = frame->method;
  record.stats = frame->stats;
  record.rendered = true;
}

EyeImage PythonScene::render(const SessionSettings& settings, const glm::dvec2& gaze_px,
                             bool depth) {
  const std::lock_guard lock(mutex_);
  SessionSettings looking = settings;
  looking.method = kLookingMethod;
  if (looking_) {
    looking_->changeSettings(looking);
  } else {
    constexpr double kRate_Hz = 1000.0;  // of no samples
    looking_.emplace(looking, opened_.scene, settings.screen, kRate_Hz, 0.0);
  }
  FrameRecord record = looking_->lookSettled(0.0, gaze_px);
  RenderRequest request = looking_->requestOf(settings.method, record);
  for (RenderRequest::Eye& eye : request.eyes) eye.settings.depth = depth;
  const std::shared_ptr<RenderedFrame> frame = frames_->take();
  renderInto(renderer_, request, frame, record);
  return {.rendered = frame, .record = std::move(record)};
}

void bindScene(py::module_& module) {
  py::class_<PythonScene, std::shared_ptr<PythonScene>>(
      module, "Scene", "Surfels in metres, right-handed, y up. Open a file, or pass points.")
      .def_static("open", &openFile, py::arg("path"), py::arg("scale_m") = 1.0,
                  py::arg("viewpoint_m") = py::none(),
                  "Open a PLY, OBJ, glTF, STL, FBX, LAS, .foci or text file.\n\n"
                  "scale_m: metres per unit of the file. viewpoint_m: (x, y, z); estimated normals "
                  "point there.")
      .def_static("from_points", &fromPoints, py::arg("position_m"), py::arg("color") = py::none(),
                  py::arg("normal") = py::none(), py::arg("radius_m") = py::none(),
                  "Surfels from points on a surface.\n\n"
                  "position_m: (N, 3), metres. color: (N, 3), linear RGB; None: mid-grey. normal: "
                  "(N, 3), any\nlength; None: estimated. radius_m: (N,), of discs that close the "
                  "gaps; None: estimated.")
      .def_property_readonly(
          "bounds_m", [](const PythonScene& s) { return boxOf(s.scene().position_m()); },
          "((x, y, z), (x, y, z)): the lowest and the highest coordinates.")
      .def_property_readonly(
          "remarks", [](const PythonScene& s) { return s.opened().remarks; },
          "What is worth knowing about the file, a sentence each.")
      .def("__len__", [](const PythonScene& s) { return s.scene().size(); })
      .def("__repr__", [](const PythonScene& s) {
        return "<foci.Scene of " + std::to_string(s.scene().size()) + " " +
               std::visit([](const auto& cloud) { return cloud.kNoun; }, s.scene().splats) + ">";
      });

  module.def(
      "render", &render, py::arg("scene"), py::arg("eye"), py::arg("screen") = defaultScreen(),
      py::kw_only(), py::arg("focus_m") = py::none(), py::arg("gaze_px") = py::none(),
      py::arg("size_px") = py::none(), py::arg("method") = "auto",
      py::arg("background") = glm::dvec3(0.0), py::arg("shading") = 0.0, py::arg("tolerance") = 1.0,
      py::arg("depth") = true,
      "Render what the eye sees through the screen.\n\n"
      "focus_m: distance of focus, metres, 0.05 to inf. gaze_px: (x, y) on the screen; the eye "
      "focuses the\nsurface there. Neither: the surface at the screen's centre. size_px: (width, "
      "height) of the image;\nNone: the screen's. method: see foci.methods(). background: linear "
      "RGB, 0 to 1. tolerance: error that\nmethod \"auto\" allows, just-noticeable differences. "
      "depth: also make depth_m, defocus_D and blur_px.\nOther Python threads run meanwhile.\n\n"
      "Returns an Image: float32 RGB of shape (height, width, 3), linear.\nRaises InputError.");
}

}  // namespace foci
