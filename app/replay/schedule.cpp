#include "app/replay/schedule.h"

#include <algorithm>
#include <cmath>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kMaxFrames = 1e7;  // more is a slip of the keyboard: 11 hours at 240 Hz

/// The frames of a live run within `output.seconds`.
Schedule recordedSchedule(const Study& study, double start_s) {
  Schedule schedule{.recorded = readFrames(*study.record.frames)};
  const auto& frames = schedule.recorded;
  schedule.fps = meanRate_Hz(frames.size(), frames.back().time_s - frames.front().time_s,
                             study.output.fps);  // a killed run's study has no mean rate
  const glm::dvec2 seconds = study.output.seconds.value_or(glm::dvec2(-1e12, 1e12));
  const auto within = [&](const RecordedFrame& frame) {
    return frame.time_s >= start_s + seconds.x && frame.time_s <= start_s + seconds.y;
  };
  auto& all = schedule.recorded;
  const auto begin = std::find_if(all.begin(), all.end(), within);
  if (begin == all.end()) {
    throw InputError(study.file.string(), "output.seconds: no frame of the record lies within");
  }
  all.erase(std::find_if_not(begin, all.end(), within), all.end());
  schedule.first = static_cast<std::size_t>(begin - all.begin());
  schedule.frames = all.size() - schedule.first;
  schedule.first_s = schedule.time_s(0);
  return schedule;
}

}  // namespace

Schedule scheduleOf(const Study& study, const GazeTrace& trace) {
  const double start_s = trace.samples.front().time_s;
  if (study.record.frames) return recordedSchedule(study, start_s);
  const double span_s = trace.samples.back().time_s - start_s;
  const glm::dvec2 seconds = study.output.seconds.value_or(glm::dvec2(0.0, span_s));
  if (seconds.x >= span_s) {
    throw InputError(study.file.string(), "output.seconds begins at " + decimal(seconds.x, 3) +
                                              ": expected within the recording, 0 to " +
                                              decimal(span_s, 3));
  }
  const double frames = (std::min(seconds.y, span_s) - seconds.x) * study.output.fps;
  if (frames > kMaxFrames) {
    throw InputError(study.file.string(),
                     "the recording has " + decimal(frames, 0) +
                         " frames: expected at most 10 million; choose output.seconds");
  }
  return {.first_s = start_s + seconds.x,
          .fps = study.output.fps,
          .frames = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(frames)))};
}

}  // namespace foci
