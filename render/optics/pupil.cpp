#include "render/optics/pupil.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>

namespace foci {
namespace {

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
  std::vector<double> light = {};  ///< of each sample; all samples of the lens have the mean 1
  glm::dvec2 centre{0.0};
  double radius = 1.0;
  double all_light = 0.0;
};

/// Takes the mean and the radius from the light of the samples.
void centre(Cell& cell) {
  cell.centre = glm::dvec2(0.0);
  cell.all_light = std::accumulate(cell.light.begin(), cell.light.end(), 0.0);
  for (std::size_t i = 0; i < cell.samples.size(); ++i) {
    cell.centre += cell.light[i] / cell.all_light * cell.samples[i];
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < cell.samples.size(); ++i) {
    const glm::dvec2 from = cell.samples[i] - cell.centre;
    squares += cell.light[i] / cell.all_light * glm::dot(from, from);
  }
  // A disc of radius a has the variance a^2 / 4 along each of two axes.
  cell.radius = std::sqrt(2.0 * squares);
}

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
    cell.light.assign(cell.samples.size(), 1.0);
    centre(cell);
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

/// The linear fit of the wavefront's slope over a part: s = mean + H (p - centre), H symmetric. H
/// has the covariance of slope and place over the part, on the disc that is rendered for the part.
/// So defocus and slope together have their variance at every distance, summed over both axes.
struct SlopeFit {
  glm::dvec2 slope{0.0};  ///< at the part's centre, rad
  glm::dmat2 curvature_D{0.0};
  double variance_rad2 = 0.0;  ///< of the slope over the part, mean of both axes
};

double sensitivityAt(const Pupil& pupil, const glm::dvec2& p) {
  const glm::dvec2 from_mm = 1000.0 * (0.5 * pupil.diameter_m * p - pupil.stiles_crawford_center_m);
  return std::pow(10.0, -pupil.stiles_crawford_per_mm2 * glm::dot(from_mm, from_mm));
}

SlopeFit fitSlope(const Pupil& pupil, const PupilWavefront& wavefront, const Cell& cell) {
  SlopeFit fit;
  std::vector<glm::dvec2> slopes;
  slopes.reserve(cell.samples.size());
  for (std::size_t i = 0; i < cell.samples.size(); ++i) {
    slopes.push_back(wavefront.at(cell.samples[i]).slope);
    fit.slope += cell.light[i] / cell.all_light * slopes.back();
  }
  // The second order is a lens itself, whatever the samples.
  const double radius_m = 0.5 * pupil.diameter_m;
  const glm::dvec3 power = power_D(pupil.wavefront);
  const glm::dmat2 lens_D(power.x + power.y, power.z, power.z, power.x - power.y);
  glm::dmat2 together(0.0);  // covariance of the rest of the slope and place
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const double share = cell.light[i] / cell.all_light;
    const glm::dvec2 p = cell.samples[i] - cell.centre, s = slopes[i] - fit.slope;
    together += share * glm::outerProduct(s - radius_m * (lens_D * p), p);
    fit.variance_rad2 += 0.5 * share * glm::dot(s, s);
  }
  // The disc has the variance a^2 / 4 along each axis.
  const glm::dmat2 per_disc =
      2.0 * (together + glm::transpose(together)) / (cell.radius * cell.radius);
  fit.curvature_D = lens_D + per_disc / radius_m;
  return fit;
}

/// The cell with the light that the cones count and that diffraction leaves in the core.
Cell lit(const Pupil& pupil, const LightInCore* core, Cell cell) {
  if (pupil.stiles_crawford_per_mm2 == 0.0 && !core) return cell;
  for (std::size_t i = 0; i < cell.samples.size(); ++i) {
    cell.light[i] =
        sensitivityAt(pupil, cell.samples[i]) * (core ? core->at(glm::length(cell.samples[i])) : 1);
  }
  centre(cell);
  return cell;
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

void weigh(std::vector<LensPart>& parts, const std::vector<double>& light) {
  const double all = std::accumulate(light.begin(), light.end(), 0.0);
  for (std::size_t i = 0; i < parts.size(); ++i)
    parts[i].weight = static_cast<float>(light[i] / all);
}

/// Diffraction below this share of the prefilter's variance is left out.
constexpr double kLeastShare = 0.03;

/// Widths of the halos, in pixels, or in Gaussians of the Airy pattern where these are wider. Of
/// the pairs from 2 to 3 px by 10 to 18 px, (2.5, 14) and (2.75, 15) keep the Airy pattern's
/// moments to 3 % in discs of 4 to 12 px. Out of focus, the first is nearer to Fourier optics.
constexpr std::array<double, 2> kHalo_px{2.5, 14.0};

/// Standard deviation, in lens radii and along an axis, of the distances that go with the
/// frequencies of a Gaussian of `blur_px`: lambda / (2 pi blur) = diffraction / (sqrt(2) blur).
double shiftOf(double diffraction_px, double blur_px) {
  return diffraction_px / (std::numbers::sqrt2 * blur_px);
}

}  // namespace

