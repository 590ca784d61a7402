// A rendered image: its arrays, and the frames behind them.
#include <utility>

#include "base/input_error.h"
#include "base/parallel.h"
#include "python/bindings.h"
#include "python/scene.h"
#include "render/image/image_file.h"
#include "render/image/srgb.h"

namespace py = pybind11;

namespace foci {
namespace {

/// An array of the image's own memory, which keeps the image alive. Nobody may write to it, because
/// a session returns an unchanged frame again.
py::array viewOf(const py::object& image, std::vector<py::ssize_t> shape,
                 std::vector<py::ssize_t> strides, const float* data) {
  py::array view(py::dtype::of<float>(), std::move(shape), std::move(strides), data, image);
  view.attr("flags").attr("writeable") = false;
  return view;
}

py::array channelsOf(const py::object& self, py::ssize_t channels) {
  const Frame& frame = self.cast<const EyeImage&>().rendered->frame;
  constexpr py::ssize_t kPixel = sizeof(glm::vec4), kChannel = sizeof(float);
  return viewOf(self, {frame.size_px.y, frame.size_px.x, channels},
                {frame.size_px.x * kPixel, kPixel, kChannel}, &frame.rgba.data()->x);
}

const Frame& frameWithDepth(const EyeImage& image) {
  const Frame& frame = image.rendered->frame;
  if (frame.depth_m.empty()) {
    throw InputError("the image has no depth", "render it with depth=True");
  }
  return frame;
}

py::array depthOf(const py::object& self) {
  const Frame& frame = frameWithDepth(self.cast<const EyeImage&>());
  constexpr py::ssize_t kPixel = sizeof(float);
  return viewOf(self, {frame.size_px.y, frame.size_px.x}, {frame.size_px.x * kPixel, kPixel},
                frame.depth_m.data());
}

/// A map of the same size, from each pixel's distance. NaN where there is no surface.
template <typename Function>
py::array_t<float> mapOf(const EyeImage& image, const Function& function) {
  const Frame& frame = frameWithDepth(image);
  py::array_t<float> map({frame.size_px.y, frame.size_px.x});
  float* out = map.mutable_data();
  const py::gil_scoped_release released;
  parallelFor(static_cast<std::size_t>(frame.size_px.y), [&](std::size_t y) {
    const auto width = static_cast<std::size_t>(frame.size_px.x);
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      const float depth_m = frame.depth_m[i];
      out[i] = depth_m > 0.0f ? function(1.0f / depth_m) : std::numeric_limits<float>::quiet_NaN();
    }
  });
  return map;
}

const Defocus& defocusOf(const EyeImage& image) {
  return image.rendered->request.eyes.front().settings.defocus;
}

py::array_t<float> defocusMap(const EyeImage& image) {
  const float focus_D = defocusOf(image).focus_D;
  return mapOf(image, [focus_D](float point_D) { return point_D - focus_D; });
}

py::array_t<float> blurMap(const EyeImage& image) {
  const Defocus& defocus = defocusOf(image);
  return mapOf(image, [&defocus](float point_D) { return blurRadius_px(defocus, point_D).x; });
}

py::array_t<std::uint8_t> codes(const EyeImage& image, const std::optional<double>& gamma) {
  if (gamma) inRange("gamma", *gamma, 1.0, 4.0);
  const Frame& frame = image.rendered->frame;
  auto bytes = outsideInterpreter(
      [&] { return std::make_unique<std::vector<std::uint8_t>>(codesOf(frame, gamma)); });
  const std::uint8_t* data = bytes->data();
  const py::capsule owner(bytes.release(), [](void* owned) {
    delete static_cast<std::vector<std::uint8_t>*>(
        owned);  // NOLINT(cppcoreguidelines-owning-memory)
  });
  return py::array_t<std::uint8_t>({frame.size_px.y, frame.size_px.x, 3}, data, owner);
}

py::object asArray(const py::object& self, const py::object& dtype, const py::object& copy) {
  py::object array = channelsOf(self, 3);
  if (!dtype.is_none() && !py::dtype::from_args(dtype).is(py::dtype::of<float>())) {
    return array.attr("astype")(dtype);
  }
  if (!copy.is_none() && copy.cast<bool>()) return array.attr("copy")();
  return array;
}

void save(const EyeImage& image, const std::filesystem::path& file) {
  const py::gil_scoped_release released;
  checkImageExtension(file);
  writeImage(file, image.rendered->frame);
}

}  // namespace

