#include "app/replay/gaze_in_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "app/platform/progress.h"
#include "app/session/eye_path.h"
#include "app/study/session_settings_of.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "base/text.h"
#include "gaze/events/pursuit.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/trace_summary.h"
#include "render/lod/surface_query.h"

namespace foci {
namespace {

constexpr std::size_t kLong = 50'000;  // samples from which on progress shows: some seconds
constexpr double kMaxIntervals = 3.0;  // a sample stands for at most so many sampling intervals

/// The eye's path from a time on.
struct PathFrom {
  double time_s;
  EyePath path;
};

std::vector<PathFrom> pathsOf(const Study& study, const ReplayedGaze& gaze) {
  std::vector<PathFrom> paths{{gaze.trace.samples.front().time_s, sessionSettingsOf(study).path}};
  Study now = study;
  for (const Change& change : gaze.changes) {
    if (!change.key.starts_with("eye.")) continue;
    setKey(now, change.key, change.toml, gaze.study.file.string());
    paths.push_back({change.time_s, sessionSettingsOf(now).path});
  }
  return paths;
}

class Looker {
 public:
  Looker(const Study& study, const ReplayedGaze& gaze, const Scene& scene)
      : study_(study),
        gaze_(gaze),
        query_(scene),
        objects_(scene.objects()),
        paths_(pathsOf(study, gaze)) {}

  const SceneObjects& objects() const { return objects_; }  // of the scene

  /// @param surface  gets what the sight meets; null: not wanted
  void look(const GazeSample& from, SightSample& sample, std::vector<SurfelShare>* surface) const {
    const double start_s = gaze_.trace.samples.front().time_s;
    const auto later = std::ranges::upper_bound(paths_.begin() + 1, paths_.end(), from.time_s, {},
                                                &PathFrom::time_s);
    const glm::dmat4 world_from_eye =
        glm::inverse(glm::dmat4(std::prev(later)->path.eyeFromWorldAt(from.time_s - start_s)));
    sample.origin_m = glm::dvec3(world_from_eye[3]);
    sample.up = glm::dvec3(world_from_eye[1]);
    sample.valid = from.point_px && !from.blink;
    if (!sample.valid) return;
    sample.direction = glm::normalize(glm::dmat3(world_from_eye) *
                                      lineOfSight(*gaze_.trace.screen, *from.point_px));
    auto met = query_.hit(sample.origin_m, sample.direction, glm::radians(study_.focus.cone_deg),
                          study_.focus.coverage);
    if (!met) return;
    SightHit hit{.point_m = sample.origin_m + met->distance_m * sample.direction,
                 .distance_m = met->distance_m,
                 .normal = met->normal};
    hit.object = objectAt(hit.point_m, met->surfels);
    sample.hit = hit;
    if (surface) *surface = std::move(met->surfels);
  }

 private:
  /// Number of the study's shape about the point, or of the object with the largest share.
  std::size_t objectAt(const glm::dvec3& point_m, const std::vector<SurfelShare>& surface) const {
    const std::vector<NamedShape>& shapes = study_.scene.objects;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (shapes[i].holds(point_m)) return i + 1;
    }
    if (objects_.empty()) return 0;
    std::map<std::uint16_t, double> shares;
    for (const SurfelShare& each : surface) shares[objects_.of[each.surfel]] += each.share;
    if (shares.empty()) return 0;
    const auto most =
        std::ranges::max_element(shares, {}, [](const auto& share) { return share.second; });
    return most->first == 0 ? 0 : shapes.size() + most->first;
  }

  const Study& study_;
  const ReplayedGaze& gaze_;
  SurfaceQuery query_;
  const SceneObjects& objects_;
  std::vector<PathFrom> paths_;
};

/// The samples of the replayed time, without what they meet; `source` gets their numbers.
std::vector<SightSample> samplesOf(const ReplayedGaze& gaze, const std::vector<GazeState>& states,
                                   std::vector<std::size_t>& source) {
  const std::vector<GazeSample>& all = gaze.trace.samples;
  const double most_s = gaze.trace.rate_Hz > 0.0 ? kMaxIntervals / gaze.trace.rate_Hz : 0.0;
  const double end_s = gaze.schedule.end_s();
  std::vector<SightSample> samples;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].time_s < gaze.schedule.first_s || all[i].time_s > end_s) continue;
    SightSample sample{.time_s = all[i].time_s,
                       .state = states[i],
                       .pupil_mm = all[i].pupil_mm,
                       .pupil_own = ownPupilOf(all[i])};
    sample.lasts_s = i + 1 < all.size() ? std::min(all[i + 1].time_s - all[i].time_s, most_s)
                                        : most_s / kMaxIntervals;
    samples.push_back(sample);
    source.push_back(i);
  }
  return samples;
}

