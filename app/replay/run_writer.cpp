#include "app/replay/run_writer.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "app/graphics/image.h"
#include "app/record/gaze_marker.h"
#include "app/replay/gaze_in_scene.h"
#include "app/replay/heatmap.h"
#include "app/study/study_words.h"
#include "base/quantile.h"
#include "base/text.h"
#include "render/image/image_file.h"

namespace foci {
namespace {

constexpr const char *kVideo = "video.mp4", *kFrames = "frames.tsv", *kEvents = "events.tsv",
                     *kManifest = "manifest.json", *kReport = "report.html",
                     *kSights = "gaze3d.tsv", *kObjects = "objects.tsv", *kMethods = "methods.md",
                     *kReferences = "references.bib";
constexpr const char *kImage = "frame-", *kImageEnd = ".png";  // the frame's number is between

constexpr std::size_t kMinFrames = 10;  // to doubt how gaze fits the scene
// Shares of the frames, chosen by hand.
constexpr double kMostWithout = 0.5, kOftenApart = 0.2, kOftenDiverge = 0.5;

std::string percentOf(std::size_t part, std::size_t all) {
  return decimal(100.0 * static_cast<double>(part) / static_cast<double>(all), 0) + " %";
}

bool exceeds(std::size_t part, std::size_t all, double share) {
  return all >= kMinFrames && static_cast<double>(part) > share * static_cast<double>(all);
}

/// Counts the samples of the replayed time, and those without a gaze point.
void countDataLoss(const GazeTrace& trace, const Schedule& schedule, ReportFacts& facts) {
  const double end_s = schedule.end_s();
  std::optional<double> absent_since_s, before_s;
  for (const GazeSample& sample : trace.samples) {
    if (sample.time_s < schedule.first_s || sample.time_s > end_s) continue;
    if (sample.after_pause) {
      absent_since_s.reset();
      if (before_s) facts.pauses.push_back({*before_s, sample.time_s});
    }
    before_s = sample.time_s;
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
          .state = record.eye.state,
          .vergence_D = record.eye.vergence ? record.eye.vergence->value_D : kAbsent,
          .world_from_eye = record.world_from_eye};
}

/// The figures of the run, once its frames are rendered.
RunSummary summaryOf(const Schedule& schedule, const std::vector<GazeEvent>& events,
                     FrameStatistics& statistics, const ReportFacts& facts,
                     const std::filesystem::path& out) {
  RunSummary summary{.fixations = countOf(events, GazeState::fixation),
                     .saccades = countOf(events, GazeState::saccade),
                     .out = out};
  statistics.fill(summary);
  summary.duration_s = static_cast<double>(summary.frames) / schedule.fps;
  if (facts.samples > 0) {
    summary.gaze_valid =
        1.0 - static_cast<double>(facts.samples_without_gaze) / static_cast<double>(facts.samples);
  }
  return summary;
}

}  // namespace

void FrameStatistics::add(const FrameRecord& record) {
  if (record.stats.tolerance_met == false && frames_over_++ == 0) {
    first_over_s_ = record.time_s;
  }
  worst_error_ = std::max(worst_error_, record.stats.tolerance_error.value_or(0.0));
  frames_without_gaze_ +=
      record.eye.state == GazeState::blink || record.eye.state == GazeState::lost;
  pupil_mm_.push_back(static_cast<float>(record.pupil_mm));
  render_ms_.push_back(static_cast<float>(record.stats.ms));
  if (record.rendered) rendered_ms_.push_back(render_ms_.back());
  splats_.push_back(static_cast<std::uint32_t>(record.stats.splats));
  charts_.add([&] { return chartRow(record); });
  if (!isStable(record.eye.state)) return;
  ++fixated_;
  without_surface_ += !record.eye.surface_distance_m;
  const auto disagrees = vergenceDisagrees(record.eye);
  compared_ += disagrees.has_value();
  disagree_ += disagrees.value_or(false);
  // Eyes may err, but not look apart on average.
  diverge_ += disagrees && record.eye.vergence->value_D < -record.eye.vergence->error_D;
}

void FrameStatistics::fill(RunSummary& summary) {
  summary.frames = render_ms_.size();
  summary.render_ms_median = quantile(render_ms_, 0.5);
  summary.render_ms_p95 = quantile(render_ms_, 0.95);
  summary.frames_rendered = rendered_ms_.size();
  summary.rendered_ms_median = rendered_ms_.empty() ? 0.0 : quantile(rendered_ms_, 0.5);
  summary.rendered_ms_p95 = rendered_ms_.empty() ? 0.0 : quantile(rendered_ms_, 0.95);
  summary.splats = quantile(splats_, 0.5);
  summary.pupil_mm = quantile(pupil_mm_, 0.5);
}

void FrameStatistics::fill(ReportFacts& facts) const {
  facts.rows = charts_.kept();
  facts.frames_without_gaze = frames_without_gaze_;
  facts.frames_over = frames_over_;
  facts.first_over_s = first_over_s_;
  facts.worst_error = worst_error_;
  const auto [min, max] = std::ranges::minmax_element(pupil_mm_);
  facts.pupil_min_mm = *min;
  facts.pupil_max_mm = *max;
}

std::vector<std::string> FrameStatistics::doubts() const {
  std::vector<std::string> doubts;
  if (exceeds(without_surface_, fixated_, kMostWithout)) {
    doubts.push_back("gaze meets no surface in " + percentOf(without_surface_, fixated_) +
                     " of the fixated frames: is the recording where the scene is (scene.scale_m, "
                     "gaze.scene_rotation, gaze.scene_scale, gaze.scene_offset_m)?");
  }
  if (exceeds(diverge_, compared_, kOftenDiverge)) {
    doubts.push_back("the lines of sight of both eyes diverge in " +
                     percentOf(diverge_, compared_) +
                     " of the fixated frames: are the columns of the left and the right eye "
                     "exchanged (gaze.left_direction, gaze.right_direction, gaze.left_angles, "
                     "gaze.right_angles)?");
  } else if (exceeds(disagree_, compared_, kOftenApart)) {
    doubts.push_back("the lines of sight of both eyes do not meet on the surface in " +
                     percentOf(disagree_, compared_) +
                     " of the fixated frames (vergence_disagrees in frames.tsv): is the recording "
                     "where the scene is (scene.scale_m, gaze.scene_offset_m), and are both eyes "
                     "calibrated?");
  }
  return doubts;
}

std::string imageFileName(std::size_t frame) {
  return kImage + printed("%06zu", frame) + kImageEnd;
}

std::vector<std::filesystem::path> imagesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> images;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool is_map =
        name.ends_with(".exr") &&
        std::ranges::any_of(kStudyWords<FrameMap>, [&](const StudyWord<FrameMap>& map) {
          return name.starts_with(std::string(map.text) + "-");
        });
    if (is_map || (name.starts_with(kImage) && name.ends_with(kImageEnd))) {
      images.push_back(entry.path());
    }
  }
  return images;
}

