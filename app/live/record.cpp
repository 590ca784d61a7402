#include "app/live/record.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/platform/output_files.h"
#include "app/record/manifest.h"
#include "app/study/inputs.h"
#include "app/study/study_text.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace fs = std::filesystem;
namespace {

/// The study of a record. Its gaze needs no calibration: the samples have been through it.
Study studyOfRecord(Study study, double rate_Hz) {
  const EventSettings events = study.gaze.events;
  study.gaze = {};
  study.gaze.source = "gaze.tsv";
  study.gaze.events = events;
  study.record.frames = "frames.tsv";
  study.record.changes = "changes.tsv";
  study.record.markers = "event_markers.tsv";
  if (study.eye.recorded) study.record.head = "head.tsv";
  study.record.rate_Hz = rate_Hz;
  if (study.eye.recorded && !study.eye.position_m) {  // of a recording; a study places its eye
    const glm::dmat4 pose = glm::inverse(glm::dmat4(study.eye.recorded->eyeFromWorldAt(0.0)));
    study.eye.position_m = glm::dvec3(pose[3]);
    study.eye.look_at_m = glm::dvec3(pose[3] - pose[2]);
    study.eye.up = glm::dvec3(pose[1]);
    study.eye.path.clear();
  }
  study.output.seconds.reset();
  study.remote = {};
  return study;
}

fs::path madeEmpty(const fs::path& folder) {
  makeRecordFolder(folder);
  // Of two programs that begin a record at once, one gets its first file.
  std::FILE* const file = std::fopen((folder / "gaze.tsv").c_str(), "wx");
  if (!file) throw std::runtime_error(cannotWrite(folder / "gaze.tsv"));
  std::fclose(file);
  return folder;
}

/// @param counts  how often each value came
/// @return 0 without values
int medianOf(const std::map<int, std::size_t>& counts) {
  std::size_t all = 0, so_far = 0;
  for (const auto& [value, count] : counts) all += count;
  for (const auto& [value, count] : counts) {
    so_far += count;
    if (2 * so_far > all) return value;
  }
  return 0;
}

}  // namespace

void makeRecordFolder(const fs::path& folder) {
  requireFolderOrNothing(folder);
  std::error_code error;
  for (const char* name :
       {"study.toml", "gaze.tsv", "frames.tsv", "changes.tsv", "timing.tsv", "event_markers.tsv",
        "head.tsv", "playback.tsv", "events.tsv", "manifest.json"}) {
    if (!fs::exists(fs::symlink_status(folder / name, error))) continue;
    throw InputError(folder.string(), std::string("has a ") + name +
                                          " already, as records have: expected another folder");
  }
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw std::runtime_error("cannot make the folder " + folder.string() +
                             (error ? ": " + error.message() : ""));
  }
}

LiveRecord::LiveRecord(const fs::path& folder, const Study& study, const Screen& screen,
                       double rate_Hz, std::string command, unsigned threads, std::string devices)
    : folder_(madeEmpty(folder)),
      study_(studyOfRecord(study, rate_Hz)),
      command_(std::move(command)),
      threads_(threads),
      devices_(std::move(devices)),
      gaze_(folder_ / "gaze.tsv", screen),
      frames_(folder_ / "frames.tsv"),
      changes_(folder_ / "changes.tsv", std::ios::binary),
      timing_(folder_ / "timing.tsv", std::ios::binary),
      markers_(folder_ / "event_markers.tsv", std::ios::binary) {
  changes_ << changesHeader();
  timing_ << "frame\tsample_s\tstate_s\trender_start_s\trender_end_s\tswap_s\trepeats\tfull\t"
             "landing_to_full_ms\tsync_level\tdisplay_s\tgaze_age_ms";
  for (const std::string_view stage : kGpuStages) timing_ << "\tgpu_" << stage << "_ms";
  timing_ << '\n';
  markers_ << "time_s\tmarker\n";
  if (study_.record.head) {
    head_.open(folder_ / "head.tsv", std::ios::binary);
    head_ << headHeader();
  }
  writeStudy(study_.output.fps);
  thread_ = std::thread([this] { run(); });
}

LiveRecord::~LiveRecord() { end(); }

std::optional<std::string> LiveRecord::end() {
  close();
  if (thread_.joinable()) thread_.join();
  return failure();
}