PupilWavefront wavefrontIn(const Pupil& pupil) {
  return PupilWavefront(pupil.wavefront ? pupil.wavefront
                                        : Wavefront{.zernike_um = {}, .pupil_m = pupil.diameter_m});
}

std::vector<LensPart> lensParts(const Defocus& defocus, const Pupil& pupil, int n) {
  std::vector<LensPart> parts;
  std::vector<double> light;
  parts.reserve(static_cast<std::size_t>(n));
  light.reserve(static_cast<std::size_t>(n));
  std::optional<PupilWavefront> wavefront;
  if (pupil.hasParts()) wavefront = wavefrontIn(pupil);
  const auto partBy = [&](const Cell& cell, float diffraction_px) {
    LensPart part = wavefront ? partOf(defocus, pupil, *wavefront, cell)
                              : LensPart{.centre = cell.centre,
                                         .radius = static_cast<float>(cell.radius),
                                         .defocus = defocus};
    part.diffraction_px = diffraction_px;
    return part;
  };
  if (n == 1) {
    LensPart part = partBy(lit(pupil, nullptr, cells(1).front()),
                           diffractionThroughPixel_px(pupil.diffraction_px));
    part.centre = glm::vec2(0.0f), part.radius = 1.0f;
    part.weight = 1.0f;
    return {part};
  }
  const DiffractionHalo halo = diffractionHalo(pupil.diffraction_px);
  std::optional<LightInCore> core;
  if (halo.inHalos() > 0.0f) core.emplace(pupil.diffraction_px, halo);
  for (const Cell& cell : cells(n)) {
    const Cell seen = lit(pupil, core ? &*core : nullptr, cell);
    float core_px = 0.0f;
    if (core) {
      const double all_light = lit(pupil, nullptr, cell).all_light;
      core_px = halo.coreOfPart_px((1.0 - seen.all_light / all_light) / core->lost());
    }
    parts.push_back(partBy(seen, core_px));
    light.push_back(seen.all_light);
  }
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
  if (pupil.hasParts()) wavefront = wavefrontIn(pupil);
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
  const SlopeFit fit = fitSlope(pupil, wavefrontIn(pupil), cells(1).front());
  const glm::dvec2 focal_px = glm::dvec2(defocus.radius_px_per_D) / (0.5 * pupil.diameter_m);
  return static_cast<float>(2.0 * std::sqrt(fit.variance_rad2 * focal_px.x * focal_px.y));
}

View viewOfPart(View view, const LensPart& part) {
  view.principal_px += part.shift_px;
  return view;
}

Acuity widened(const Acuity& acuity, const Pupil& pupil) {
  return widened(acuity,
                 LensPart{.diffraction_px = diffractionThroughPixel_px(pupil.diffraction_px)});
}

Acuity widened(const Acuity& acuity, const LensPart& part) {
  if (part.diffraction_px == 0.0f && part.rest_px == 0.0f) return acuity;
  Acuity wide = acuity;
  wide.base_px = std::sqrt(std::max(acuity.base_px * acuity.base_px, 1.0f) +
                           part.diffraction_px * part.diffraction_px + part.rest_px * part.rest_px);
  return wide;
}

double diffractionGaussian_rad(double pupil_m, double wavelength_m) {
  return std::numbers::sqrt2 / std::numbers::pi * wavelength_m / pupil_m;
}

double peakLostToDiffraction(double diffraction_px, double blur_px) {
  // Distances of a Gaussian in two dimensions: quantiles of Rayleigh's distribution.
  constexpr int kQuantiles = 128;
  const double shift = shiftOf(diffraction_px, blur_px);
  double lost = 0.0;
  for (int i = 0; i < kQuantiles; ++i) {
    const double s = 0.5 * shift * std::sqrt(-2.0 * std::log(1.0 - (i + 0.5) / kQuantiles));
    const double mtf =
        s >= 1.0 ? 0.0 : 2.0 / std::numbers::pi * (std::acos(s) - s * std::sqrt(1.0 - s * s));
    lost += (1.0 - mtf) / kQuantiles;
  }
  return lost;
}

