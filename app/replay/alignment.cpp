#include "app/replay/alignment.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "app/replay/scene_view.h"
#include "app/study/framing.h"
#include "app/study/inputs.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "base/text.h"
#include "base/transformed.h"
#include "gaze/focus/vergence.h"
#include "gaze/geometry/line_of_sight.h"
#include "render/lod/surface_query.h"

namespace foci {
namespace {

constexpr double kNearest_m = 0.1, kFarthest_m = 100.0;  // plausible distances of gaze
constexpr double kSurface_D = 0.1;                       // as `vergenceDisagrees`
constexpr double kUsual_m = 2.0;                         // of gaze without vergence
constexpr double kLeastVergence_D = 0.2;                 // its points still count for places
constexpr double kCone_rad = 0.0087, kCoverage = 0.5;    // half a degree, as focus.cone_deg
constexpr double kElsewhere = 0.15, kFarStart = 0.5;     // of the distance
constexpr std::size_t kMaxAlignedSights = 240;
constexpr double kBlock_s = 0.3, kErrors = 2.0, kSame = 0.01;
constexpr double kNear = 0.1, kNearYaw_deg = 5.0;  // steps to neighbours
constexpr std::size_t kRoughSights = 32, kMiddleSights = 60;
constexpr std::size_t kEachGrid = 3, kStarts = 30, kFinalists = 4;
constexpr double kGridStep = 0.3, kMostCells = 16.0;  // of the distance; along the longest side

/// A yaw and a scale relative to those as it stands, and where the pivot lies in the scene.
struct Pose {
  double yaw_rad = 0.0, log_scale = 0.0;
  glm::dvec3 place_m{0.0};
};

struct Scored {
  Pose pose;
  double score;
};

using Distance = std::function<std::optional<double>(const glm::dvec3&, const glm::dvec3&)>;

double scoreOf(const Sight& sight, const std::optional<double>& met_m, double scale,
               double sigma_D) {
  if (!met_m) return 0.0;
  const double away_m = *met_m / scale;
  if (!(away_m >= kNearest_m && away_m <= kFarthest_m)) return 0.0;
  if (!sight.vergence_D) return 1.0;
  const double error = (1.0 / away_m - *sight.vergence_D) / sigma_D;
  return std::exp(-0.5 * error * error);
}

std::vector<Sight> someOf(const std::vector<Sight>& all, std::size_t most) {
  std::vector<Sight> some;
  const double step = std::max(1.0, static_cast<double>(all.size()) / static_cast<double>(most));
  for (double at = 0.0; at < static_cast<double>(all.size()); at += step) {
    some.push_back(all[static_cast<std::size_t>(at)]);
  }
  return some;
}

/// Whether the first does no better than the second beyond chance.
bool noBetter(const std::vector<Sight>& sights, const std::vector<double>& best,
              const std::vector<double>& other) {
  std::vector<double> blocks;
  double sum = 0.0, count = 0.0, since_s = sights.front().time_s;
  const auto close = [&] {
    if (count > 0.0) blocks.push_back(sum / count);
    sum = count = 0.0;
  };
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (sights[i].time_s >= since_s + kBlock_s) {
      close();
      since_s = sights[i].time_s;
    }
    sum += best[i] - other[i];
    count += 1.0;
  }
  close();
  const auto n = static_cast<double>(blocks.size());
  double mean = 0.0, squares = 0.0;
  for (const double each : blocks) mean += each / n;
  for (const double each : blocks) squares += (each - mean) * (each - mean);
  const double error = n > 1.0 ? std::sqrt(squares / (n - 1.0) / n) : 1.0;
  return mean <= std::max(kSame, kErrors * error);
}

class Search {
 public:
  Search(const Scene& scene, const std::vector<Sight>& sights, const SceneAlignment& now,
         const glm::dvec3& up, double sigma_D)
      : sights_(sights), now_(now), up_(up), sigma_D_(sigma_D), query_(scene) {
    const glm::dquat stands = sceneFromRecording(now);
    const glm::dvec3 y = stands * glm::dvec3(0.0, 1.0, 0.0);
    if (glm::dot(y, up) > -0.999) {
      upright_ = glm::normalize(glm::dquat(1.0 + glm::dot(y, up), glm::cross(y, up))) * stands;
    } else {  // half a turn about any horizontal axis
      const glm::dvec3 axis(tangentTo(glm::vec3(up)));
      upright_ = glm::dquat(0.0, axis.x, axis.y, axis.z) * stands;
    }
    std::vector<double> away_m;
    for (const Sight& sight : sights) {
      away_m.push_back(probableDistance_m(sight));
      pivot_m_ +=
          (sight.eye_m + away_m.back() * sight.direction) / static_cast<double>(sights.size());
    }
    distance_m_ = quantile(away_m, 0.5);
    const SceneBox box = boxWithoutStrays(scene.position_m());
    low_m_ = box.low;
    high_m_ = box.high;
  }

