#include "app/replay/fixation_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/text.h"
#include "gaze/events/online_events.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/trace_summary.h"
#include "gaze/webcam/webcam_frames.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

std::string pairText(const glm::dvec2& pair, int digits) {
  return tabbed(decimal(pair.x, digits), decimal(pair.y, digits));
}

/// "01" of "sub-01_task-look" for "sub-"; empty if a name has no such part.
std::string entityIn(const std::string& name, std::string_view entity) {
  for (std::size_t at = 0; at < name.size(); at = std::min(name.find('_', at), name.size()) + 1) {
    if (name.compare(at, entity.size(), entity) != 0) continue;
    const std::size_t first = at + entity.size();
    return name.substr(first, std::min(name.find_first_of("_.", first), name.size()) - first);
  }
  return {};
}

/// The columns of the recording and of an event's time.
constexpr const char* kWho = "recording\tsubject\tsession\ttrial\ttrial_type";

std::string whoText(const RecordingName& name, const std::vector<TraceTrial>& trials,
                    double time_s) {
  const TraceTrial* const trial = trialDuring(trials, time_s);
  const bool typed = trial != nullptr && !trial->type.empty();
  return tabbed(name.recording, name.subject, name.session, trialAt(trials, time_s),
                typed ? visible(trial->type) : "n/a");
}

std::string timesText(const GazeEvent& event) {
  return tabbed(decimal(event.onset_s, 6), decimal(event.onset_s + event.duration_s, 6),
                decimal(event.duration_s, 6));
}

/// A point in px and in degrees from the centre of the screen.
std::string placeText(const Screen& screen, const std::optional<glm::dvec2>& point_px) {
  if (!point_px) return "n/a\tn/a\tn/a\tn/a";
  const glm::dvec2 middle_deg = eccentricity_deg(screen, 0.5 * glm::dvec2(screen.size_px));
  return tabbed(pairText(*point_px, 2),
                pairText(eccentricity_deg(screen, *point_px) - middle_deg, 3));
}

std::string offScreenText(const Screen& screen, const std::optional<glm::dvec2>& point_px) {
  if (!point_px) return "n/a";
  const bool inside = glm::all(glm::greaterThanEqual(*point_px, glm::dvec2(0.0))) &&
                      glm::all(glm::lessThanEqual(*point_px, glm::dvec2(screen.size_px)));
  return inside ? "0" : "1";
}

std::string worldText(const glm::dvec3& direction, const glm::dvec3& up) {
  if (direction == glm::dvec3(0.0)) return "n/a\tn/a";
  return pairText(azimuthElevation_deg(direction, up), 3);
}

/// Root mean square of the angle from sample to sample, and mean pupil, of the samples of an event.
struct SamplesOfEvent {
  std::optional<double> rms_s2s_deg{}, pupil_mm{}, pupil_own{};

  SamplesOfEvent(const GazeTrace& trace, const GazeEvent& event) {
    auto sample = std::ranges::lower_bound(trace.samples, event.onset_s, {}, &GazeSample::time_s);
    const double end_s = event.onset_s + event.duration_s;
    std::optional<glm::dvec3> last;
    double steps = 0.0, squares = 0.0;
    std::array<double, 2> sums{}, counts{};
    for (; sample != trace.samples.end() && sample->time_s < end_s; ++sample) {
      const auto sight = sightOf(*sample, *trace.screen).direction;
      if (sight && last) {
        steps += 1.0;
        squares += glm::dot(*sight - *last, *sight - *last);
      }
      last = sight;
      const std::array pupils{sample->pupil_mm, ownPupilOf(*sample)};
      for (std::size_t i = 0; i < pupils.size(); ++i) {
        sums[i] += pupils[i].value_or(0.0);
        counts[i] += pupils[i] ? 1.0 : 0.0;
      }
    }
    if (steps > 0.0 && !trace.relative) rms_s2s_deg = glm::degrees(std::sqrt(squares / steps));
    if (counts[0] > 0.0) pupil_mm = sums[0] / counts[0];
    if (counts[1] > 0.0) pupil_own = sums[1] / counts[1];
  }
};

