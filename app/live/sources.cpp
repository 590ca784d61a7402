#include "app/live/sources.h"

#include <utility>

#include "app/record/tables.h"
#include "app/session/session.h"
#include "app/study/gaze_calibration.h"
#include "app/study/inputs.h"
#include "app/study/session_settings_of.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/webcam/webcam_calibration.h"
#include "gaze/live/lsl_source.h"
#include "gaze/sources/recording_formats.h"
#include "gaze/webcam/webcam_source.h"
#ifdef FOCI_PUPIL
#include "gaze/live/pupil_source.h"
#endif

namespace foci {
namespace {

constexpr double kMouse_Hz = 250.0;   // as a common tracker
constexpr double kPushed_Hz = 500.0;  // between common trackers, 60 to 2000 Hz

void openWebcam(const WebcamPlace& place, const Study& study, NamedSource& named) {
  std::optional<WebcamReference> reference;
  WebcamMapping map;
  if (study.gaze.map) {
    const WebcamCalibration calibration = webcamCalibrationOf(study);
    reference = calibration.reference;
    const auto now = std::make_shared<WebcamRecalibration>(calibration.map, study.screenInForce());
    map = [now](const WebcamView& view) { return now->gazeOf(view); };
    named.lookedAt = [now](const glm::dvec2& point_px) { return now->click(point_px); };
  }
  WebcamTracker tracker(std::nullopt, reference);
  named.warnings.add(tracker.remark());
  named.source = std::make_unique<WebcamSource>(place, std::move(tracker), map);
}

/// A tracker whose gaze goes through the map of a calibration.
class MappedSource final : public LiveSource {
 public:
  MappedSource(std::unique_ptr<LiveSource> source, GazeMap map, const Screen& screen)
      : source_(std::move(source)), map_(std::move(map)), screen_(screen) {}

  void poll(double now_s, std::vector<GazeSample>& samples) override {
    GazeTrace news;
    source_->poll(now_s, news.samples);
    if (news.samples.empty()) return;
    news = mapTrace(map_, screen_, std::move(news));
    samples.insert(samples.end(), news.samples.begin(), news.samples.end());
  }
  double rate_Hz() const override { return source_->rate_Hz(); }
  std::string status() const override { return source_->status(); }
  SenderFacts sender() const override { return source_->sender(); }