SightFixation fixationOf(const GazeEvent& event, std::span<SightSample> samples,
                         std::size_t objects) {
  SightFixation fixation{.onset_s = event.onset_s, .duration_s = event.duration_s};
  std::vector<double> on_object_s(objects, 0.0);
  double gaze_s = 0.0, met_s = 0.0;
  SightHit mean;
  glm::dvec3 sight{0.0};
  for (const SightSample& sample : samplesDuring(event, samples)) {
    if (!sample.valid) continue;
    gaze_s += sample.lasts_s;
    sight += sample.lasts_s * sample.direction;
    if (!sample.hit) continue;
    met_s += sample.lasts_s;
    mean.point_m += sample.lasts_s * sample.hit->point_m;
    mean.distance_m += sample.lasts_s * sample.hit->distance_m;
    fixation.surface_D += sample.lasts_s / sample.hit->distance_m;
    mean.normal += sample.lasts_s * sample.hit->normal;
    on_object_s[sample.hit->object] += sample.lasts_s;
  }
  if (glm::length(sight) > 0.0) fixation.direction = glm::normalize(sight);
  if (!(met_s > 0.0)) return fixation;
  fixation.surface_D /= met_s;
  mean.point_m /= met_s;
  mean.distance_m /= met_s;
  if (mean.normal != glm::dvec3(0.0)) mean.normal = glm::normalize(mean.normal);
  const auto most = std::ranges::max_element(on_object_s);
  mean.object = static_cast<std::size_t>(most - on_object_s.begin());
  fixation.share = *most / gaze_s;
  fixation.hit = mean;
  return fixation;
}

/// Upwards in the scene.
glm::dvec3 upOf(const Study& study, const std::vector<SightSample>& samples) {
  glm::dvec3 up(0.0);
  for (const SightSample& sample : samples) up += sample.lasts_s * sample.up;
  if (!study.eye.recorded || !(glm::length(up) > 0.0)) up = study.eye.up;
  return glm::normalize(up);
}

/// How objects are looked at, from samples and fixations in order of time.
class Looks {
 public:
  /// @param named  the objects without looks
  explicit Looks(const std::vector<ObjectLooks>& named)
      : objects_(named), distance_s_(named.size(), 0.0) {}

  void add(const SightSample& sample) {
    if (!sample.hit) return;
    objects_[sample.hit->object].dwell_s += sample.lasts_s;
    distance_s_[sample.hit->object] += sample.lasts_s * sample.hit->distance_m;
  }

  void add(const SightFixation& fixation) {
    if (!fixation.hit) {
      last_.reset();
      return;
    }
    ObjectLooks& object = objects_[fixation.hit->object];
    if (!object.first_look_s) object.first_look_s = fixation.onset_s;
    ++object.fixations;
    object.visits += last_ != fixation.hit->object;
    last_ = fixation.hit->object;
  }

  std::vector<ObjectLooks> finish() {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      ObjectLooks& object = objects_[i];
      if (object.dwell_s > 0.0) object.mean_distance_m = distance_s_[i] / object.dwell_s;
    }
    return std::move(objects_);
  }

 private:
  std::vector<ObjectLooks> objects_;
  std::vector<double> distance_s_;
  std::optional<std::size_t> last_{};
};

std::string normalText(const glm::dvec3& normal) {
  return normal == glm::dvec3(0.0) ? "n/a\tn/a\tn/a" : vectorText(normal, 4);
}

/// By axis.
std::optional<glm::dvec3> medianPoint_m(std::span<const SightSample> samples) {
  std::vector<double> axis;
  glm::dvec3 median(0.0);
  for (int k = 0; k < 3; ++k) {
    axis.clear();
    for (const SightSample& sample : samples) {
      if (sample.hit) axis.push_back(sample.hit->point_m[k]);
    }
    if (axis.empty()) return std::nullopt;
    median[k] = quantile(axis, 0.5);
  }
  return median;
}

/// Standard deviation of a direction along each axis, degrees, from the steps between samples.
double noiseOf_deg(std::span<const glm::dvec3> directions) {
  double squares = 0.0;
  for (std::size_t i = 1; i < directions.size(); ++i) {
    const glm::dvec3 step = directions[i] - directions[i - 1];
    squares += glm::dot(step, step);
  }
  const auto steps = static_cast<double>(std::max<std::size_t>(directions.size(), 2) - 1);
  return glm::degrees(std::sqrt(0.25 * squares / steps));
}

