#include "app/replay/replay.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "app/graphics/image.h"
#include "app/graphics/video_writer.h"
#include "app/platform/interrupt.h"
#include "app/platform/output_folder.h"
#include "app/platform/progress.h"
#include "app/platform/sha256.h"
#include "app/record/gaze_marker.h"
#include "app/record/manifest.h"
#include "app/record/record_files.h"
#include "app/record/run_events.h"
#include "app/record/tables.h"
#include "app/replay/contact_sheet.h"
#include "app/replay/report.h"
#include "app/replay/schedule.h"
#include "app/session/session.h"
#include "app/study/inputs.h"
#include "app/study/live_change.h"
#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "base/quantile.h"

namespace foci {
namespace {

constexpr const char *kVideo = "video.mp4", *kFrames = "frames.tsv", *kEvents = "events.tsv",
                     *kManifest = "manifest.json", *kReport = "report.html";
constexpr const char* kImage = "frame-";  // and its number

/// What a replay reads. Reading it all refuses bad input before anything is written.
struct ReplayInputs {
  GazeTrace trace;
  Schedule schedule;
  std::vector<Change> changes;
  std::vector<EventMarker> markers;
  SurfelCloud cloud;
  std::vector<InputFile> files;
};

ReplayInputs readInputs(const Study& study, std::optional<SceneFile>&& scene) {
  const glm::ivec2 size_px = study.imageSize_px();
  if (size_px.x % 2 != 0 || size_px.y % 2 != 0) {
    throw InputError(study.file.string(), "images of " + std::to_string(size_px.x) + "x" +
                                              std::to_string(size_px.y) +
                                              " px: expected even numbers, as H.264 wants");
  }
  ReplayInputs inputs{.trace = loadGaze(study),
                      .schedule = {},
                      .changes = {},
                      .markers = {},
                      .cloud = {},
                      .files = {}};
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
  if (study.record.markers) inputs.markers = readEventMarkers(*study.record.markers);
  inputs.cloud = loadScene(study, std::move(scene));
  for (const auto& file : inputFiles(study)) inputs.files.push_back({file, sha256OfFile(file)});
  return inputs;
}

/// The observer of a replay: gives samples and changed keys to a session, frame after frame.
class ReplayedEye {
 public:
  ReplayedEye(const Study& study, const ReplayInputs& inputs)
      : study_(study),
        inputs_(inputs),
        session_(sessionSettingsOf(study), inputs.cloud, *inputs.trace.screen, inputs.trace.rate_Hz,
                 inputs.trace.samples.front().time_s) {
    lookAtSkippedFrames();
  }

  FrameRecord look(double time_s) {
    const GazeTrace& trace = inputs_.trace;
    const std::vector<Change>& changes = inputs_.changes;
    for (; change_ < changes.size() && changes[change_].time_s <= time_s; ++change_) {
      changeLive(study_, session_, changes[change_].key, changes[change_].toml);
    }
    for (; sample_ < trace.samples.size() && trace.samples[sample_].time_s <= time_s; ++sample_) {
      session_.push(trace.samples[sample_]);
    }
    return session_.look(time_s);
  }

  /// Renders a frame of the schedule that has just been looked at.
  const Frame& render(std::size_t frame, FrameRecord& record) {
    const Schedule& schedule = inputs_.schedule;
    return session_.render(schedule.recorded.empty()
                               ? study_.render.method
                               : schedule.recorded[schedule.first + frame].method,
                           record);
  }

  /// Says what renders, and whether a live run's record comes from another device.
  void sayDevice() const {
    const std::string device = session_.deviceOf(study_.render.method);
    std::fprintf(stderr, "foci: renders on %s\n", device.c_str());
    const std::string& recorded = study_.record.device;
    if (recorded.empty() || recorded == device) return;
    std::fprintf(stderr,
                 "foci: the run was rendered on %s: the frames may differ from it in rounding\n",
                 recorded.c_str());
  }

  const Session& session() const { return session_; }
  /// With the changes so far.
  const Study& study() const { return study_; }

 private:
  /// What the eye of a live run did before the first rendered frame counts, too.
  void lookAtSkippedFrames() {
    const Schedule& schedule = inputs_.schedule;
    for (std::size_t i = 0; i < schedule.first; ++i) {
      FrameRecord record = look(schedule.recorded[i].time_s);
      if (study_.observer.pupil == PupilModel::luminance) {
        session_.render(schedule.recorded[i].method, record);
      }
    }
  }

