// A session: gaze samples in as they arrive, eye states and frames out.
#include "app/session/session.h"

#include <memory>
#include <utility>

#include "base/input_error.h"
#include "python/bindings.h"
#include "python/eye.h"
#include "python/scene.h"

namespace py = pybind11;

namespace foci {
namespace {

struct StateRow {
  Word state{};
  double time_s = 0.0;
  glm::dvec2 gaze_px{kNaN}, fixation_px{kNaN};
  double surface_distance_m = kNaN, target_D = kNaN, focus_D = 0.0, pupil_mm = 0.0;
};

StateRow rowOf(const FrameRecord& record) {
  return {.state = wordOf(nameOf(record.eye.state)),
          .time_s = record.time_s,
          .gaze_px = orNaN(record.gaze_px),
          .fixation_px = orNaN(record.fixation_px),
          .surface_distance_m = orNaN(record.eye.surface_distance_m),
          .target_D = orNaN(record.eye.target_D),
          .focus_D = record.eye.focus_D,
          .pupil_mm = record.pupil_mm};
}

/// The session of a scene that it keeps alive. One thread may push samples while another renders.
class LiveSession {
 public:
  LiveSession(std::shared_ptr<PythonScene> scene, const SessionSettings& settings, double rate_Hz,
              double start_s, bool depth)
      : scene_(std::move(scene)),
        session_(settings, scene_->scene(), settings.screen, rate_Hz, start_s),
        renderer_(session_.cloneRenderer()),
        depth_(depth),
        newest_s_(-std::numeric_limits<double>::infinity()),
        looked_s_(newest_s_) {}

  void push(const GazeSample& sample) {
    const auto lock = lockOutsideInterpreter(mutex_);
    pushLocked(sample);
  }

  void pushColumns(const SampleColumns& columns) {
    const py::gil_scoped_release released;
    const std::lock_guard lock(mutex_);
    for (py::ssize_t row = 0; row < columns.rows; ++row) pushLocked(columns.at(row));
  }

  py::array track(const SampleColumns& columns) {
    std::vector<StateRow> rows;
    {
      const py::gil_scoped_release released;
      const std::lock_guard lock(mutex_);
      rows.reserve(static_cast<std::size_t>(columns.rows));
      for (py::ssize_t row = 0; row < columns.rows; ++row) {
        pushLocked(columns.at(row));
        rows.push_back(rowOf(stateLocked(columns.t[row])));
      }
    }
    return tableOfRows(
        rows, {"*state", "time_s", "gaze_x_px", "gaze_y_px", "fixation_x_px", "fixation_y_px",
               "surface_distance_m", "target_D", "focus_D", "pupil_mm"});
  }

  FrameRecord state(double time_s) {
    const auto lock = lockOutsideInterpreter(mutex_);
    return stateLocked(time_s);
  }

  EyeImage frame(double time_s) {
    const py::gil_scoped_release released;
    const std::lock_guard rendering(render_mutex_);
    FrameRecord record;
    RenderRequest request;
    {
      const std::lock_guard lock(mutex_);
      note(time_s);
      record = session_.look(time_s);
      request = session_.requestOf(session_.settings().method, record);
    }
    for (RenderRequest::Eye& eye : request.eyes) eye.settings.depth = depth_;
    // As Session::render does, but into frames that Python may keep.
    const bool again = last_ && last_->request == request &&
                       !methodInfo(request.method).incremental &&
                       (!request.hasTimeBudget() || last_->stats.full_quality);
    if (again) {
      record.method = last_->method;
      record.stats = last_->stats;
      record.stats.ms = 0.0;
      record.rendered = false;
    } else {
      if (last_ && request.hasTimeBudget() && request.sameViews(last_->request)) {
        renderer_.prepare(request);
      }
      const std::shared_ptr<RenderedFrame> next = scene_->frames().take();
      renderInto(renderer_, request, next, record);
      last_ = next;
    }
    return {.rendered = last_, .record = std::move(record)};
  }

