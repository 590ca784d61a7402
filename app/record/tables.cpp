#include "app/record/tables.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "app/session/session.h"
#include "base/file.h"
#include "base/text.h"
#include "gaze/sources/trace_summary.h"

namespace foci {
namespace {

constexpr int kTimeDigits = 6, kPointDigits = 2, kLengthDigits = 4, kDioptreDigits = 4,
              kTurnDigits = 6;

std::string pointOrAbsent(const std::optional<glm::dvec2>& point_px) {
  if (!point_px) return "n/a\tn/a";
  return tabbed(decimal(point_px->x, kPointDigits), decimal(point_px->y, kPointDigits));
}

std::string vergenceFields(const EyeNow& eye) {
  if (!eye.vergence) return "n/a\tn/a\tn/a";
  const auto disagrees = vergenceDisagrees(eye);
  return tabbed(decimal(eye.vergence->value_D, kDioptreDigits),
                decimal(eye.vergence->error_D, kDioptreDigits),
                disagrees ? *disagrees ? "1" : "0" : "n/a");
}

std::string poseFields(const FrameRecord& record) {
  const glm::dvec3& p = record.eye_m;
  const glm::dquat& q = record.world_from_eye;
  std::string text;
  for (const double value : {p.x, p.y, p.z}) text += decimal(value, kLengthDigits) + '\t';
  for (const double value : {q.x, q.y, q.z}) text += decimal(value, kTurnDigits) + '\t';
  return text + decimal(q.w, kTurnDigits);
}

}  // namespace

std::string orAbsent(const std::optional<double>& value, int digits) {
  return value ? decimal(*value, digits) : "n/a";
}

FrameTable::FrameTable(const std::filesystem::path& file, std::vector<TraceTrial> trials)
    : file_(file.string()), out_(file, std::ios::binary), trials_(std::move(trials)) {
  out_ << "frame\ttime_s\tgaze_time_s\tgaze_x_px\tgaze_y_px\tgaze_state\t"
          "surface_distance_m\t"
          "target_D\tfocus_D\tpupil_mm\tmethod\tsplats\tfragments\ttolerance_error\t"
          "tolerance_met\tquality_level\tvergence_D\t"
          "vergence_error_D\tvergence_disagrees\teye_x_m\teye_y_m\teye_z_m\teye_qx\t"
          "eye_qy\teye_qz\teye_qw\ttrial\trender_ms\n";
}

void FrameTable::add(std::size_t frame, const FrameRecord& record) {
  const EyeNow& eye = record.eye;
  const RenderStats& stats = record.stats;
  out_ << rowOf(frame, decimal(record.time_s, kTimeDigits),
                eye.sample ? decimal(eye.sample->time_s, kTimeDigits) : "n/a",
                pointOrAbsent(record.gaze_px), nameOf(eye.state),
                orAbsent(eye.surface_distance_m, kLengthDigits),
                orAbsent(eye.target_D, kDioptreDigits), decimal(eye.focus_D, kDioptreDigits),
                decimal(record.pupil_mm, 3), record.method, stats.splats, stats.fragments,
                orAbsent(stats.tolerance_error, 2),
                stats.tolerance_met ? *stats.tolerance_met ? "1" : "0" : "n/a",
                stats.quality_level ? textOf(*stats.quality_level) : "n/a", vergenceFields(eye),
                poseFields(record), trialAt(trials_, record.time_s), decimal(stats.ms, 3));
  if (!out_) throw std::runtime_error(cannotWrite(file_));
}

void FrameTable::finish() {
  out_.close();
  if (!out_) throw std::runtime_error(cannotWrite(file_));
}

std::string eventTable(const std::vector<GazeEvent>& events, const std::vector<TraceTrial>& trials,
                       std::optional<Detector> detector) {
  std::string table =
      "event\tonset_s\tduration_s\tx_px\ty_px\tstart_x_px\tstart_y_px\tamplitude_deg\t"
      "peak_velocity_deg_s";
  table += detector ? "\tprobability\tdetector\ttrial\n" : "\ttrial\n";
  for (const GazeEvent& event : events) {
    table += tabbed(nameOf(event.kind), decimal(event.onset_s, kTimeDigits),
                    decimal(event.duration_s, kTimeDigits), pointOrAbsent(event.position_px),
                    pointOrAbsent(event.start_px), orAbsent(event.amplitude_deg, 3),
                    orAbsent(event.peak_velocity_deg_s, 1));
    if (detector) table += '\t' + tabbed(orAbsent(event.probability, 3), labelOf(*detector));
    table += '\t' + trialAt(trials, event.onset_s) + '\n';
  }
  return table;
}

RunEvents eventsOfRun(const Study& study, const GazeTrace& trace, double from_s, double to_s) {
  const Screen screen = study.screenInForce();
  const auto on_screen = [&](std::optional<glm::dvec2>& point_px) {
    if (point_px) point_px = onOtherScreen_px(*trace.screen, screen, *point_px);
  };
  const EventSettings& settings = study.gaze.events;
  EventLabels labels = labelEvents(trace, *trace.screen, settings);
  RunEvents run{.events = eventsOf(labels, trace, *trace.screen, settings)};
  run.quality = qualityOf(trace, *trace.screen, labels.states, run.events);
  run.warnings = eventWarnings(trace, labels, run.quality, settings);
  run.states = std::move(labels.states);
  std::vector<GazeEvent>& events = run.events;
  std::erase_if(events, [&](const GazeEvent& event) {
    return event.onset_s >= to_s || event.onset_s + event.duration_s <= from_s;
  });
  for (GazeEvent& event : events) {
    on_screen(event.position_px);
    on_screen(event.start_px);
  }
  return run;
}

std::size_t countOf(const std::vector<GazeEvent>& events, GazeState kind) {
  return static_cast<std::size_t>(std::ranges::count(events, kind, &GazeEvent::kind));
}

}  // namespace foci
