#include "render/scene/sampling/sample_surface.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace foci {
namespace {

constexpr float kDifference = 1e-3f;  // of the unit square, for derivatives
constexpr int kDensitySteps = 96;     // at which a row's density is looked at
constexpr int kDensityRows = 24;
constexpr float kMaxForeshortening = 8;  // a surfel's axes stay within about this ratio
constexpr float kCoarser = 4.0f;         // where the eye does not look
constexpr int kTextureSamples = 2;       // a side of a surfel's cell

struct Tangents {
  glm::vec3 u, v;
};

Tangents tangentsAt(const ParametricSurface& surface, glm::vec2 uv) {
  const glm::vec2 low = glm::max(uv - kDifference, 0.0f), high = glm::min(uv + kDifference, 1.0f);
  return {(surface.at({high.x, uv.y}) - surface.at({low.x, uv.y})) / (high.x - low.x),
          (surface.at({uv.x, high.y}) - surface.at({uv.x, low.y})) / (high.y - low.y)};
}

glm::vec3 normalOf(const Tangents& t) {
  const glm::vec3 n = glm::cross(t.u, t.v);
  const float length = glm::length(n);
  return length > 1e-12f ? n / length : glm::vec3(0.0f, 1.0f, 0.0f);
}

/// The step from row to row that, as the eye sees it, goes straight across the row: rows may slide
/// along themselves, since each of them is even.
glm::vec3 acrossRow(const Tangents& t, const glm::vec3& p, const glm::vec3& eye_m) {
  const glm::vec3 sight = glm::normalize(p - eye_m);
  const glm::vec3 u_seen = t.u - glm::dot(t.u, sight) * sight;
  const float least = glm::dot(t.u, t.u) / (kMaxForeshortening * kMaxForeshortening);
  const float length2 = std::max(glm::dot(u_seen, u_seen), least);
  return length2 > 0.0f ? t.v - glm::dot(u_seen, t.v) / length2 * t.u : t.v;
}

/// Samples a unit of the parameter along `axis`.
float density(const glm::vec3& axis, const glm::vec3& normal, const glm::vec3& p, bool two_sided,
              const SampledFor& audience) {
  const glm::vec3 to_point = p - audience.eye_m;
  const float distance_m = std::max(glm::length(to_point), 0.05f);
  const glm::vec3 sight = to_point / distance_m;
  const float length = glm::length(axis);
  const float across = glm::length(axis - glm::dot(axis, sight) * sight);
  const float seen = std::max(across, length / kMaxForeshortening) / distance_m;
  const float depth = std::max(glm::dot(sight, audience.forward), 1e-3f);
  const glm::vec2 place =
      glm::abs(glm::vec2(glm::dot(sight, audience.right), glm::dot(sight, audience.up))) / depth /
      audience.half_view;
  const float beside = glm::smoothstep(1.05f, 1.25f, std::max(place.x, place.y));
  const float behind = two_sided ? 0.0f : glm::smoothstep(0.3f, 0.5f, glm::dot(normal, sight));
  return seen / audience.step_rad / glm::mix(1.0f, kCoarser, std::max(beside, behind));
}

/// Cuts the unit interval in steps that hold the same number of samples of a density.
std::vector<float> equalSteps(const std::vector<float>& densities) {
  std::vector<float> sums(densities.size() + 1, 0.0f);
  const auto cells = static_cast<float>(densities.size());
  for (std::size_t i = 0; i < densities.size(); ++i) sums[i + 1] = sums[i] + densities[i] / cells;
  const int count = std::max(1, static_cast<int>(std::ceil(sums.back())));
  std::vector<float> cuts(static_cast<std::size_t>(count) + 1, 0.0f);
  std::size_t cell = 0;
  for (int k = 1; k <= count; ++k) {
    const float wanted = sums.back() * static_cast<float>(k) / static_cast<float>(count);
    while (cell + 1 < densities.size() && sums[cell + 1] < wanted) ++cell;
    const float span = std::max(sums[cell + 1] - sums[cell], 1e-12f);
    cuts[static_cast<std::size_t>(k)] =
        std::min((static_cast<float>(cell) + (wanted - sums[cell]) / span) / cells, 1.0f);
  }
  cuts.back() = 1.0f;
  return cuts;
}

/// One surfel for the cell [low, high] of the unit square.
void appendCell(SurfelCloud& cloud, const ParametricSurface& surface, const glm::vec3& eye_m,
                glm::vec2 low, glm::vec2 high) {
  const glm::vec2 uv = 0.5f * (low + high), size = high - low;
  const Tangents t = tangentsAt(surface, uv);
  const SurfacePoint middle{uv, surface.at(uv), normalOf(t)};
  if (surface.keep && !surface.keep(middle)) return;

  glm::vec3 color(0.0f);
  for (int i = 0; i < kTextureSamples * kTextureSamples; ++i) {
    const glm::vec2 part((static_cast<float>(i % kTextureSamples) + 0.5f) / kTextureSamples,
                         (static_cast<float>(i / kTextureSamples) + 0.5f) / kTextureSamples);
    const glm::vec2 sample = low + part * size;
    color += surface.paint({sample, surface.at(sample), middle.normal});
  }
  color /= static_cast<float>(kTextureSamples * kTextureSamples);
  if (surface.light) color = surface.light(middle, color);

  // Principal axes of the cell's two edges a, b: rotate them until they are perpendicular.
  const glm::vec3 a = t.u * size.x, b = acrossRow(t, middle.p_world, eye_m) * size.y;
  // In double: std::atan2 of floats differs between versions of the C library.
  const auto angle = static_cast<float>(
      0.5 * std::atan2(2.0 * double{glm::dot(a, b)}, double{glm::dot(a, a) - glm::dot(b, b)}));
  const glm::vec3 major = std::cos(angle) * a + std::sin(angle) * b;
  const glm::vec3 minor = std::cos(angle) * b - std::sin(angle) * a;
  const float area_m2 = glm::length(glm::cross(a, b));
  if (!(area_m2 > 1e-14f)) return;
  cloud.position_m.push_back(middle.p_world);
  cloud.axis_u_m.push_back(kSigmaPerSpacing * major);
  cloud.axis_v_m.push_back(kSigmaPerSpacing * minor);
  cloud.color.push_back(color);
  cloud.area_m2.push_back(area_m2);
  cloud.opacity.push_back(surface.opacity);
}

}  // namespace

