#include "render/scene/mesh/sample_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "base/input_error.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "render/scene/surfel_cloud.h"

namespace foci {
namespace {

/// Each connected part has a point a pixel where it fills so many rows of a screen.
constexpr double kPartRows = 200.0;

/// With its finer parts, a mesh has at most so many times the points that it has without.
constexpr double kMostForParts = 4.0;

struct TriangleSize {
  double area_m2, least_height_m;
};

TriangleSize sizeOf(const TriangleMesh& mesh, std::size_t triangle) {
  const glm::dvec3 a = mesh.corners_m[3 * triangle], b = mesh.corners_m[3 * triangle + 1],
                   c = mesh.corners_m[3 * triangle + 2];
  const double area_m2 = 0.5 * glm::length(glm::cross(b - a, c - a));
  const double longest_m =
      std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  return {area_m2, longest_m > 0.0 ? 2.0 * area_m2 / longest_m : 0.0};
}

/// Pixels of the texture in a triangle; 0 where it has no texture.
double texelsOf(const TriangleMesh& mesh, std::size_t triangle) {
  const std::uint32_t m = mesh.material[triangle];
  if (m >= mesh.materials.size() || !mesh.materials[m].texture) return 0.0;
  const glm::dvec2 size_px = mesh.materials[m].texture->size_px();
  const glm::dvec2 a = glm::dvec2(mesh.uv[3 * triangle + 1] - mesh.uv[3 * triangle]) * size_px,
                   b = glm::dvec2(mesh.uv[3 * triangle + 2] - mesh.uv[3 * triangle]) * size_px;
  return 0.5 * std::abs(a.x * b.y - a.y * b.x);
}

float largestCoordinate(const TriangleMesh& mesh) {
  float largest_m = 0.0f;
  for (const glm::vec3& corner : mesh.corners_m) {
    largest_m = std::max({largest_m, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  }
  return largest_m;
}

/// Triangles that are sampled at one spacing.
struct Level {
  double spacing_m = 0.0;
  std::vector<std::uint32_t> triangles;
};

/// A connected surface of the mesh.
struct Part {
  glm::vec3 low_m{std::numeric_limits<float>::infinity()},
      high_m{-std::numeric_limits<float>::infinity()};
  double area_m2 = 0.0;
};

/// None where they are unknown.
std::vector<Part> partsOf(const TriangleMesh& mesh) {
  std::vector<Part> parts;
  if (mesh.surface.empty()) return parts;
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    if (mesh.surface[t] >= parts.size()) parts.resize(mesh.surface[t] + 1);
    Part& part = parts[mesh.surface[t]];
    for (std::size_t k = 0; k < 3; ++k) {
      part.low_m = glm::min(part.low_m, mesh.corners_m[3 * t + k]);
      part.high_m = glm::max(part.high_m, mesh.corners_m[3 * t + k]);
    }
    part.area_m2 += sizeOf(mesh, t).area_m2;
  }
  return parts;
}

/// How often the mesh's spacing is halved for each part, so that the part has a point a pixel where
/// it fills so many rows of a screen.
std::vector<int> halvingsOf(const std::vector<Part>& parts, double spacing_m, double rows,
                            double least_m) {
  std::vector<int> halvings(parts.size());
  const int most = std::max(static_cast<int>(std::log2(spacing_m / least_m)), 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double extent_m = glm::length(glm::dvec3(parts[i].high_m) - glm::dvec3(parts[i].low_m));
    const double finer = std::ceil(std::log2(spacing_m * rows / std::max(extent_m, least_m)));
    halvings[i] = static_cast<int>(std::clamp(finer, 0.0, static_cast<double>(most)));
  }
  return halvings;
}

/// The spacing of a mesh, and how often it is halved for each part. None: one spacing for all.
struct Plan {
  double spacing_m = 0.0;
  std::vector<int> halvings;
};

double pointsOf(const Plan& plan, const std::vector<Part>& parts) {
  double points = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double even = parts[i].area_m2 / (plan.spacing_m * plan.spacing_m);
    points += std::ldexp(even, 2 * plan.halvings[i]);
  }
  return points;
}

/// @param wanted   points that are spread evenly, at most
/// @param fewest   the same, at least
/// @param most     points with those of finer parts
/// @param least_m  no spacing is smaller
Plan planOf(const std::vector<Part>& parts, double area_m2, double wanted, double fewest,
            double most, double least_m) {
  const auto planFor = [&](double even, double rows) {
    const double spacing_m = std::sqrt(area_m2 / even);
    return Plan{spacing_m, halvingsOf(parts, spacing_m, rows, least_m)};
  };
  for (double rows = kPartRows; parts.size() > 1 && rows >= 1.0; rows *= 0.5) {
    const auto fits = [&](double even) { return pointsOf(planFor(even, rows), parts) <= most; };
    if (!fits(fewest)) continue;
    if (fewest < wanted && fits(wanted)) return planFor(wanted, rows);
    // As many as fit, by bisection.
    double low = fewest, high = wanted;
    constexpr int kHalvings = 12;
    for (int i = 0; i < kHalvings && low < high; ++i) {
      const double even = 0.5 * (low + high);
      (fits(even) ? low : high) = even;
    }
    return planFor(low, rows);
  }
  return {std::sqrt(area_m2 / wanted), {}};
}

std::vector<Level> levelsOf(const TriangleMesh& mesh, const Plan& plan) {
  std::map<int, Level> levels;
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    const int halved = plan.halvings.empty() ? 0 : plan.halvings[mesh.surface[t]];
    Level& level = levels[halved];
    level.spacing_m = std::ldexp(plan.spacing_m, -halved);
    level.triangles.push_back(static_cast<std::uint32_t>(t));
  }
  std::vector<Level> all;
  all.reserve(levels.size());
  for (auto& [halved, level] : levels) all.push_back(std::move(level));
  return all;
}

/// Points of a mesh, with the spacing and the mean share of the area of each.
struct Samples {
  std::vector<MeshPoint> points;
  std::vector<float> spacing_m, area_m2;
};

/// The corners of some triangles.
std::vector<glm::vec3> cornersOf(const TriangleMesh& mesh,
                                 const std::vector<std::uint32_t>& triangles) {
  std::vector<glm::vec3> corners_m;
  corners_m.reserve(3 * triangles.size());
  for (const std::uint32_t t : triangles) {
    const auto first = mesh.corners_m.begin() + 3 * static_cast<std::ptrdiff_t>(t);
    corners_m.insert(corners_m.end(), first, first + 3);
  }
  return corners_m;
}

void sampleLevel(const TriangleMesh& mesh, const Level& level, Samples& samples) {
  const bool all = level.triangles.size() == mesh.size();  // a large scan is not copied
  const std::vector<glm::vec3> some_m =
      all ? std::vector<glm::vec3>() : cornersOf(mesh, level.triangles);
  const std::vector<glm::vec3>& corners_m = all ? mesh.corners_m : some_m;
  const std::vector<MeshPoint> points = poissonDisk(corners_m, level.spacing_m);
  // Triangles narrower than the spacing hold more points, which must not take area from the others.
  const double share_m2 = areaOf_m2(corners_m) / static_cast<double>(points.size());
  const double area_m2 = std::max(share_m2, kPoissonArea * level.spacing_m * level.spacing_m);
  for (MeshPoint point : points) {
    point.triangle = level.triangles[point.triangle];
    samples.points.push_back(point);
  }
  samples.spacing_m.resize(samples.points.size(), static_cast<float>(level.spacing_m));
  samples.area_m2.resize(samples.points.size(), static_cast<float>(area_m2));
}

/// Bodies that a texture cuts a hole in are open.
void openCutBodies(PointCloud& cloud, const std::vector<std::uint8_t>& keep) {
  if (cloud.body.empty()) return;
  std::vector<std::uint8_t> cut(std::size_t{kMaxBodies} + 1, 0);
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] == 0) cut[cloud.body[i]] = 1;
  }
  for (std::uint16_t& body : cloud.body) {
    if (cut[body] != 0) body = 0;
  }
}

}  // namespace

