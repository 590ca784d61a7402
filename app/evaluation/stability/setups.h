// Builds and scores the scenes of the stability suite. Private to it.
#pragma once

#include "app/evaluation/stability/scenes.h"
#include "app/evaluation/stability/sheets.h"
#include "render/optics/view.h"

namespace foci::stability {

inline constexpr int kSize_px = 128;

/// A camera at the origin that looks along -z.
View view();

/// Blur depends on the depth along the axis: a sheet across the axis is blurred evenly.
RenderSettings lens(float radius_px_per_D, float focus_D);

/// A scene of sheets, with `exactFrame` as its reference.
StabilitySetup sceneOf(const std::vector<Sheet>& sheets, const RenderSettings& settings);

/// A green sheet, then a red half-plane before it, left of the axis.
std::vector<Sheet> edgeSheets(float near_m, float far_m);

/// Mean difference between red and `edgeShare`, over the pixels of the middle rows within
/// `reach_px` of the edge.
double edgeError(const Frame& frame, double radius_px, double reach_px);

/// Mean difference between coverage and `alpha`, over the pixels at least `border_px` from the
/// border.
double coverageErrorFrom(const Frame& frame, float alpha, int border_px);

// Scenes of irregular samples, by the value of their dial.
StabilitySetup density(float ratio);
StabilitySetup patches(float width_px);
StabilitySetup duplicates(float copies);
StabilitySetup misledNormals(float angle_deg);

/// Scores of focus that follows a gaze near an edge between surfaces at 0.5 and 2 m.
enum class GazeScore {
  wrong_share,    ///< share of the frames with wrong focus
  jumps_a_second  ///< jumps of focus beyond those of a gaze without noise and data loss
};
extern const std::vector<std::string> kObservers;
/// @param observer  an index of `kObservers`
double gazeNoise(std::size_t observer, float noise_deg, GazeScore score);
double gazeLoss(std::size_t observer, float lost_percent, GazeScore score);

/// Share of a uniform disc beyond a straight edge, seen through a Gaussian pixel:
///   share(x) = (acos(-t) + t sqrt(1 - t^2)) / pi,   t = clamp(x / radius_px, -1, 1),
/// convolved with the Gaussian. With radius 0 the share is the integral of the Gaussian alone.
/// @param distance_px  from the edge to the disc's centre; > 0: the centre lies on the near side
/// @param radius_px    of the disc, >= 0
/// @param sigma_px     of the Gaussian
/// @return 0 to 1
double edgeShare(double distance_px, double radius_px, double sigma_px);

/// Light per square pixel of a uniform disc of unit light, seen through a Gaussian pixel, at the
/// distance d from its centre:
///   1 / (pi C^2 s^2) int_0^C r exp(-(r^2 + d^2) / (2 s^2)) I0(r d / s^2) dr.
/// @param radius_px  C, > 0
/// @param sigma_px   s, of the Gaussian
double discThroughGaussian(double distance_px, double radius_px, double sigma_px);

}  // namespace foci::stability