  SceneAlignment alignmentOf(const Pose& pose) const {
    const glm::dquat r = glm::angleAxis(pose.yaw_rad, up_) * upright_;
    const double scale = now_.scale * std::exp(pose.log_scale);
    return {.rotation = {r.x, r.y, r.z, r.w},
            .scale = scale,
            .offset_m = pose.place_m - scale * (r * pivot_m_)};
  }

  /// Of all sights, in the scene itself.
  AlignmentFit fitOf(const SceneAlignment& alignment) const {
    AlignmentFit fit{.alignment = alignment};
    fit.met_m.resize(sights_.size());
    const glm::dquat r = sceneFromRecording(alignment);
    parallelFor(sights_.size(), [&](std::size_t i) {
      fit.met_m[i] = exact(alignment.offset_m + alignment.scale * (r * sights_[i].eye_m),
                           r * sights_[i].direction);
    });
    const auto n = static_cast<double>(sights_.size());
    for (std::size_t i = 0; i < sights_.size(); ++i) {
      fit.scores.push_back(scoreOf(sights_[i], fit.met_m[i], alignment.scale, sigma_D_));
      fit.score += fit.scores.back() / n;
      fit.met += fit.met_m[i] ? 1.0 / n : 0.0;
    }
    return fit;
  }

  double distance_m() const { return distance_m_; }

  /// How far apart two poses place what is looked at, and the eye, over its distance.
  double apart(const Pose& a, const Pose& b) const {
    const SceneAlignment first = alignmentOf(a), second = alignmentOf(b);
    const auto placing = [](const SceneAlignment& by) {
      return [&by, r = sceneFromRecording(by)](const glm::dvec3& p) {
        return by.offset_m + by.scale * (r * p);
      };
    };
    const auto in_first = placing(first), in_second = placing(second);
    std::vector<double> moved;
    for (const Sight& sight : someOf(sights_, 16)) {
      const glm::dvec3 point_m = sight.eye_m + probableDistance_m(sight) * sight.direction;
      moved.push_back(std::max(glm::distance(in_first(point_m), in_second(point_m)),
                               glm::distance(in_first(sight.eye_m), in_second(sight.eye_m))));
    }
    return quantile(moved, 0.5) / (distance_m_ * std::sqrt(first.scale * second.scale));
  }

  /// The best poses, the best first, each elsewhere.
  std::vector<Pose> best(const Scene& scene, const AlignmentRange& range) const {
    const SceneVoxels voxels(scene, low_m_, high_m_);
    const Distance rough = [&](const glm::dvec3& o, const glm::dvec3& d) {
      return voxels.distance_m(o, d);
    };
    std::vector<Scored> found = starts(rough, range);
    const double yaw_rad = glm::radians(range.yaw_deg) / 2.0;
    const std::vector<Sight> some = someOf(sights_, kMiddleSights);
    parallelFor(found.size(), [&](std::size_t i) {
      const double step_m = 0.5 * stepOf_m(found[i].pose);
      found[i] = climb(found[i].pose, some, rough, 0.4, {yaw_rad, 0.09, glm::dvec3(step_m)}, 4, 6);
      found[i] =
          climb(found[i].pose, some, rough, 0.2, {yaw_rad / 4, 0.03, glm::dvec3(step_m / 4)}, 4, 6);
    });
    found = elsewhere(std::move(found), kElsewhere, kFinalists);
    found.push_back(
        {{0.0, 0.0, now_.offset_m + now_.scale * (sceneFromRecording(now_) * pivot_m_)}, 0.0});
    const Distance fine = [&](const glm::dvec3& o, const glm::dvec3& d) { return exact(o, d); };
    parallelFor(found.size(), [&](std::size_t i) {
      const Pose step{yaw_rad / 8, 0.02, glm::dvec3(voxels.cube_m())};
      found[i] = climb(found[i].pose, some, fine, sigma_D_, step, 4, 3);
    });
    auto poses =
        transformed(elsewhere(std::move(found), kElsewhere, kFinalists + 1), &Scored::pose);
    if (!poses.empty()) {
      const Pose step{yaw_rad / 16, 0.01, glm::dvec3(voxels.cube_m() / 2)};
      poses[0] = climb(poses[0], sights_, fine, sigma_D_, step, 5, 6).pose;
    }
    return poses;
  }

