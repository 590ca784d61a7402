// Gaze maps: from the tracker's gaze to the point that the observer looks at. Polynomials in the
// plane (Stampe 1993; Cerrolaza, Villanueva and Cabeza 2008), with the uncertainty of each
// estimate; and their files.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/gaze_map/map_units.h"

namespace foci {

/// Order of the polynomial. Terms for each axis: 1, 3, 6 and 10.
enum class GazeModel { offset, affine, second, third };

/// "offset", "affine", "second", "third".
std::string_view nameOf(GazeModel model);
std::optional<GazeModel> gazeModelNamed(std::string_view name);
std::size_t termsOf(GazeModel model);

inline constexpr std::size_t kMaxTerms = 10;

/// Radius with 68.27 % of the errors that are Gaussian along each axis, in deviations of one axis:
/// sqrt(-2 ln(1 - 0.6827)).
inline constexpr double kGaussianSigmaRadius = 1.5152;

/// Powers of the normalised gaze u: 1, x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3.
std::array<double, kMaxTerms> gazeTerms(const glm::dvec2& u);

struct GazeMap {
  GazeFrame frame;  ///< units of the targets and of the result
  GazeModel model = GazeModel::offset;
  glm::dvec2 centre{0.0};  ///< u = (gaze - centre) / scale
  glm::dvec2 scale{1.0};   ///< the calibrated targets lie at about |u| <= 1
  glm::dvec2 low{
      -1.0};  ///< calibrated range of u; beyond it the map continues as its tangent plane
  glm::dvec2 high{1.0};
  std::array<glm::dvec2, kMaxTerms>
      coefficients{};  ///< in the frame's units; 0 beyond the model's terms

  /// Covariance of the coefficients of one axis (both have the same design), deg^2, row-major,
  /// `termsOf(model)` squared.
  std::vector<double> covariance_deg2;
  double target_sd_deg = 0.0;  ///< how far, per axis, the observer and the model miss a target
  double sample_sd_deg = 0.0;  ///< scatter of single samples, per axis
  /// Radius with 68.27 % of the errors, in deviations per axis.
  double sigma_radius = kGaussianSigmaRadius;
};

struct GazeEstimate {
  glm::dvec2 point{0.0};         ///< in the map's units
  double uncertainty_deg = 0.0;  ///< 68.27 % of the errors are smaller (1 sigma)
};

/// point = sum_k coefficients[k] term_k(u), uncertainty = sigma_radius sqrt(t' C t + target_sd^2 +
/// sample_sd^2). Never fails.
GazeEstimate estimateGaze(const GazeMap& map, const glm::dvec2& gaze);

/// The map, moved so that `gaze`, measured while the observer looked at `target`, falls on it.
/// @throws InputError with fewer than 5 samples, samples far apart, or a drift above 5 deg
///   (calibrate again)
GazeMap correctDrift(const GazeMap& map, std::span<const glm::dvec2> gaze,
                     const glm::dvec2& target);

/// The map applied to a recording, whose points are pixels of `screen`. A map in `norm` uses its
/// own screen for angles only.
GazeTrace mapTrace(const GazeMap& map, const Screen& screen, GazeTrace trace);

/// The map as commented TOML, every digit kept.
std::string gazeMapToml(const GazeMap& map);

/// @throws InputError by file and key
GazeMap readGazeMap(const std::filesystem::path& file);

}  // namespace foci
