#include "render/optics/pupil.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>

namespace foci {
namespace {

/// Diffraction below this share of the prefilter's variance is left out.
constexpr float kLeastShare = 0.03f;

constexpr int kSamplesOfCell = 48, kFewestSamples = 1600, kMostParts = 256, kRounds = 24;

/// Sample `i` of `n` on the unit disc (Vogel, 1979).
glm::dvec2 discSample(int i, int n) {
  const double golden_angle_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt((i + 0.5) / n), angle_rad = i * golden_angle_rad;
  return radius * glm::dvec2(std::cos(angle_rad), std::sin(angle_rad));
}

/// A cell of the lens: its samples, their mean, and the radius of the disc of their variance.
struct Cell {
  std::vector<glm::dvec2> samples;
  glm::dvec2 centre{0.0};
  double radius = 1.0;
};

std::vector<Cell> cellsOf(int n) {
  const int count = std::max(n * kSamplesOfCell, kFewestSamples);
  std::vector<Cell> cells(static_cast<std::size_t>(n));
  // 7, 19, 37 and 61 start as rings of 6, 12, 18 and 24 around the middle.
  int rings = 0;
  while (1 + 3 * rings * (rings + 1) < n) ++rings;
  const bool full = 1 + 3 * rings * (rings + 1) == n;
  for (int i = 0, ring = 0, first = 0; i < n; ++i) {
    if (i == first + std::max(6 * ring, 1)) first = i, ++ring;
    const double angle_rad = 2.0 * std::numbers::pi * (i - first) / std::max(6 * ring, 1);
    cells[static_cast<std::size_t>(i)].centre =
        full ? ring / (rings + 0.5) * glm::dvec2(std::cos(angle_rad), std::sin(angle_rad))
             : discSample(i, n);
  }
  for (int round = 0; round < kRounds; ++round) {
    for (Cell& cell : cells) cell.samples.clear();
    for (int i = 0; i < count; ++i) {
      const glm::dvec2 p = discSample(i, count);
      const auto distance2 = [&](const Cell& cell) {
        return glm::dot(cell.centre - p, cell.centre - p);
      };
      std::ranges::min_element(cells, {}, distance2)->samples.push_back(p);
    }
    for (Cell& cell : cells) {
      glm::dvec2 sum(0.0);
      for (const glm::dvec2& p : cell.samples) sum += p;
      cell.centre = sum / static_cast<double>(cell.samples.size());
    }
  }
  for (Cell& cell : cells) {
    double squares = 0.0;
    for (const glm::dvec2& p : cell.samples) squares += glm::dot(p - cell.centre, p - cell.centre);
    // A disc of radius a has the variance a^2 / 4 along each of two axes.
    cell.radius = std::sqrt(2.0 * squares / static_cast<double>(cell.samples.size()));
  }
  return cells;
}

const std::vector<Cell>& cells(int n) {
  assert(n >= 1 && n <= kMostParts);
  static std::array<std::vector<Cell>, kMostParts + 1> all;
  static std::array<std::once_flag, kMostParts + 1> made;
  const auto at = static_cast<std::size_t>(n);
  std::call_once(made[at], [&] { all[at] = cellsOf(n); });
  return all[at];
}

/// The linear fit of the wavefront's slope over a part, by least squares.
struct SlopeFit {
  glm::dvec2 slope{0.0};  ///< at the part's centre, rad
  glm::dmat2 curvature_D{0.0};
  double variance_rad2 = 0.0;  ///< of the slope over the part, mean of both axes
};

double sensitivityAt(const Pupil& pupil, const glm::dvec2& p) {
  const glm::dvec2 from_mm = 1000.0 * (0.5 * pupil.diameter_m * p - pupil.stiles_crawford_center_m);
  return std::pow(10.0, -pupil.stiles_crawford_per_mm2 * glm::dot(from_mm, from_mm));
}

double sensitivityOver(const Pupil& pupil, const Cell& cell) {
  double sum = 0.0;
  for (const glm::dvec2& p : cell.samples) sum += sensitivityAt(pupil, p);
  return sum;
}

SlopeFit fitSlope(const Pupil& pupil, const PupilWavefront& wavefront, const Cell& cell) {
  // s = mean + H (p - centre), H symmetric: three unknowns from xx, xy, yy and the products.
  const auto n = static_cast<double>(cell.samples.size());
  SlopeFit fit;
  std::vector<glm::dvec2> slopes;
  slopes.reserve(cell.samples.size());
  for (const glm::dvec2& p : cell.samples) {
    slopes.push_back(wavefront.at(p).slope);
    fit.slope += slopes.back() / n;
  }
  glm::dmat3 normal(0.0);
  glm::dvec3 right(0.0);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const glm::dvec2 p = cell.samples[i] - cell.centre, s = slopes[i] - fit.slope;
    normal += glm::dmat3(p.x * p.x, p.x * p.y, 0.0, p.x * p.y, glm::dot(p, p), p.x * p.y, 0.0,
                         p.x * p.y, p.y * p.y);
    right += glm::dvec3(p.x * s.x, p.x * s.y + p.y * s.x, p.y * s.y);
  }
  const glm::dvec3 h = glm::inverse(normal) * right;
  const glm::dmat2 per_disc(h.x, h.y, h.y, h.z);
  for (const glm::dvec2& slope : slopes) {
    fit.variance_rad2 += glm::dot(slope - fit.slope, slope - fit.slope) / (2.0 * n);
  }
  fit.curvature_D = per_disc / (0.5 * pupil.diameter_m);
  return fit;
}

/// The part of a cell, but for its weight.
LensPart partOf(const Defocus& defocus, const Pupil& pupil, const PupilWavefront& wavefront,
                const Cell& cell) {
  const double radius_m = 0.5 * pupil.diameter_m;
  const glm::dvec2 focal_px = glm::dvec2(defocus.radius_px_per_D) / radius_m;
  const double focal_mean_px = std::sqrt(focal_px.x * focal_px.y);
  const SlopeFit fit = fitSlope(pupil, wavefront, cell);
  LensPart part{
      .centre = cell.centre, .radius = static_cast<float>(cell.radius), .defocus = defocus};
  const glm::dmat2& h = fit.curvature_D;
  const double sphere_D = 0.5 * (h[0][0] + h[1][1]);
  const glm::dvec2 astigmatism_D(0.5 * (h[0][0] - h[1][1]), h[0][1]);
  glm::dvec2 shift_rad = fit.slope - radius_m * sphere_D * cell.centre;
  part.defocus.focus_D += static_cast<float>(sphere_D);
  // Over a disc of radius a, J p has the variance (|J| a / 2)^2 along each axis.
  const double per_D = 0.5 * radius_m * cell.radius;
  double fitted_rad2 = per_D * per_D * sphere_D * sphere_D;
  const double stretch_rad = per_D * glm::length(astigmatism_D);
  if (stretch_rad * focal_mean_px > kRest_px || isAstigmatic(defocus)) {
    part.defocus.astigmatism_D += glm::vec2(astigmatism_D);
    const glm::dmat2 j(astigmatism_D.x, astigmatism_D.y, astigmatism_D.y, -astigmatism_D.x);
    shift_rad -= radius_m * (j * cell.centre);
    fitted_rad2 += stretch_rad * stretch_rad;
  }
  const double rest_rad = std::sqrt(std::max(fit.variance_rad2 - fitted_rad2, 0.0));
  part.shift_px = focal_px * shift_rad;
  part.rest_px = static_cast<float>(rest_rad * focal_mean_px);
  const double linear_rad2 = per_D * per_D * sphere_D * sphere_D + stretch_rad * stretch_rad;
  part.nonlinear_px =
      static_cast<float>(std::sqrt(std::max(fit.variance_rad2 - linear_rad2, 0.0)) * focal_mean_px);
  return part;
}

PupilWavefront wavefrontOf(const Pupil& pupil) {
  return PupilWavefront(pupil.wavefront ? pupil.wavefront
                                        : Wavefront{.zernike_um = {}, .pupil_m = pupil.diameter_m});
}

void weigh(std::vector<LensPart>& parts, const std::vector<double>& light) {
  const double all = std::accumulate(light.begin(), light.end(), 0.0);
  for (std::size_t i = 0; i < parts.size(); ++i)
    parts[i].weight = static_cast<float>(light[i] / all);
}

}  // namespace