  Study study_;
  const ReplayInputs& inputs_;
  Session session_;
  std::size_t sample_ = 0, change_ = 0;  // next of each
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

/// What the frames of a run add up to.
class FrameStatistics {
 public:
  /// @param tolerance  of the frame, JND
  void add(const FrameRecord& record, double tolerance) {
    if (record.stats.tolerance_error > tolerance && frames_over_++ == 0) {
      first_over_s_ = record.time_s;
    }
    worst_error_ = std::max(worst_error_, record.stats.tolerance_error.value_or(0.0));
    frames_without_gaze_ +=
        record.eye.state == GazeState::blink || record.eye.state == GazeState::lost;
    pupil_mm_.push_back(static_cast<float>(record.pupil_mm));
    render_ms_.push_back(static_cast<float>(record.stats.ms));
    if (record.rendered) rendered_ms_.push_back(render_ms_.back());
    splats_.push_back(static_cast<std::uint32_t>(record.stats.splats));
    charts_.add(chartRow(record));
  }

  void fill(RunSummary& summary) {
    summary.frames = render_ms_.size();
    summary.render_ms_median = quantile(render_ms_, 0.5);
    summary.render_ms_p95 = quantile(render_ms_, 0.95);
    summary.frames_rendered = rendered_ms_.size();
    summary.rendered_ms_median = rendered_ms_.empty() ? 0.0 : quantile(rendered_ms_, 0.5);
    summary.rendered_ms_p95 = rendered_ms_.empty() ? 0.0 : quantile(rendered_ms_, 0.95);
    summary.splats = quantile(splats_, 0.5);
    summary.pupil_mm = quantile(pupil_mm_, 0.5);
  }

  void fill(ReportFacts& facts) const {
    facts.rows = charts_.rows();
    facts.frames_without_gaze = frames_without_gaze_;
    facts.frames_over = frames_over_;
    facts.first_over_s = first_over_s_;
    facts.worst_error = worst_error_;
    const auto [min, max] = std::minmax_element(pupil_mm_.begin(), pupil_mm_.end());
    facts.pupil_min_mm = *min;
    facts.pupil_max_mm = *max;
  }

 private:
  ChartSeries charts_;
  std::vector<float> render_ms_, rendered_ms_, pupil_mm_;
  std::vector<std::uint32_t> splats_;
  std::size_t frames_without_gaze_ = 0, frames_over_ = 0;
  double first_over_s_ = 0.0, worst_error_ = 0.0;
};

/// Counts the samples of the replayed time, and those without a gaze point.
void countDataLoss(const GazeTrace& trace, const Schedule& schedule, ReportFacts& facts) {
  const double end_s = schedule.end_s();
  std::optional<double> absent_since_s;
  for (const GazeSample& sample : trace.samples) {
    if (sample.time_s < schedule.first_s || sample.time_s > end_s) continue;
    ++facts.samples;
    facts.samples_blink += sample.blink;
    if (sample.point_px) {
      absent_since_s.reset();
      continue;
    }
    ++facts.samples_without_gaze;
    if (!absent_since_s) absent_since_s = sample.time_s;
    facts.longest_data_loss_s =
        std::max(facts.longest_data_loss_s, sample.time_s - *absent_since_s);
  }
}

/// Frames as images: into the video, the hash of the run, and files of their own if wanted.
class FrameFiles {
 public:
  FrameFiles(const Study& study, OutputFolder& folder)
      : folder_(folder),
        images_(study.output.images),
        video_file_(folder.stage(kVideo)),
        video_(video_file_, study.imageSize_px(), study.output.fps) {}

  void add(std::size_t frame, Image&& image) {
    hash_.add(image.rgb);
    if (images_) {
      const auto png = pngOf(image);
      std::string number = std::to_string(frame);
      number.insert(0, 6 - std::min<std::size_t>(6, number.size()), '0');
      folder_.write(kImage + number + ".png", {png.begin(), png.end()});
    }
    video_.push(std::move(image));
  }

  /// @return the hash of all frames
  std::string finish() {
    video_.finish();
    return hash_.hex();
  }

  const std::filesystem::path& videoFile() const { return video_file_; }

