#include "render/scene/estimation/estimate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "base/quantile.h"
#include "render/normalisation/weights.h"
#include "render/scene/neighbours.h"
#include "render/scene/principal_axes.h"

namespace foci {
namespace {

// Chosen by hand; `SurfelsFromPoints` tests bound normals, areas and sums.
constexpr std::size_t kNeighbours = 16;
constexpr std::size_t kSolveNeighbours = 64;  // four spacings: all that a grown kernel meets
constexpr std::uint8_t kStacked = 4;          // neighbours that coincide with a point
constexpr float kSameSheetCosine = 0.5f;      // of normals
constexpr float kCreaseCosine = -0.25f;       // of the normals of two faces that meet in a crease
constexpr float kSeenCosine = 0.1f;           // of a normal to the line of sight
constexpr float kSameSheetReach = 0.5f;       // off the tangent plane, over the k-th distance
constexpr float kMaxLocalSpacings = 2.0f;     // neighbours' medians: strays beside a surface
constexpr float kMaxSpacings = 5.0f;          // medians of the cloud: strays far from everything
constexpr float kMinSigma_m = 1e-9f;          // its fourth power is still a normal float
constexpr int kQuickIterations = 8, kMeshIterations = 40;
// More make the sums no more even, of scans of a cube, a room and a rippled terrain. Fewer rounds
// make those of coarse levels less even.
constexpr int kPointRounds = 20, kPointIterations = 20;
constexpr float kAround = 16.0f;      // spacings; weights hardly act farther
constexpr double kMaxOpposed = 0.05;  // share of neighbours, in an oriented cloud

/// Unit eigenvector of the smallest eigenvalue; any of them if several are smallest, the z axis
/// for the zero matrix.
glm::dvec3 smallestAxis(const glm::dmat3& a) {
  const PrincipalAxes all = principalAxes(a);
  int smallest = 2;
  for (int i = 0; i < 2; ++i) {
    if (all.variance[i] < all.variance[smallest]) smallest = i;
  }
  return glm::normalize(all.axes[smallest]);
}

void estimateNormals(const std::vector<glm::vec3>& position_m, const Neighbours& near,
                     const std::optional<glm::vec3>& viewpoint_m, std::vector<glm::vec3>& normal) {
  glm::dvec3 centroid(0.0);
  for (const glm::vec3& p : position_m) centroid += p;
  centroid /= static_cast<double>(position_m.size());

  normal.resize(position_m.size(), glm::vec3(0.0f));
  parallelFor(position_m.size(), [&](std::size_t i) {
    if (normal[i] != glm::vec3(0.0f)) return;
    const glm::dvec3 p = position_m[i];
    glm::dvec3 mean(0.0);
    for (const std::uint32_t j : near.of(i)) mean += glm::dvec3(position_m[j]) - p;
    mean /= static_cast<double>(near.k + 1);
    glm::dmat3 covariance = glm::outerProduct(mean, mean);  // the point itself
    for (const std::uint32_t j : near.of(i)) {
      const glm::dvec3 d = glm::dvec3(position_m[j]) - p - mean;
      covariance += glm::outerProduct(d, d);
    }
    const glm::dvec3 axis = smallestAxis(covariance);
    const glm::dvec3 outwards = viewpoint_m ? glm::dvec3(*viewpoint_m) - p : p - centroid;
    normal[i] = glm::vec3(glm::dot(axis, outwards) < 0.0 ? -axis : axis);
  });
}

std::uint16_t bodyOf(const PointCloud& points, std::size_t i) {
  return points.body.empty() ? std::uint16_t{0} : points.body[i];
}

/// By point of a mesh, a number for its closed body and how densely that is sampled, the densest
/// first: an object on the ground holds none of the ground's neighbours. Empty for other points.
std::vector<std::uint32_t> groupsOf(const PointCloud& points) {
  using Group = std::pair<float, std::uint16_t>;
  if (points.area_m2.empty()) return {};
  std::map<Group, std::uint32_t> number;
  for (std::size_t i = 0; i < points.size(); ++i) number[{points.area_m2[i], bodyOf(points, i)}];
  std::uint32_t next = 0;
  for (auto& [group, value] : number) value = next++;
  std::vector<std::uint32_t> of(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    of[i] = number[{points.area_m2[i], bodyOf(points, i)}];
  }
  return of;
}

/// Whether two points lie on faces of one surface that an eye can see at once.
bool meet(const PointCloud& points, std::size_t i, std::size_t j) {
  return !points.surface.empty() && points.surface[i] == points.surface[j] &&
         glm::dot(points.normal[i], points.normal[j]) >= kCreaseCosine;
}

/// By point of a mesh, the direction along which its kernels are summed: its normal, and beside a
/// crease the mean normal around. Along that the eye sees both faces, which tile what it sees.
/// Empty for other points, whose surfaces are unknown.
std::vector<glm::vec3> directionsOf(const PointCloud& points, const Neighbours& near) {
  if (points.surface.empty()) return {};
  std::vector<glm::vec3> along = points.normal;
  parallelFor(points.size(), [&](std::size_t i) {
    glm::vec3 sum = points.normal[i];
    for (const std::uint32_t j : near.of(i)) {
      if (meet(points, i, j)) sum += points.normal[j];
    }
    const float length = glm::length(sum);
    // At the tip of a spike no direction sees all sides.
    if (glm::dot(sum, points.normal[i]) > kSeenCosine * length) along[i] = sum / length;
  });
  return along;
}

/// By point, one bit for each neighbour: whether both lie on the same sheet of surface, seen along
/// the point's direction (`directionsOf`). A closed body has sheets of its own: the ground goes on
/// under it. The two sides of a thin one are two sheets: an eye outside of it sees one of them.
std::vector<std::uint64_t> sameSheet(const PointCloud& points, const std::vector<glm::vec3>& along,
                                     const Neighbours& near) {
  static_assert(kMaxNeighbours <= 64);  // bits
  const std::vector<glm::vec3>&position_m = points.position_m, &normal = points.normal;
  std::vector<std::uint64_t> sheet(position_m.size(), 0);
  if (near.k == 0) return sheet;
  const auto same = [&](std::size_t i, std::size_t j) {
    if (bodyOf(points, i) != bodyOf(points, j)) return false;
    float cosine = glm::dot(normal[i], normal[j]);
    if (cosine < kSameSheetCosine && meet(points, i, j)) {
      return glm::dot(along[i], normal[j]) >= kSeenCosine;
    }
    if (bodyOf(points, i) == 0) cosine = std::abs(cosine);
    const float off_plane = std::abs(glm::dot(position_m[j] - position_m[i], normal[i]));
    return off_plane <= kSameSheetReach * near.reach_m[i] && cosine >= kSameSheetCosine;
  };
  parallelFor(position_m.size(), [&](std::size_t i) {
    std::uint64_t bits = 0, bit = 1;
    for (const std::uint32_t j : near.of(i)) {
      if (same(i, j)) bits |= bit;
      bit <<= 1;
    }
    sheet[i] = bits;
  });
  return sheet;
}

/// Whether almost all neighbours on one sheet have their normals on the same side.
bool agree(const std::vector<glm::vec3>& normal, const Neighbours& near,
           const std::vector<std::uint64_t>& sheet) {
  std::vector<std::uint8_t> opposed(normal.size(), 0);
  parallelFor(normal.size(), [&](std::size_t i) {
    std::uint64_t bit = 1;
    for (const std::uint32_t j : near.of(i)) {
      opposed[i] += (sheet[i] & bit) != 0 && glm::dot(normal[i], normal[j]) < 0.0f;
      bit <<= 1;
    }
  });
  std::size_t pairs = 0, opposed_pairs = 0;
  for (std::size_t i = 0; i < normal.size(); ++i) {
    pairs += static_cast<std::size_t>(std::popcount(sheet[i]));
    opposed_pairs += opposed[i];
  }
  return pairs > 0 && static_cast<double>(opposed_pairs) < kMaxOpposed * static_cast<double>(pairs);
}

/// Square root of a sample's area, from the distance of the k-th neighbour; strays are kept small.
std::vector<float> spacings(const Neighbours& near, const std::vector<std::uint64_t>& sheet,
                            float lone_spacing_m) {
  std::vector<float> raw(sheet.size(), lone_spacing_m);
  if (near.k == 0) return raw;
  parallelFor(raw.size(), [&](std::size_t i) {
    const int own = std::popcount(sheet[i]);
    const auto samples = static_cast<float>(own >= 3 ? own : static_cast<int>(near.k));
    raw[i] = near.reach_m[i] * std::sqrt(glm::pi<float>() / samples);
  });
  std::vector<float> sorted = raw;
  const float max_m = kMaxSpacings * quantile(sorted, 0.5);
  std::vector<float> spacing(raw.size());
  parallelFor(raw.size(), [&](std::size_t i) {
    std::array<float, kNeighbours> around{};
    std::size_t count = 0;
    for (const std::uint32_t j : near.of(i)) around[count++] = raw[j];
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(count));
    spacing[i] = std::max(std::min({raw[i], max_m, kMaxLocalSpacings * *middle}), kMinSigma_m);
  });
  return spacing;
}

SurfelCloud assemble(PointCloud&& points, const std::vector<float>& sigma_m,
                     std::vector<float>&& weight) {
  SurfelCloud cloud;
  const std::size_t count = points.size();
  cloud.axis_u_m.resize(count);
  cloud.axis_v_m.resize(count);
  parallelFor(count, [&](std::size_t i) {
    const glm::vec3 n = points.normal[i];
    const glm::vec3 u = tangentTo(n);
    cloud.axis_u_m[i] = sigma_m[i] * u;
    cloud.axis_v_m[i] = sigma_m[i] * glm::cross(n, u);
  });
  cloud.position_m = std::move(points.position_m);
  cloud.color = std::move(points.color);
  cloud.area_m2 = std::move(weight);
  const bool opaque = std::all_of(points.opacity.begin(), points.opacity.end(),
                                  [](float opacity) { return opacity == 1.0f; });
  if (!opaque) cloud.opacity = std::move(points.opacity);
  cloud.bodies.of_surfel = std::move(points.body);
  completeBodies(cloud);
  cloud.objects = std::move(points.objects);
  points = {};
  return cloud;
}

KernelEffort effortOf(const EstimateSettings& settings, bool areas_known) {
  switch (settings.solve) {
    case KernelSolve::none:
      return {};
    case KernelSolve::quick:
      return {.weight_iterations = kQuickIterations};
    case KernelSolve::thorough:
      break;
  }
  return {.sigma_rounds = kPointRounds,
          .rendered_iterations = areas_known ? kMeshIterations : kPointIterations,
          .progress = settings.progress};
}

/// By point, the number of its part of space, of up to `most` points.
std::vector<std::uint32_t> partsInSpace(const std::vector<glm::vec3>& position_m,
                                        std::size_t most) {
  std::vector<std::uint32_t> part_of(position_m.size()), order(position_m.size());
  std::iota(order.begin(), order.end(), 0u);
  std::uint32_t parts = 0;
  const auto split = [&](const auto& self, std::span<std::uint32_t> some) -> void {
    if (some.size() <= most) {
      for (const std::uint32_t i : some) part_of[i] = parts;
      ++parts;
      return;
    }
    const glm::vec3 first = position_m[some.front()];
    glm::vec3 low = first, high = first;
    for (const std::uint32_t i : some) {
      low = glm::min(low, position_m[i]);
      high = glm::max(high, position_m[i]);
    }
    const glm::vec3 size = high - low;
    const int axis = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = some.size() / 2;
    std::nth_element(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(half), some.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::tuple(position_m[a][axis], a) <
                              std::tuple(position_m[b][axis], b);
                     });
    self(self, some.first(half));
    self(self, some.subspan(half));
  };
  split(split, order);
  return part_of;
}

