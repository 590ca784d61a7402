#include "render/optics/colours.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace foci {
namespace {

constexpr double kFirst_nm = 380.0, kStep_nm = 10.0;
constexpr std::array kEfficiency{0.00004, 0.00012, 0.0004,  0.0012,  0.0040,   0.0116,   0.023,
                                 0.038,   0.060,   0.09098, 0.13902, 0.20802,  0.323,    0.503,
                                 0.710,   0.862,   0.954,   0.99495, 0.995,    0.952,    0.870,
                                 0.757,   0.631,   0.503,   0.381,   0.265,    0.175,    0.107,
                                 0.061,   0.032,   0.017,   0.00821, 0.004102, 0.002091, 0.001047};

/// Power of the primaries at a wavelength, linear between samples.
glm::dvec3 powerAt(const std::vector<SpectrumSample>& spectra, double nm) {
  const auto above = std::ranges::lower_bound(spectra, nm, {}, &SpectrumSample::wavelength_nm);
  if (above == spectra.end() || (above == spectra.begin() && above->wavelength_nm > nm)) {
    return glm::dvec3(0.0);
  }
  if (above == spectra.begin()) return above->red_green_blue;
  const SpectrumSample& below = *(above - 1);
  const double t = (nm - below.wavelength_nm) / (above->wavelength_nm - below.wavelength_nm);
  return glm::mix(below.red_green_blue, above->red_green_blue, t);
}

}  // namespace

std::vector<Colour> coloursOfPrimaries() {
  const glm::vec3 nearer_D = chromaticDifferenceOfPrimaries_D();
  return {{nearer_D.r, {1.0f, 0.0f, 0.0f}},
          {nearer_D.g, {0.0f, 1.0f, 0.0f}},
          {nearer_D.b, {0.0f, 0.0f, 1.0f}}};
}

double luminousEfficiency(double wavelength_nm) {
  const double at = (wavelength_nm - kFirst_nm) / kStep_nm;
  if (!(at >= 0.0 && at <= static_cast<double>(kEfficiency.size() - 1))) return 0.0;
  const auto i = std::min(static_cast<std::size_t>(at), kEfficiency.size() - 2);
  return std::lerp(kEfficiency[i], kEfficiency[i + 1], at - static_cast<double>(i));
}

std::vector<Colour> coloursOfSpectra(const std::vector<SpectrumSample>& spectra, int n) {
  assert(spectra.size() >= 2 && n >= 1);
  constexpr int kFine = 40;  // steps of each band
  const double from_nm = std::max(spectra.front().wavelength_nm, 400.0);
  const double width_nm = (std::min(spectra.back().wavelength_nm, 700.0) - from_nm) / n;
  std::vector<glm::dvec3> bands(static_cast<std::size_t>(n));
  glm::dvec3 all(0.0);
  for (int i = 0; i < n * kFine; ++i) {
    const double nm = from_nm + (i + 0.5) * width_nm / kFine;
    const glm::dvec3 light = luminousEfficiency(nm) * powerAt(spectra, nm);
    bands[static_cast<std::size_t>(i / kFine)] += light;
    all += light;
  }
  assert(all.r > 0.0 && all.g > 0.0 && all.b > 0.0);
  std::vector<Colour> colours;
  colours.reserve(bands.size());
  for (int i = 0; i < n; ++i) {
    const glm::vec3 share(bands[static_cast<std::size_t>(i)] / all);
    if (share == glm::vec3(0.0f)) continue;
    const double um = 1e-3 * (from_nm + (i + 0.5) * width_nm);
    colours.push_back({static_cast<float>(chromaticDifference_D(um)), share});
  }
  return colours;
}

Refraction refractionOf(const Prescription& prescription) {
  const double half_D = 0.5 * prescription.cylinder_D;
  const double twice_rad = glm::radians(2.0 * prescription.axis_deg);
  return {
      .far_point_D = -(prescription.sphere_D + half_D),
      .astigmatism_D = glm::vec2(half_D * glm::dvec2(std::cos(twice_rad), std::sin(twice_rad)))};
}

double chromaticDifference_D(double wavelength_um) {
  return 0.63346 / (wavelength_um - 0.2141) - 1.7312;
}

glm::vec3 chromaticDifferenceOfPrimaries_D() {
  return {chromaticDifference_D(0.6114), chromaticDifference_D(0.5491),
          chromaticDifference_D(0.4642)};
}

}  // namespace foci
