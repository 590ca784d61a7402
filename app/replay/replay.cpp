#include "app/replay/replay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "app/graphics/image.h"
#include "app/graphics/video_writer.h"
#include "app/platform/interrupt.h"
#include "app/platform/output_folder.h"
#include "app/platform/progress.h"
#include "app/platform/sha256.h"
#include "app/record/manifest.h"
#include "app/record/record_files.h"
#include "app/record/run_events.h"
#include "app/record/tables.h"
#include "app/replay/report.h"
#include "app/session/observer_eye.h"
#include "app/session/session.h"
#include "app/study/inputs.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kSheetImages = 12;
constexpr int kSheetWidth_px = 480;
constexpr double kMaxFrames = 1e7;

/// The frames of a replay, on the recording's clock.
struct Schedule {
  double first_s = 0.0;
  double fps = 0.0;
  std::size_t frames = 0;
  std::vector<RecordedFrame> recorded{};  ///< of a live run: those to be looked at
  std::size_t first = 0;                  ///< of the recorded frames that is rendered

  double time_s(std::size_t frame) const {
    return recorded.empty() ? first_s + static_cast<double>(frame) / fps
                            : recorded[first + frame].time_s;
  }
  double end_s() const {
    return recorded.empty() ? time_s(frames) : time_s(frames - 1) + 1.0 / fps;
  }
};

/// The frames of a live run within `output.seconds`.
Schedule recordedSchedule(const Study& study, double start_s) {
  Schedule schedule{.fps = study.output.fps, .recorded = readFrames(*study.record.frames)};
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

/// The contact sheet, chosen while frames go by: of each of equal stretches of the replay the frame
/// at which a fixation has lasted longest, so that the focus has settled; where there is none, the
/// stretch's first.
class ContactSheet {
 public:
  explicit ContactSheet(std::size_t frames)
      : frames_(frames), count_(std::min(frames, kSheetImages)) {}

  void offer(std::size_t frame, const Session& session, const FrameRecord& record,
             const Image& image) {
    held_frames_ = record.eye.state == GazeState::fixation ? held_frames_ + 1 : 0;
    const std::size_t stretch = frame * count_ / frames_;
    const bool is_new = stretch >= chosen_.size();
    // Not two of neighbouring stretches that show the same.
    const bool apart = chosen_.size() < 2 || 2 * (frame - before_) * count_ >= frames_;
    if (!is_new && (held_frames_ <= best_ || !apart)) return;
    if (is_new) before_ = at_;
    at_ = frame;
    if (is_new) chosen_.emplace_back();
    best_ = is_new ? 0 : held_frames_;
    chosen_.back() = {record, thumbnail(image, std::min(kSheetWidth_px, image.size_px.x)),
                      session.gazePoints_px(record)};
  }

  std::vector<SheetImage> images(const glm::ivec2& image_px) const {
    std::vector<SheetImage> sheet;
    for (const auto& [record, small, points_px] : chosen_) {
      Image image = small;
      const double scale = static_cast<double>(small.size_px.x) / image_px.x;
      for (const glm::dvec2& point_px : points_px) {
        drawMarker(image, scale * point_px, isHeld(record));
      }
      sheet.push_back({.time_s = record.time_s,
                       .state = record.eye.state,
                       .focus_D = record.eye.focus_D,
                       .surface_distance_m = record.eye.surface_distance_m,
                       .jpeg = jpegOf(image)});
    }
    return sheet;
  }

 private:
  struct Chosen {
    FrameRecord record;
    Image small;
    std::vector<glm::dvec2> points_px;  // of gaze, in the whole image
  };
  std::size_t frames_, count_;
  std::size_t held_frames_ = 0, best_ = 0;
  std::size_t at_ = 0, before_ = 0;  // frames chosen last, and in the stretch before
  std::vector<Chosen> chosen_;
};

ChartRow chartRow(const FrameRecord& record) {
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  const auto& surface_m = record.eye.surface_distance_m;
  return {.time_s = record.time_s,
          .gaze_x_px = record.gaze_px ? record.gaze_px->x : kAbsent,
          .gaze_y_px = record.gaze_px ? record.gaze_px->y : kAbsent,
          .surface_D = surface_m ? 1.0 / *surface_m : kAbsent,
          .target_D = record.eye.target_D.value_or(kAbsent),
          .focus_D = record.eye.focus_D,
          .pupil_mm = record.pupil_mm,
          .render_ms = record.stats.ms,
          .state = record.eye.state};
}

/// Counts the samples of the replayed time, and those without a gaze point.
void countLosses(const GazeTrace& trace, const Schedule& schedule, ReportFacts& facts) {
  const double end_s = schedule.end_s();
  std::optional<double> lost_since_s;
  for (const GazeSample& sample : trace.samples) {
    if (sample.time_s < schedule.first_s || sample.time_s > end_s) continue;
    ++facts.samples;
    facts.samples_blink += sample.blink;
    if (sample.point_px) {
      lost_since_s.reset();
      continue;
    }
    ++facts.samples_lost;
    if (!lost_since_s) lost_since_s = sample.time_s;
    facts.longest_loss_s = std::max(facts.longest_loss_s, sample.time_s - *lost_since_s);
  }
}

}  // namespace

