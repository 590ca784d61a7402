#include "app/eye/visual_quality.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <complex>
#include <map>
#include <numeric>
#include <opencv2/core.hpp>
#include <utility>

#include "base/parallel.h"
#include "render/optics/colours.h"

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
  const auto best = static_cast<std::size_t>(std::ranges::max_element(contrast) - contrast.begin());
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
  std::vector<double> u(kMost_cycles_per_deg + 1);
  std::iota(u.begin(), u.end(), 0.0);
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

namespace {

constexpr double kDeg_rad = std::numbers::pi / 180.0;

/// Fine samples lie this many times denser than light of a coherent pupil needs, lambda / A.
constexpr double kDenser = 2.5;

/// Width of the field around geometric blur, in lambda / A; the pupil is as many cells wide.
constexpr double kRings = 64.0;

/// Samples along a side for an OTF and for a peak. A smaller field than the blur's only takes the
/// OTF at fewer frequencies: a PSF that comes in again at the other side has the same values there.
constexpr int kMostForTransfer = 1024, kMostForPeak = 2048;

/// White light: from 420 to 680 nm.
constexpr double kFirstWave_nm = 420.0, kWaveStep_nm = 20.0;
constexpr int kWaves = 14;

/// The amplitude of light over a pupil, for `n` x `n` directions.
struct PupilField {
  cv::Mat field;            ///< complex numbers; the centre of the pupil is in the middle
  double amplitudes = 0.0;  ///< sum of the moduli
};

PupilField pupilField(const EyeOptics& eye, double step_rad, int n) {
  const double radius_m = 0.5 * eye.pupil.diameter_m;
  assert(radius_m > 0.0 && step_rad <= eye.wavelength_m / (2.0 * eye.pupil.diameter_m));
  const double step_m = eye.wavelength_m / (n * step_rad);
  const double per_m = 2.0 * std::numbers::pi / eye.wavelength_m;
  const PupilWavefront wavefront = wavefrontIn(eye.pupil);
  const int up = std::min(static_cast<int>(radius_m / step_m), n / 2 - 1);
  const int across = std::min(static_cast<int>(eye.pupil_aspect * radius_m / step_m), n / 2 - 1);
  PupilField pupil{.field = cv::Mat::zeros(2 * up + 1, 2 * across + 1, CV_64FC2)};
  for (int row = 0; row < pupil.field.rows; ++row) {
    for (int column = 0; column < pupil.field.cols; ++column) {
      const double x = (column - across) * step_m, y = (row - up) * step_m;
      if (std::hypot(x / eye.pupil_aspect, y) > radius_m) continue;
      const glm::dvec2 from_mm = 1000.0 * (glm::dvec2(x, y) - eye.pupil.stiles_crawford_center_m);
      const double amplitude =
          std::pow(10.0, -0.5 * eye.pupil.stiles_crawford_per_mm2 * glm::dot(from_mm, from_mm));
      const double error_m =
          wavefront.at(glm::dvec2(x, y) / radius_m).error_m + 0.5 * eye.defocus_D * (x * x + y * y);
      pupil.field.at<cv::Vec2d>(row, column) = {amplitude * std::cos(per_m * error_m),
                                                amplitude * std::sin(per_m * error_m)};
      pupil.amplitudes += amplitude;
    }
  }
  return pupil;
}

/// The intensity of `n` x `n` directions `step_rad` apart, with the axis at (n / 2, n / 2) and the
/// sum 1; light beyond the field comes in again at the other side.
/// @param peak  receives the peak over that of an equal pupil without aberrations
cv::Mat intensity(const EyeOptics& eye, double step_rad, int n, double* peak = nullptr) {
  const PupilField pupil = pupilField(eye, step_rad, n);
  // A shifted pupil has the same intensity, and cv::dft skips the rows without light.
  cv::Mat field = cv::Mat::zeros(n, n, CV_64FC2);
  pupil.field.copyTo(field(cv::Rect(0, 0, pupil.field.cols, pupil.field.rows)));
  cv::dft(field, field, 0, pupil.field.rows);
  cv::Mat light(n, n, CV_64F);
  double sum = 0.0, highest = 0.0;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const cv::Vec2d& value = field.at<cv::Vec2d>((row + n - n / 2) % n, (column + n - n / 2) % n);
      const double power = value[0] * value[0] + value[1] * value[1];
      light.at<double>(row, column) = power;
      sum += power;
      highest = std::max(highest, power);
    }
  }
  if (peak) *peak = highest / (pupil.amplitudes * pupil.amplitudes);
  return light / sum;
}