 private:
  std::optional<double> exact(const glm::dvec3& origin_m, const glm::dvec3& direction) const {
    return query_.distance(origin_m, direction, kCone_rad, kCoverage);
  }

  double stepOf_m(const Pose& pose) const {
    const glm::dvec3 size_m = high_m_ - low_m_;
    return std::max(kGridStep * now_.scale * std::exp(pose.log_scale) * distance_m_,
                    std::max({size_m.x, size_m.y, size_m.z}) / kMostCells);
  }

  double score(const Pose& pose, const std::vector<Sight>& sights, const Distance& distance,
               double sigma_D) const {
    const SceneAlignment by = alignmentOf(pose);
    const glm::dmat3 r(glm::mat3_cast(sceneFromRecording(by)));
    double sum = 0.0;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const Sight& sight = sights[i];
      sum +=
          scoreOf(sight, distance(by.offset_m + by.scale * (r * sight.eye_m), r * sight.direction),
                  by.scale, sigma_D);
      if (i == 7 && sum < 1.0) return 0.0;  // no start
    }
    return sum / static_cast<double>(sights.size());
  }

  /// The best cells of a grid of places for each yaw and scale; of all, those far from each other.
  std::vector<Scored> starts(const Distance& rough, const AlignmentRange& range) const {
    const std::vector<Sight> some = someOf(sights_, kRoughSights);
    const auto yaws = static_cast<std::size_t>(std::lround(360.0 / range.yaw_deg));
    const auto scales = 2 * static_cast<std::size_t>(range.scales) + 1;
    std::vector<std::vector<Scored>> by(yaws * scales);
    parallelFor(by.size(), [&](std::size_t k) {
      Pose pose{.yaw_rad = glm::radians(range.yaw_deg) * static_cast<double>(k % yaws),
                .log_scale = 0.25 * std::log(2.0) * (static_cast<double>(k / yaws) - range.scales)};
      const double step_m = stepOf_m(pose);
      const glm::ivec3 cells = glm::ivec3(glm::ceil((high_m_ - low_m_) / step_m)) + 1;
      const glm::dvec3 first_m = 0.5 * (low_m_ + high_m_) - 0.5 * step_m * glm::dvec3(cells - 1);
      std::vector<Scored> all;
      for (int x = 0; x < cells.x; ++x) {
        for (int y = 0; y < cells.y; ++y) {
          for (int z = 0; z < cells.z; ++z) {
            pose.place_m = first_m + step_m * glm::dvec3(x, y, z);
            all.push_back({pose, score(pose, some, rough, std::max(sigma_D_, 0.4))});
          }
        }
      }
      by[k] = elsewhere(std::move(all), kFarStart, kEachGrid);
    });
    std::vector<Scored> found;
    for (const auto& each : by) found.insert(found.end(), each.begin(), each.end());
    return elsewhere(std::move(found), kFarStart, kStarts);
  }

