#include "app/replay/compared_run.h"

#include <algorithm>
#include <cmath>

#include "app/replay/fixation_tables.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

template <class Get>
double meanOf(const std::vector<RunFrame>& frames, const Get& get) {
  double sum = 0.0;
  for (const RunFrame& frame : frames) sum += get(frame);
  return sum / static_cast<double>(frames.size());
}

}  // namespace

double ComparedRun::duration_s() const {
  const auto count = static_cast<double>(frames.size());
  return frames.size() < 2 ? 0.0 : frames.back().time_s * count / (count - 1.0);
}

double ComparedRun::meanFocus_D() const {
  return meanOf(frames, [](const RunFrame& frame) { return frame.focus_D; });
}

double ComparedRun::meanPupil_mm() const {
  return meanOf(frames, [](const RunFrame& frame) { return frame.pupil_mm; });
}

std::optional<double> ComparedRun::meanBlur_arcmin() const {
  double sum = 0.0;
  std::size_t count = 0;
  for (const RunFrame& frame : frames) {
    if (!std::isfinite(frame.surface_D)) continue;
    sum += 1e-3 * frame.pupil_mm * std::abs(frame.surface_D - frame.focus_D) * kArcminPerRad;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

ComparedRun readRun(const std::filesystem::path& folder) {
  ComparedRun run{.folder = folder, .name = folder.lexically_normal().filename().string()};
  if (run.name.empty()) run.name = folder.lexically_normal().parent_path().filename().string();
  run.frames = framesOfRun(folder);
  const double first_s = run.frames.front().time_s;
  for (RunFrame& frame : run.frames) frame.time_s -= first_s;
  run.fixations = fixationsOfRun(folder).size();
  NamedTable objects = tableOfRun(folder, "objects.tsv");
  const std::size_t object = objects.column("object"), dwell = objects.column("dwell_s");
  objects.withoutComments();  // an object may be named #1
  while (objects.next()) {
    run.dwell_s[std::string(objects.text(object))] += objects.needed(dwell);
  }
  std::vector<std::size_t> wanted;
  for (std::size_t k = 0; k < kPictures; ++k) {
    wanted.push_back((2 * k + 1) * run.frames.size() / (2 * kPictures));
  }
  run.pictures = videoFrames(folder, wanted);
  return run;
}

}  // namespace foci