void LiveRecord::writeStudy(double fps) const {
  Study study = study_;
  study.output.fps = std::clamp(fps, 1.0, 1000.0);
  study.record.device = devices_;
  writeText(folder_ / "study.toml",
            "# A record of foci live. As a video with its report:\n"
            "#     foci replay study.toml --out replay\n" +
                studyToml(study));
}

void LiveRecord::post(std::function<void()> task, std::size_t frames) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_ || failure_) return;
    frames_waiting_ += frames;
    tasks_.push_back(std::move(task));
  }
  changed_.notify_all();
}

void LiveRecord::add(const GazeSample& sample) {
  post([this, sample] {
    gaze_.add(sample);
    ++gaze_samples_;
    gaze_points_ += sample.point_px.has_value();
    inferred_ += sample.inferred;
    queried_ += sample.queried && sample.point_px;
  });
}

void LiveRecord::add(const Change& change) {
  post([this, change] { changes_ << changeRow(change); });
}

void LiveRecord::add(const HeadRow& row) {
  post([this, row] { head_ << headRow(row); });
}

void LiveRecord::play(const std::string& file, const PlayPoint& point) {
  post([this, file] {
    playback_.open(folder_ / "playback.tsv", std::ios::binary);
    playback_ << "# recording=" << visible(file) << "\ntime_s\trecording_s\tspeed\n";
  });
  add(point);
}

void LiveRecord::add(const PlayPoint& point) {
  post([this, point] {
    playback_ << rowOf(decimal(point.time_s, 6), decimal(point.recording_s, 6),
                       decimal(point.speed, 3));
  });
}

void LiveRecord::addMarker(double time_s, const std::string& text) {
  post([this, time_s, text] { markers_ << decimal(time_s, 6) << '\t' << visible(text) << '\n'; });
}

void LiveRecord::setDevices(const std::string& devices) {
  post([this, devices] { devices_ = devices; });
}

void LiveRecord::addWarning(const std::string& warning) {
  post([this, warning] { warnings_.include({warning}); });
}

void LiveRecord::setReception(const GazeReception& reception) {
  post([this, reception] { reception_ = reception; });
}

void LiveRecord::add(std::shared_ptr<const LiveFrame> frame) {
  post([this, frame = std::move(frame)] { write(*frame); }, 1);
}

void LiveRecord::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

std::size_t LiveRecord::backlog() const {
  const std::lock_guard lock(mutex_);
  return frames_waiting_;
}

std::optional<std::string> LiveRecord::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

bool LiveRecord::finished() const {
  const std::lock_guard lock(mutex_);
  return finished_;
}

void LiveRecord::run() {
  try {
    for (;;) {
      std::function<void()> task;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !tasks_.empty() || closed_; });
        if (tasks_.empty()) break;
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
      task();
    }
    finish();
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    failure_ = error.what();
    tasks_.clear();
    frames_waiting_ = 0;
  }
  const std::lock_guard lock(mutex_);
  finished_ = true;
}

void LiveRecord::write(const LiveFrame& frame) {
  constexpr double kFlush_s = 1.0;  // a crash of the machine costs at most this much
  const FrameTiming& timing = frame.timing;
  if (frame_count_ == 0) first_s_ = frame.record.time_s;
  last_s_ = frame.record.time_s;
  frames_.add(frame_count_, frame.record);
  const auto &sample_s = timing.sample_s, &swap_s = timing.swap_s, &display_s = timing.display_s;
  std::optional<double> landed_ms, age_ms;
  if (swap_s) landed_ms = landings_.add(frame.record, timing.state_s, timing.in_full, *swap_s);
  if (display_s && sample_s) age_ms = 1e3 * (*display_s - *sample_s);
  timing_ << tabbed(frame_count_, orAbsent(sample_s, 6), decimal(timing.state_s, 6),
                    decimal(timing.render_start_s, 6), decimal(timing.render_end_s, 6),
                    orAbsent(swap_s, 6), timing.repeats, timing.in_full, orAbsent(landed_ms, 1),
                    swap_s ? std::to_string(timing.sync_level) : "n/a", orAbsent(display_s, 6),
                    orAbsent(age_ms, 1));
  for (std::size_t stage = 0; stage < kGpuStages.size(); ++stage) {
    const std::optional<GpuTimes>& gpu = frame.record.stats.gpu;
    timing_ << '\t' << (gpu ? decimal(gpu->stage_ms.at(stage), 3) : "n/a");
  }
  timing_ << '\n';
  hash_.add(frame.image.get()->rgb);
  render_.add(frame.record.stats.ms);
  if (frame.record.rendered) rendered_.add(frame.record.stats.ms);
  splats_ = frame.record.stats.splats;
  ++pupils_[static_cast<int>(std::lround(100.0 * frame.record.pupil_mm))];
  ++frame_count_;
  if (last_s_ >= flushed_s_ + kFlush_s) {
    flushed_s_ = last_s_;
    gaze_.flush();
    frames_.flush();
    for (std::ofstream* out : {&changes_, &timing_, &markers_, &head_, &playback_}) out->flush();
  }
  if (!changes_ || !timing_ || !markers_ || !head_ || !playback_) {
    throw std::runtime_error(cannotWrite(folder_));
  }
  const std::lock_guard lock(mutex_);
  --frames_waiting_;
}

