// How the scenes of stability_scenes.h are built and scored. Private to it.
#pragma once

#include "app/evaluation/stability/scenes.h"
#include "app/evaluation/stability/sheets.h"
#include "render/optics/view.h"

namespace foci::stability {

inline constexpr int kSize_px = 128;

/// A camera at the origin that looks along -z.
View view();

/// Blur by depth along the axis: a sheet across it is blurred alike everywhere.
RenderSettings lens(float radius_px_per_D, float focus_D);

/// A scene of sheets, the truth about it included.
StabilitySetup sceneOf(const std::vector<Sheet>& sheets, const RenderSettings& settings);

/// A red half-plane left of the axis before a green sheet: the sheet first.
std::vector<Sheet> edgeSheets(float near_m, float far_m);

/// Mean difference of red and closed form, over the pixels within `reach_px` of the edge in the
/// middle rows.
double edgeError(const Frame& frame, double radius_px, double reach_px);

/// Mean lack or excess of coverage `border_px` and more from the border.
double coverageErrorFrom(const Frame& frame, float alpha, int border_px);

// By the value of the scene's dial.
StabilitySetup parallel(float gap_m);
StabilitySetup intersecting(float angle_deg);
StabilitySetup intersectingDeep(float angle_deg);
StabilitySetup wire(float width_px);
StabilitySetup sharpSilhouette(float radius_px);
StabilitySetup blurredSilhouette(float radius_px);
StabilitySetup closeUp(float distance_m);
StabilitySetup nearPlane(float radius_px);
StabilitySetup focusRange(float focus_D);
StabilitySetup pointLight(float focus_D);
StabilitySetup transparent(float layers);
StabilitySetup crossingLayers(float layers);
StabilitySetup highlightOf(float times);
StabilitySetup firefly(float times);
StabilitySetup slanted(float angle_deg);
StabilitySetup curved(float radius_m);
StabilitySetup sweptFocus(float radius_px_per_D);
StabilitySetup movingEye(float px_a_frame);
// Irregular samples.
StabilitySetup density(float ratio);
StabilitySetup patches(float width_px);
StabilitySetup duplicates(float copies);
StabilitySetup misledNormals(float angle_deg);

/// Focus under gaze near the edge between surfaces at 0.5 and 2 m. By noise of a sample, degrees,
/// and by the share of samples lost, %.
enum class GazeScore { wrong_share, jumps_a_second };
extern const std::vector<std::string> kObservers;
double gazeNoise(std::size_t observer, float noise_deg, GazeScore score);
double gazeLoss(std::size_t observer, float lost_percent, GazeScore score);

}  // namespace foci::stability
