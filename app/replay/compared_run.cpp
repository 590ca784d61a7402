#include "app/replay/compared_run.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "app/replay/fixation_tables.h"
#include "base/input_error.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

std::vector<Image> picturesOf(const std::filesystem::path& video, std::size_t frames) {
  requireRegularFile(video);
#ifdef FOCI_VIDEO
  std::vector<Image> pictures;
  cv::VideoCapture capture(video.string());
  cv::Mat bgr;
  std::size_t next = 0;
  for (int k = 0; k < kPictures; ++k) {
    const std::size_t wanted = (2 * static_cast<std::size_t>(k) + 1) * frames / (2 * kPictures);
    for (; next <= wanted; ++next) {
      if (!capture.read(bgr)) throw InputError(video.string(), "ends before the tables do");
    }
    Image image{.size_px = {bgr.cols, bgr.rows}, .rgb = {}};
    cv::Mat rgb;
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    image.rgb.assign(rgb.datastart, rgb.dataend);
    pictures.push_back(std::move(image));
  }
  return pictures;
#else
  throw InputError(video.string(), "this foci was built without videos (FOCI_VIDEO), where " +
                                       std::to_string(frames) + " frames are");
#endif
}

template <class Get>
double meanOf(const std::vector<ComparedFrame>& frames, const Get& get) {
  double sum = 0.0;
  for (const ComparedFrame& frame : frames) sum += get(frame);
  return sum / static_cast<double>(frames.size());
}

}  // namespace

double ComparedRun::duration_s() const {
  const auto count = static_cast<double>(frames.size());
  return frames.size() < 2 ? 0.0 : frames.back().time_s * count / (count - 1.0);
}

double ComparedRun::meanFocus_D() const {
  return meanOf(frames, [](const ComparedFrame& frame) { return frame.focus_D; });
}

double ComparedRun::meanPupil_mm() const {
  return meanOf(frames, [](const ComparedFrame& frame) { return frame.pupil_mm; });
}

std::optional<double> ComparedRun::meanBlur_arcmin() const {
  double sum = 0.0;
  std::size_t count = 0;
  for (const ComparedFrame& frame : frames) {
    if (!frame.off_focus_D) continue;
    sum += 1e-3 * frame.pupil_mm * *frame.off_focus_D * kArcminPerRad;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

ComparedRun readRun(const std::filesystem::path& folder) {
  ComparedRun run{.folder = folder, .name = folder.lexically_normal().filename().string()};
  if (run.name.empty()) run.name = folder.lexically_normal().parent_path().filename().string();
  const auto table = [&](const char* name) {
    return NamedTable(folder / name, "the folder of a replay by this version of foci");
  };
  NamedTable frames = table("frames.tsv");
  const std::size_t time = frames.column("time_s"), focus = frames.column("focus_D");
  const std::size_t pupil = frames.column("pupil_mm");
  const std::size_t surface = frames.column("surface_distance_m");
  while (frames.next()) {
    ComparedFrame& frame = run.frames.emplace_back();
    frame = {.time_s = frames.needed(time),
             .focus_D = frames.needed(focus),
             .pupil_mm = frames.needed(pupil)};
    if (const auto surface_m = frames.number(surface)) {
      frame.off_focus_D = std::abs(1.0 / *surface_m - frame.focus_D);
    }
  }
  if (run.frames.empty()) throw InputError(frames.fileName(), "has no frames");
  const double first_s = run.frames.front().time_s;
  for (ComparedFrame& frame : run.frames) frame.time_s -= first_s;
  NamedTable events = table("events.tsv");
  const std::size_t event = events.column("event");
  while (events.next()) run.fixations += events.text(event) == "fixation";
  NamedTable objects = table("objects.tsv");
  const std::size_t object = objects.column("object"), dwell = objects.column("dwell_s");
  objects.withoutComments();  // an object may be named #1
  while (objects.next()) {
    run.dwell_s[std::string(objects.text(object))] += objects.needed(dwell);
  }
  run.pictures = picturesOf(folder / "video.mp4", run.frames.size());
  return run;
}

}  // namespace foci
