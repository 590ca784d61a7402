// Recordings and their events.
#include <algorithm>
#include <filesystem>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/events/event_labels.h"
#include "gaze/events/recording_quality.h"
#include "gaze/sources/trace_reader.h"
#include "gaze/sources/trace_summary.h"
#include "python/bindings.h"

namespace py = pybind11;

namespace foci {
namespace {

struct EventRow {
  Word kind{};
  double onset_s = 0.0, duration_s = 0.0;
  glm::dvec2 position_px{kNaN}, start_px{kNaN};
  double amplitude_deg = kNaN, peak_velocity_deg_s = kNaN, probability = kNaN;
};

EventRow rowOf(const GazeEvent& event) {
  return {.kind = wordOf(nameOf(event.kind)),
          .onset_s = event.onset_s,
          .duration_s = event.duration_s,
          .position_px = orNaN(event.position_px),
          .start_px = orNaN(event.start_px),
          .amplitude_deg = orNaN(event.amplitude_deg),
          .peak_velocity_deg_s = orNaN(event.peak_velocity_deg_s),
          .probability = orNaN(event.probability)};
}

/// The keywords of the event detection.
struct EventOptions {
  EventSettings settings{};
  bool online = false;
};

EventOptions eventOptions(const py::kwargs& keywords) {
  EventOptions options;
  EventSettings& settings = options.settings;
  for (const auto& [key, value] : keywords) {
    const auto name = py::cast<std::string>(key);
    // The ranges are those of the study's keys.
    if (name == "online") {
      options.online = py::cast<bool>(value);
    } else if (name == "detector") {
      const auto word = py::cast<std::string>(value);
      const auto found = detectorNamed(word);
      if (!found) {
        throw InputError("detector", shown(word) + ": expected trained, rules, ivt or idt");
      }
      settings.detector = *found;
    } else if (name == "pursuit") {
      settings.pursuit = py::cast<std::optional<bool>>(value);
    } else if (name == "saccade_deg_s") {
      settings.saccade_deg_s = inRange(name.c_str(), py::cast<double>(value), 1.0, 1000.0);
    } else if (name == "min_fixation_s") {
      settings.min_fixation_s = inRange(name.c_str(), py::cast<double>(value), 0.0, 10.0);
    } else if (name == "max_blink_s") {
      settings.max_blink_s = inRange(name.c_str(), py::cast<double>(value), 0.0, 10.0);
    } else if (name == "delay_s") {
      settings.delay_s = inRange(name.c_str(), py::cast<double>(value), 0.0, 0.2);
    } else {
      throw py::type_error("unexpected keyword " + name);
    }
  }
  return options;
}

py::array eventTable(const GazeTrace& trace, const py::kwargs& keywords) {
  const EventOptions options = eventOptions(keywords);
  std::vector<EventRow> rows;
  {
    const py::gil_scoped_release released;
    const EventLabels labels = labelEvents(trace, *trace.screen, options.settings, options.online);
    for (const GazeEvent& event : eventsOf(labels, trace, *trace.screen, options.settings)) {
      rows.push_back(rowOf(event));
    }
  }
  return tableOfRows(rows, {"*event", "onset_s", "duration_s", "x_px", "y_px", "start_x_px",
                            "start_y_px", "amplitude_deg", "peak_velocity_deg_s", "probability"});
}

py::array labelColumn(const GazeTrace& trace, const py::kwargs& keywords) {
  const EventOptions options = eventOptions(keywords);
  std::vector<Word> words;
  {
    const py::gil_scoped_release released;
    for (const GazeState state :
         labelEvents(trace, *trace.screen, options.settings, options.online).states) {
      words.push_back(wordOf(nameOf(state)));
    }
  }
  return {py::dtype("U8"), static_cast<py::ssize_t>(words.size()), words.data()};
}

/// The fields of `RecordingQuality`, and the warnings.
py::dict qualityDict(const GazeTrace& trace, const py::kwargs& keywords) {
  const EventOptions options = eventOptions(keywords);
  RecordingQuality quality;
  std::vector<std::string> warnings;
  {
    const py::gil_scoped_release released;
    const EventLabels labels = labelEvents(trace, *trace.screen, options.settings, options.online);
    quality = qualityOf(trace, *trace.screen, labels.states,
                        eventsOf(labels, trace, *trace.screen, options.settings));
    warnings = eventWarnings(trace, labels, quality, options.settings);
  }
  py::dict dict;
  dict["rate_Hz"] = quality.rate_Hz;
  dict["jitter_s"] = quality.jitter_s;
  dict["lost"] = quality.lost;
  dict["longest_gap_s"] = quality.longest_gap_s;
  dict["rms_s2s_deg"] = quality.rms_s2s_deg;
  dict["sd_deg"] = quality.sd_deg;
  dict["unjudged"] = quality.unjudged;
  dict["main_sequence"] = py::none();
  if (const auto& fit = quality.main_sequence) {
    py::dict main_sequence;
    main_sequence["saccades"] = fit->saccades;
    main_sequence["at_1_deg_deg_s"] = fit->at_1_deg_deg_s;
    main_sequence["exponent"] = fit->exponent;
    dict["main_sequence"] = main_sequence;
  }
  dict["detector"] = labelOf(options.settings.detector);
  dict["warnings"] = warnings;
  return dict;
}

Recording recordingOf(const Numbers& t, const Numbers& x, const Numbers& y,
                      const std::optional<Numbers>& pupil, const Screen& screen,
                      const std::optional<double>& rate_Hz) {
  const SampleColumns columns = columnsOf(t, x, y, pupil);
  if (columns.rows < 2) throw InputError("t", "expected two samples or more");
  auto trace = std::make_shared<GazeTrace>();
  trace->format = "arrays";
  trace->screen = screen;
  TraceSummary summary;
  trace->samples.reserve(static_cast<std::size_t>(columns.rows));
  for (py::ssize_t row = 0; row < columns.rows; ++row) {
    trace->samples.push_back(columns.at(row));
    summary.add(trace->samples.back());
  }
  if (summary.present() == 0) throw InputError("x, y", "no sample has a position");
  trace->rate_Hz = inRange("rate_Hz", rate_Hz.value_or(summary.rate_Hz()), 5.0, 20000.0);
  return trace;
}

Recording openRecording(const std::filesystem::path& path, const std::optional<Screen>& screen,
                        const std::optional<double>& rate_Hz) {
  const py::gil_scoped_release released;
  requireRegularFile(path);
  return std::make_shared<GazeTrace>(
      readTrace(path, {}, screen.value_or(defaultScreen()), rate_Hz));
}

/// A property: a new array of one number for each sample.
template <typename Function>
auto column(Function function) {
  return [function](const GazeTrace& trace) {
    py::array_t<double> numbers(static_cast<py::ssize_t>(trace.samples.size()));
    std::ranges::transform(trace.samples, numbers.mutable_data(), function);
    return numbers;
  };
}

}  // namespace

void requireLater(double time_s, double before_s) {
  if (std::isfinite(time_s) && time_s > before_s) return;
  // Without Python: a session calls this while the interpreter's lock is released.
  throw InputError("t", exactText(time_s) + " after " + exactText(before_s) +
                            ": expected times in seconds that increase");
}

GazeSample SampleColumns::at(py::ssize_t row) const {
  GazeSample sample{.time_s = t[row], .point_px = pointOrAbsent(x[row], y[row])};
  if (pupil != nullptr) sample.pupil_mm = numberOrAbsent(pupil[row]);
  return sample;
}

SampleColumns columnsOf(const Numbers& t, const Numbers& x, const Numbers& y,
                        const std::optional<Numbers>& pupil) {
  if (t.ndim() != 1) throw InputError("t", "expected one dimension");
  SampleColumns columns{.rows = t.shape(0), .t = t.data()};
  columns.x = columnOf("x", x, columns.rows);
  columns.y = columnOf("y", y, columns.rows);
  if (pupil) columns.pupil = columnOf("pupil_mm", *pupil, columns.rows);
  double before_s = -std::numeric_limits<double>::infinity();
  for (py::ssize_t row = 0; row < columns.rows; ++row) {
    requireLater(columns.t[row], before_s);
    before_s = columns.t[row];
  }
  return columns;
}

void bindRecordings(py::module_& module) {
  py::class_<GazeTrace, std::shared_ptr<GazeTrace>>(
      module, "Recording", "Gaze samples on a screen. Times increase; NaN stands for data loss.")
      .def_static("open", &openRecording, py::arg("path"), py::arg("screen") = py::none(),
                  py::arg("rate_Hz") = py::none(),
                  "Open an EyeLink ASC, Tobii, Pupil, SMI, GazeBase or BIDS file, or a table with "
                  "named columns.\n\nscreen: used where the file states none; None takes 1920x1080 "
                  "px, 0.5313 x 0.2989 m, 0.6 m away. rate_Hz: None takes the median interval.")
      .def(py::init(&recordingOf), py::arg("t"), py::arg("x"), py::arg("y"),
           py::arg("pupil_mm") = py::none(), py::arg("screen") = defaultScreen(),
           py::arg("rate_Hz") = py::none(),
           "t: (N,), seconds. x, y: (N,), pixels of the screen, origin top-left. pupil_mm: (N,).")
      .def_property_readonly("t", column(&GazeSample::time_s), "Seconds, (N,).")
      .def_property_readonly("x", column([](const auto& s) { return orNaN(s.point_px).x; }),
                             "Pixels from the screen's left edge, (N,); NaN in data loss.")
      .def_property_readonly("y", column([](const auto& s) { return orNaN(s.point_px).y; }),
                             "Pixels from the screen's upper edge, (N,); NaN in data loss.")
      .def_property_readonly("pupil_mm", column([](const auto& s) { return orNaN(s.pupil_mm); }),
                             "Diameter of the pupil, millimetres, (N,); NaN where unknown.")
      .def_property_readonly(
          "screen", [](const GazeTrace& r) { return *r.screen; }, "That x and y lie on.")
      .def_readonly("rate_Hz", &GazeTrace::rate_Hz, "Sampling rate, nominal or median, hertz.")
      .def_readonly("format", &GazeTrace::format, "Of the file, for people.")
      .def_readonly("assumed", &GazeTrace::assumed,
                    "What foci assumed because the file does not state it, a sentence each.")
      .def_readonly("warnings", &GazeTrace::warnings,
                    "What is worth knowing about the file, a sentence each.")
      .def("__len__", [](const GazeTrace& r) { return r.samples.size(); })
      .def("__repr__",
           [](const GazeTrace& r) {
             return std::string(py::str("<foci.Recording of {} samples, {:.0f} Hz, {}>")
                                    .format(r.samples.size(), r.rate_Hz, r.format));
           })
      .def("_events", &eventTable)
      .def("labels", &labelColumn,
           "The state of each sample, (N,) words: fixation, saccade, pso, pursuit, blink, lost, "
           "unjudged. Keywords as events().")
      .def("quality", &qualityDict,
           "Noise, data loss, jitter, share unjudged, main sequence and warnings. Keywords as "
           "events().");
}

}  // namespace foci
