#include "app/replay/join.h"

#include <algorithm>

#include "app/platform/progress.h"
#include "app/platform/sha256.h"
#include "app/replay/replay_inputs.h"
#include "app/study/inputs.h"
#include "app/study/load_scene.h"
#include "app/study/recorded_head.h"
#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "base/rows.h"

namespace foci {
namespace {

bool sameInputs(const Part& a, const Part& b) {
  return std::ranges::equal(a.inputs, b.inputs, {}, &InputFile::sha256, &InputFile::sha256);
}

/// @throws InputError unless `part` belongs to the same run as `first`
void requireSameRun(const Part& first, const Part& part) {
  const std::string both = first.folder.string() + " and " + part.folder.string();
  if (part.version != first.version) {
    throw InputError(both, "rendered by foci " + first.version + " and " + part.version +
                               "; expected one version");
  }
  if (part.configuration != first.configuration || part.frames != first.frames) {
    throw InputError(both, "have different studies; expected parts of one run");
  }
  if (!sameInputs(first, part)) {
    throw InputError(both, "have input files with different contents; expected parts of one run");
  }
}

std::string framesText(std::size_t first, std::size_t end) {
  return std::to_string(first) + ":" + std::to_string(end);
}

/// The devices of the parts, each once.
std::string devicesOf(const std::vector<Part>& parts, Warnings& warnings) {
  std::vector<std::string> devices;
  for (const Part& part : parts) {
    if (std::ranges::find(devices, part.device) == devices.end()) devices.push_back(part.device);
  }
  std::string text = listed(devices, "; ");
  if (devices.size() > 1) {
    warnings.add("the parts were rendered on " + text + ": they may differ in rounding");
  }
  return text;
}

/// Compares hashes. The part's own study.toml replaces two inputs: the run's study and the file of
/// its monitor. Neither needs to be as it was.
/// @throws InputError unless the parts were rendered from the files that the join reads
void requireSameFiles(const Part& part, const Study& study, const Study& stated) {
  for (std::size_t i = 0; i < part.inputs.size(); ++i) {
    const auto& [path, sha256] = part.inputs[i];
    const std::filesystem::path& place = part.input_places[i];
    const bool replaced = path == part.study_file || path == stated.screen.monitor;
    if (replaced && place != study.scene.file) continue;
    if (FileToHash(place).sha256() == sha256) continue;
    throw InputError(path.string(),
                     "is not the file that the parts were rendered from; render the parts again");
  }
}

/// Times on the recording's clock tell whether the recording is still the one that was rendered.
void requireSameTimes(const Part& part, const Schedule& schedule) {
  for (std::size_t i = 0; i < part.all.size(); ++i) {
    const std::size_t frame = part.span.first + i;
    if (frame < schedule.frames && part.all[i].seen.record.time_s == schedule.time_s(frame))
      continue;
    throw InputError(part.folder.string(),
                     "has other times than the recording; render the part again");
  }
}

}  // namespace

std::vector<Part> inOrder(std::vector<Part> parts) {
  std::ranges::sort(parts, {}, [](const Part& part) { return part.span.first; });
  std::size_t next = 0;
  for (const Part& part : parts) {
    requireSameRun(parts.front(), part);
    if (part.span.first > next) {
      throw InputError("frames " + framesText(next, part.span.first), "are in none of the parts");
    }
    if (part.span.first < next) {
      throw InputError(part.folder.string(),
                       "frames " + framesText(part.span.first, std::min(next, part.span.end)) +
                           " are in another part, too");
    }
    next = part.span.end;
  }
  if (next < parts.front().frames) {
    throw InputError("frames " + framesText(next, parts.front().frames),
                     "are in none of the parts");
  }
  return parts;
}

RunResult join(const std::vector<Part>& parts, const Study& study, const std::filesystem::path& out,
               const std::string& command, const OutputGuard& guard) {
  Study stated = statedStudyOf(parts.front());
  requireSameFiles(parts.front(), study, stated);
  Warnings warnings;
  const ReplayedGaze gaze = readReplayedGaze(study, warnings);
  stated = withRecordedHead(stated, gaze.trace);
  stated.output.fps = gaze.study.output.fps;
  for (const Part& part : parts) requireSameTimes(part, gaze.schedule);
  const Scene scene = loadScene(gaze.study, warnings);
  warnings.add(eyeRemark(gaze.study));
  RunWriter writer(stated, gaze, scene, out, guard, warnings);
  sayAssumptions(gaze.study, gaze.trace);
  Progress progress("joining", "frames", gaze.schedule.frames);
  RunFacts facts{.command = command,
                 .threads = parts.front().threads,
                 .device = devicesOf(parts, warnings),
                 .inputs = parts.front().inputs};
  std::size_t frame = 0;
  Image image;
  for (const Part& part : parts) {
    for (const std::string& warning : part.warnings) warnings.add(warning);
    for (std::size_t i = 0; i < part.all.size(); ++i) {
      if (!part.all[i].image.empty()) image = imageOf(part, part.all[i], stated.imageSize_px());
      writer.add(frame, part.all[i].seen, image);
      const std::vector<FrameMap>& maps = stated.output.maps;
      const std::vector<std::string> files = mapsOf(part, i, maps);
      for (std::size_t k = 0; k < maps.size(); ++k) writer.addMap(maps[k], frame, files[k]);
      ++frame;
      progress.advance(frame);
    }
  }
  return writer.finish(facts);
}

}  // namespace foci