/// Focus and pupil of the frames of an event.
struct EyeDuring {
  std::optional<double> focus_D{}, focus_end_D{}, pupil_mm{};

  EyeDuring(const std::vector<EyeInFrame>& frames, const GazeEvent& event) {
    auto first = std::ranges::lower_bound(frames, event.onset_s, {}, &EyeInFrame::time_s);
    const auto end =
        std::ranges::lower_bound(frames, event.onset_s + event.duration_s, {}, &EyeInFrame::time_s);
    if (first == end && first != frames.begin()) --first;
    if (first == end) return;
    double focus = 0.0, pupil = 0.0;
    for (auto frame = first; frame != end; ++frame) {
      focus += frame->focus_D;
      pupil += frame->pupil_mm;
    }
    const auto count = static_cast<double>(end - first);
    focus_D = focus / count;
    pupil_mm = pupil / count;
    focus_end_D = std::prev(end)->focus_D;
  }
};

/// The surface, the eye's focus and the blur of a fixation.
std::string focusText(const SightFixation& sight, const EyeDuring& eye, const Screen& screen) {
  std::optional<double> defocus_D, blur_arcmin, blur_px;
  if (sight.hit && eye.focus_D) {
    defocus_D = *eye.focus_D - sight.surface_D;
    const double blur_rad = 0.5e-3 * *eye.pupil_mm * std::abs(*defocus_D);
    blur_arcmin = kArcminPerRad * blur_rad;
    blur_px = screen.distance_m * screen.size_px.x / screen.size_m.x * blur_rad;
  }
  return tabbed(orAbsent(eye.focus_D, 4), orAbsent(eye.focus_end_D, 4), orAbsent(defocus_D, 4),
                orAbsent(blur_arcmin, 3), orAbsent(blur_px, 3), orAbsent(eye.pupil_mm, 3));
}

/// The saccade that ends where an event begins; null: there is none.
const GazeEvent* saccadeBefore(const std::vector<GazeEvent>& events, std::size_t at) {
  while (at > 0 && events[at - 1].kind == GazeState::oscillation) --at;
  return at > 0 && events[at - 1].kind == GazeState::saccade ? &events[at - 1] : nullptr;
}

std::string saccadeText(const GazeEvent* saccade) {
  if (saccade == nullptr) return "n/a\tn/a\tn/a";
  return tabbed(orAbsent(saccade->amplitude_deg, 3), decimal(saccade->duration_s, 6),
                orAbsent(saccade->peak_velocity_deg_s, 1));
}

}  // namespace

RecordingName recordingNameOf(const Study& study) {
  const auto place = webcamPlaceOf(study.gaze.source);
  const fs::path file = place ? place->file : fs::path(study.gaze.source);
  const fs::path name = file.extension() == ".gz" ? file.stem().stem() : file.stem();
  std::array<std::string, 2> found;
  for (const auto& part : file) {
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::string value = entityIn(part.string(), i == 0 ? "sub-" : "ses-");
      if (!value.empty()) found[i] = value;
    }
  }
  if (found[0].empty() && !study.gaze.columns.rows.empty()) {
    found[0] = study.gaze.columns.rows.front().second;
  }
  const auto field = [](const std::string& text) { return text.empty() ? "n/a" : visible(text); };
  return {field(name.string()), field(found[0]), field(found[1])};
}

