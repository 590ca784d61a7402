#include "app/replay/replay_inputs.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "app/platform/sha256.h"
#include "app/study/inputs.h"
#include "base/input_error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "gaze/sources/trace_summary.h"

namespace foci {
namespace {

/// Those of the study, else of its marker, else of the recording.
std::vector<TraceTrial> trialsOf(const Study& study, const GazeTrace& trace, Warnings& warnings) {
  const double first_s = trace.samples.front().time_s, last_s = trace.samples.back().time_s;
  if (!study.trials.empty()) {
    const bool any = std::ranges::any_of(study.trials, [&](const TraceTrial& trial) {
      return trial.first_s <= last_s && trial.last_s > first_s;
    });
    if (!any) {
      warnings.add(study.file.string(),
                   "no [[trial]] lies within the recording, whose clock runs from " +
                       decimal(first_s, 3) + " to " + decimal(last_s, 3) + " s");
    }
    return study.trials;
  }
  const std::string& marker = study.gaze.trial_marker;
  if (marker.empty() && !trace.trials.empty()) return trace.trials;
  auto trials = trialsIn(trace.markers, marker.empty() ? kTrialMessage : marker, last_s);
  if (trials.empty() && !marker.empty()) {
    warnings.add(study.gaze.source, "no event marker begins with gaze.trial_marker = \"" + marker +
                                        "\", so there are no trials");
  }
  return trials;
}

/// The poses of a live run in a headset. Each frame has its own, and so has each sample of gaze.
/// @return time of the last frame
double takeRecordedPoses(ReplayedGaze& inputs) {
  const std::filesystem::path& file = *inputs.study.record.head;
  const std::vector<HeadRow> rows = readHeads(file);
  giveHeads(rows, inputs.trace.samples);
  const double start_s = inputs.trace.samples.front().time_s;
  std::vector<TrackedPose> poses;
  for (const HeadRow& row : rows) {
    if (row.of_sample) continue;
    poses.push_back({.time_s = row.time_s - start_s,
                     .position_m = row.head.position_m,
                     .world_from_eye = row.head.world_from_head});
  }
  if (poses.empty()) throw InputError(file.string(), "expected poses of frames");
  const double end_s = start_s + poses.back().time_s;
  inputs.study.eye.recorded = EyePath(std::move(poses));
  inputs.trace.screen = inputs.study.screenInForce();
  return end_s;
}

std::vector<FileToHash> opened(const Study& study) {
  const std::vector<std::filesystem::path> files = inputFiles(study);
  return {files.begin(), files.end()};
}

}  // namespace

ReplayedGaze readReplayedGaze(const Study& study, Warnings& warnings) {
  ReplayedGaze inputs{
      .study = {}, .trace = loadGaze(study, warnings), .schedule = {}, .changes = {}, .trials = {}};
  inputs.study = withRecordedHead(study, inputs.trace);
  std::optional<double> head_end_s;
  if (study.record.head) head_end_s = takeRecordedPoses(inputs);
  const glm::ivec2 size_px = inputs.study.imageSize_px();
  if (size_px.x % 2 != 0 || size_px.y % 2 != 0) {
    throw InputError(study.file.string(), "images of " + std::to_string(size_px.x) + "x" +
                                              std::to_string(size_px.y) +
                                              " px: expected even numbers, as H.264 wants");
  }
  warnings.addAll(study.gaze.source, headRemarks(inputs.study, inputs.trace));
  const auto& samples = inputs.trace.samples;
  const bool has_pupil = std::ranges::any_of(
      samples, [](const GazeSample& sample) { return sample.pupil_mm.has_value(); });
  if (study.observer.pupil == PupilModel::recording && !has_pupil && !study.record.frames) {
    throw InputError(study.file.string(),
                     "observer.pupil = \"recording\": the gaze has no pupil in millimetres; "
                     "expected \"fixed\" or \"luminance\"");
  }
  inputs.schedule = scheduleOf(study, inputs.trace);
  inputs.study.output.fps = inputs.schedule.fps;
  if (const auto& frames = inputs.schedule.recorded;
      head_end_s && !frames.empty() && frames.back().time_s > *head_end_s + 1e-6) {
    warnings.add(study.record.head->string(), "ends before the last frame: the head then rests");
  }
  if (study.record.changes) inputs.changes = readChanges(*study.record.changes);
  if (study.record.markers) inputs.trace.markers = readEventMarkers(*study.record.markers);
  inputs.trials = trialsOf(inputs.study, inputs.trace, warnings);
  return inputs;
}

InputHashes::InputHashes(const Study& study, std::vector<InputFile> known)
    : files_(std::async(
          maxThreads() > 1 ? std::launch::async : std::launch::deferred,
          [this, inputs = opened(study), known = std::move(known)]() mutable {
            const auto goOn = [this] {
              if (stop_) throw std::runtime_error("stopped");
            };
            std::vector<InputFile> files;
            for (FileToHash& input : inputs) {
              const auto of = std::ranges::find(known, input.path(), &InputFile::path);
              files.push_back({input.path(), of != known.end() ? of->sha256 : input.sha256(goOn)});
            }
            return files;
          })) {}

InputHashes::~InputHashes() { stop_ = true; }

std::vector<InputFile> InputHashes::get() {
  if (files_.wait_for(std::chrono::seconds(1)) == std::future_status::timeout) {
    say("computing the hashes of the input files, for the manifest");
  }
  return files_.get();
}

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
  const auto begin = std::ranges::find_if(all, within);
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
