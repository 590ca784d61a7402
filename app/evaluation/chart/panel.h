// Time against accuracy: one scene at one blur and number of threads, every method a point.
#pragma once

#include <string>
#include <vector>

#include "app/evaluation/chart/measure.h"
#include "app/graphics/plot.h"
#include "app/platform/machine.h"

namespace foci {

/// What accuracy is.
enum class ChartMeasure {
  psnr,        ///< of the whole image
  silhouette,  ///< of the pixels that a step in depth blurs into
};

/// A kind of method, which has a colour.
struct ChartFamily {
  std::string name;
  std::string color;
};

const ChartFamily& familyOf(const std::string& method);
const std::vector<ChartFamily>& chartFamilies();

/// @param points  of one panel: one scene, blur and number of threads; some with that measure. The
///                frontier is drawn of what is shown: of silhouettes, of theirs.
Plot panelOf(const std::vector<ChartPoint>& points, ChartMeasure measure, const std::string& title);

/// Those of one scene, blur and number of threads.
std::vector<ChartPoint> pointsOf(const std::vector<ChartPoint>& points, const std::string& scene,
                                 double blur_px, unsigned threads);

/// One image of all scenes at one blur, with the machine's name, for a page that cannot be
/// clicked.
Drawing overviewOf(const ChartPlan& plan, const std::vector<ChartPoint>& points, double blur_px,
                   const Machine& machine);

}  // namespace foci
