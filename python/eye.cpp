#include "python/eye.h"

#include "base/input_error.h"
#include "python/bindings.h"
#include "render/methods/method.h"

namespace py = pybind11;

namespace foci {
namespace {

// The ranges are those of the study's keys.
constexpr double kFar_m = 1e6;

glm::dvec3 checkedPoint(const char* argument, const glm::dvec3& point_m) {
  for (int axis = 0; axis < 3; ++axis) inRange(argument, point_m[axis], -kFar_m, kFar_m);
  return point_m;
}

Screen makeScreen(const glm::ivec2& size_px, const glm::dvec2& size_m, double distance_m) {
  for (const int side : {size_px.x, size_px.y}) inRange("size_px", side, 16, 16384);
  for (const double side : {size_m.x, size_m.y}) inRange("size_m", side, 0.01, 20.0);
  inRange("distance_m", distance_m, 0.01, 100.0);
  return {.size_px = size_px, .size_m = size_m, .distance_m = distance_m};
}

/// The second order belongs to sphere_D and cylinder_D, as in a study whose observer wears glasses.
Wavefront wavefrontOf(const std::vector<double>& zernike_um,
                      const std::optional<double>& pupil_mm) {
  if (zernike_um.empty()) return {};
  if (!pupil_mm) {
    throw InputError("wavefront_um", "expected wavefront_pupil_mm, too, the pupil it holds for");
  }
  if (static_cast<int>(zernike_um.size()) > zernikeCount(kMaxZernikeOrder)) {
    throw InputError("wavefront_um",
                     "expected at most 66 coefficients, in the order of OSA and ANSI");
  }
  for (const double um : zernike_um) inRange("wavefront_um", um, -50.0, 50.0);
  inRange("wavefront_pupil_mm", *pupil_mm, 1.0, 12.0);
  return withoutRefraction({.zernike_um = zernike_um, .pupil_m = *pupil_mm / 1000.0});
}

StillEye makeEye(double pupil_mm, const glm::dvec3& position_m, const glm::dvec3& look_at_m,
                 const glm::dvec3& up, const std::optional<double>& age_years, double sphere_D,
                 double cylinder_D, double axis_deg, bool chromatic,
                 const std::vector<double>& wavefront_um,
                 const std::optional<double>& wavefront_pupil_mm, bool stiles_crawford,
                 bool diffraction) {
  StillEye eye{.position_m = checkedPoint("position_m", position_m),
               .look_at_m = checkedPoint("look_at_m", look_at_m),
               .up = checkedPoint("up", up),
               .pupil_mm = inRange("pupil_mm", pupil_mm, 0.0, 12.0),
               .age_years = age_years,
               .prescription = {.sphere_D = inRange("sphere_D", sphere_D, -20.0, 20.0),
                                .cylinder_D = inRange("cylinder_D", cylinder_D, -10.0, 10.0),
                                .axis_deg = inRange("axis_deg", axis_deg, 0.0, 180.0)},
               .chromatic = chromatic,
               .wavefront = wavefrontOf(wavefront_um, wavefront_pupil_mm),
               .stiles_crawford = stiles_crawford,
               .diffraction = diffraction};
  if (age_years) inRange("age_years", *age_years, 1.0, 120.0);
  // A path that cannot be looked along is refused here, not at the first image.
  pathOf(eye).eyeFromWorldAt(0.0);
  return eye;
}

std::string textOf(const Screen& screen) {
  return py::str("Screen(size_px=({}, {}), size_m=({:g}, {:g}), distance_m={:g})")
      .format(screen.size_px.x, screen.size_px.y, screen.size_m.x, screen.size_m.y,
              screen.distance_m);
}

std::string textOf(const StillEye& eye) {
  return py::str("Eye(pupil_mm={:g}, position_m={}, look_at_m={})")
      .format(eye.pupil_mm, py::list(py::cast(eye.position_m)), py::list(py::cast(eye.look_at_m)));
}

}  // namespace

EyePath pathOf(const StillEye& eye) {
  return EyePath({{.position_m = eye.position_m, .look_at_m = eye.look_at_m, .up = {}}}, eye.up,
                 "Eye");
}

SessionSettings settingsOf(const StillEye& eye, const Screen& screen,
                           const PictureOptions& options) {
  SessionSettings settings;
  for (int k = 0; k < 3; ++k) inRange("background", options.background[k], 0.0, 1.0);
  settings.lighting.background = glm::vec3(options.background);
  settings.lighting.shading = static_cast<float>(inRange("shading", options.shading, 0.0, 1.0));
  settings.path = pathOf(eye);
  settings.screen = screen;
  settings.observer.pupil_mm = eye.pupil_mm;
  settings.observer.refraction = refractionOf(eye.prescription);
  settings.observer.chromatic = eye.chromatic;
  settings.observer.wavefronts = {eye.wavefront, eye.wavefront};
  settings.observer.stiles_crawford = eye.stiles_crawford;
  settings.observer.diffraction = eye.diffraction;
  settings.focus.accommodation.age_years = eye.age_years;
  settings.method = options.method;
  settings.device = RenderDevice::cpu;  // a session in Python renders in the thread that asks
  settings.quality.tolerance = inRange("tolerance", options.tolerance, 0.1, 100.0);
  settings.output.size_px = screen.size_px;
  if (options.size_px) settings.output.size_px = *options.size_px;
  for (const int side : {settings.output.size_px.x, settings.output.size_px.y}) {
    inRange("size_px", side, 16, 8192);
  }
  if (const auto expected = expectedMethod(options.method)) {
    throw InputError("method = " + options.method, "expected " + *expected);
  }
  return settings;
}

void bindScreenAndEye(py::module_& module) {
  const Screen usual = defaultScreen();
  py::class_<Screen>(module, "Screen",
                     "A flat screen whose centre the eye faces.\n\n"
                     "size_px: (width, height) in pixels. size_m: (width, height) in metres.\n"
                     "distance_m: from the eye to the screen's centre, metres.")
      .def(py::init(&makeScreen), py::arg("size_px") = glm::ivec2(1920, 1080),
           py::arg("size_m") = usual.size_m, py::arg("distance_m") = usual.distance_m)
      .def_readonly("size_px", &Screen::size_px, "(width, height), pixels.")
      .def_readonly("size_m", &Screen::size_m, "(width, height) of the visible area, metres.")
      .def_readonly("distance_m", &Screen::distance_m, "From the eye to the screen, metres.")
      .def("__repr__", [](const Screen& s) { return textOf(s); });

  py::class_<StillEye>(
      module, "Eye",
      "An eye at one place.\n\n"
      "pupil_mm: diameter of the pupil, 0 to 12 mm; 0 is a pinhole. position_m, look_at_m: (x, y, "
      "z)\n"
      "in metres; the centre of the screen shows look_at_m. age_years limits how near the eye\n"
      "focuses. sphere_D, cylinder_D, axis_deg: a prescription that is not worn, dioptres and\n"
      "degrees. chromatic: each colour has its own focus. wavefront_um: Zernike coefficients from\n"
      "index 0, um, in the order and signs of OSA and ANSI, for a pupil of wavefront_pupil_mm;\n"
      "indices 0 to 5 have no effect. stiles_crawford: light near the rim of the pupil counts "
      "less.\n"
      "diffraction: the blur of a small pupil, at 555 nm.")
      .def(py::init(&makeEye), py::arg("pupil_mm") = 4.0, py::arg("position_m") = glm::dvec3(0.0),
           py::arg("look_at_m") = glm::dvec3(0.0, 0.0, -1.0),
           py::arg("up") = glm::dvec3(0.0, 1.0, 0.0), py::arg("age_years") = py::none(),
           py::arg("sphere_D") = 0.0, py::arg("cylinder_D") = 0.0, py::arg("axis_deg") = 0.0,
           py::arg("chromatic") = false, py::arg("wavefront_um") = std::vector<double>(),
           py::arg("wavefront_pupil_mm") = py::none(), py::arg("stiles_crawford") = false,
           py::arg("diffraction") = false)
      .def_readonly("pupil_mm", &StillEye::pupil_mm, "Diameter of the pupil, millimetres.")
      .def_readonly("age_years", &StillEye::age_years, "Limits accommodation; None: no limit.")
      .def_readonly("chromatic", &StillEye::chromatic,
                    "Whether colours focus at different distances.")
      .def_readonly("position_m", &StillEye::position_m, "(x, y, z), metres in the scene.")
      .def_readonly("look_at_m", &StillEye::look_at_m,
                    "(x, y, z) that the screen's centre shows, metres.")
      .def_readonly("up", &StillEye::up, "(x, y, z), roughly upwards.")
      .def("__repr__", [](const StillEye& e) { return textOf(e); });
}

}  // namespace foci
