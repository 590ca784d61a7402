#include "render/normalisation/kernel_sums.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "base/parallel.h"
#include "render/kernel/kernel.h"
#include "render/optics/defocus.h"
#include "render/scene/neighbours.h"

namespace foci {
namespace {

// Chosen by hand; `KernelSums` tests bound them. "Rendered" lengths are standard deviations of a
// kernel on the image, with prefilter and blur.
constexpr float kReach = 4.0f;              // radius in which surfels are summed, rendered
constexpr std::size_t kMaxSurfels = 2048;   // within reach
constexpr float kSameSheetCosine = 0.5f;    // of normals; signs apart but for closed bodies
constexpr float kSameSheetOffPlane = 3.0f;  // widths of the surfel at the probe
constexpr float kSmoothReach = 3.0f;        // rendered: a whole kernel
constexpr float kSmoothCosine = 0.9f;
constexpr float kSmoothOffPlane = 0.4f;  // rendered
constexpr float kBorderReach = 2.4f;     // rendered: only a gap that begins here makes a border
constexpr float kBorderGap = 1.6f;       // rad, without a surfel from there to kReach

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

/// The widest gap between consecutive angles, rad.
float largestGap(std::vector<float>& angles) {
  if (angles.empty()) return glm::two_pi<float>();
  std::sort(angles.begin(), angles.end());
  float gap = glm::two_pi<float>() - (angles.back() - angles.front());
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap;
}

/// Probes at equal steps of the accumulated area, each up to half a spacing beside a surfel.
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

/// The kernels as they are rendered, for surfels of a given squared spacing.
class RenderedKernel {
 public:
  RenderedKernel(const SeenAs& seen, float spacing2)
      : prefilter_(seen.pixel_spacings * seen.pixel_spacings * spacing2),
        radius2_(seen.blur_spacings * seen.blur_spacings * spacing2),
        min_radius2_(1e-12f * spacing2) {}

  /// The kernel of surfel `j` at a place of the surface, as the eye sees it along the normal there:
  /// foreshortened.
  /// @param right, up  unit vectors that span the tangent plane at `p_world`
  float at(const SurfelCloud& cloud, std::span<const float> added_m2, std::size_t j,
           const glm::vec3& p_world, const glm::vec3& right, const glm::vec3& up) const {
    const glm::vec3 d = p_world - cloud.position_m[j];
    const glm::vec3 &u = cloud.axis_u_m[j], &v = cloud.axis_v_m[j];
    const glm::vec2 seen_u(glm::dot(u, right), glm::dot(u, up));
    const glm::vec2 seen_v(glm::dot(v, right), glm::dot(v, up));
    const float parallelogram = std::abs(seen_u.x * seen_v.y - seen_u.y * seen_v.x);
    const float cosine = parallelogram / (glm::length(u) * glm::length(v));
    const float xx = seen_u.x * seen_u.x + seen_v.x * seen_v.x;
    const float yy = seen_u.y * seen_u.y + seen_v.y * seen_v.y;
    const float xy = seen_u.x * seen_u.y + seen_v.x * seen_v.y;
    const auto detWith = [&](float wide) { return (xx + wide) * (yy + wide) - xy * xy; };
    const float soft = prefilter_ + (added_m2.empty() ? 0.0f : kOverlap * added_m2[j]);
    const float unblurred = std::sqrt(std::max(detWith(soft), 0.0f));
    const KernelShape& shape =
        kernelShape(kernelExponent(unblurred / std::max(radius2_, min_radius2_)));
    const float widening = prefilter_ + kDiscVariancePerRadius2 * radius2_;
    const float det = detWith(widening);
    if (!(det > 0.0f)) return 0.0f;
    const float x = glm::dot(d, right), y = glm::dot(d, up);
    const float q = ((yy + widening) * x * x - 2.0f * xy * x * y + (xx + widening) * y * y) /
                    (det * shape.support2);
    if (q >= 1.0f) return 0.0f;
    return cosine * cloud.area_m2[j] / (shape.support2 * std::sqrt(det)) * shape.at(1.0f - q);
  }

