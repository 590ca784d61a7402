// Trackers that give eye centres and directions in space: where the display stands in the tracker's
// frame, and by how much each eye's line of sight differs from the axis that the tracker sees
// (kappa).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace foci {

/// One moment at one target. Metres, in the tracker's frame; an eye may be absent.
struct BinocularSample {
  struct Eye {
    glm::dvec3 centre_m{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};  ///< of any length above 0
  };
  std::array<std::optional<Eye>, 2> eyes{};  ///< left, right
  glm::dvec2 target_m{0.0};                  ///< on the display, from its centre, x right, y up
};

struct BinocularMap {
  /// tracker_from_display: p_tracker = rotation p_display + translation; the display is the plane z
  /// = 0.
  glm::dmat3 rotation{1.0};
  glm::dvec3 translation_m{0.0};
  /// Added to each eye's yaw and pitch in the tracker's frame. Radians.
  std::array<glm::dvec2, 2> kappa_rad{};
};

/// The line of sight: the measured direction with yaw = atan2(x, z) and pitch = asin(y) moved by
/// kappa. Unit length.
glm::dvec3 correctedDirection(const BinocularMap& map, std::size_t eye,
                              const glm::dvec3& direction);

/// Where the line of sight of an eye meets the display; absent where it leads away from it.
std::optional<glm::dvec2> pointOnDisplay(const BinocularMap& map, std::size_t eye,
                                         const BinocularSample::Eye& measured);

/// Vergence of the two corrected lines of sight: 1 / distance of the point nearest to both from the
/// middle between the eyes, negative where they diverge. Dioptres; absent with one eye.
std::optional<double> vergence_D(const BinocularMap& map, const BinocularSample& sample);

/// A first guess from the samples alone: the display whose targets lie nearest to the lines of
/// sight (linear least squares of the distances across them, kappa left out).
/// @throws InputError where the samples do not tell it
BinocularMap roughBinocularMap(std::span<const BinocularSample> samples);

/// Angle between each corrected line of sight and the sample's target, eye by eye.
std::vector<double> errorsOf_deg(const BinocularMap& map, std::span<const BinocularSample> samples);

struct BinocularFit {
  BinocularMap map;
  double accuracy_deg = 0.0;            ///< mean angle between line of sight and target
  double translation_sd_m = 0.0;        ///< largest, from the covariance
  double kappa_sd_deg = 0.0;            ///< largest
  double vergence_bias_before_D = 0.0;  ///< median of measured less true vergence
  double vergence_bias_after_D = 0.0;
};

/// Bundle adjustment (Ceres, Cauchy's loss) of the angles between lines of sight and targets, from
/// the nominal pose of the display. A turn of the display and a common kappa look alike from one
/// place: the head must have moved, nearer and aside.
/// @throws InputError with fewer than 20 samples or 3 targets, or where the samples do not tell
/// pose and
///   kappa apart (deviations above 20 mm or 1 deg)
BinocularFit fitBinocular(std::span<const BinocularSample> samples, const BinocularMap& nominal);

}  // namespace foci