 private:
  OutputFolder& folder_;
  bool images_;
  std::filesystem::path video_file_;
  VideoWriter video_;
  Sha256 hash_;
};

void renderFrames(const ReplayInputs& inputs, ReplayedEye& eye, FrameFiles& files,
                  FrameTable& table, ContactSheet& sheet, FrameStatistics& statistics) {
  const std::size_t frames = inputs.schedule.frames;
  Progress progress("rendering", "frames", frames);
  Image plain;  // the last frame without marker
  for (std::size_t i = 0; i < frames; ++i) {
    throwIfInterrupted();
    FrameRecord record = eye.look(inputs.schedule.time_s(i));
    const Frame& frame = eye.render(i, record);
    if (record.rendered || plain.rgb.empty()) plain = imageOf(frame, eye.study().screen.gamma);
    Image image = plain;
    sheet.offer(i, eye.session(), record, image);
    if (eye.study().output.marker) drawGazeMarkers(eye.session(), record, image);
    table.add(i, record);
    statistics.add(record, eye.study().quality.tolerance);
    files.add(i, std::move(image));
    progress.advance(i + 1);
  }
  table.finish();
}

/// The figures of the run, once its frames are rendered.
RunSummary summaryOf(const ReplayInputs& inputs, const std::vector<GazeEvent>& events,
                     FrameStatistics& statistics, const ReportFacts& facts,
                     const std::filesystem::path& out) {
  RunSummary summary{.fixations = countOf(events, GazeState::fixation),
                     .saccades = countOf(events, GazeState::saccade),
                     .out = out};
  statistics.fill(summary);
  summary.duration_s = static_cast<double>(summary.frames) / inputs.schedule.fps;
  if (facts.samples > 0) {
    summary.gaze_valid =
        1.0 - static_cast<double>(facts.samples_without_gaze) / static_cast<double>(facts.samples);
  }
  return summary;
}

}  // namespace

std::vector<std::filesystem::path> replayFiles(const Study& study,
                                               const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files;
  for (const char* name : {kVideo, kFrames, kEvents, kManifest, kReport}) {
    files.push_back(out / name);
  }
  std::error_code ignored;
  if (!study.output.images) return files;
  for (const auto& entry : std::filesystem::directory_iterator(out, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(kImage) && name.ends_with(".png")) files.push_back(entry.path());
  }
  return files;
}

RunSummary replay(const Study& study, const std::filesystem::path& out, const std::string& command,
                  unsigned threads, std::optional<SceneFile> scene) {
  const ReplayInputs inputs = readInputs(study, std::move(scene));
  ReplayedEye eye(study, inputs);
  noteInterrupts();
  if (const std::string remark = ellipseRemark(study); !remark.empty()) {
    std::fprintf(stderr, "foci: %s\n", remark.c_str());
  }

  OutputFolder folder(out);
  eye.sayDevice();
  FrameFiles files(study, folder);
  FrameTable table(folder.stage(kFrames));
  ContactSheet sheet(inputs.schedule.frames);
  FrameStatistics statistics;
  renderFrames(inputs, eye, files, table, sheet, statistics);
  const std::string frames_sha256 = files.finish();
  if (const std::string remark = eye.session().deviceRemark(); !remark.empty()) {
    std::fprintf(stderr, "foci: %s\n", remark.c_str());
  }

  const std::vector<GazeEvent> events =
      eventsOfRun(study, inputs.trace, inputs.schedule.first_s, inputs.schedule.end_s());
  folder.write(kEvents, eventTable(events));

  ReportFacts facts;
  facts.threads = threads;
  facts.device = eye.session().deviceOf(study.render.method);
  countDataLoss(inputs.trace, inputs.schedule, facts);
  statistics.fill(facts);
  facts.summary = summaryOf(inputs, events, statistics, facts, out);
  facts.sheet = sheet.images(study.imageSize_px());
  facts.run = changesOfRun(study, inputs.changes, inputs.markers, inputs.schedule.time_s(0),
                           inputs.schedule.time_s(inputs.schedule.frames - 1));
  if (const std::string warning = toleranceText(study, facts); !warning.empty()) {
    std::fprintf(stderr, "foci: %s\n", warning.c_str());
  }
  folder.write(kManifest, manifestJson(study, facts.summary,
                                       {.command = command,
                                        .threads = threads,
                                        .device = facts.device,
                                        .gaze = factsOf(inputs.trace),
                                        .inputs = inputs.files,
                                        .frames_sha256 = frames_sha256}));
  if (!writeReport(folder.stage(kReport), files.videoFile(), inputs.trace, facts)) {
    std::fputs(
        "foci: the report has no charts: gnuplot is not installed (apt install gnuplot-nox)\n",
        stderr);
  }
  folder.commit();
  return facts.summary;
}

}  // namespace foci