RunSummary replay(const Study& study, const std::filesystem::path& out, const std::string& command,
                  unsigned threads) {
  // Everything that can be refused is, before anything is written.
  const glm::ivec2 size_px = study.imageSize_px();
  if (size_px.x % 2 != 0 || size_px.y % 2 != 0) {
    throw InputError(study.file.string(), "images of " + std::to_string(size_px.x) + "x" +
                                              std::to_string(size_px.y) +
                                              " px: expected even numbers, as H.264 wants");
  }
  const GazeTrace trace = loadGaze(study);
  const bool has_pupil =
      std::any_of(trace.samples.begin(), trace.samples.end(),
                  [](const GazeSample& sample) { return sample.pupil_mm.has_value(); });
  if (study.observer.pupil == "recording" && !has_pupil && !study.record.frames) {
    throw InputError(study.file.string(),
                     "observer.pupil = \"recording\": the gaze has no pupil in millimetres; "
                     "expected \"fixed\" or \"luminance\"");
  }
  const Schedule schedule = scheduleOf(study, trace);
  std::vector<Change> changes;
  if (study.record.changes) changes = readChanges(*study.record.changes);
  const SurfelCloud cloud = loadScene(study);
  ManifestFacts facts{.command = command,
                      .threads = threads,
                      .gaze = factsOf(trace),
                      .inputs = {},
                      .frames_sha256 = {}};
  for (const auto& file : inputFiles(study)) facts.inputs.push_back({file, sha256OfFile(file)});

  Session session(study, cloud, *trace.screen, trace.rate_Hz, trace.samples.front().time_s);
  noteInterrupts();
  if (const std::string remark = ellipseText(study); !remark.empty()) {
    std::fprintf(stderr, "foci: %s\n", remark.c_str());
  }
  OutputFolder folder(out);
  const auto video_file = folder.stage("video.mp4");
  VideoWriter video(video_file, size_px, study.output.fps);
  FrameTable table(folder.stage("frames.tsv"));
  ContactSheet sheet(schedule.frames);
  ChartSeries series;
  ReportFacts report;
  report.threads = threads;
  Sha256 frames_hash;
  Image plain;  // without a mark
  std::vector<float> render_ms, rendered_ms;
  std::vector<float> pupil_mm;
  std::vector<std::uint32_t> splats;
  std::size_t frames_held = 0;
  Progress progress("rendering", "frames", schedule.frames);

  auto sample = trace.samples.begin();
  auto change = changes.begin();
  const auto lookAt = [&](double time_s) {
    for (; change != changes.end() && change->time_s <= time_s; ++change) {
      session.change(change->key, change->toml);
    }
    for (; sample != trace.samples.end() && sample->time_s <= time_s; ++sample) {
      session.push(*sample);
    }
    return session.look(time_s);
  };
  // What the eye did before the first frame that is rendered counts, too.
  for (std::size_t i = 0; i < schedule.first; ++i) {
    FrameRecord record = lookAt(schedule.recorded[i].time_s);
    if (study.observer.pupil == "luminance") {
      session.render(schedule.recorded[i].method, record);
    }
  }
  for (std::size_t i = 0; i < schedule.frames; ++i) {
    throwIfInterrupted();
    FrameRecord record = lookAt(schedule.time_s(i));
    const Frame& frame =
        session.render(schedule.recorded.empty() ? session.study().render.method
                                                 : schedule.recorded[schedule.first + i].method,
                       record);
    if (record.rendered || plain.rgb.empty()) plain = imageOf(frame, study.screen.gamma);
    Image image = plain;
    sheet.offer(i, session, record, image);
    session.mark(record, image);
    if (record.stats.tolerance_error > session.study().quality.tolerance) {
      if (report.frames_over++ == 0) report.first_over_s = record.time_s;
    }
    report.worst_error = std::max(report.worst_error, record.stats.tolerance_error.value_or(0.0));
    frames_held += record.eye.state == GazeState::blink || record.eye.state == GazeState::lost;
    table.add(i, record);
    series.add(chartRow(record));
    pupil_mm.push_back(static_cast<float>(record.pupil_mm));
    render_ms.push_back(static_cast<float>(record.stats.ms));
    if (record.rendered) rendered_ms.push_back(render_ms.back());
    splats.push_back(static_cast<std::uint32_t>(record.stats.splats));
    frames_hash.add(image.rgb);
    if (study.output.images) {
      const auto png = pngOf(image);
      std::string number = std::to_string(i);
      number.insert(0, 6 - std::min<std::size_t>(6, number.size()), '0');
      writeText(folder.stage("frame-" + number + ".png"), {png.begin(), png.end()});
    }
    video.push(std::move(image));
    progress.advance(i + 1);
  }
  video.finish();
  table.finish();
  facts.frames_sha256 = frames_hash.hex();

  const std::vector<GazeEvent> events =
      eventsOfRun(study, trace, schedule.first_s, schedule.end_s());
  writeText(folder.stage("events.tsv"), eventTable(events));

  report.frames_held = frames_held;
  countLosses(trace, schedule, report);
  RunSummary& summary = report.summary;
  summary = {.frames = schedule.frames,
             .duration_s = static_cast<double>(schedule.frames) / schedule.fps,
             .gaze_valid = report.samples == 0 ? 0.0
                                               : 1.0 - static_cast<double>(report.samples_lost) /
                                                           static_cast<double>(report.samples),
             .fixations = countOf(events, GazeState::fixation),
             .saccades = countOf(events, GazeState::saccade),
             .render_ms_median = quantile(render_ms, 0.5),
             .render_ms_p95 = quantile(render_ms, 0.95),
             .frames_rendered = rendered_ms.size(),
             .rendered_ms_median = rendered_ms.empty() ? 0.0 : quantile(rendered_ms, 0.5),
             .rendered_ms_p95 = rendered_ms.empty() ? 0.0 : quantile(rendered_ms, 0.95),
             .splats = quantile(splats, 0.5),
             .pupil_mm = quantile(pupil_mm, 0.5),
             .out = out};
  if (const std::string warning = toleranceText(study, report); !warning.empty()) {
    std::fprintf(stderr, "foci: %s\n", warning.c_str());
  }
  writeText(folder.stage("manifest.json"), manifestJson(study, summary, facts));
  report.rows = series.rows();
  report.sheet = sheet.images(size_px);
  if (!writeReport(folder.stage("report.html"), video_file, study, trace, report)) {
    std::fputs(
        "foci: the report has no charts: gnuplot is not installed (apt install gnuplot-nox)\n",
        stderr);
  }
  folder.commit();
  return summary;
}

}  // namespace foci
