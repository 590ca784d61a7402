// Gaze maps: fits, files, accuracy, and their use on points and recordings.
#include <filesystem>

#include "base/file.h"
#include "base/input_error.h"
#include "calibration/gaze_map/fit_gaze_map.h"
#include "calibration/gaze_map/gaze_map.h"
#include "calibration/gaze_map/gaze_report.h"
#include "python/bindings.h"

namespace py = pybind11;

namespace foci {
namespace {

/// Converts between the caller's units and the map's. Pixels of the map's own screen are not a unit
/// of a map: they stand for its units.
class Units {
 public:
  /// @throws InputError for an unknown name, or for other units than the map's
  Units(const std::string& name, const GazeFrame& frame) : frame_(frame), pixels_(name == "px") {
    if (!pixels_ && name != nameOf(frame.units)) {
      throw InputError("units = " + name,
                       "expected px or " + std::string(nameOf(frame.units)) + ", the map's own");
    }
  }

  glm::dvec2 toMap(const glm::dvec2& point) const {
    return pixels_ ? fromPixels(frame_, frame_.screen, point) : point;
  }
  glm::dvec2 fromMap(const glm::dvec2& point) const {
    return pixels_ ? toPixels(frame_, frame_.screen, point) : point;
  }

 private:
  GazeFrame frame_;
  bool pixels_;
};

/// The frame of a fit in these units: pixels are fitted in degrees.
GazeFrame frameOf(const std::string& units, const Screen& screen) {
  if (units == "px") return {MapUnits::deg, screen};
  if (const auto named = mapUnitsNamed(units)) return {*named, screen};
  throw InputError("units = " + units, "expected px, deg, norm or direction");
}

std::vector<GazePair> pairsOf(const Numbers& gaze, const Numbers& target, const Units& units) {
  constexpr double kFarthest = 1e6;
  const double* gazes = tableOf("gaze", gaze, -1, 2);
  const double* targets = tableOf("target", target, gaze.shape(0), 2);
  std::vector<GazePair> pairs;
  pairs.reserve(static_cast<std::size_t>(gaze.shape(0)));
  for (py::ssize_t i = 0; i < 2 * gaze.shape(0); i += 2) {
    GazePair pair;
    if (const auto point = pointOrAbsent(gazes[i], gazes[i + 1])) {
      inRange("gaze", point->x, -kFarthest, kFarthest);
      inRange("gaze", point->y, -kFarthest, kFarthest);
      pair.gaze = units.toMap(*point);
    }
    pair.target = units.toMap({inRange("target", targets[i], -kFarthest, kFarthest),
                               inRange("target", targets[i + 1], -kFarthest, kFarthest)});
    pairs.push_back(pair);
  }
  return pairs;
}

GazeMap fit(const Numbers& gaze, const Numbers& target, const std::string& units,
            const Screen& screen, const std::optional<std::string>& model) {
  const GazeFrame frame = frameOf(units, screen);
  std::optional<GazeModel> forced;
  if (model) {
    forced = gazeModelNamed(*model);
    if (!forced) {
      throw InputError("model = " + *model, "expected offset, affine, second, third or None");
    }
  }
  const std::vector<GazePair> pairs = pairsOf(gaze, target, Units(units, frame));
  const py::gil_scoped_release released;
  return fitGazeMap(pairs, frame, forced).map;
}

GazeMap openMap(const std::filesystem::path& path, const Screen& screen) {
  requireRegularFile(path);
  GazeMap map = readGazeMap(path);
  Screen& own = map.frame.screen;
  if (own.size_m.x <= 0.0 || own.distance_m <= 0.0) own = screen;
  if (own.size_px.x <= 0) own.size_px = screen.size_px;
  return map;
}

py::tuple apply(const GazeMap& map, const Numbers& points, const std::string& unit_name) {
  const Units units(unit_name, map.frame);
  const double* in = tableOf("points", points, -1, 2);
  const py::ssize_t rows = points.shape(0);
  py::array_t<double> mapped({rows, py::ssize_t{2}});
  py::array_t<double> uncertainty_deg(rows);
  double *out = mapped.mutable_data(), *errors = uncertainty_deg.mutable_data();
  for (py::ssize_t i = 0; i < rows; ++i, out += 2) {
    const auto point = pointOrAbsent(in[2 * i], in[2 * i + 1]);
    const GazeEstimate estimate =
        point ? estimateGaze(map, units.toMap(*point)) : GazeEstimate{glm::dvec2(kNaN), kNaN};
    const glm::dvec2 result = point ? units.fromMap(estimate.point) : estimate.point;
    out[0] = result.x;
    out[1] = result.y;
    errors[i] = estimate.uncertainty_deg;
  }
  return py::make_tuple(mapped, uncertainty_deg);
}

Recording applyToRecording(const GazeMap& map, const GazeTrace& recording) {
  const py::gil_scoped_release released;
  return std::make_shared<GazeTrace>(mapTrace(map, *recording.screen, recording));
}

py::dict accuracy(const GazeMap& map, const Numbers& gaze, const Numbers& target,
                  const std::string& units) {
  const std::vector<GazePair> pairs = pairsOf(gaze, target, Units(units, map.frame));
  const GazeAccuracy measured = measureAccuracy(pairs, map.frame, &map);
  const GazeMeasures& overall = measured.overall;
  py::dict result;
  result["accuracy_deg"] = orNaN(overall.accuracy_deg);
  result["worst_target_deg"] = orNaN(measured.worst_deg);
  result["precision_rms_s2s_deg"] = orNaN(overall.rms_s2s_deg);
  result["precision_sd_deg"] = orNaN(overall.sd_deg);
  result["samples"] = overall.samples;
  result["missing"] = overall.missing;
  result["grade"] = std::string(nameOf(gradeOf(measured)));
  return result;
}

}  // namespace

void bindCalibration(py::module_& module) {
  py::class_<GazeMap>(module, "GazeMap",
                      "A map from the tracker's gaze to the point that the observer looks at.")
      .def_static("fit", &fit, py::arg("gaze"), py::arg("target"), py::kw_only(),
                  py::arg("units") = "px", py::arg("screen") = defaultScreen(),
                  py::arg("model") = py::none(),
                  "Fit a map to samples at known targets.\n\n"
                  "gaze, target: (N, 2), a row for each sample; NaN in gaze stands for data loss. "
                  "units: \"px\" of\nthe screen, \"deg\", \"norm\" or \"direction\". model: "
                  "\"offset\", \"affine\", \"second\", \"third\"; None\nchooses by "
                  "cross-validation. Raises InputError if the targets cannot carry a fit.")
      .def_static("open", &openMap, py::arg("path"), py::arg("screen") = defaultScreen(),
                  "Open a map that `save` or `foci calibrate gaze` wrote.\n\nscreen: of the "
                  "pixels, where the file does not state it. A map in degrees does not.")
      .def(
          "save",
          [](const GazeMap& map, const std::filesystem::path& path) {
            requireRegularFile(path);
            replaceFile(path, gazeMapToml(map));
          },
          py::arg("path"),
          "Write the map as TOML, with every digit. Replaces a file, but no folder, pipe or "
          "device.")
      .def("apply", &applyToRecording, py::arg("recording"),
           "The recording with mapped points: a new Recording.")
      .def("apply", &apply, py::arg("points"), py::arg("units") = "px",
           "Map points of shape (N, 2).\n\nReturns (points (N, 2) in the same units, uncertainty "
           "(N,) in degrees: 68 % of the errors are\nsmaller). NaN stays NaN.")
      .def("accuracy", &accuracy, py::arg("gaze"), py::arg("target"), py::arg("units") = "px",
           "Accuracy and precision on samples at known targets, a dict; degrees.")
      .def_property_readonly(
          "model", [](const GazeMap& m) { return nameOf(m.model); },
          "offset, affine, second or third.")
      .def_property_readonly(
          "units", [](const GazeMap& m) { return nameOf(m.frame.units); },
          "Of the gaze that the map takes: px, deg, norm or direction.")
      .def_property_readonly(
          "screen", [](const GazeMap& m) { return m.frame.screen; }, "That the map was fitted on.")
      .def("__repr__", [](const GazeMap& map) {
        return "<foci.GazeMap, " + std::string(nameOf(map.model)) + ", in " +
               std::string(nameOf(map.frame.units)) + ">";
      });
}

}  // namespace foci