double diffractionGaussian_rad(double pupil_m, double wavelength_m) {
  return std::numbers::sqrt2 / std::numbers::pi * wavelength_m / pupil_m;
}

std::vector<LensPart> lensParts(const Defocus& defocus, const Pupil& pupil, int n) {
  std::vector<LensPart> parts;
  std::vector<double> light;
  parts.reserve(static_cast<std::size_t>(n));
  light.reserve(static_cast<std::size_t>(n));
  const bool plain = !pupil.hasParts();
  std::optional<PupilWavefront> wavefront;
  if (!plain) wavefront = wavefrontOf(pupil);
  for (const Cell& cell : cells(n)) {
    light.push_back(plain ? static_cast<double>(cell.samples.size())
                          : sensitivityOver(pupil, cell));
    parts.push_back(plain ? LensPart{.centre = cell.centre,
                                     .radius = static_cast<float>(cell.radius),
                                     .defocus = defocus}
                          : partOf(defocus, pupil, *wavefront, cell));
  }
  if (n == 1) parts[0].centre = glm::vec2(0.0f), parts[0].radius = 1.0f;
  weigh(parts, light);
  return parts;
}

std::vector<LensPart> lensPoints(const Defocus& defocus, const Pupil& pupil,
                                 const std::vector<glm::vec2>& points) {
  std::vector<LensPart> parts;
  std::vector<double> light;
  parts.reserve(points.size());
  light.reserve(points.size());
  std::optional<PupilWavefront> wavefront;
  if (pupil.hasParts()) wavefront = wavefrontOf(pupil);
  for (const glm::vec2& p : points) {
    LensPart part{.centre = p, .radius = 0.0f, .defocus = defocus};
    if (wavefront) {
      part.shift_px =
          glm::dvec2(defocus.radius_px_per_D) / (0.5 * pupil.diameter_m) * wavefront->at(p).slope;
    }
    light.push_back(wavefront ? sensitivityAt(pupil, p) : 1.0);
    parts.push_back(part);
  }
  weigh(parts, light);
  return parts;
}

float aberrationRadius_px(const Defocus& defocus, const Pupil& pupil) {
  if (!pupil.wavefront) return 0.0f;
  const SlopeFit fit = fitSlope(pupil, wavefrontOf(pupil), cells(1).front());
  const glm::dvec2 focal_px = glm::dvec2(defocus.radius_px_per_D) / (0.5 * pupil.diameter_m);
  return static_cast<float>(2.0 * std::sqrt(fit.variance_rad2 * focal_px.x * focal_px.y));
}

View viewOfPart(View view, const LensPart& part) {
  view.principal_px += part.shift_px;
  return view;
}

float shownDiffraction_px(const Pupil& pupil) {
  return pupil.diffraction_px * pupil.diffraction_px > kLeastShare ? pupil.diffraction_px : 0.0f;
}

Acuity widened(Acuity acuity, const Pupil& pupil, float rest_px) {
  const float seen = shownDiffraction_px(pupil);
  if (seen > 0.0f || rest_px > 0.0f) {
    acuity.base_px = std::sqrt(std::max(acuity.base_px * acuity.base_px, 1.0f) + seen * seen +
                               rest_px * rest_px);
  }
  return acuity;
}

}  // namespace foci
