// How the scenes of stability_scenes.h are built and scored. Private to it.
#pragma once

#include "app/stability_scenes.h"
#include "render/optics/view.h"

namespace foci::stability {

inline constexpr float kFocal_px = 300.0f;

/// Of all scenes: a camera at the origin that looks along -z.
View view();

// By the value of the scene's dial.
StabilitySetup parallel(float gap_m);
StabilitySetup intersecting(float angle_deg);
StabilitySetup intersectingDeep(float angle_deg);
StabilitySetup density(float ratio);
StabilitySetup wire(float width_px);
StabilitySetup sharpSilhouette(float radius_px);
StabilitySetup blurredSilhouette(float radius_px);
StabilitySetup closeUp(float distance_m);
StabilitySetup focusRange(float focus_D);
StabilitySetup transparent(float layers);
StabilitySetup highlightOf(float times);
StabilitySetup slanted(float angle_deg);
StabilitySetup sweptScene(float radius_px_per_D);

}  // namespace foci::stability
