// A study and its replay: what `foci replay` does, into arrays.
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "app/record/tables.h"
#include "app/replay/fixation_tables.h"
#include "app/replay/replay.h"
#include "app/replay/replayed_eye.h"
#include "app/study/study_request.h"
#include "python/bindings.h"
#include "python/scene.h"

namespace py = pybind11;

namespace foci {
namespace {

/// Warnings that have not been raised yet.
void raise(const Warnings& warnings, std::size_t& raised) {
  while (raised < warnings.all().size()) warn(warnings.all()[raised++]);
}

py::object jsonOf(const py::object& value, const char* function) {
  return py::module_::import("json").attr(function)(value);
}

std::shared_ptr<StudyAsked> openStudy(const std::filesystem::path& path,
                                      const std::optional<std::filesystem::path>& scene,
                                      const std::optional<std::string>& trace,
                                      const std::optional<std::string>& look,
                                      const std::optional<std::string>& up, const py::dict& set) {
  StudyRequest request{.study = path.string(),
                       .scene = scene ? scene->string() : "",
                       .trace = trace.value_or(""),
                       .look = look.value_or(""),
                       .up = up.value_or("")};
  for (const auto& [key, value] : set) {
    const py::object json = value.is_none()
                                ? py::object(py::str("null"))
                                : jsonOf(py::reinterpret_borrow<py::object>(value), "dumps");
    request.set.push_back(py::cast<std::string>(key) + "=" + py::cast<std::string>(json));
  }
  const py::gil_scoped_release released;
  return std::make_shared<StudyAsked>(studyOf(request));
}

py::dict keysOf(const StudyAsked& asked) {
  py::dict keys;
  for (const ResolvedKey& key : resolvedKeys(asked.study)) {
    keys[py::str(std::string(key.name))] = jsonOf(py::str(key.json), "loads");
  }
  return keys;
}

/// A recording in its scene, with the tables of its run.
class Replay {
 public:
  Replay(const StudyAsked& asked, bool depth)
      : shared_(asked.scene ? std::optional(*asked.scene) : std::nullopt),
        gaze_(readReplayedGaze(withDepth(asked.study, depth), warnings_)),
        scene_(shared_.of(gaze_.study, warnings_)) {}

  /// With the warnings that are still to be raised.
  void raiseWarnings() { raise(warnings_, raised_); }
  std::vector<std::string> warnings() const { return warnings_.all(); }
  std::size_t frames() const { return gaze_.schedule.frames; }
  const ReplayedGaze& gaze() const { return gaze_; }
  const Scene& scene() const { return scene_; }

  /// The text of a table that `foci replay` writes.
  std::string table(const std::string& name) {
    const std::lock_guard lock(mutex_);
    if (!in_scene_) {
      judged_ = eventsOfRun(study(), gaze_.trace, gaze_.schedule.first_s, gaze_.schedule.end_s());
      warnings_.addAll(study().gaze.source, judged_.warnings);
      in_scene_ = lookIntoScene(study(), gaze_, scene_, judged_, false);
    }
    if (name == "events") {
      return eventTable(judged_.events, gaze_.trials, study().gaze.events.detector);
    }
    if (name == "gaze3d") return sightTable(*in_scene_, gaze_.trials, gaze_.trace.pupil_unit);
    if (name == "objects") return objectTable(*in_scene_, gaze_.trials);
    if (name == "saccades") return saccadeTable(study(), gaze_, judged_, *in_scene_);
    if (eyes_.empty()) {
      ReplayedEye eye(study(), gaze_, scene_, warnings_);
      for (std::size_t i = 0; i < frames(); ++i) {
        const FrameRecord record = eye.pass(i);
        eyes_.push_back({record.time_s, record.eye.focus_D, record.pupil_mm});
      }
    }
    return fixationTable(study(), gaze_, judged_, *in_scene_, eyes_);
  }

 private:
  static Study withDepth(Study study, bool depth) {
    study.output.maps.clear();
    if (depth) study.output.maps.push_back(FrameMap::depth);
    return study;
  }
  const Study& study() const { return gaze_.study; }