/// Solves one part of space after the other, so that the neighbours of one part alone are in
/// memory. Points around a part are solved with it, and left.
/// @return the weights
std::vector<float> solveInParts(const PointCloud& points, const std::vector<std::uint32_t>& group,
                                const std::vector<float>& spacing_m,
                                const EstimateSettings& settings, std::vector<float>& sigma_m) {
  const std::vector<glm::vec3>& position_m = points.position_m;
  const std::vector<std::uint32_t> part_of = partsInSpace(position_m, settings.solved_at_once);
  const std::size_t parts = 1 + *std::max_element(part_of.begin(), part_of.end());
  std::vector<float> solved_m(points.size()), weight(points.size());
  for (std::uint32_t part = 0; part < parts; ++part) {
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (part_of[i] != part) continue;
      low = glm::min(low, position_m[i] - kAround * spacing_m[i]);
      high = glm::max(high, position_m[i] + kAround * spacing_m[i]);
    }
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const glm::vec3& p = position_m[i];
      if (glm::clamp(p, low, high) == p) chosen.push_back(i);
    }
    PointCloud some;
    some.position_m = picked(position_m, chosen);
    some.normal = picked(points.normal, chosen);
    some.body = picked(points.body, chosen);
    some.surface = picked(points.surface, chosen);
    const Neighbours near =
        findNeighbours(some.position_m, picked(group, chosen), kSolveNeighbours);
    const std::vector<glm::vec3> along = directionsOf(some, near);
    const std::vector<std::uint64_t> sheet = sameSheet(some, along, near);
    const std::vector<float> spacing_of_some_m = picked(spacing_m, chosen);
    std::vector<float> sigma_of_some_m = picked(sigma_m, chosen);
    const bool areas_known = !group.empty();
    KernelEffort effort = effortOf(settings, areas_known);
    if (settings.progress) {
      effort.progress = [&](std::size_t done, std::size_t total) {
        settings.progress(part * total + done, parts * total);
      };
    }
    const std::vector<float> weight_of_some =
        solveKernels({some.position_m, some.normal, along.empty() ? some.normal : along, near,
                      sheet, spacing_of_some_m, areas_known},
                     effort, sigma_of_some_m);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (part_of[chosen[k]] != part) continue;
      solved_m[chosen[k]] = sigma_of_some_m[k];
      weight[chosen[k]] = weight_of_some[k];
    }
  }
  sigma_m = std::move(solved_m);
  return weight;
}