/// Field that holds the light: geometric blur and the wings of diffraction.
double fieldOf_rad(const EyeOptics& eye) {
  const bool sharp = !eye.pupil.wavefront && eye.defocus_D == 0.0;
  const double slope_rad = sharp ? 0.0 : steepest_rad(eye, 64, {0.5, 0.75, 1.0});
  return 4.0 * slope_rad + kRings * eye.wavelength_m / eye.pupil.diameter_m;
}

/// Fine samples: their angle, and an even number of them along a side.
struct Fine {
  double step_rad;
  int n;
};
Fine fineOf(const EyeOptics& eye) {
  const double step_rad = eye.wavelength_m / (kDenser * eye.pupil.diameter_m);
  const int wanted = static_cast<int>(std::ceil(0.5 * fieldOf_rad(eye) / step_rad));
  return {step_rad, 2 * cv::getOptimalDFTSize(wanted)};
}

/// The OTF of an eye: the autocorrelation of its pupil. It is summed for each frequency that is
/// asked for, which is quicker than a DFT for a circle of them, or taken for all by DFT.
class Transfer {
 public:
  enum class By { sum, dft };

  Transfer(const EyeOptics& eye, By by) {
    Fine fine = fineOf(eye);
    fine.n = std::min(fine.n, kMostForTransfer);
    n_ = fine.n;
    per_cycle_deg_ = fine.n * fine.step_rad / kDeg_rad;
    if (by == By::dft) {
      const cv::Mat light = intensity(eye, fine.step_rad, n_);
      cv::Mat around(n_, n_, CV_64F);
      for (int row = 0; row < n_; ++row) {
        for (int column = 0; column < n_; ++column) {
          around.at<double>(row, column) =
              light.at<double>((row + n_ / 2) % n_, (column + n_ / 2) % n_);
        }
      }
      cv::dft(around, values_, cv::DFT_COMPLEX_OUTPUT);
      return;
    }
    pupilField(eye, fine.step_rad, n_).field.convertTo(field_, CV_32F);
    turned_.create(field_.size(), CV_32FC2);
    for (int row = 0; row < field_.rows; ++row) {
      for (int column = 0; column < field_.cols; ++column) {
        const cv::Vec2f& v = field_.at<cv::Vec2f>(row, column);
        turned_.at<cv::Vec2f>(row, column) = {v[1], -v[0]};
      }
    }
    light_ = field_.dot(field_);
  }

  /// At the frequency (x, y), cycles per degree; bilinear.
  std::complex<double> at(double x, double y) {
    x *= per_cycle_deg_;
    y *= per_cycle_deg_;
    if (std::hypot(x, y) > n_ / 2) return 0.0;
    const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
    const double fx = x - column, fy = y - row;
    return (1 - fy) * ((1 - fx) * value(row, column) + fx * value(row, column + 1)) +
           fy * ((1 - fx) * value(row + 1, column) + fx * value(row + 1, column + 1));
  }

 private:
  std::complex<double> value(int row, int column) {
    if (values_.empty()) {
      const auto [known, is_new] = sums_.try_emplace({row, column});
      if (is_new) known->second = correlation(row, column);
      return known->second;
    }
    const cv::Vec2d& v = values_.at<cv::Vec2d>((row % n_ + n_) % n_, (column % n_ + n_) % n_);
    return {v[0], v[1]};
  }

  /// sum P(x) conj(P(x + lag)) / sum |P|^2.
  std::complex<double> correlation(int row, int column) const {
    const cv::Size overlap(field_.cols - std::abs(column), field_.rows - std::abs(row));
    if (overlap.width <= 0 || overlap.height <= 0) return 0.0;
    const cv::Rect here({std::max(-column, 0), std::max(-row, 0)}, overlap);
    const cv::Mat there = field_(cv::Rect({std::max(column, 0), std::max(row, 0)}, overlap));
    return {field_(here).dot(there) / light_, turned_(here).dot(there) / light_};
  }

  int n_ = 0;
  double per_cycle_deg_ = 0.0;  ///< steps for one cycle per degree
  cv::Mat values_{};            ///< by DFT
  cv::Mat field_{}, turned_{};  ///< P and -i P
  double light_ = 0.0;
  std::map<std::pair<int, int>, std::complex<double>> sums_{};
};

