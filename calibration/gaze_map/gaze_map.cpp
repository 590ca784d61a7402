#include "calibration/gaze_map/gaze_map.h"

#include <algorithm>
#include <cmath>

#include "base/input_error.h"
#include "base/quantile.h"
#include "base/transformed.h"
#include "calibration/calibration_file.h"
#include "calibration/location.h"

namespace foci {
namespace {

constexpr std::array<std::string_view, 4> kNames{"offset", "affine", "second", "third"};
constexpr std::array<std::size_t, 4> kTerms{1, 3, 6, 10};
constexpr std::size_t kMinDriftSamples = 5;
constexpr double kMaxDrift_deg = 5.0;  // chosen by hand; a larger drift needs a new calibration
/// Samples are of one place where two thirds lie within this multiple of the radius that holds the
/// densest 40 %, and nearer than the largest drift. Gaussian noise: 1.47; of ten samples, one set
/// in 30 exceeds 3 by chance.
constexpr double kMaxScatter = 3.0, kAlwaysFine_deg = 1.0;
constexpr std::size_t kTriedCentres = 100;

struct Scatter {
  double dense_deg = INFINITY;  ///< within it lie the nearest 40 %
  double most_deg = INFINITY;   ///< and two thirds
};

/// About the sample with the densest surroundings: of two places, it lies in one.
Scatter scatterOf(const GazeFrame& frame, const std::vector<glm::dvec2>& points) {
  Scatter scatter;
  const std::size_t step = points.size() / kTriedCentres + 1;
  for (std::size_t i = 0; i < points.size(); i += step) {
    std::vector<double> apart_deg = transformed(points, [&](const glm::dvec2& point) {
      return angle_deg(onPlane(frame, point), onPlane(frame, points[i]));
    });
    const double dense_deg = quantile(apart_deg, 0.4);
    if (dense_deg >= scatter.dense_deg) continue;
    scatter = {.dense_deg = dense_deg, .most_deg = quantile(apart_deg, 2.0 / 3.0)};
  }
  return scatter;
}

/// Derivatives of the terms along x and y.
std::array<glm::dvec2, kMaxTerms> slopes(const glm::dvec2& u) {
  const auto [x, y] = std::pair(u.x, u.y);
  return {{{0, 0},
           {1, 0},
           {0, 1},
           {2 * x, 0},
           {y, x},
           {0, 2 * y},
           {3 * x * x, 0},
           {2 * x * y, x * x},
           {y * y, 2 * x * y},
           {0, 3 * y * y}}};
}

constexpr double kMaxNumber = 1e9;

}  // namespace

std::string_view nameOf(GazeModel model) { return kNames[static_cast<std::size_t>(model)]; }

std::optional<GazeModel> gazeModelNamed(std::string_view name) {
  const auto found = std::ranges::find(kNames, name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<GazeModel>(found - kNames.begin());
}

std::size_t termsOf(GazeModel model) { return kTerms[static_cast<std::size_t>(model)]; }

std::array<double, kMaxTerms> gazeTerms(const glm::dvec2& u) {
  const auto [x, y] = std::pair(u.x, u.y);
  return {1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y};
}

GazeEstimate estimateGaze(const GazeMap& map, const glm::dvec2& gaze) {
  const glm::dvec2 u = (gaze - map.centre) / map.scale;
  const glm::dvec2 inside = glm::clamp(u, map.low, map.high);
  const glm::dvec2 beyond = u - inside;

  // Powers explode beyond the calibrated range: follow the tangent plane there.
  auto terms = gazeTerms(inside);
  const auto slope = slopes(inside);
  for (std::size_t k = 0; k < kMaxTerms; ++k) terms[k] += glm::dot(slope[k], beyond);

  GazeEstimate estimate;
  for (std::size_t k = 0; k < kMaxTerms; ++k) estimate.point += map.coefficients[k] * terms[k];

  const std::size_t n = termsOf(map.model);
  double variance = map.target_sd_deg * map.target_sd_deg + map.sample_sd_deg * map.sample_sd_deg;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      variance += terms[i] * map.covariance_deg2[i * n + j] * terms[j];
    }
  }
  estimate.uncertainty_deg = map.sigma_radius * std::sqrt(std::max(variance, 0.0));
  return estimate;
}

GazeMap correctDrift(const GazeMap& map, std::span<const glm::dvec2> gaze,
                     const glm::dvec2& target) {
  if (gaze.size() < kMinDriftSamples) {
    throw InputError("drift correction", counted(gaze.size(), "sample") + ": expected 5 or more");
  }
  const std::vector<glm::dvec2> mapped =
      transformed(gaze, [&](const glm::dvec2& sample) { return estimateGaze(map, sample).point; });
  const glm::dvec2 seen = robustLocation(mapped).centre;
  const Scatter scatter = scatterOf(map.frame, mapped);
  const double max_deg =
      std::clamp(kMaxScatter * scatter.dense_deg, kAlwaysFine_deg, kMaxDrift_deg);
  if (!(scatter.most_deg <= max_deg)) {
    throw InputError("drift correction", "a third of the samples lie " +
                                             decimal(scatter.most_deg, 2) +
                                             " deg or more from the others: expected at most " +
                                             decimal(max_deg, 2) + ", look at the target only");
  }
  const double drift_deg = angle_deg(onPlane(map.frame, seen), onPlane(map.frame, target));
  if (!(drift_deg <= kMaxDrift_deg)) {
    throw InputError("drift correction", decimal(drift_deg, 1) + " deg: expected at most " +
                                             exactText(kMaxDrift_deg) + ", calibrate anew");
  }
  GazeMap corrected = map;
  corrected.coefficients[0] += target - seen;
  return corrected;
}