std::vector<std::filesystem::path> RunWriter::files(const Study& study,
                                                    const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files;
  if (study.output.images || !study.output.maps.empty()) files = imagesIn(out);
  for (const char* name : {kVideo, kFrames, kEvents, kFixationTable, kSaccadeTable, kSights,
                           kObjects, kManifest, kReport, kMethods, kReferences}) {
    files.push_back(out / name);
  }
  return files;
}

RunWriter::RunWriter(const Study& study, const ReplayedGaze& gaze, const Scene& scene,
                     const std::filesystem::path& out, const OutputGuard& guard, Warnings& warnings)
    : study_(study),
      gaze_(gaze),
      scene_(scene),
      warnings_(warnings),
      out_(out),
      folder_(out, guard),
      video_file_(folder_.stage(kVideo)),
      video_(video_file_, study.imageSize_px(), study.output.fps),
      table_(folder_.stage(kFrames), gaze.trials),
      sheet_(gaze.schedule.frames) {}

void RunWriter::addMaps(std::size_t frame, const SeenFrame& seen, const Frame& rendered) {
  stageMaps(study_.output.maps, frame, rendered, seen.record.eye.focus_D, folder_);
}

void RunWriter::add(std::size_t frame, const SeenFrame& seen, const Image& image) {
  sheet_.offer(frame, seen.record, seen.gaze_px, image);
  Image shown = image;
  if (seen.marker) drawGazeMarkers(seen.gaze_px, seen.record, shown);
  table_.add(frame, seen.record);
  statistics_.add(seen.record);
  eyes_.push_back({seen.record.time_s, seen.record.eye.focus_D, seen.record.pupil_mm});
  hash_.add(shown.rgb);
  if (study_.output.images) folder_.write(imageFileName(frame), pngOf(shown));
  video_.push(std::move(shown));
}

void RunWriter::addMap(FrameMap map, std::size_t frame, const std::string& bytes) {
  folder_.write(mapFileName(map, frame), bytes);
}