  /// The best, in order, each farther than `apart_by` from those before it.
  std::vector<Scored> elsewhere(std::vector<Scored> all, double apart_by, std::size_t most) const {
    std::ranges::stable_sort(all, std::ranges::greater{}, &Scored::score);
    std::vector<Scored> kept;
    for (const Scored& each : all) {
      if (kept.size() == most || each.score <= 0.0) break;
      if (std::ranges::all_of(
              kept, [&](const Scored& k) { return apart(k.pose, each.pose) > apart_by; })) {
        kept.push_back(each);
      }
    }
    return kept;
  }

  /// Steps along one coordinate after another while the score rises; then half the step.
  Scored climb(Pose pose, const std::vector<Sight>& sights, const Distance& distance,
               double sigma_D, Pose step, int halvings, int sweeps) const {
    sigma_D = std::max(sigma_D, sigma_D_);
    double best = score(pose, sights, distance, sigma_D);
    const auto improve = [&](double& coordinate, double by) {
      for (const double to : {coordinate + by, coordinate - by}) {
        const double from = std::exchange(coordinate, to);
        const double now = score(pose, sights, distance, sigma_D);
        if (now > best) {
          best = now;
          return true;
        }
        coordinate = from;
      }
      return false;
    };
    for (int i = 0; i < halvings; ++i) {
      bool better = true;
      for (int sweep = 0; better && sweep < sweeps; ++sweep) {
        better = improve(pose.yaw_rad, step.yaw_rad);
        better |= improve(pose.log_scale, step.log_scale);
        for (int axis = 0; axis < 3; ++axis) {
          better |= improve(pose.place_m[axis], step.place_m[axis]);
        }
      }
      step = {0.5 * step.yaw_rad, 0.5 * step.log_scale, 0.5 * step.place_m};
    }
    return {pose, best};
  }

  const std::vector<Sight>& sights_;
  SceneAlignment now_;
  glm::dvec3 up_;
  double sigma_D_;
  SurfaceQuery query_;
  glm::dquat upright_{};  // the recording as it stands, its y axis upwards
  glm::dvec3 pivot_m_{0.0}, low_m_{0.0}, high_m_{0.0};
  double distance_m_ = 0.0;
};

std::string inPercent(double share) { return decimal(100.0 * share, 0) + " %"; }

}  // namespace

double probableDistance_m(const Sight& sight) {
  return sight.vergence_D ? 1.0 / std::max(*sight.vergence_D, kLeastVergence_D) : kUsual_m;
}

RecordedSights sightsOf(const GazeTrace& trace, const Screen& screen, double ipd_m) {
  const glm::dvec3 eye_head_m = middleOfEyes_m(trace.samples);
  std::vector<Sight> all;
  std::vector<double> steps_D;  // between neighbours
  std::optional<double> before_D;
  for (const GazeSample& sample : trace.samples) {
    const auto direction = sightInWorld(sample, screen);
    if (!sample.head || !direction || sample.blink) continue;
    Sight sight{.time_s = sample.time_s,
                .eye_m = sample.head->position_m + sample.head->world_from_head * eye_head_m,
                .direction = *direction};
    if (sample.eyes[0].direction && sample.eyes[1].direction) {
      if (const auto rays = raysOf(sample, screen, ipd_m)) {
        sight.vergence_D = vergence_D(rays->first, rays->second);
      }
    }
    if (sight.vergence_D && before_D) steps_D.push_back(std::abs(*sight.vergence_D - *before_D));
    before_D = sight.vergence_D;
    all.push_back(sight);
  }
  RecordedSights sights{.sights = someOf(all, kMaxAlignedSights)};
  if (!steps_D.empty()) {
    sights.sigma_D = std::hypot(kSurface_D, kSigmaPerMad * quantile(steps_D, 0.5) / std::sqrt(2.0));
  }
  return sights;
}

AlignmentSearch::Verdict AlignmentSearch::verdict() const {
  if (best.score < kLeastFit) return Verdict::nothing_fits;
  if (now_as_good) return Verdict::keep;
  const bool flat = std::ranges::any_of(neighbours, &AlignmentNeighbour::as_good);
  return flat || rivals > 0 ? Verdict::ambiguous : Verdict::propose;
}