GazeTrace mapTrace(const GazeMap& map, const Screen& screen, GazeTrace trace) {
  for (GazeSample& sample : trace.samples) {
    if (!sample.point_px) continue;
    const glm::dvec2 gaze = fromPixels(map.frame, screen, *sample.point_px);
    const GazeEstimate estimate = estimateGaze(map, gaze);
    sample.point_px = toPixels(map.frame, screen, estimate.point);
    sample.uncertainty_deg = estimate.uncertainty_deg;
  }
  return trace;
}

std::string gazeMapToml(const GazeMap& map) {
  std::vector<double> x, y;
  const std::size_t kept = std::max<std::size_t>(termsOf(map.model), 3);
  for (std::size_t k = 0; k < kept; ++k) {
    x.push_back(map.coefficients[k].x);
    y.push_back(map.coefficients[k].y);
  }
  std::string text =
      "# Gaze map of foci. u = (gaze - centre) / scale. From low to high a polynomial in\n"
      "# 1, x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3; beyond, its tangent plane.\n"
      "[map]\n";
  text += "units = " + quotedText(std::string(nameOf(map.frame.units))) + "\n";
  text += "model = " + quotedText(std::string(nameOf(map.model))) + "\n";
  text += "centre = " + exactText(map.centre) + "\nscale = " + exactText(map.scale) + "\n";
  text += "low = " + exactText(map.low) + "\nhigh = " + exactText(map.high) + "\n";
  text += "x = " + exactText(x) + "\ny = " + exactText(y) + "\n\n";
  text +=
      "# Deviations per axis. Radius with 68 % of errors: sigma_radius sqrt(sum of variances).\n";
  text += "[uncertainty]\ncovariance_deg2 = " + exactText(map.covariance_deg2) + "\n";
  text += "target_sd_deg = " + exactText(map.target_sd_deg) + "\n";
  text += "sample_sd_deg = " + exactText(map.sample_sd_deg) + "\n";
  text += "sigma_radius = " + exactText(map.sigma_radius) + "\n";
  if (map.frame.units == MapUnits::norm) {
    const Screen& screen = map.frame.screen;
    text += "\n[screen]\nsize_px = " + exactText(screen.size_px) +
            "\nsize_m = " + exactText(screen.size_m) +
            "\ndistance_m = " + exactText(screen.distance_m) + "\n";
  }
  return text;
}

GazeMap readGazeMap(const std::filesystem::path& file) {
  CalibrationFile in(file);
  GazeMap map;
  const auto units = mapUnitsNamed(in.text("map.units"));
  if (!units) in.refuse("map.units", "deg, norm or direction");
  const auto model = gazeModelNamed(in.text("map.model"));
  if (!model) in.refuse("map.model", "offset, affine, second or third");
  map.frame.units = *units;
  map.model = *model;
  map.centre = in.pair("map.centre", -kMaxNumber, kMaxNumber);
  map.scale = in.pair("map.scale", 1e-9, kMaxNumber);
  map.low = in.pair("map.low", -100.0, 100.0);
  map.high = in.pair("map.high", -100.0, 100.0);
  if (map.low.x > map.high.x || map.low.y > map.high.y) in.refuse("map.low", "at most map.high");
  const std::size_t terms = termsOf(map.model), kept = std::max<std::size_t>(terms, 3);
  const auto x = in.numbers("map.x", kept, -kMaxNumber, kMaxNumber);
  const auto y = in.numbers("map.y", kept, -kMaxNumber, kMaxNumber);
  for (std::size_t k = 0; k < kept; ++k) map.coefficients[k] = {x[k], y[k]};
  map.covariance_deg2 =
      in.numbers("uncertainty.covariance_deg2", terms * terms, -kMaxNumber, kMaxNumber);
  map.target_sd_deg = in.number("uncertainty.target_sd_deg", 0.0, 180.0);
  map.sample_sd_deg = in.number("uncertainty.sample_sd_deg", 0.0, 180.0);
  map.sigma_radius = in.number("uncertainty.sigma_radius", 0.0, 100.0);
  if (map.frame.units == MapUnits::norm) {
    map.frame.screen = {
        .size_px = in.size_px("screen.size_px"),
        .size_m = in.pair("screen.size_m", 0.01, 20.0),
        .distance_m = in.number("screen.distance_m", kNearestScreen_m, kFarthestScreen_m)};
  }
  in.refuseUnknownKeys();
  return map;
}

}  // namespace foci
