#include "app/replay/replay_inputs.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "app/platform/sha256.h"
#include "app/study/inputs.h"
#include "app/study/recorded_head.h"
#include "base/input_error.h"

namespace foci {

ReplayedGaze readReplayedGaze(const Study& study) {
  ReplayedGaze inputs{
      .study = {}, .trace = loadGaze(study), .schedule = {}, .changes = {}, .markers = {}};
  inputs.study = withRecordedHead(study, inputs.trace);
  const glm::ivec2 size_px = inputs.study.imageSize_px();
  if (size_px.x % 2 != 0 || size_px.y % 2 != 0) {
    throw InputError(study.file.string(), "images of " + std::to_string(size_px.x) + "x" +
                                              std::to_string(size_px.y) +
                                              " px: expected even numbers, as H.264 wants");
  }
  for (const std::string& remark : headRemarks(inputs.study, inputs.trace)) {
    std::fprintf(stderr, "foci: %s: %s\n", study.gaze.source.c_str(), remark.c_str());
  }
  const auto& samples = inputs.trace.samples;
  const bool has_pupil = std::any_of(samples.begin(), samples.end(), [](const GazeSample& sample) {
    return sample.pupil_mm.has_value();
  });
  if (study.observer.pupil == PupilModel::recording && !has_pupil && !study.record.frames) {
    throw InputError(study.file.string(),
                     "observer.pupil = \"recording\": the gaze has no pupil in millimetres; "
                     "expected \"fixed\" or \"luminance\"");
  }
  inputs.schedule = scheduleOf(study, inputs.trace);
  if (study.record.changes) inputs.changes = readChanges(*study.record.changes);
  if (study.record.markers) {
    inputs.markers = readEventMarkers(*study.record.markers);
  } else {
    inputs.markers.reserve(inputs.trace.markers.size());
    for (const TraceMarker& marker : inputs.trace.markers) {
      inputs.markers.push_back({marker.time_s, marker.text});
    }
  }
  return inputs;
}

std::vector<InputFile> hashedInputs(const Study& study) {
  std::vector<InputFile> files;
  for (const auto& file : inputFiles(study)) files.push_back({file, sha256OfFile(file)});
  return files;
}

}  // namespace foci
