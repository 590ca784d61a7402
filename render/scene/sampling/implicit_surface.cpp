#include "render/scene/sampling/implicit_surface.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "base/parallel.h"
#include "render/scene/sampling/poisson_disk.h"

namespace foci {
namespace {

constexpr float kDifference_m = 2e-4f;  // step of gradients, above the rounding of floats about 1 m
constexpr int kNewtonSteps = 4;
// Points asked of the Poisson disks over those wanted: darts leave gaps, where surfaces are near
// each other most. The last few, which only filled gaps, are not needed.
constexpr double kSpare = 1.12;
constexpr double kFiner = 0.99;

glm::vec3 gradientOf(const Solid& solid, const glm::vec3& p) {
  glm::vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    glm::vec3 step(0.0f);
    step[axis] = kDifference_m;
    gradient[axis] = (solid(p + step) - solid(p - step)) / (2.0f * kDifference_m);
  }
  return gradient;
}

struct Corner {
  glm::vec3 p;
  float value;
};

glm::vec3 crossing(const Corner& inside, const Corner& outside) {
  const float share = inside.value / (inside.value - outside.value);
  return glm::mix(inside.p, outside.p, share);
}

/// The triangles in which the surface crosses a tetrahedron, counter-clockwise from outside.
void addTriangles(const std::array<Corner, 4>& corners, std::vector<glm::vec3>& triangles) {
  std::array<Corner, 4> inside{}, outside{};
  std::size_t in = 0, out = 0;
  glm::vec3 inwards(0.0f);
  for (const Corner& corner : corners) {
    if (corner.value < 0.0f) {
      inside[in++] = corner;
    } else {
      outside[out++] = corner;
    }
  }
  if (in == 0 || out == 0) return;
  inwards = inside[0].p - outside[0].p;
  const auto add = [&](const glm::vec3& a, glm::vec3 b, glm::vec3 c) {
    if (glm::dot(glm::cross(b - a, c - a), inwards) > 0.0f) std::swap(b, c);
    triangles.insert(triangles.end(), {a, b, c});
  };
  if (in == 2) {
    const glm::vec3 a = crossing(inside[0], outside[0]), b = crossing(inside[0], outside[1]);
    const glm::vec3 c = crossing(inside[1], outside[1]), d = crossing(inside[1], outside[0]);
    add(a, b, c);
    add(a, c, d);
    return;
  }
  const bool one_inside = in == 1;
  std::array<glm::vec3, 3> at{};
  for (std::size_t i = 0; i < 3; ++i) {
    at[i] = one_inside ? crossing(inside[0], outside[i]) : crossing(inside[i], outside[0]);
  }
  add(at[0], at[1], at[2]);
}

/// Marching tetrahedra: six a cell, around its diagonal.
std::vector<glm::vec3> triangulate(const Solid& solid, const SolidBounds& bounds) {
  const glm::ivec3 cells(glm::ceil((bounds.high_m - bounds.low_m) / bounds.cell_m));
  const glm::ivec3 corners = cells + 1;
  const auto place = [&](int x, int y, int z) {
    return bounds.low_m + bounds.cell_m * glm::vec3(x, y, z);
  };
  const auto layer = static_cast<std::size_t>(corners.x) * static_cast<std::size_t>(corners.y);
  std::vector<float> values(layer * static_cast<std::size_t>(corners.z));
  const auto slot = [&](int x, int y, int z) {
    return static_cast<std::size_t>(z) * layer +
           static_cast<std::size_t>(y) * static_cast<std::size_t>(corners.x) +
           static_cast<std::size_t>(x);
  };
  parallelFor(static_cast<std::size_t>(corners.z), [&](std::size_t z) {
    for (int y = 0; y <= cells.y; ++y) {
      for (int x = 0; x <= cells.x; ++x) {
        values[slot(x, y, static_cast<int>(z))] = solid(place(x, y, static_cast<int>(z)));
      }
    }
  });
  // Corner k of a cell lies at the bits of k; the tetrahedra share the edge from 0 to 7.
  constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                     {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  std::vector<std::vector<glm::vec3>> slices(static_cast<std::size_t>(cells.z));
  parallelFor(slices.size(), [&](std::size_t slice) {
    const int z = static_cast<int>(slice);
    for (int y = 0; y < cells.y; ++y) {
      for (int x = 0; x < cells.x; ++x) {
        for (const auto& tetrahedron : kTetrahedra) {
          std::array<Corner, 4> at{};
          for (std::size_t i = 0; i < 4; ++i) {
            const int k = tetrahedron[i];
            const int cx = x + (k & 1), cy = y + (k >> 1 & 1), cz = z + (k >> 2);
            at[i] = {place(cx, cy, cz), values[slot(cx, cy, cz)]};
          }
          addTriangles(at, slices[slice]);
        }
      }
    }
  });
  std::vector<glm::vec3> triangles;
  for (const auto& slice : slices) triangles.insert(triangles.end(), slice.begin(), slice.end());
  return triangles;
}

}  // namespace

glm::vec3 normalOf(const Solid& solid, const glm::vec3& p) {
  return glm::normalize(gradientOf(solid, p));
}

SolidSamples sampleSolid(const Solid& solid, const SolidBounds& bounds, std::size_t count) {
  const std::vector<glm::vec3> triangles = triangulate(solid, bounds);
  const double area_m2 = areaOf_m2(triangles);
  if (!(area_m2 > 0.0)) throw std::invalid_argument("no surface within the bounds");
  double spacing_m = std::sqrt(area_m2 / (kSpare * static_cast<double>(count)));
  std::vector<MeshPoint> points = poissonDisk(triangles, spacing_m);
  while (points.size() < count) {
    spacing_m *= kFiner;
    points = poissonDisk(triangles, spacing_m);
  }
  points.resize(count);

  SolidSamples samples{std::vector<glm::vec3>(count), std::vector<glm::vec3>(count)};
  parallelFor(count, [&](std::size_t i) {
    const glm::vec3* corners = &triangles[3 * points[i].triangle];
    glm::vec3 p = corners[0] + points[i].weights.x * (corners[1] - corners[0]) +
                  points[i].weights.y * (corners[2] - corners[0]);
    for (int step = 0; step < kNewtonSteps; ++step) {
      const glm::vec3 gradient = gradientOf(solid, p);
      p -= solid(p) / glm::dot(gradient, gradient) * gradient;
    }
    samples.position_m[i] = p;
    samples.normal[i] = normalOf(solid, p);
  });
  return samples;
}

}  // namespace foci
