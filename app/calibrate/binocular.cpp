// `foci calibrate binocular`: fits the display's pose and each eye's kappa to a table of eyes and
// targets.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

#include "app/calibrate/options.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "base/input_error.h"
#include "base/quantile.h"
#include "calibration/binocular/binocular_map.h"
#include "calibration/binocular/fit_binocular.h"

namespace foci {
namespace {

double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// @param validated  accuracy was measured on other samples than the fit's
void print(const CalibrateBinocularOptions& options, const BinocularFit& fit, std::size_t samples,
           bool validated, double accuracy_deg, double uncertainty_deg) {
  const glm::dvec3 position_mm = 1e3 * fit.map.translation_m;
  const auto kappa_deg = [&](std::size_t eye) { return glm::degrees(fit.map.kappa_rad[eye]); };
  if (options.json) {
    const nlohmann::ordered_json json = {
        {"samples", samples},
        {"validated", validated},
        {"accuracy_deg", accuracy_deg},
        {"uncertainty_deg", uncertainty_deg},
        {"position_mm", {position_mm.x, position_mm.y, position_mm.z}},
        {"position_sd_mm", 1e3 * fit.translation_sd_m},
        {"left_kappa_deg", {kappa_deg(0).x, kappa_deg(0).y}},
        {"right_kappa_deg", {kappa_deg(1).x, kappa_deg(1).y}},
        {"kappa_sd_deg", fit.kappa_sd_deg},
        {"vergence_bias_before_D", fit.vergence_bias_before_D},
        {"vergence_bias_after_D", fit.vergence_bias_after_D}};
    std::puts(json.dump().c_str());
    return;
  }
  std::printf(
      "accuracy %.2f deg %s; 68 %% of the errors below %.2f deg\n"
      "display at %.1f, %.1f, %.1f mm (+- %.1f)\n"
      "kappa: left %.2f, %.2f deg; right %.2f, %.2f deg (+- %.2f)\n"
      "vergence bias %.2f D, corrected %.2f D\n",
      accuracy_deg, validated ? "on other samples" : "on the samples of the fit", uncertainty_deg,
      position_mm.x, position_mm.y, position_mm.z, 1e3 * fit.translation_sd_m, kappa_deg(0).x,
      kappa_deg(0).y, kappa_deg(1).x, kappa_deg(1).y, fit.kappa_sd_deg, fit.vergence_bias_before_D,
      fit.vergence_bias_after_D);
}

}  // namespace

void calibrateBinocular(const CalibrateBinocularOptions& options) {
  OutputFiles files(
      OutputGuard({options.out}, {options.pairs, options.validate}, options.overwrite));
  const auto pairs = readBinocularPairs(options.pairs);
  std::vector<BinocularSample> others;
  if (!options.validate.empty()) others = readBinocularPairs(options.validate);
  refuseOwnSamples(options.validate, pairs, others,
                   [](const BinocularSample& sample) { return sample.eyes[0] || sample.eyes[1]; });
  BinocularFit fit;
  try {
    fit = fitBinocular(pairs, roughBinocularMap(pairs));
  } catch (const InputError& error) {
    throw InputError(options.pairs.string(), error.what());
  }
  Warnings().addAll(options.pairs.string(), fit.warnings);
  constexpr double kOneSigma = 0.6827;
  std::vector<double> fitted_deg = errorsOf_deg(fit.map, pairs);
  const BinocularCalibration calibration{.map = fit.map,
                                         .uncertainty_deg = quantile(fitted_deg, kOneSigma)};
  double accuracy_deg = fit.accuracy_deg;
  if (!others.empty()) {
    const std::vector<double> errors_deg = errorsOf_deg(fit.map, others);
    if (errors_deg.empty())
      throw InputError(options.validate.string(), "no row has data of an eye");
    accuracy_deg = meanOf(errors_deg);
  }
  if (!options.out.empty()) files.write(options.out, binocularToml(calibration));
  files.commit();
  print(options, fit, pairs.size(), !others.empty(), accuracy_deg, calibration.uncertainty_deg);
}

}  // namespace foci