AlignmentSearch searchAlignment(const Scene& scene, const RecordedSights& looks,
                                const SceneAlignment& now, const glm::dvec3& up,
                                const AlignmentRange& range) {
  AlignmentSearch result;
  result.sigma_D = looks.sigma_D;
  const std::vector<Sight>& sights = looks.sights;
  const Search search(scene, sights, now, up, result.sigma_D);
  result.now = search.fitOf(now);
  result.best = result.now;
  const std::vector<Pose> poses = search.best(scene, range);
  std::vector<AlignmentFit> fits;
  fits.reserve(poses.size());
  for (const Pose& pose : poses) fits.push_back(search.fitOf(search.alignmentOf(pose)));
  std::size_t at = poses.size();  // as it stands
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].score > result.best.score) {
      result.best = fits[i];
      at = i;
    }
  }
  result.now_as_good = noBetter(sights, result.best.scores, result.now.scores);
  if (at == poses.size()) return result;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (i == at) continue;
    result.rivals += noBetter(sights, result.best.scores, fits[i].scores);
    if (!result.rival || fits[i].score > result.rival->score) result.rival = fits[i];
  }
  const double step_m = kNear * result.best.alignment.scale * search.distance_m();
  const auto look = [&](const std::string& name, const Pose& step) {
    AlignmentNeighbour neighbour{.step = name, .drop = 1.0};
    for (const double side : {-1.0, 1.0}) {
      const Pose& p = poses[at];
      const AlignmentFit fit = search.fitOf(
          search.alignmentOf({p.yaw_rad + side * step.yaw_rad, p.log_scale + side * step.log_scale,
                              p.place_m + side * step.place_m}));
      neighbour.drop = std::min(neighbour.drop, result.best.score - fit.score);
      neighbour.as_good |= noBetter(sights, result.best.scores, fit.scores);
    }
    result.neighbours.push_back(neighbour);
  };
  for (int axis = 0; axis < 3; ++axis) {
    Pose step;
    step.place_m[axis] = step_m;
    look(significant(step_m, 2) + " m along " + "xyz"[axis], step);
  }
  look(significant(kNearYaw_deg) + " degrees about the vertical",
       {.yaw_rad = glm::radians(kNearYaw_deg)});
  look("10 % in scale", {.log_scale = std::log(1.1)});
  return result;
}

std::string verdictText(const AlignmentSearch& search) {
  using Verdict = AlignmentSearch::Verdict;
  switch (search.verdict()) {
    case Verdict::keep:
      return search.rivals == 0
                 ? "no pose does better than the recording as it stands"
                 : "the recording as it stands does as well as any pose, but so do " +
                       counted(search.rivals, "pose") + " elsewhere";
    case Verdict::nothing_fits:
      return "no pose fits: even the best one scores " + inPercent(search.best.score) +
             ", and below " + inPercent(kLeastFit) + " foci proposes none";
    case Verdict::propose:
      return "one pose fits better than all others";
    case Verdict::ambiguous:
      break;
  }
  std::string flat;
  for (const AlignmentNeighbour& each : search.neighbours) {
    if (each.as_good) flat += (flat.empty() ? "" : ", or by ") + each.step;
  }
  std::string text = "many poses do as well, so foci proposes none:";
  if (!flat.empty()) text += " the best one may move by " + flat;
  if (search.rivals > 0) {
    text += std::string(flat.empty() ? " " : "; ") + counted(search.rivals, "pose") +
            " elsewhere " + (search.rivals == 1 ? "is" : "are") + " no worse than the best one";
  }
  if (search.sigma_D == 0.0) text += "; directions of both eyes would tell how far gaze was";
  return text;
}

std::string alignmentToml(const SceneAlignment& alignment) {
  const glm::dvec4 r = glm::normalize(alignment.rotation);
  const auto list = [](std::initializer_list<double> values, int digits) {
    return "[" + listed(values, ", ", [&](double each) { return decimal(each, digits); }) + "]";
  };
  return "[gaze]\nscene_rotation = " + list({r.x, r.y, r.z, r.w}, 6) +
         "\nscene_scale = " + significant(alignment.scale, 5) + "\nscene_offset_m = " +
         list({alignment.offset_m.x, alignment.offset_m.y, alignment.offset_m.z}, 4) + "\n";
}

}  // namespace foci