  Warnings warnings_{};
  std::size_t raised_ = 0;
  ReplayedScene shared_;
  ReplayedGaze gaze_;
  const Scene& scene_;
  std::mutex mutex_{};
  RunEvents judged_{};
  std::optional<GazeInScene> in_scene_{};
  std::vector<EyeInFrame> eyes_{};
};

std::shared_ptr<Replay> replayOf(const StudyAsked& asked, bool depth) {
  auto replay = outsideInterpreter([&] { return std::make_shared<Replay>(asked, depth); });
  replay->raiseWarnings();
  return replay;
}

/// The frames of a replay, from the first one on.
class Frames {
 public:
  explicit Frames(std::shared_ptr<Replay> replay)
      : replay_(std::move(replay)),
        eye_(replay_->gaze().study, replay_->gaze(), replay_->scene(), warnings_) {
    eye_.requireSceneInView(replay_->scene());
  }

  EyeImage next() {
    if (next_ == replay_->frames()) throw py::stop_iteration();
    EyeImage image;
    {
      const py::gil_scoped_release released;
      SeenFrame seen;
      RenderedFrame& rendered = eye_.seeKept(next_++, seen);
      eye_.renderer().read(rendered);
      const auto copy = std::make_shared<RenderedFrame>();
      copy->request = rendered.request;
      copy->frame = rendered.frame;
      copy->method = rendered.method;
      copy->stats = rendered.stats;
      image = {.rendered = copy, .record = std::move(seen.record)};
    }
    raise(warnings_, raised_);
    return image;
  }

 private:
  std::shared_ptr<Replay> replay_;
  Warnings warnings_{};
  std::size_t raised_ = 0, next_ = 0;
  ReplayedEye eye_;
};

}  // namespace

void warn(const std::string& text) {
  constexpr int kCaller = 1;
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), kCaller) != 0) throw py::error_already_set();
}

void bindStudy(py::module_& module) {
  sayTo([](const std::string&) {});  // the warnings become Python's
  py::class_<StudyAsked, std::shared_ptr<StudyAsked>>(
      module, "Study", "A study, or a scene with automatic framing, as `foci replay` takes it.")
      .def(
          py::init(&openStudy), py::arg("path"), py::kw_only(), py::arg("scene") = py::none(),
          py::arg("trace") = py::none(), py::arg("look") = py::none(), py::arg("up") = py::none(),
          py::arg("set") = py::dict(),
          "path: a study (TOML) or a scene. scene, trace, look, up: the command's options of these "
          "names.\nset: values of keys, such as {\"focus.fixed_D\": 2}; None sets the default.")
      .def_readonly("framing", &StudyAsked::framing,
                    "What was chosen for a scene, and why; empty for a study.")
      .def_property_readonly("keys", &keysOf, "Every key of the study with the value in force.")
      .def(
          "save",
          [](const StudyAsked& asked, const std::filesystem::path& path) {
            writeOutput(path, writtenStudy(path, asked.study, asked.framing), OutputGuard());
          },
          py::arg("path"), "Write the study as TOML.")
      .def("replay", &replayOf, py::kw_only(), py::arg("depth") = false,
           "Read scene and recording. depth: the images have depth_m, defocus_D and blur_px, too.\n"
           "Warnings of the command are UserWarnings.");
  py::class_<Replay, std::shared_ptr<Replay>>(
      module, "Replay",
      "A recording through the eye: iterate over it for the frames, an Image each.")
      .def_property_readonly("warnings", &Replay::warnings,
                             "What makes the results other than expected, a sentence each.")
      .def("__len__", &Replay::frames)
      .def("__iter__",
           [](const std::shared_ptr<Replay>& replay) {
             return outsideInterpreter([&] { return std::make_unique<Frames>(replay); });
           })
      .def("_table", [](Replay& replay, const std::string& name) {
        std::string text = outsideInterpreter([&] { return replay.table(name); });
        replay.raiseWarnings();
        return text;
      });
  py::class_<Frames>(module, "_Frames")
      .def("__iter__", [](Frames& frames) -> Frames& { return frames; })
      .def("__next__", &Frames::next);
}

}  // namespace foci
