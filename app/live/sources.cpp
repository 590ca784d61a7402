#include "app/live/sources.h"

#include <algorithm>
#include <utility>

#include "app/study/gaze_calibration.h"
#include "app/study/inputs.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/webcam/webcam_calibration.h"
#include "gaze/live/lsl_source.h"
#include "gaze/webcam/webcam_source.h"
#ifdef FOCI_PUPIL
#include "gaze/live/pupil_source.h"
#endif

namespace foci {
namespace {

constexpr double kMouse_Hz = 250.0;   // as a common tracker
constexpr double kPushed_Hz = 500.0;  // between common trackers, 60 to 2000 Hz

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
  const std::string remark = tracker.remark();
  named.source = std::make_unique<WebcamSource>(place, std::move(tracker), map);
  if (!remark.empty()) named.warnings.add(remark);
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

}  // namespace

NamedSource openLiveSource(const std::string& name, const Study& study) {
  NamedSource named{.source = nullptr, .screen = study.screenInForce()};
  if (name == "mouse") {
    auto mouse = std::make_unique<MouseSource>(kMouse_Hz);
    named.mouse = mouse.get();
    named.source = std::move(mouse);
  } else if (name.starts_with("trace:")) {
    Study other = study;
    other.gaze.source = name.substr(6);
    if (other.gaze.source.empty()) throw InputError("--source trace:", "expected a file's name");
    GazeTrace trace = loadGaze(other, named.warnings);
    const bool moves_head = std::any_of(trace.samples.begin(), trace.samples.end(),
                                        [](const GazeSample& sample) { return sample.head; });
    if (moves_head) {
      throw InputError("--source " + shown(name),
                       "records a head, which moves the eye in foci replay only");
    }
    sayAssumptions(other, trace);
    named.screen = *trace.screen;
    named.source = std::make_unique<TraceSource>(std::move(trace));
  } else if (name.starts_with("pupil:")) {
    named.source = openPupil(name, named.screen);
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
  return named;
}

}  // namespace foci
