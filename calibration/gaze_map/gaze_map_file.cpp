#include "calibration/gaze_map/gaze_map_file.h"

#include <algorithm>

#include "calibration/calibration_file.h"

namespace foci {
namespace {

constexpr double kMaxNumber = 1e9;

}  // namespace

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
    map.frame.screen = {.size_px = in.size_px("screen.size_px"),
                        .size_m = in.pair("screen.size_m", 0.01, 20.0),
                        .distance_m = in.number("screen.distance_m", 0.01, 100.0)};
  }
  in.refuseUnknownKeys();
  return map;
}

}  // namespace foci