 private:
  float prefilter_, radius2_, min_radius2_;
};

}  // namespace

std::vector<std::vector<KernelSum>> kernelSums(const SurfelCloud& cloud, std::size_t probes,
                                               std::span<const SeenAs> seen,
                                               std::span<const float> added_m2) {
  const std::vector<Probe> at = spread(cloud, probes);
  // The surfel's width, and the standard deviation of its rendered kernel.
  const auto widthOf = [&](std::size_t i) {
    return std::max(sigmaOf(cloud, i), kSigmaPerSpacing * std::sqrt(cloud.area_m2[i]));
  };
  const auto renderedOf = [&](std::size_t i, const SeenAs& as) {
    const float width = widthOf(i);
    const float widening2 = as.pixel_spacings * as.pixel_spacings +
                            kDiscVariancePerRadius2 * as.blur_spacings * as.blur_spacings;
    return std::sqrt(width * width + widening2 * cloud.area_m2[i]);
  };
  std::vector<glm::vec3> centers_m;
  std::vector<float> radius_m;
  for (const Probe& probe : at) {
    float widest_m = 0.0f;
    for (const SeenAs& as : seen) widest_m = std::max(widest_m, renderedOf(probe.beside, as));
    centers_m.push_back(probe.p_world);
    radius_m.push_back(kReach * widest_m);
  }
  const auto around = findWithin(cloud.position_m, centers_m, radius_m, kMaxSurfels);

  const auto onBody = [&](std::size_t i) {
    return !cloud.bodies.of_surfel.empty() && cloud.bodies.of_surfel[i] != 0;
  };
  std::vector<std::vector<KernelSum>> sums(seen.size());
  for (auto& each : sums) each.assign(at.size(), {-1.0f, false});
  parallelFor(at.size(), [&](std::size_t k) {
    if (around[k].size() >= kMaxSurfels) return;
    const std::size_t beside = at[k].beside;
    const glm::vec3 normal = normalOf(cloud, beside);
    const glm::vec3 along_u = glm::normalize(cloud.axis_u_m[beside]);
    const glm::vec3 along_v = glm::normalize(cloud.axis_v_m[beside]);
    const float width = widthOf(beside);
    struct Near {
      std::uint32_t surfel;
      float distance2, off_plane, cosine;
    };
    std::vector<Near> all;
    all.reserve(around[k].size());
    for (const std::uint32_t j : around[k]) {
      const glm::vec3 d = cloud.position_m[j] - at[k].p_world;
      const float cosine = glm::dot(normalOf(cloud, j), normal);
      all.push_back({j, glm::dot(d, d), std::abs(glm::dot(d, normal)),
                     onBody(beside) && onBody(j) ? cosine : std::abs(cosine)});
    }
    std::vector<std::uint32_t> sheet;
    std::vector<float> angles;
    for (std::size_t s = 0; s < seen.size(); ++s) {
      const float rendered = renderedOf(beside, seen[s]);
      const auto isWithin = [&](const Near& near, float reach) {
        return near.distance2 < reach * reach * rendered * rendered;
      };
      sheet.clear();
      double area = 0.0;
      bool smooth = true;
      for (const Near& near : all) {
        if (isWithin(near, kSmoothReach)) {
          smooth = smooth && near.cosine >= kSmoothCosine &&
                   near.off_plane <= kSmoothOffPlane * rendered;
        }
        if (near.cosine < kSameSheetCosine || near.off_plane > kSameSheetOffPlane * width ||
            !isWithin(near, kReach)) {
          continue;
        }
        sheet.push_back(near.surfel);
        area += cloud.area_m2[near.surfel];
      }
      if (sheet.empty()) continue;
      const RenderedKernel kernel(seen[s],
                                  static_cast<float>(area / static_cast<double>(sheet.size())));
      float sum = 0.0f;
      for (const std::uint32_t j : sheet)
        sum += kernel.at(cloud, added_m2, j, at[k].p_world, along_u, along_v);
      angles.clear();
      for (const Near& near : all) {
        if (!smooth || isWithin(near, kBorderReach) || !isWithin(near, kReach)) continue;
        const glm::vec3 d = cloud.position_m[near.surfel] - at[k].p_world;
        angles.push_back(static_cast<float>(
            std::atan2(double{glm::dot(d, along_v)}, double{glm::dot(d, along_u)})));
      }
      sums[s][k] = {sum, smooth && largestGap(angles) < kBorderGap};
    }
  });
  for (auto& each : sums) {
    std::erase_if(each, [](const KernelSum& sum) { return sum.sum < 0.0f; });
  }
  return sums;
}

float kernelSumAt(const SurfelCloud& cloud, const glm::vec3& p_world, float spacing_m,
                  const SeenAs& seen, std::span<const float> added_m2) {
  const RenderedKernel rendered_kernel(seen, spacing_m * spacing_m);
  float sum = 0.0f;
  for (std::size_t j = 0; j < cloud.size(); ++j)
    sum += rendered_kernel.at(cloud, added_m2, j, p_world, glm::normalize(cloud.axis_u_m[j]),
                              glm::normalize(cloud.axis_v_m[j]));
  return sum;
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