enum class Stacks { possible, resolved };

/// Whether so many points coincide somewhere that the neighbours' distance is no spacing.
bool anyStack(const std::vector<glm::vec3>& position_m, const Neighbours& near) {
  std::vector<std::uint8_t> coinciding(position_m.size(), 0);
  parallelFor(position_m.size(), [&](std::size_t i) {
    for (const std::uint32_t j : near.of(i)) coinciding[i] += position_m[j] == position_m[i];
  });
  return std::any_of(coinciding.begin(), coinciding.end(),
                     [](std::uint8_t count) { return count >= kStacked; });
}

SurfelCloud estimate(PointCloud&& points, const EstimateSettings& settings, Stacks stacks);

/// Estimates surfels of a cloud in which many points coincide. One point of each stack is
/// estimated, then all points of the stack share its area.
SurfelCloud surfelsOfStacks(PointCloud&& points, const EstimateSettings& settings) {
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const glm::vec3 &p = points.position_m[a], &q = points.position_m[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  };
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), less);

  PointCloud single;
  std::vector<std::uint32_t> stack_of(points.size()), height;
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::uint32_t i = order[at];
    if (at == 0 || points.position_m[i] != points.position_m[order[at - 1]]) {
      single.position_m.push_back(points.position_m[i]);
      if (!points.normal.empty()) single.normal.push_back(points.normal[i]);
      if (!points.radius_m.empty()) single.radius_m.push_back(points.radius_m[i]);
      height.push_back(0);
    }
    stack_of[i] = static_cast<std::uint32_t>(height.size() - 1);
    ++height.back();
  }
  single.color.resize(single.size());
  const SurfelCloud shared = estimate(std::move(single), settings, Stacks::resolved);

  points.normal.resize(points.size(), glm::vec3(0.0f));
  std::vector<float> sigma(points.size()), weight(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t stack = stack_of[i];
    if (points.normal[i] == glm::vec3(0.0f)) {
      points.normal[i] = glm::normalize(glm::cross(glm::normalize(shared.axis_u_m[stack]),
                                                   glm::normalize(shared.axis_v_m[stack])));
    }
    const bool sized = !points.radius_m.empty() && points.radius_m[i] > 0.0f;
    sigma[i] = sized ? std::max(kSigmaPerRadius * points.radius_m[i], kMinSigma_m)
                     : glm::length(shared.axis_u_m[stack]);
    weight[i] = std::min(shared.area_m2[stack] / static_cast<float>(height[stack]),
                         glm::two_pi<float>() * sigma[i] * sigma[i]);
  }
  SurfelCloud cloud = assemble(std::move(points), sigma, std::move(weight));
  cloud.oriented = shared.oriented;
  return cloud;
}