/// What is quicker for so many frequencies.
Transfer::By quickerFor(std::span<const double> cycles_per_deg) {
  constexpr std::size_t kFew = 2;
  return cycles_per_deg.size() <= kFew ? Transfer::By::sum : Transfer::By::dft;
}

std::vector<double> mtfOf(std::vector<Transfer> transfers, const std::vector<double>& weights,
                          std::span<const double> cycles_per_deg) {
  constexpr int kOrientations = 72;  // over half a turn: the OTF of real light is symmetric
  std::vector<double> mtf;
  mtf.reserve(cycles_per_deg.size());
  const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (const double u : cycles_per_deg) {
    double sum = 0.0;
    for (int i = 0; i < kOrientations; ++i) {
      const double angle_rad = std::numbers::pi * (i + 0.5) / kOrientations;
      std::complex<double> transfer = 0.0;
      for (std::size_t k = 0; k < transfers.size(); ++k) {
        transfer += weights[k] * transfers[k].at(u * std::cos(angle_rad), u * std::sin(angle_rad));
      }
      sum += std::abs(transfer);
    }
    mtf.push_back(sum / kOrientations / all);
  }
  return mtf;
}

}  // namespace

double steepest_rad(const EyeOptics& eye, int angles, std::initializer_list<double> shares) {
  const PupilWavefront wavefront = wavefrontIn(eye.pupil);
  double steepest = 0.0;
  for (int i = 0; i < angles; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / angles;
    for (const double r : shares) {
      const glm::dvec2 p = r * glm::dvec2(std::cos(angle_rad), std::sin(angle_rad));
      steepest = std::max(steepest, glm::length(wavefront.at(p).slope +
                                                0.5 * eye.defocus_D * eye.pupil.diameter_m * p));
    }
  }
  return steepest;
}

Psf fourierPsf(const EyeOptics& eye, double sample_rad, int size) {
  assert(sample_rad > 0.0 && size > 0);
  int finer =
      static_cast<int>(std::ceil(sample_rad * kDenser * eye.pupil.diameter_m / eye.wavelength_m));
  finer += 1 - finer % 2;  // odd: a fine sample in the middle
  const double step_rad = sample_rad / finer;
  const int least = static_cast<int>(std::ceil(fieldOf_rad(eye) / step_rad));
  const int n = 2 * cv::getOptimalDFTSize((std::max(least, size * finer + finer) + 1) / 2);
  const cv::Mat fine = intensity(eye, step_rad, n);
  Psf psf{.size = size, .sample_rad = sample_rad};
  psf.light.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const int x = n / 2 + (column - size / 2) * finer - finer / 2;
      const int y = n / 2 + (row - size / 2) * finer - finer / 2;
      psf.light.push_back(cv::sum(fine(cv::Rect(x, y, finer, finer)))[0]);
    }
  }
  return psf;
}

std::vector<double> radialMtf(const EyeOptics& eye, std::span<const double> cycles_per_deg) {
  return mtfOf({Transfer(eye, quickerFor(cycles_per_deg))}, {1.0}, cycles_per_deg);
}

std::vector<double> whiteMtf(const EyeOptics& eye, std::span<const double> cycles_per_deg) {
  std::vector<Transfer> transfers;
  std::vector<double> brightness;
  transfers.reserve(kWaves);
  brightness.reserve(kWaves);
  for (int i = 0; i < kWaves; ++i) {
    const double nm = kFirstWave_nm + i * kWaveStep_nm;
    EyeOptics colour = eye;
    colour.wavelength_m = 1e-9 * nm;
    colour.defocus_D +=
        chromaticDifference_D(1e-3 * nm) - chromaticDifference_D(1e6 * eye.wavelength_m);
    transfers.emplace_back(colour, quickerFor(cycles_per_deg));
    brightness.push_back(luminousEfficiency(nm));
  }
  return mtfOf(std::move(transfers), brightness, cycles_per_deg);
}

double strehlRatio(const EyeOptics& eye) {
  // The peak may lie between samples: half the step.
  const Fine fine = fineOf(eye);
  double peak = 0.0;
  intensity(eye, 0.5 * fine.step_rad, std::min(2 * fine.n, kMostForPeak), &peak);
  return peak;
}

double diffractionMtf(double pupil_m, double wavelength_m, double cycles_per_deg) {
  const double s = cycles_per_deg / kDeg_rad * wavelength_m / pupil_m;
  if (s >= 1.0) return 0.0;
  return 2.0 / std::numbers::pi * (std::acos(s) - s * std::sqrt(1.0 - s * s));
}

}  // namespace foci