bool restsOnAPoint(std::span<const SightSample> samples, const EventRules& rules) {
  const auto point_m = medianPoint_m(samples);
  if (!point_m) return false;
  const bool moves = std::ranges::any_of(samples, [&](const SightSample& sample) {
    return sample.origin_m != samples.front().origin_m;
  });
  if (!moves) return false;
  const auto towards = [&](const SightSample& sample) {
    return glm::normalize(*point_m - sample.origin_m);
  };
  std::vector<glm::dvec3> directions;
  StableGaze gaze;
  const glm::dvec3 middle = towards(samples[samples.size() / 2]);
  for (const SightSample& sample : samples) {
    if (!sample.valid) continue;
    directions.push_back(glm::normalize(sample.direction - towards(sample) + middle));
    gaze.add(sample.time_s, directions.back());
  }
  return directions.size() > 1 && !gaze.isPursuit(noiseOf_deg(directions), rules);
}

}  // namespace

void fixateRestingPoints(std::vector<GazeEvent>& events, std::span<SightSample> samples,
                         const EventRules& rules) {
  for (GazeEvent& event : events) {
    if (event.kind != GazeState::pursuit) continue;
    const std::span<SightSample> during = samplesDuring(event, samples);
    if (!restsOnAPoint(during, rules)) continue;
    event.kind = GazeState::fixation;
    for (SightSample& sample : during) {
      if (sample.state == GazeState::pursuit) sample.state = GazeState::fixation;
    }
  }
}

glm::dvec2 azimuthElevation_deg(const glm::dvec3& direction, const glm::dvec3& up) {
  glm::dvec3 ahead(0.0, 0.0, -1.0);
  if (glm::length(glm::cross(ahead, up)) < 0.1) ahead = {0.0, 1.0, 0.0};
  ahead = glm::normalize(ahead - glm::dot(ahead, up) * up);
  const glm::dvec3 right = glm::cross(ahead, up);
  const double azimuth_rad = std::atan2(glm::dot(direction, right), glm::dot(direction, ahead));
  const double elevation_rad = std::asin(glm::clamp(glm::dot(direction, up), -1.0, 1.0));
  return glm::degrees(glm::dvec2(azimuth_rad, elevation_rad));
}

std::string vectorText(const glm::dvec3& v, int digits) {
  return tabbed(decimal(v.x, digits), decimal(v.y, digits), decimal(v.z, digits));
}

std::optional<double> ownPupilOf(const GazeSample& sample) {
  const auto &left = sample.eyes[0].pupil_own, &right = sample.eyes[1].pupil_own;
  if (sample.pupil_own) return sample.pupil_own;
  if (left && right) return 0.5 * (*left + *right);
  return left ? left : right;
}

std::string pupilText(const std::optional<double>& pupil_mm, const std::optional<double>& pupil_own,
                      const std::string& own_unit) {
  if (pupil_mm) return decimal(*pupil_mm, 3) + "\tmm";
  return pupil_own ? tabbed(decimal(*pupil_own, 3), own_unit) : "n/a\tn/a";
}

std::string objectText(const GazeInScene& gaze, const std::optional<SightHit>& hit) {
  return !hit || hit->object == 0 ? "n/a" : visible(gaze.objects[hit->object].name);
}

bool NamedShape::holds(const glm::dvec3& point_m) const {
  if (radius_m) return glm::distance(point_m, center_m) <= *radius_m;
  return glm::all(glm::lessThanEqual(glm::abs(point_m - center_m), 0.5 * *size_m));
}

std::span<SightSample> samplesDuring(const GazeEvent& event, std::span<SightSample> samples) {
  const auto at = [&](double time_s) {
    return std::ranges::lower_bound(samples, time_s, {}, &SightSample::time_s);
  };
  return {at(event.onset_s), at(event.onset_s + event.duration_s)};
}