void LiveRecord::finish() {
  gaze_.flush();
  frames_.finish();
  for (std::ofstream* out : {&changes_, &timing_, &markers_}) out->close();
  if (study_.record.head) head_.close();
  if (playback_.is_open()) playback_.close();
  if (inferred_ > 0) {
    warnings_.include({std::to_string(inferred_) + " of " + std::to_string(gaze_samples_) +
                       " samples of gaze are inferred: the tracker did not see the eyes"});
  }
  if (queried_ > 0) {
    warnings_.include({"the runtime does not state when gaze was measured: the times of " +
                       std::to_string(queried_) + " of " + std::to_string(gaze_samples_) +
                       " samples are those of the query"});
  }
  writeStudy(meanRate_Hz(frame_count_, last_s_ - first_s_, study_.output.fps));
  // The rest is computed from the files, as a replay would.
  const Study study = readStudy(folder_ / "study.toml");
  std::vector<GazeEvent> events;
  ManifestFacts facts{.command = command_,
                      .threads = threads_,
                      .device = devices_,
                      .gaze = {.format = "no gaze",
                               .rate_Hz = study.record.rate_Hz.value_or(0.0),
                               .samples = gaze_samples_},
                      .landings = &landings_};
  if (gaze_points_ > 0) {
    GazeTrace trace = loadGaze(study, warnings_);
    if (study.record.head) {
      giveHeads(readHeads(*study.record.head), trace.samples);
      trace.screen = study.screenInForce();
    }
    RunEvents judged =
        eventsOfRun(study, trace, first_s_, last_s_ + 1.0 / std::max(study.output.fps, 1.0));
    warnings_.addAll(study.gaze.source, judged.warnings);
    facts.gaze = factsOf(trace, judged);
    events = std::move(judged.events);
  }
  facts.warnings = warnings_.all();
  writeText(folder_ / "events.tsv", eventTable(events, {}, study.gaze.events.detector));
  for (const auto& file : inputFiles(study)) facts.inputs.push_back({file, sha256OfFile(file)});
  facts.gaze.reception = reception_;
  facts.frames_sha256 = hash_.hex();
  const double gaze_valid = static_cast<double>(gaze_points_) /
                            static_cast<double>(std::max<std::size_t>(gaze_samples_, 1));
  const RunSummary summary{.frames = frame_count_,
                           .duration_s = static_cast<double>(frame_count_) / study.output.fps,
                           .gaze_valid = gaze_valid,
                           .fixations = countOf(events, GazeState::fixation),
                           .saccades = countOf(events, GazeState::saccade),
                           .render_ms_median = render_.quantile_ms(0.5),
                           .render_ms_p95 = render_.quantile_ms(0.95),
                           .frames_rendered = rendered_.count(),
                           .rendered_ms_median = rendered_.quantile_ms(0.5),
                           .rendered_ms_p95 = rendered_.quantile_ms(0.95),
                           .splats = splats_,
                           .pupil_mm = 0.01 * medianOf(pupils_),
                           .out = folder_};
  writeText(folder_ / "manifest.json", manifestJson(study, summary, facts));
}

}  // namespace foci
