#include "app/replay/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/study/framing.h"

namespace foci {
namespace {

constexpr float kReach = 8.0f;      // points shown, over the extent of eyes and points met
constexpr double kOutliers = 0.02;  // share of the samples beyond each side of the box
constexpr std::uint64_t kGoldenFraction = 0x9e3779b97f4a7c15;  // of 2^64
constexpr float kLeastExtent = 0.05f;  // of a side of the box, over its longest

/// The frame's axes in the world: right, up, backwards.
/// @param sight  mean line of sight, of any length
glm::dmat3 axesOf(const glm::dvec3& sight, const glm::dvec3& up) {
  glm::dvec3 ahead = sight - glm::dot(sight, up) * up;
  if (!(glm::length(ahead) > 1e-3 * glm::length(sight))) ahead = tangentTo(glm::vec3(up));
  ahead = glm::normalize(ahead);
  return {glm::cross(ahead, up), up, -ahead};
}

/// Points within reach, evenly by number: those where the fraction of number times golden ratio is
/// small, so that rows of a grid leave no pattern. A point is as likely as it is opaque (Enderton
/// et al. 2010, Stochastic transparency), so that veils cover what they should.
void choosePoints(const auto& cloud, const glm::dvec3& origin_m, const glm::dmat3& axes,
                  SceneView& view) {
  const auto& positions_m = cloud.position_m;
  const auto placeOf = [&](std::size_t i) -> std::optional<glm::vec3> {
    const glm::vec3 at_m((glm::dvec3(positions_m[i]) - origin_m) * axes);
    const glm::vec3 away_m = glm::abs(at_m);
    const bool near = std::max({away_m.x, away_m.y, away_m.z}) <= view.reach_m;
    return near ? std::optional(at_m) : std::nullopt;
  };
  view.points_all = positions_m.size();
  double opacity = 0.0;
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    if (!placeOf(i)) continue;
    ++view.points_near;
    opacity += double{opacityOf(cloud, i)};
  }
  const double share = std::min(1.0, static_cast<double>(kMaxViewPoints) / opacity);
  std::uint64_t fraction = 0;
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    const auto at_m = placeOf(i);
    if (!at_m) continue;
    fraction += kGoldenFraction;
    if (static_cast<double>(fraction) * 0x1p-64 >= share * double{opacityOf(cloud, i)}) continue;
    view.points.push_back(
        {.at_m = *at_m,
         .radius_m = coveringRadius_m(cloud, i) / static_cast<float>(std::sqrt(share)),
         .color = glm::u8vec3(glm::round(255.0f * displayColorOf(cloud, i)))});
  }
}

/// The box without outliers, such as a glance at the horizon.
void boxAbout(const std::vector<glm::vec3>& places_m, SceneView& view) {
  std::vector<float> values(places_m.size());
  const auto out = static_cast<std::size_t>(kOutliers * static_cast<double>(values.size()));
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(places_m, values.begin(), [&](const glm::vec3& at) { return at[axis]; });
    std::ranges::sort(values);
    view.low_m[axis] = values[out];
    view.high_m[axis] = values[values.size() - 1 - out];
  }
  const glm::vec3 extent = view.high_m - view.low_m;
  const float longest = std::max({extent.x, extent.y, extent.z, 1e-6f});
  const glm::vec3 wider = glm::max(glm::vec3(kLeastExtent * longest) - extent, 0.0f) / 2.0f;
  view.low_m -= wider;
  view.high_m += wider;
  view.reach_m = kReach * longest;
}

}  // namespace

std::optional<SceneView> sceneViewOf(const Scene& scene, const GazeInScene& gaze) {
  glm::dvec3 origin_m(0.0), sight(0.0);
  double met_s = 0.0;
  for (const SightSample& sample : gaze.samples) {
    if (!sample.hit) continue;
    origin_m += sample.lasts_s * sample.hit->point_m;
    sight += sample.lasts_s * sample.direction;
    met_s += sample.lasts_s;
  }
  if (!(met_s > 0.0)) return {};
  origin_m /= met_s;
  const glm::dmat3 axes = axesOf(sight, gaze.up);
  const auto inView = [&](const glm::dvec3& p) { return glm::vec3((p - origin_m) * axes); };

  SceneView view;
  std::vector<glm::vec3> places_m;
  for (std::size_t i = 0; i < gaze.fixations.size(); ++i) {
    const SightFixation& from = gaze.fixations[i];
    if (!from.hit) continue;
    const glm::dvec3 eye_m = from.hit->point_m - from.hit->distance_m * from.direction;
    const glm::dvec3 normal =
        from.hit->normal == glm::dvec3(0.0) ? -from.direction : from.hit->normal;
    view.fixations.push_back({{from.onset_s, inView(eye_m), inView(from.hit->point_m)},
                              from.duration_s,
                              i + 1,
                              glm::vec3(normal * axes)});
  }
  const std::size_t step = (gaze.samples.size() + kMaxSights - 1) / kMaxSights;
  for (std::size_t i = 0; i < gaze.samples.size(); i += step) {
    const SightSample& from = gaze.samples[i];
    const glm::vec3 nowhere(std::numeric_limits<float>::quiet_NaN());
    view.path.push_back(
        {from.time_s, inView(from.origin_m), from.hit ? inView(from.hit->point_m) : nowhere});
    places_m.push_back(view.path.back().eye_m);
    if (from.hit) places_m.push_back(view.path.back().point_m);
  }
  boxAbout(places_m, view);
  std::visit([&](const auto& cloud) { choosePoints(cloud, origin_m, axes, view); }, scene.splats);
  return view;
}

SceneView sceneViewOf(const Scene& scene, const std::vector<SightLine>& lines,
                      const glm::dvec3& up) {
  const SceneBox box = boxWithoutStrays(scene.position_m());
  glm::dvec3 sight(0.0);
  for (const SightLine& line : lines) sight += glm::normalize(line.end_m - line.eye_m);
  const glm::dmat3 axes = axesOf(sight, up);
  const auto inView = [&](const glm::dvec3& p) { return glm::vec3((p - box.middle()) * axes); };
  SceneView view;
  std::vector<glm::vec3> places_m;
  for (const SightLine& line : lines) {
    const glm::vec3 eye_m = inView(line.eye_m), end_m = inView(line.end_m);
    view.lines.push_back({eye_m, end_m, line.met});
    view.path.push_back({0.0, eye_m, end_m});
    places_m.insert(places_m.end(), {eye_m, end_m});
  }
  boxAbout(places_m, view);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::bvec3 high(corner & 1, corner & 2, corner & 4);
    const glm::vec3 at = inView(glm::mix(box.low, box.high, high));
    view.low_m = glm::min(view.low_m, at);
    view.high_m = glm::max(view.high_m, at);
  }
  const glm::vec3 reach_m = glm::max(glm::abs(view.low_m), glm::abs(view.high_m));
  view.reach_m = std::max({reach_m.x, reach_m.y, reach_m.z});
  std::visit([&](const auto& cloud) { choosePoints(cloud, box.middle(), axes, view); },
             scene.splats);
  return view;
}

}  // namespace foci