GazeInScene lookIntoScene(const Study& study, const ReplayedGaze& gaze, const Scene& scene,
                          RunEvents& judged, bool attention) {
  GazeInScene found;
  found.objects.push_back({.name = {}});
  for (const NamedShape& shape : study.scene.objects) found.objects.push_back({.name = shape.name});
  const Looker looker(study, gaze, scene);
  const std::vector<std::string>& names = looker.objects().names;
  for (std::size_t i = 1; i < names.size(); ++i) found.objects.push_back({.name = names[i]});
  std::vector<std::size_t> source;
  found.samples = samplesOf(gaze, judged.states, source);
  if (attention) {
    found.attention_s.assign(scene.size(), 0.0);
    found.heat_s_per_m2 = found.attention_s;
  }
  std::optional<Progress> progress;
  if (source.size() >= kLong) progress.emplace("following the gaze", "samples", source.size());
  // In blocks, so that the order of sums does not depend on the number of threads.
  constexpr std::size_t kBlock = 4096;
  std::vector<std::vector<SurfelShare>> surfaces(attention ? kBlock : 0);
  for (std::size_t first = 0; first < source.size(); first += kBlock) {
    const std::size_t some = std::min(kBlock, source.size() - first);
    parallelFor(some, [&](std::size_t i) {
      if (attention) surfaces[i].clear();
      looker.look(gaze.trace.samples[source[first + i]], found.samples[first + i],
                  attention ? &surfaces[i] : nullptr);
    });
    for (std::size_t i = 0; attention && i < some; ++i) {
      for (const SurfelShare& each : surfaces[i]) {
        const double lasts_s = found.samples[first + i].lasts_s;
        found.attention_s[each.surfel] += each.share * lasts_s;
        found.heat_s_per_m2[each.surfel] += each.per_m2 * lasts_s;
      }
    }
    if (progress) progress->advance(first + some);
  }
  if (gaze.trace.samples.front().head) {
    fixateRestingPoints(judged.events, found.samples, study.gaze.events.rules);
  }
  for (const GazeEvent& event : judged.events) {
    if (event.kind != GazeState::fixation) continue;
    found.fixations.push_back(fixationOf(event, found.samples, found.objects.size()));
  }
  Looks looks(found.objects);
  for (const SightSample& sample : found.samples) looks.add(sample);
  for (const SightFixation& fixation : found.fixations) looks.add(fixation);
  found.objects = looks.finish();
  found.up = upOf(study, found.samples);
  return found;
}

std::string sightTable(const GazeInScene& gaze, const std::vector<TraceTrial>& trials,
                       const std::string& pupil_unit) {
  std::string table =
      "time_s\tgaze_state\torigin_x_m\torigin_y_m\torigin_z_m\tdirection_x\tdirection_y\t"
      "direction_z\tpoint_x_m\tpoint_y_m\tpoint_z_m\tdistance_m\tnormal_x\tnormal_y\tnormal_z\t"
      "object\tpupil\tpupil_unit\ttrial\n";
  for (const SightSample& sample : gaze.samples) {
    std::string met = "n/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a";
    if (sample.hit) {
      met = tabbed(vectorText(sample.hit->point_m, 4), decimal(sample.hit->distance_m, 4),
                   normalText(sample.hit->normal));
    }
    table += rowOf(decimal(sample.time_s, 6), nameOf(sample.state), vectorText(sample.origin_m, 4),
                   sample.valid ? vectorText(sample.direction, 6) : "n/a\tn/a\tn/a", met,
                   objectText(gaze, sample.hit),
                   pupilText(sample.pupil_mm, sample.pupil_own, pupil_unit),
                   trialAt(trials, sample.time_s));
  }
  return table;
}

std::string objectTable(const GazeInScene& gaze, const std::vector<TraceTrial>& trials) {
  std::vector<ObjectLooks> named(gaze.objects.size());
  for (std::size_t i = 0; i < named.size(); ++i) named[i].name = gaze.objects[i].name;
  std::vector<std::string> order;
  order.reserve(trials.size() + 1);
  for (const TraceTrial& trial : trials) order.push_back(visible(trial.name));
  order.emplace_back("n/a");
  std::map<std::string, Looks> looks;
  if (trials.empty()) looks.try_emplace("n/a", named);
  const auto during = [&](double time_s) -> Looks& {
    return looks.try_emplace(trialAt(trials, time_s), named).first->second;
  };
  for (const SightSample& sample : gaze.samples) during(sample.time_s).add(sample);
  for (const SightFixation& fixation : gaze.fixations) during(fixation.onset_s).add(fixation);
  std::string table = "trial\tobject\tfirst_look_s\tdwell_s\tfixations\tvisits\tmean_distance_m\n";
  for (const std::string& trial : order) {
    const auto found = looks.find(trial);
    if (found == looks.end()) continue;
    const std::vector<ObjectLooks> objects = found->second.finish();
    looks.erase(found);
    for (std::size_t i = 1; i < objects.size(); ++i) {
      const ObjectLooks& object = objects[i];
      table += rowOf(trial, visible(object.name), orAbsent(object.first_look_s, 6),
                     decimal(object.dwell_s, 4), object.fixations, object.visits,
                     orAbsent(object.mean_distance_m, 4));
    }
  }
  return table;
}

}  // namespace foci