RunResult RunWriter::finish(ManifestFacts run,
                            const std::optional<std::filesystem::path>& heatmap) {
  table_.finish();
  video_.finish();
  const Schedule& schedule = gaze_.schedule;
  RunEvents judged = eventsOfRun(study_, gaze_.trace, schedule.first_s, schedule.end_s());
  const std::vector<GazeEvent>& events = judged.events;
  warnings_.addAll(study_.gaze.source, judged.warnings);
  const GazeInScene in_scene = lookIntoScene(study_, gaze_, scene_, judged, heatmap.has_value());
  folder_.write(kEvents, eventTable(events, gaze_.trials, study_.gaze.events.detector));
  ReportFacts facts;
  facts.fixations = fixationTable(study_, gaze_, judged, in_scene, eyes_);
  facts.trials = gaze_.trials;
  folder_.write(kFixationTable, facts.fixations);
  folder_.write(kSaccadeTable, saccadeTable(study_, gaze_, judged, in_scene));
  folder_.write(kSights, sightTable(in_scene, gaze_.trials, gaze_.trace.pupil_unit));
  folder_.write(kObjects, objectTable(in_scene, gaze_.trials));

  facts.threads = run.threads;
  facts.device = run.device;
  countDataLoss(gaze_.trace, schedule, facts);
  statistics_.fill(facts);
  facts.summary = summaryOf(schedule, events, statistics_, facts, out_);
  if (study_.display.kind == DisplayKind::headset) {
    facts.headset = {.screen = study_.screenInForce(), .up = in_scene.up};
  }
  facts.objects = in_scene.objects;
  facts.scene = sceneViewOf(scene_, in_scene);
  facts.quality = judged.quality;
  if (heatmap) {
    const HeatMap heat = heatMapOf(scene_, in_scene);
    facts.heat = heatPictures(heat.scene, in_scene);
    facts.most_heat_s_per_m2 = heat.most_s_per_m2;
    folder_.files().write(*heatmap, [&](const std::filesystem::path& to) {
      writeHeatPly(to, heat.scene, in_scene.attention_s);
    });
  }
  facts.sheet = sheet_.images(study_.imageSize_px());
  facts.run = changesOfRun(study_, gaze_.changes, gaze_.trace.markers, schedule.time_s(0),
                           schedule.time_s(schedule.frames - 1));
  warnings_.add(toleranceText(study_, facts));
  warnings_.add(focusText(study_, facts));
  if (study_.eye.recorded) warnings_.addAll(study_.gaze.source, statistics_.doubts());
  run.gaze = factsOf(gaze_.trace, judged);
  run.warnings = facts.warnings = warnings_.all();
  run.frames_sha256 = hash_.hex();
  folder_.write(kManifest, manifestJson(study_, facts.summary, run));
  const MethodsText methods = methodsOf(gaze_.trace, facts);
  folder_.write(kMethods, methods.markdown);
  folder_.write(kReferences, methods.bibtex);
  const std::string problem =
      writeReport(folder_.stage(kReport), video_file_, gaze_.trace, facts, methods);
  if (!problem.empty()) say("the report has no charts: " + problem);
  folder_.commit();
  return {.summary = facts.summary, .image = facts.sheet[facts.sheet.size() / 2]};
}

std::vector<float> defocusMap_D(const Frame& frame, double focus_D) {
  std::vector<float> map_D(frame.depth_m.size());
  for (std::size_t p = 0; p < map_D.size(); ++p) {
    map_D[p] = frame.depth_m[p] > 0.0f
                   ? static_cast<float>(1.0 / static_cast<double>(frame.depth_m[p]) - focus_D)
                   : std::numeric_limits<float>::quiet_NaN();
  }
  return map_D;
}

namespace {

void write(const std::filesystem::path& file, FrameMap map, const Frame& frame, double focus_D) {
  if (map == FrameMap::light) return writeImage(file, frame);
  writeMap(file, frame.size_px,
           map == FrameMap::depth ? frame.depth_m : defocusMap_D(frame, focus_D));
}

}  // namespace

std::string mapFileName(FrameMap map, std::size_t frame) {
  return std::string(studyWord(map)) + printed("-%06zu.exr", frame);
}

std::vector<std::filesystem::path> stageMaps(const std::vector<FrameMap>& maps, std::size_t frame,
                                             const Frame& rendered, double focus_D,
                                             OutputFolder& folder) {
  std::vector<std::filesystem::path> staged;
  staged.reserve(maps.size());
  for (const FrameMap map : maps) {
    staged.push_back(folder.stage(mapFileName(map, frame)));
    write(staged.back(), map, rendered, focus_D);
  }
  return staged;
}

}  // namespace foci