std::size_t defaultPoints(const TriangleMesh& mesh) {
  double area_m2 = 0.0, texels = 0.0;
  std::vector<double> heights_m(mesh.size());
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const TriangleSize size = sizeOf(mesh, i);
    area_m2 += size.area_m2;
    heights_m[i] = size.least_height_m;
    texels += texelsOf(mesh, i);
  }
  const double height_m = quantile(heights_m, 0.5);
  // Equilateral triangles of this height, two for each vertex: their edges are as far apart as the
  // vertices.
  const double vertex_m2 = 2.0 / std::sqrt(3.0) * height_m * height_m;
  const double detail = std::max(area_m2 / std::max(vertex_m2, 1e-300), texels);
  const auto [low, high] = boxOf(mesh.corners_m);
  const double pixel_m = glm::length(glm::dvec3(high) - glm::dvec3(low)) / kScreenRows;
  const double on_screen = std::min(detail, area_m2 / (pixel_m * pixel_m));
  const double needed = std::max(on_screen, 0.5 * static_cast<double>(mesh.size()));
  return static_cast<std::size_t>(
      std::clamp(needed, static_cast<double>(kMinPoints), static_cast<double>(kMaxPoints)));
}

PointCloud sampleMesh(const TriangleMesh& mesh, const std::filesystem::path& name,
                      const MeshSampling& sampling) {
  const std::size_t wanted = sampling.points.value_or(defaultPoints(mesh));
  const double mesh_m2 = areaOf_m2(mesh.corners_m);
  const double spacing_m = std::sqrt(mesh_m2 / static_cast<double>(wanted));
  const double least_m =
      double{largestCoordinate(mesh)} * double{std::numeric_limits<float>::epsilon()};
  if (spacing_m < least_m) {
    throw InputError(
        name.string(), "is so far from the origin, or has so little area for its extent, that ",
        wanted, " points would fall on each other: move it to the origin, e.g. with CloudCompare");
  }
  // A wanted number counts finer parts.
  const auto even = static_cast<double>(wanted);
  const double fewest = sampling.points ? even / kMostForParts : even;
  const double most =
      sampling.points ? even : std::min(kMostForParts * even, static_cast<double>(kMaxPoints));
  const Plan plan = planOf(partsOf(mesh), mesh_m2, even, fewest, most, std::max(least_m, 1e-30));
  Samples samples;
  for (const Level& level : levelsOf(mesh, plan)) sampleLevel(mesh, level, samples);
  const std::vector<MeshPoint>& points = samples.points;

  PointCloud cloud;
  cloud.area_m2 = std::move(samples.area_m2);
  cloud.remarks = mesh.remarks;
  cloud.position_m.resize(points.size());
  cloud.normal.resize(points.size());
  cloud.color.resize(points.size());
  cloud.opacity.resize(points.size());
  cloud.body.resize(mesh.body.empty() ? 0 : points.size());
  cloud.surface.resize(mesh.surface.empty() ? 0 : points.size());
  cloud.objects.of.resize(mesh.objects.empty() ? 0 : points.size());
  cloud.objects.names = mesh.objects.names;
  std::vector<std::uint8_t> keep(points.size());
  parallelFor(points.size(), [&](std::size_t i) {
    const MeshPoint& point = points[i];
    const glm::dvec3 a = mesh.corners_m[3 * std::size_t{point.triangle}];
    const glm::dvec3 ab = glm::dvec3(mesh.corners_m[3 * std::size_t{point.triangle} + 1]) - a;
    const glm::dvec3 ac = glm::dvec3(mesh.corners_m[3 * std::size_t{point.triangle} + 2]) - a;
    cloud.position_m[i] =
        glm::vec3(a + double{point.weights.x} * ab + double{point.weights.y} * ac);
    cloud.normal[i] = glm::vec3(glm::normalize(glm::cross(ab, ac)));
    const MeshColor color = colorAt(mesh, point, samples.spacing_m[i]);
    cloud.color[i] = color.color;
    cloud.opacity[i] = color.opacity;
    keep[i] = color.opacity > 0.0f;
    if (!mesh.body.empty()) cloud.body[i] = mesh.body[point.triangle];
    if (!mesh.surface.empty()) cloud.surface[i] = mesh.surface[point.triangle];
    if (!mesh.objects.empty()) cloud.objects.of[i] = mesh.objects.of[point.triangle];
  });
  openCutBodies(cloud, keep);
  cloud.forEachArray([&](auto& values) { keepMarked(values, keep); });
  if (cloud.size() == 0) throw InputError(name.string(), "has no surface that is not cut out");
  return cloud;
}

}  // namespace foci
