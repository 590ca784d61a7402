#include "render/scene/kernel_sums.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "app/base/parallel.h"
#include "render/scene/neighbours.h"

namespace foci {
namespace {

constexpr float kReach = 4.0f;              // standard deviations of a prefiltered kernel
constexpr std::size_t kMostSurfels = 2048;  // within reach
constexpr float kSameSheetCosine = 0.5f;    // of normals, signs apart
constexpr float kSameSheetOffPlane = 3.0f;  // standard deviations of the surfel beside
constexpr float kSmoothReach = 3.0f;        // standard deviations: where smoothness is asked for
constexpr float kSmoothCosine = 0.9f;
constexpr float kSmoothOffPlane = 0.5f;  // standard deviations
constexpr float kBorderOffset = 0.25f;   // of the smooth reach; a half-disc's centroid lies at 0.42

float sigmaOf(const SurfelCloud& cloud, std::size_t i) {
  return std::sqrt(glm::length(cloud.axis_u_m[i]) * glm::length(cloud.axis_v_m[i]));
}

glm::vec3 normalOf(const SurfelCloud& cloud, std::size_t i) {
  return glm::normalize(
      glm::cross(glm::normalize(cloud.axis_u_m[i]), glm::normalize(cloud.axis_v_m[i])));
}

struct Probe {
  std::uint32_t beside;
  glm::vec3 p_world;
};

/// At equal steps of the area summed up over the surfels, each up to half a spacing beside one.
std::vector<Probe> spread(const SurfelCloud& cloud, std::size_t count) {
  double area = 0.0;
  for (const float area_m2 : cloud.area_m2) area += area_m2;
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f - 0.5f; };
  std::vector<Probe> probes;
  double sum = 0.0;
  for (std::size_t i = 0; i < cloud.size() && probes.size() < count; ++i) {
    sum += cloud.area_m2[i];
    while (probes.size() < count &&
           sum * static_cast<double>(count) > area * (static_cast<double>(probes.size()) + 0.5)) {
      const float side = std::sqrt(cloud.area_m2[i]);
      probes.push_back(
          {static_cast<std::uint32_t>(i),
           cloud.position_m[i] + side * (uniform() * glm::normalize(cloud.axis_u_m[i]) +
                                         uniform() * glm::normalize(cloud.axis_v_m[i]))});
    }
  }
  return probes;
}

}  // namespace

std::vector<KernelSum> kernelSums(const SurfelCloud& cloud, std::size_t probes,
                                  float pixel_spacings) {
  const std::vector<Probe> at = spread(cloud, probes);
  std::vector<glm::vec3> centers_m;
  std::vector<float> radius_m;
  const float widened = std::hypot(1.0f, pixel_spacings / kSigmaPerSpacing);
  for (const Probe& probe : at) {
    centers_m.push_back(probe.p_world);
    radius_m.push_back(kReach * widened * sigmaOf(cloud, probe.beside));
  }
  const auto around = findWithin(cloud.position_m, centers_m, radius_m, kMostSurfels);

  std::vector<KernelSum> sums(at.size(), {0.0f, false});
  parallelFor(at.size(), [&](std::size_t k) {
    const glm::vec3 normal = normalOf(cloud, at[k].beside);
    const float sigma = sigmaOf(cloud, at[k].beside);
    std::vector<std::uint32_t> sheet;
    double area = 0.0;
    bool smooth = true;
    glm::vec3 centroid(0.0f);
    float close = 0.0f;
    for (const std::uint32_t j : around[k]) {
      const glm::vec3 d = cloud.position_m[j] - at[k].p_world;
      const float off_plane = std::abs(glm::dot(d, normal));
      const float cosine = std::abs(glm::dot(normalOf(cloud, j), normal));
      if (glm::dot(d, d) < kSmoothReach * kSmoothReach * sigma * sigma) {
        smooth = smooth && cosine >= kSmoothCosine && off_plane <= kSmoothOffPlane * sigma;
        centroid += d;
        ++close;
      }
      if (cosine < kSameSheetCosine || off_plane > kSameSheetOffPlane * sigma) continue;
      sheet.push_back(j);
      area += cloud.area_m2[j];
    }
    if (sheet.empty() || around[k].size() >= kMostSurfels) {
      sums[k].sum = -1.0f;
      return;
    }
    const auto spacing = static_cast<float>(std::sqrt(area / static_cast<double>(sheet.size())));
    const float prefilter = pixel_spacings * pixel_spacings * spacing * spacing;
    float sum = 0.0f;
    for (const std::uint32_t j : sheet) {
      const glm::vec3 d = cloud.position_m[j] - at[k].p_world;
      const float u2 = glm::dot(cloud.axis_u_m[j], cloud.axis_u_m[j]);
      const float v2 = glm::dot(cloud.axis_v_m[j], cloud.axis_v_m[j]);
      const float u = glm::dot(d, cloud.axis_u_m[j]), v = glm::dot(d, cloud.axis_v_m[j]);
      const float q = u * u / u2 / (u2 + prefilter) + v * v / v2 / (v2 + prefilter);
      sum +=
          cloud.area_m2[j] / std::sqrt((u2 + prefilter) * (v2 + prefilter)) * std::exp(-0.5f * q);
    }
    const bool border = glm::length(centroid) > kBorderOffset * close * kSmoothReach * sigma;
    sums[k] = {sum / glm::two_pi<float>(), smooth && !border};
  });
  std::erase_if(sums, [](const KernelSum& sum) { return sum.sum < 0.0f; });
  return sums;
}

double shareWithin(const std::vector<KernelSum>& sums, float tolerance, bool smooth_only) {
  std::size_t all = 0, within = 0;
  for (const KernelSum& sum : sums) {
    if (smooth_only && !sum.smooth) continue;
    ++all;
    within += std::abs(sum.sum - 1.0f) <= tolerance;
  }
  return all == 0 ? 1.0 : static_cast<double>(within) / static_cast<double>(all);
}

}  // namespace foci