float diffractionThroughPixel_px(float diffraction_px) {
  // A Gaussian of variance v takes v / (1 + v) of the peak.
  const double lost = peakLostToDiffraction(diffraction_px, 1.0);
  const double variance_px2 = lost / (1.0 - lost);
  return variance_px2 < kLeastShare ? 0.0f : static_cast<float>(std::sqrt(variance_px2));
}

DiffractionHalo diffractionHalo(float diffraction_px) {
  if (diffractionThroughPixel_px(diffraction_px) == 0.0f) return {};
  const double d2 = double{diffraction_px} * diffraction_px;
  std::array<double, 2> blur2{}, lost{};  // of and through each halo
  for (std::size_t i = 0; i < 2; ++i) {
    blur2[i] = kHalo_px[i] * kHalo_px[i] * (1.0 + d2);
    lost[i] = peakLostToDiffraction(diffraction_px, std::sqrt(blur2[i]));
  }
  // What a Gaussian takes of its peak through a round blur of variance b: of the core, which is
  // round, and of a halo, which is a line. So the shares follow from the core's variance by two
  // linear equations.
  const auto round = [](double v, double b) { return v / (v + b); };
  const auto line = [](double v, double b) { return 1.0 - 1.0 / std::sqrt(1.0 + v / b); };
  const auto sharesOf = [&](double core2) {
    const double near = round(core2, blur2[0]), far = round(core2, blur2[1]);
    const glm::dmat2 halos(line(blur2[0], blur2[0]) - near, line(blur2[0], blur2[1]) - far,
                           line(blur2[1], blur2[0]) - near, line(blur2[1], blur2[1]) - far);
    return glm::inverse(halos) * glm::dvec2(lost[0] - near, lost[1] - far);
  };
  const double lost_near = peakLostToDiffraction(diffraction_px, 1.0);
  double low = 0.0, high = 4.0 * lost_near / (1.0 - lost_near);
  for (int i = 0; i < 40; ++i) {
    const double core2 = 0.5 * (low + high);
    const glm::dvec2 share = sharesOf(core2);
    const double sum = (1.0 - share.x - share.y) * round(core2, 1.0) +
                       share.x * line(blur2[0], 1.0) + share.y * line(blur2[1], 1.0);
    (sum < lost_near ? low : high) = core2;
  }
  const glm::dvec2 share = sharesOf(low);
  return {
      .core_px = static_cast<float>(std::sqrt(low)),
      .halo_px = {static_cast<float>(std::sqrt(blur2[0])), static_cast<float>(std::sqrt(blur2[1]))},
      .halo_share = {static_cast<float>(share.x), static_cast<float>(share.y)}};
}

float DiffractionHalo::coreOfPart_px(double lost) const {
  return static_cast<float>(core_px * std::sqrt(lost));
}

LightInCore::LightInCore(float diffraction_px, const DiffractionHalo& halo)
    : lost_(peakLostToDiffraction(diffraction_px, halo.halo_px[0])) {
  constexpr int kDirections = 32;  // over a quarter turn
  const double shift = shiftOf(diffraction_px, halo.halo_px[0]);
  for (int i = 0; i <= kSteps; ++i) {
    const double r = static_cast<double>(i) / kSteps;
    double lost = 0.0;
    for (int k = 0; k < kDirections; ++k) {
      const double angle_rad = 0.5 * std::numbers::pi * (k + 0.5) / kDirections;
      const double across = r * std::sin(angle_rad);
      const double to_rim = std::sqrt(1.0 - across * across) - r * std::cos(angle_rad);
      lost += std::exp(-2.0 * to_rim * to_rim / (shift * shift)) / kDirections;
    }
    by_radius_[static_cast<std::size_t>(i)] = 1.0 - lost;
  }
}

double LightInCore::at(double radius) const {
  const double place = std::clamp(radius, 0.0, 1.0) * kSteps;
  const auto below = std::min(static_cast<std::size_t>(place), std::size_t{kSteps - 1});
  const double t = place - static_cast<double>(below);
  return (1.0 - t) * by_radius_[below] + t * by_radius_[below + 1];
}

}  // namespace foci