  void move(const StillEye& eye) {
    const auto lock = lockOutsideInterpreter(mutex_);
    SessionSettings settings = session_.settings();
    settings.path = pathOf(eye);
    session_.changeSettings(settings);
  }

 private:
  void pushLocked(const GazeSample& sample) {
    if (!(std::isfinite(sample.time_s) && sample.time_s > newest_s_ &&
          sample.time_s >= looked_s_)) {
      requireLater(sample.time_s, std::max(newest_s_, looked_s_));
    }
    session_.push(sample);
    newest_s_ = sample.time_s;
  }

  FrameRecord stateLocked(double time_s) {
    note(time_s);
    return session_.state(time_s);
  }

  /// The time of a state or frame.
  void note(double time_s) {
    const double earliest_s = std::max(newest_s_, looked_s_);
    if (!(std::isfinite(time_s) && time_s >= earliest_s)) {
      throw InputError("time_s = " + std::to_string(time_s),
                       "expected a time not before the newest sample or state");
    }
    looked_s_ = time_s;
  }

  std::shared_ptr<PythonScene> scene_;
  std::mutex mutex_{}, render_mutex_{};
  Session session_;
  FrameRenderer renderer_;
  std::shared_ptr<const RenderedFrame> last_{};
  bool depth_;
  double newest_s_, looked_s_;
};

PupilModel pupilNamed(const std::string& name) {
  if (name == "fixed") return PupilModel::fixed;
  if (name == "recording") return PupilModel::recording;
  throw InputError("pupil = " + name, "expected fixed or recording");
}

std::unique_ptr<LiveSession> makeSession(std::shared_ptr<PythonScene> scene, const StillEye& eye,
                                         const Screen& screen, double rate_Hz, double start_s,
                                         const std::optional<glm::ivec2>& size_px,
                                         const std::string& method, const glm::dvec3& background,
                                         double shading, double tolerance,
                                         const std::optional<double>& frame_ms, bool foveated,
                                         const std::string& pupil, double latency_s,
                                         double time_constant_s, bool depth) {
  SessionSettings settings =
      settingsOf(eye, screen, {size_px, method, background, shading, tolerance});
  settings.observer.pupil = pupilNamed(pupil);
  settings.quality.foveated = foveated;
  if (frame_ms) settings.quality.frame_ms = inRange("frame_ms", *frame_ms, 1.0, 10000.0);
  settings.focus.accommodation.latency_s = inRange("latency_s", latency_s, 0.0, 5.0);
  settings.focus.accommodation.time_constant_s =
      inRange("time_constant_s", time_constant_s, 0.001, 10.0);
  inRange("rate_Hz", rate_Hz, 5.0, 20000.0);
  constexpr double kLongest_s = 1e12;
  inRange("start_s", start_s, -kLongest_s, kLongest_s);
  const py::gil_scoped_release released;
  return std::make_unique<LiveSession>(std::move(scene), settings, rate_Hz, start_s, depth);
}

GazeSample sampleOf(double t, double x, double y, const std::optional<double>& pupil_mm,
                    bool blink) {
  GazeSample sample{.time_s = t, .point_px = pointOrAbsent(x, y), .blink = blink};
  if (pupil_mm) sample.pupil_mm = numberOrAbsent(*pupil_mm);
  return sample;
}

void bindState(py::module_& module) {
  py::class_<FrameRecord>(module, "State", "The observer's eye at a moment.")
      .def_readonly("time_s", &FrameRecord::time_s, "Seconds on the clock of the samples.")
      .def_property_readonly(
          "state", [](const FrameRecord& r) { return nameOf(r.eye.state); },
          "fixation, saccade, pursuit, blink or lost.")
      .def_readonly("gaze_px", &FrameRecord::gaze_px,
                    "(x, y) on the screen; None in a blink and in data loss.")
      .def_readonly("fixation_px", &FrameRecord::fixation_px,
                    "(x, y) of the last fixation; None before the first.")
      .def_property_readonly(
          "surface_distance_m", [](const FrameRecord& r) { return r.eye.surface_distance_m; },
          "Distance of the fixated surface, metres; None if there is none.")
      .def_property_readonly(
          "target_D", [](const FrameRecord& r) { return r.eye.target_D; },
          "Vergence of the target of focus, dioptres; None before the first.")
      .def_property_readonly(
          "focus_D", [](const FrameRecord& r) { return r.eye.focus_D; }, "Focus, dioptres.")
      .def_readonly("pupil_mm", &FrameRecord::pupil_mm, "Diameter of the pupil, millimetres.")
      .def("__repr__", [](const FrameRecord& r) {
        return std::string(py::str("<foci.State {:.3f} s, {}, focus {:.2f} D>")
                               .format(r.time_s, nameOf(r.eye.state), r.eye.focus_D));
      });
}

}  // namespace

void bindSession(py::module_& module) {
  bindState(module);
  const AccommodationSettings usual;
  py::class_<LiveSession>(
      module, "Session",
      "Follows one observer. Push every sample up to a moment, then ask for the state or the frame "
      "of it.")
      .def(py::init(&makeSession), py::arg("scene"), py::arg("eye"),
           py::arg("screen") = defaultScreen(), py::kw_only(), py::arg("rate_Hz"),
           py::arg("start_s") = 0.0, py::arg("size_px") = py::none(), py::arg("method") = "auto",
           py::arg("background") = glm::dvec3(0.0), py::arg("shading") = 0.0,
           py::arg("tolerance") = 1.0, py::arg("frame_ms") = py::none(),
           py::arg("foveated") = false, py::arg("pupil") = "fixed",
           py::arg("latency_s") = usual.latency_s,
           py::arg("time_constant_s") = usual.time_constant_s, py::arg("depth") = false,
           "rate_Hz: of the samples. size_px, method, background, shading, tolerance, depth: as in "
           "render.\nframe_ms: frame-time budget, milliseconds; None: full quality. foveated: no "
           "finer than the eye\nresolves away from the gaze. pupil: \"fixed\" at the eye's "
           "pupil_mm, or \"recording\". latency_s,\ntime_constant_s: of accommodation.")
      .def(
          "push",
          [](LiveSession& session, double t, double x, double y,
             const std::optional<double>& pupil_mm,
             bool blink) { session.push(sampleOf(t, x, y, pupil_mm, blink)); },
          py::arg("t"), py::arg("x"), py::arg("y"), py::arg("pupil_mm") = py::none(),
          py::arg("blink") = false,
          "Push one sample: seconds, pixels, millimetres. NaN in x or y stands for data loss.")
      .def(
          "push",
          [](LiveSession& session, const Numbers& t, const Numbers& x, const Numbers& y,
             const std::optional<Numbers>& pupil_mm) {
            session.pushColumns(columnsOf(t, x, y, pupil_mm));
          },
          py::arg("t"), py::arg("x"), py::arg("y"), py::arg("pupil_mm") = py::none(),
          "Push columns of samples, (N,) each.")
      .def(
          "track",
          [](LiveSession& session, const Numbers& t, const Numbers& x, const Numbers& y,
             const std::optional<Numbers>& pupil_mm) {
            return session.track(columnsOf(t, x, y, pupil_mm));
          },
          py::arg("t"), py::arg("x"), py::arg("y"), py::arg("pupil_mm") = py::none(),
          "Push columns of samples, (N,) each, and read the state at each: a structured array, "
          "(N,).")
      .def("state", &LiveSession::state, py::arg("time_s"),
           "The eye at time_s, which is not before the newest sample. Its surface is sought again "
           "once gaze "
           "or the\neye has moved by more than noise; a frame always seeks it.")
      .def("frame", &LiveSession::frame, py::arg("time_s"),
           "What the eye sees at time_s: an Image. A frame that would look the same is returned "
           "again.")
      .def("move", &LiveSession::move, py::arg("eye"),
           "From the next state on the eye stands at the place of another.");
}

}  // namespace foci