void appendSurface(SurfelCloud& cloud, const ParametricSurface& surface,
                   const SampledFor& audience) {
  const auto densityAlong = [&](glm::vec2 uv, bool rows) {
    const Tangents t = tangentsAt(surface, uv);
    const glm::vec3 p = surface.at(uv);
    return density(rows ? acrossRow(t, p, audience.eye_m) : t.u, normalOf(t), p, surface.two_sided,
                   audience);
  };
  std::vector<float> row_density(kDensitySteps, 0.0f);
  for (int i = 0; i < kDensitySteps; ++i) {
    const float v = (static_cast<float>(i) + 0.5f) / kDensitySteps;
    float& most = row_density[static_cast<std::size_t>(i)];
    for (int j = 0; j < kDensityRows; ++j) {
      const float u = (static_cast<float>(j) + 0.5f) / kDensityRows;
      most = std::max(most, densityAlong({u, v}, true));
    }
  }
  const std::vector<float> rows = equalSteps(row_density);

  std::vector<SurfelCloud> parts(rows.size() - 1);
  parallelFor(parts.size(), [&](std::size_t row) {
    const float v = 0.5f * (rows[row] + rows[row + 1]);
    std::vector<float> densities(kDensitySteps);
    for (int i = 0; i < kDensitySteps; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / kDensitySteps;
      densities[static_cast<std::size_t>(i)] = densityAlong({u, v}, false);
    }
    const std::vector<float> cuts = equalSteps(densities);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      appendCell(parts[row], surface, audience.eye_m, {cuts[i], rows[row]},
                 {cuts[i + 1], rows[row + 1]});
    }
  });
  for (const SurfelCloud& part : parts) {
    cloud.position_m.append(part.position_m);
    cloud.axis_u_m.append(part.axis_u_m);
    cloud.axis_v_m.append(part.axis_v_m);
    cloud.color.append(part.color);
    cloud.area_m2.append(part.area_m2);
    cloud.opacity.append(part.opacity);
  }
}

}  // namespace foci