 private:
  std::unique_ptr<LiveSource> source_;
  GazeMap map_;
  Screen screen_;
};

/// Applies the study's gaze map, if there is one, to the samples of a tracker.
void mapSource(const Study& study, NamedSource& named) {
  if (!study.gaze.map) return;
  const GazeCalibration calibration = readGazeCalibration(*study.gaze.map, /*webcam=*/false);
  const auto* map = std::get_if<GazeMap>(&calibration);
  if (!map) {
    throw InputError(study.gaze.map->string(),
                     "expected a map of foci calibrate gaze: foci live takes no binocular map");
  }
  named.source = std::make_unique<MappedSource>(std::move(named.source), *map, named.screen);
}

/// `socket` or `socket:RATE`
void openSocket(const std::string& name, NamedSource& named) {
  constexpr double kMin_Hz = 5.0, kMax_Hz = 20000.0;  // as of recordings
  double rate_Hz = kPushed_Hz;
  if (name != "socket") {
    const auto rate = parseNumber(name.substr(7));
    if (!rate || *rate < kMin_Hz || *rate > kMax_Hz) {
      throw InputError("--source " + shown(name),
                       "expected socket:RATE, 5 to 20000 samples a second");
    }
    rate_Hz = *rate;
  }
  auto pushed = std::make_unique<PushedSource>(rate_Hz);
  named.pushed = pushed.get();
  named.source = std::move(pushed);
}

/// From here on the samples have the place of the eye in the scene as their head, and their points
/// are on the study's screen, which the head takes with it. A study's path is such a head.
/// @return the head at a time of the recording's clock; empty: there is none
std::function<HeadInWorld(double recording_s)> followRecordedHead(const Study& study,
                                                                  GazeTrace& trace,
                                                                  NamedSource& named) {
  Study moved = withRecordedHead(study, trace);
  if (moved.eye.recorded) {
    moved.eye.path.clear();
  } else if (!moved.eye.path.empty()) {
    moved.eye.recorded = eyePathOf(moved);
  } else {
    return {};
  }
  moved.eye.position_m.reset();
  moved.eye.look_at_m.reset();
  named.study = std::move(moved);
  named.warnings.addAll(study.gaze.source, headRemarks(*named.study, trace));
  const double first_s = trace.samples.front().time_s;
  const auto headAt = [path = *named.study->eye.recorded, first_s](double recording_s) {
    const glm::dmat4 pose = glm::inverse(glm::dmat4(path.eyeFromWorldAt(recording_s - first_s)));
    return HeadInWorld{.position_m = glm::dvec3(pose[3]),
                       .world_from_head = glm::normalize(glm::quat_cast(glm::dmat3(pose)))};
  };
  constexpr double kMinStep_s = 0.05, kMaxSteps = 4000.0;  // of the path that is shown
  const double last_s = trace.samples.back().time_s;
  const double step_s = std::max(kMinStep_s, (last_s - first_s) / kMaxSteps);
  for (double at_s = first_s; at_s <= last_s; at_s += step_s) {
    named.playback.path_m.push_back(headAt(at_s).position_m);
  }
  const Screen from = std::exchange(named.screen, named.study->screenInForce());
  for (GazeSample& sample : trace.samples) {
    if (sample.head) sample.head = headAt(sample.time_s);
    if (sample.point_px) sample.point_px = onOtherScreen_px(from, named.screen, *sample.point_px);
    for (EyeSample& eye : sample.eyes) {
      if (eye.point_px) eye.point_px = onOtherScreen_px(from, named.screen, *eye.point_px);
    }
  }
  trace.screen = named.screen;
  return headAt;
}

void openRecording(const std::string& file, const Study& study, NamedSource& named) {
  if (file.empty()) throw InputError("--source trace:", "expected a file's name");
  Study other = study;
  other.gaze.source = file;
  GazeTrace trace = loadGaze(other, named.warnings);
  sayAssumptions(other, trace);
  named.screen = *trace.screen;
  const auto headAt = followRecordedHead(other, trace, named);
  named.playback.file = file;
  named.playback.markers = trace.markers;
  named.playback.events = eventsOfRun(named.study.value_or(other), trace,
                                      trace.samples.front().time_s, trace.samples.back().time_s)
                              .events;
  auto player = std::make_unique<TracePlayer>(std::move(trace));
  named.player = player.get();
  if (headAt) {
    named.playback.head = [headAt, played = named.player](double time_s) {
      return headAt(played->recordingAt_s(time_s));
    };
  }
  named.source = std::move(player);
}

}  // namespace

std::unique_ptr<LiveSource> openPupil(const std::string& name, const Screen& screen) {
  const std::size_t colon = name.rfind(':');
  const auto port = parseNumber(name.substr(colon + 1));
  if (colon <= 5 || !port || *port != static_cast<int>(*port)) {
    throw InputError("--source " + shown(name), "expected pupil:HOST:PORT");
  }
#ifdef FOCI_PUPIL
  return std::make_unique<PupilSource>(name.substr(6, colon - 6), static_cast<int>(*port), screen);
#else
  (void)screen;
  throw InputError("--source " + shown(name), "built without Pupil (FOCI_PUPIL=OFF)");
#endif
}

NamedSource openLiveSource(const std::string& name, const Study& study) {
  NamedSource named{.source = nullptr, .screen = study.screenInForce()};
  if (name == "mouse") {
    auto mouse = std::make_unique<MouseSource>(kMouse_Hz);
    named.mouse = mouse.get();
    named.source = std::move(mouse);
  } else if (name.starts_with("trace:")) {
    openRecording(name.substr(6), study, named);
  } else if (name.starts_with("pupil:")) {
    named.source = openPupil(name, named.screen);
    if (!study.gaze.map) named.warnings.add(name, kOfSceneCamera);
    mapSource(study, named);
  } else if (name == "lsl" || name.starts_with("lsl:")) {
    const std::string stream = name == "lsl" ? "" : name.substr(4);
    named.source = std::make_unique<LslSource>(stream, study.columnsInForce(), named.screen);
    mapSource(study, named);
  } else if (name == "socket" || name.starts_with("socket:")) {
    openSocket(name, named);
    mapSource(study, named);
  } else if (const auto place = webcamPlaceOf(name)) {
    openWebcam(*place, study, named);
  } else {
    throw InputError("--source " + shown(name),
                     "expected mouse, trace:FILE, pupil:HOST:PORT, lsl[:NAME], socket[:RATE] or "
                     "webcam[:N|FILE]");
  }
  if (!named.player) addScreenDoubts(study, named.warnings);
  return named;
}

LiveNext openedFile(const std::filesystem::path& file, const StudyRequest& options,
                    const std::string& source, const Study& now) {
  if (isScene(file) || lowerExtension(file) == ".toml") {
    StudyAsked asked = studyOf({.study = file.string(),
                                .size = options.size,
                                .device = options.device,
                                .no_cache = options.no_cache});
    return {.study = std::move(asked.study),
            .scene = std::move(asked.scene),
            .source = source.starts_with("trace:") ? "mouse" : source,
            .title = file.filename().string()};
  }
  LiveNext next{.study = now,
                .source = "trace:" + file.string(),
                .title = now.file.filename().string() + ", " + file.filename().string()};
  openLiveSource(next.source, next.study);  // or says what is wrong with it
  return next;
}

}  // namespace foci