std::shared_ptr<RenderedFrame> FramePool::take() {
  std::unique_ptr<RenderedFrame> frame;
  {
    const std::lock_guard lock(mutex_);
    if (!free_.empty()) {
      frame = std::move(free_.back());
      free_.pop_back();
    }
  }
  if (!frame) frame = std::make_unique<RenderedFrame>();
  return {frame.release(), [pool = shared_from_this()](RenderedFrame* returned) {
            pool->giveBack(std::unique_ptr<RenderedFrame>(returned));
          }};
}

void FramePool::giveBack(std::unique_ptr<RenderedFrame> frame) {
  const std::lock_guard lock(mutex_);
  if (free_.size() < kMaxFree) free_.push_back(std::move(frame));
}

void bindImage(py::module_& module) {
  py::class_<EyeImage>(
      module, "Image",
      "A rendered image. numpy.asarray(image) is `rgb`. Its arrays share the image's memory and "
      "are\nread-only.")
      .def_property_readonly(
          "rgb", [](const py::object& self) { return channelsOf(self, 3); },
          "Linear RGB, float32, shape (height, width, 3), top row first.")
      .def_property_readonly(
          "rgba", [](const py::object& self) { return channelsOf(self, 4); },
          "Linear RGB over the background and coverage (0 to 1), float32, "
          "shape (height, width, 4).")
      .def_property_readonly("depth_m", &depthOf,
                             "Distance from the eye, metres, float32, shape (height, width); 0 "
                             "where there is no surface.")
      .def_property_readonly(
          "defocus_D", &defocusMap,
          "1 / depth_m less the focus, dioptres, float32, shape (height, width): "
          "above 0 nearer\nthan the focus; NaN where there is no surface.")
      .def_property_readonly("blur_px", &blurMap,
                             "Blur radius along x, pixels, float32, shape (height, width); NaN "
                             "where there is no\nsurface.")
      .def(
          "srgb", &codes, py::arg("gamma") = py::none(),
          "Code values for a display, uint8, shape (height, width, 3). gamma: of the display, 1 to "
          "4;\nNone: sRGB.")
      .def("save", &save, py::arg("path"),
           "Write a .png (8 bits, sRGB), or a .pfm or .exr (linear float).")
      .def_property_readonly(
          "shape",
          [](const EyeImage& image) {
            const glm::ivec2& size_px = image.rendered->frame.size_px;
            return py::make_tuple(size_px.y, size_px.x, 3);
          },
          "(height, width, 3).")
      .def_property_readonly(
          "focus_D", [](const EyeImage& i) { return i.record.eye.focus_D; },
          "Focus of the eye, dioptres.")
      .def_property_readonly(
          "surface_distance_m", [](const EyeImage& i) { return i.record.eye.surface_distance_m; },
          "Distance of the surface at the gaze, metres; None if there is none.")
      .def_property_readonly(
          "pupil_mm", [](const EyeImage& i) { return i.record.pupil_mm; },
          "Diameter of the pupil, millimetres.")
      .def_property_readonly(
          "time_s", [](const EyeImage& i) { return i.record.time_s; },
          "Of a session's frame, seconds on the clock of its samples.")
      .def_property_readonly(
          "state", [](const EyeImage& i) { return nameOf(i.record.eye.state); },
          "State of the gaze: \"fixation\", \"saccade\", ...")
      .def_property_readonly(
          "rendered", [](const EyeImage& i) { return i.record.rendered; },
          "False: the session returned its previous frame again.")
      .def_property_readonly(
          "render_ms", [](const EyeImage& i) { return i.record.stats.ms; },
          "Time that the renderer took, milliseconds; 0 for a frame that was "
          "reused.")
      .def_property_readonly(
          "splats", [](const EyeImage& i) { return i.record.stats.splats; },
          "Number of splats that were rendered.")
      .def_property_readonly(
          "method", [](const EyeImage& i) { return i.record.method; },
          "The method that renders the same image again.")
      .def("__array__", &asArray, py::arg("dtype") = py::none(), py::arg("copy") = py::none())
      .def("__repr__", [](const EyeImage& image) {
        const glm::ivec2& size_px = image.rendered->frame.size_px;
        return std::string(
            py::str("<foci.Image {}x{}, focus {:.2f} D, pupil {:.1f} mm>")
                .format(size_px.x, size_px.y, image.record.eye.focus_D, image.record.pupil_mm));
      });
}

}  // namespace foci