std::string fixationTable(const Study& study, const ReplayedGaze& gaze, const RunEvents& judged,
                          const GazeInScene& in_scene, const std::vector<EyeInFrame>& frames) {
  const Screen screen = study.screenInForce();
  const RecordingName name = recordingNameOf(study);
  const bool has_head = gaze.trace.samples.front().head.has_value();
  std::string table = std::string(kWho) +
                      "\tfixation\tonset_s\tend_s\tduration_s\tx_px\ty_px\tx_deg\ty_deg\t"
                      "world_azimuth_deg\tworld_elevation_deg\trms_s2s_deg\toff_screen\tobject\t"
                      "object_share\tpoint_x_m\tpoint_y_m\tpoint_z_m\tdistance_m\tsurface_D\t"
                      "focus_D\tfocus_end_D\tdefocus_D\tblur_radius_arcmin\tblur_radius_px\t"
                      "pupil_mm\trecorded_pupil\trecorded_pupil_unit\tsaccade_amplitude_deg\t"
                      "saccade_duration_s\tsaccade_peak_velocity_deg_s\tprobability\n";
  std::size_t number = 0;
  for (std::size_t i = 0; i < judged.events.size(); ++i) {
    const GazeEvent& event = judged.events[i];
    if (event.kind != GazeState::fixation) continue;
    const SightFixation& sight = in_scene.fixations[number++];
    const SamplesOfEvent samples(gaze.trace, event);
    std::string met = "n/a\tn/a\tn/a\tn/a\tn/a\tn/a";
    if (sight.hit) {
      met = tabbed(sight.hit->object == 0 ? "n/a" : decimal(sight.share, 3),
                   vectorText(sight.hit->point_m, 4), decimal(sight.hit->distance_m, 4),
                   decimal(sight.surface_D, 4));
    }
    table += rowOf(whoText(name, gaze.trials, event.onset_s), number, timesText(event),
                   placeText(screen, event.position_px),
                   worldText(has_head ? sight.direction : glm::dvec3(0.0), in_scene.up),
                   orAbsent(samples.rms_s2s_deg, 4), offScreenText(screen, event.position_px),
                   objectText(in_scene, sight.hit), met,
                   focusText(sight, EyeDuring(frames, event), screen),
                   pupilText(samples.pupil_mm, samples.pupil_own, gaze.trace.pupil_unit),
                   saccadeText(saccadeBefore(judged.events, i)), orAbsent(event.probability, 3));
  }
  return table;
}

std::string saccadeTable(const Study& study, const ReplayedGaze& gaze, const RunEvents& judged,
                         const GazeInScene& in_scene) {
  const Screen screen = study.screenInForce();
  const RecordingName name = recordingNameOf(study);
  std::string table = std::string(kWho) +
                      "\tsaccade\tonset_s\tend_s\tduration_s\tstart_x_px\tstart_y_px\tstart_x_deg\t"
                      "start_y_deg\tx_px\ty_px\tx_deg\ty_deg\toff_screen\tamplitude_deg\t"
                      "peak_velocity_deg_s\tfrom_object\tto_object\tprobability\n";
  const std::vector<SightFixation>& fixations = in_scene.fixations;
  std::size_t number = 0, fixations_before = 0;
  for (const GazeEvent& event : judged.events) {
    fixations_before += event.kind == GazeState::fixation;
    if (event.kind != GazeState::saccade) continue;
    const auto objectOf = [&](std::size_t fixation) {
      return fixation < fixations.size() ? objectText(in_scene, fixations[fixation].hit) : "n/a";
    };
    table += rowOf(whoText(name, gaze.trials, event.onset_s), ++number, timesText(event),
                   placeText(screen, event.start_px), placeText(screen, event.position_px),
                   offScreenText(screen, event.position_px), orAbsent(event.amplitude_deg, 3),
                   orAbsent(event.peak_velocity_deg_s, 1),
                   fixations_before > 0 ? objectOf(fixations_before - 1) : "n/a",
                   objectOf(fixations_before), orAbsent(event.probability, 3));
  }
  return table;
}

std::string joinedTable(const std::vector<std::pair<std::string, std::string>>& tables) {
  std::string joined;
  for (const auto& [run, table] : tables) {
    std::size_t at = table.find('\n') + 1;
    if (joined.empty()) joined = table.substr(0, at);
    while (at < table.size()) {
      const std::size_t end = table.find('\n', at) + 1, first = table.find('\t', at);
      joined += visible(run) + table.substr(first, end - first);
      at = end;
    }
  }
  return joined;
}

}  // namespace foci
