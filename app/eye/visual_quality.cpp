#include "app/eye/visual_quality.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "render/optics/wavefront.h"

namespace foci {

Pupil typicalPupil(double pupil_m) {
  Pupil pupil{.diameter_m = pupil_m};
  pupil.wavefront = withoutRefraction(rescaled(typicalWavefront(), pupil_m));
  return pupil;
}

ThroughFocus throughFocus(const Pupil& pupil, double reach_D, double step_D) {
  ThroughFocus through;
  const int steps = static_cast<int>(std::ceil(reach_D / step_D));
  through.defocus_D.reserve(2 * static_cast<std::size_t>(steps) + 1);
  for (int i = -steps; i <= steps; ++i) through.defocus_D.push_back(i * step_D);
  through.contrast.resize(through.defocus_D.size());
  parallelFor(through.defocus_D.size(), [&](std::size_t i) {
    const std::array at{kFocus_cycles_per_deg};
    through.contrast[i] = whiteMtf({.pupil = pupil, .defocus_D = through.defocus_D[i]}, at).front();
  });
  return through;
}

double focusReach_D(double pupil_m) { return std::clamp(5e-3 / pupil_m, 0.6, 5.0); }

DepthOfFocus depthOfFocus(const ThroughFocus& through) {
  bool complete = true;
  const std::vector<double>& contrast = through.contrast;
  const auto best = static_cast<std::size_t>(std::max_element(contrast.begin(), contrast.end()) -
                                             contrast.begin());
  const double limit = kInFocusShare * contrast[best];
  // Linear between the two steps that the limit lies between.
  const auto edge = [&](int direction) {
    auto i = static_cast<std::ptrdiff_t>(best);
    const auto last = static_cast<std::ptrdiff_t>(contrast.size()) - 1;
    while (i != (direction < 0 ? 0 : last)) {
      const auto here = static_cast<std::size_t>(i);
      const auto next = static_cast<std::size_t>(i + direction);
      if (contrast[next] < limit) {
        const double t = (contrast[here] - limit) / (contrast[here] - contrast[next]);
        return through.defocus_D[here] + t * (through.defocus_D[next] - through.defocus_D[here]);
      }
      i += direction;
    }
    complete = false;
    return through.defocus_D[static_cast<std::size_t>(i)];
  };
  DepthOfFocus depth{
      .best_D = through.defocus_D[best], .nearest_D = edge(-1), .farthest_D = edge(1)};
  depth.complete = complete;
  return depth;
}

double GratingAcuity::logMAR() const { return std::log10(30.0 / cycles_per_deg); }

GratingAcuity acuityOf(const EyeOptics& eye) {
  constexpr int kMost_cycles_per_deg = 160;
  std::vector<double> u;
  u.reserve(kMost_cycles_per_deg + 1);
  for (int i = 0; i <= kMost_cycles_per_deg; ++i) u.push_back(i);
  const std::vector<double> contrast = whiteMtf(eye, u);  // 1 at 0 cycles
  std::size_t i = 0;
  while (i + 1 < u.size() && contrast[i + 1] >= 0.05) ++i;
  if (i + 1 == u.size()) return {.cycles_per_deg = u.back()};
  const double t = (contrast[i] - 0.05) / (contrast[i] - contrast[i + 1]);
  return {.cycles_per_deg = u[i] + std::clamp(t, 0.0, 1.0)};
}

double refractedContrast(double pupil_m, double cycles_per_deg) {
  struct Error {
    glm::dvec3 power_D;
    double weight;
  };
  std::vector<Error> errors;
  const double sphere_D = std::sqrt(3.0) * kRefractionLeft_D;
  const double cylinder_D = std::sqrt(2.0) * kCylinderLeft_D;
  for (const auto& [m, weight] : {std::pair{-1.0, 1.0 / 6.0}, {0.0, 2.0 / 3.0}, {1.0, 1.0 / 6.0}}) {
    for (const glm::dvec2 j : {glm::dvec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      errors.push_back({glm::dvec3(m * sphere_D, cylinder_D * j), 0.25 * weight});
    }
  }
  std::vector<double> contrast(errors.size());
  parallelFor(errors.size(), [&](std::size_t i) {
    Pupil pupil = typicalPupil(pupil_m);
    pupil.wavefront = withPower(pupil.wavefront, errors[i].power_D);
    const std::array at{cycles_per_deg};
    contrast[i] = errors[i].weight * whiteMtf({.pupil = pupil}, at).front();
  });
  return std::accumulate(contrast.begin(), contrast.end(), 0.0);
}

double meanMtf(double pupil_mm, double cycles_per_deg) {
  assert(pupil_mm >= 2.0 && pupil_mm <= 6.0);
  const double u1 = 21.95 - 5.512 * pupil_mm + 0.3922 * pupil_mm * pupil_mm;
  const double ratio = cycles_per_deg / u1;
  return std::pow(1.0 + ratio * ratio, -0.62) *
         std::sqrt(diffractionMtf(pupil_mm / 1000.0, 555e-9, cycles_per_deg));
}

}  // namespace foci
