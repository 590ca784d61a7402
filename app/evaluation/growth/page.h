// growth.html, and its panels in one image.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/growth/growth.h"
#include "app/graphics/drawing.h"

namespace foci {

/// What a study with method `auto` and frames of 1280 x 720 px needs.
struct StudyNeeds {
  double memory_GB;  ///< to open the scene and to render
  double frame_cpu_s;
  double batch_core_h;  ///< a thousand recordings of ten minutes, 30 frames a second, all rendered
};

/// From the curves over splats; k times the pixels with k times the splats take k times the time.
/// @return nothing without curves of that kind
std::optional<StudyNeeds> needsOf(double splats, bool gaussians,
                                  const std::vector<GrowthCurve>& curves);

/// @param notice  what the reader should know first; may be empty
std::string growthPage(bool quick, const std::vector<GrowthCurve>& curves,
                       const std::string& notice);

Drawing growthOverview(const std::vector<GrowthCurve>& curves);

}  // namespace foci