SurfelCloud estimate(PointCloud&& points, const EstimateSettings& settings, Stacks stacks) {
  const std::vector<std::uint32_t> group = groupsOf(points);
  Neighbours near = findNeighbours(points.position_m, group, kNeighbours);
  if (stacks == Stacks::possible && anyStack(points.position_m, near)) {
    near = {};
    return surfelsOfStacks(std::move(points), settings);
  }

  const bool given_normals = !points.normal.empty();
  estimateNormals(points.position_m, near, settings.viewpoint_m, points.normal);
  std::vector<glm::vec3> along = directionsOf(points, near);
  std::vector<std::uint64_t> sheet = sameSheet(points, along, near);
  const bool oriented = given_normals && agree(points.normal, near, sheet);
  const bool areas_known = !points.area_m2.empty();
  std::vector<float> spacing = std::move(points.area_m2);
  if (areas_known) {
    for (float& each : spacing) each = std::sqrt(each);
  } else {
    spacing = spacings(near, sheet, settings.lone_spacing_m);
  }

  std::vector<float> sigma(points.size());
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    const bool sized = !points.radius_m.empty() && points.radius_m[i] > 0.0f;
    sigma[i] = std::max(
        sized ? kSigmaPerRadius * points.radius_m[i] : kSigmaPerSpacing * spacing[i], kMinSigma_m);
  }
  std::vector<float> weight;
  if (settings.solve == KernelSolve::thorough) {
    near = {};
    along = {};
    sheet = {};
    if (settings.unsolved) {
      std::vector<float> initial = solveKernels(
          {points.position_m, points.normal, points.normal, near, sheet, spacing}, {}, sigma);
      settings.unsolved(assemble(PointCloud(points), sigma, std::move(initial)));
    }
    weight = solveInParts(points, group, spacing, settings, sigma);
  } else {
    weight = solveKernels({points.position_m, points.normal, along.empty() ? points.normal : along,
                           near, sheet, spacing, areas_known},
                          effortOf(settings, areas_known), sigma);
  }
  near = {};
  SurfelCloud cloud = assemble(std::move(points), sigma, std::move(weight));
  cloud.oriented = oriented;
  return cloud;
}

}  // namespace

SurfelCloud surfelsFromPoints(PointCloud&& points, const EstimateSettings& settings) {
  if (points.size() == 0) return {};
  const std::vector<std::uint32_t> order = mortonOrder(points.position_m);
  points.forEachArray([&](auto& values) { reorder(values, order); });
  return estimate(std::move(points), settings, Stacks::possible);
}

}  // namespace foci
