// How time and memory grow while one size grows: of the gallery and, for blur, of the paper's
// plane; of surfels, and of Gaussians on these.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/evaluated_methods.h"
#include "app/graphics/drawing.h"
#include "render/methods/quality_level.h"

namespace foci {

/// Surfels or Gaussians, pixels, blur radius in pixels, N of the method, threads.
enum class GrowthAxis : std::uint8_t { splats, pixels, blur, views, threads };
const char* nameOf(GrowthAxis axis);

/// To make a scene's level of detail: stands among the methods.
inline constexpr const char* kPrepare = "prepare";

/// A method at one size.
struct GrowthPoint {
  GrowthAxis axis = GrowthAxis::splats;
  double size = 0.0;
  bool gaussians = false;
  std::string method = {};
  double splats = 0.0, pixels = 0.0, blur_px = 0.0;
  unsigned threads = 1;

  double ms = 0.0, cpu_ms = 0.0;  ///< of a frame, medians
  double memory_GB = 0.0;         ///< peak of the process
  std::optional<QualityLevel> quality_level = {};

  /// CPU time, which other programs disturb least; over threads, wall time. For logarithms at least
  /// 1 us, as a coarse clock may show none.
  double time_ms() const { return std::max(axis == GrowthAxis::threads ? ms : cpu_ms, 1e-3); }
  /// For logarithms at least 1 MB, as not all systems state it.
  double leastMemory_GB() const { return std::max(memory_GB, 1e-3); }
};

struct GrowthPlan {
  bool quick = false;
  double timing_ms = 0.0;                ///< CPU time for the frames of a point
  std::vector<GrowthPoint> points = {};  ///< to measure
};
inline std::size_t stepsOf(const GrowthPlan& plan) { return plan.points.size(); }

/// @param width_px   of images, 640 unless pixels grow. Splats go with the pixels
/// @param memory_GB  that scenes may take
/// @throws InputError if that is too little
GrowthPlan planGrowth(bool quick, int width_px, double memory_GB, unsigned threads);

/// Slopes of log cost over log size.
struct GrowthFit {
  struct Bend {
    double at, before, after;
  };
  double exponent = 0.0;  ///< of the line through all points
  std::optional<Bend> bend = {};
};

/// Lines by least squares. The bend is the inner point where two lines meet that fit best, if there
/// are at least four points and the slopes differ by more than kMinBend.
/// @param curve  (size, cost) by size, costs > 0; points of size 0 are left out. At least two sizes
///               are left (asserted)
GrowthFit fitGrowth(const std::vector<glm::dvec2>& curve);
inline constexpr double kMinBend = 0.25;  // noise bends lines by 0.1 to 0.2

/// "0.45; 0.91 up to 3.1, then 0.04". @param unit  of the size in the text
std::string growthText(const GrowthFit& fit, double unit);

/// The cost at a size, on lines through neighbours in log cost over log size, and beyond the ends.
/// @param curve  as above, without size 0
double costAt(const std::vector<glm::dvec2>& curve, double size);

/// A method while one size grows.
struct GrowthCurve {
  std::string method = {};               ///< without N where N grows
  std::vector<GrowthPoint> points = {};  ///< by size
  GrowthFit time = {}, memory = {};
};

/// "auto over splats, surfels".
std::string nameOf(const GrowthCurve& curve);

/// The curves of at least two sizes.
std::vector<GrowthCurve> curvesOf(const std::vector<GrowthPoint>& points);

/// No run continues an earlier one.
Measured<GrowthCurve> measureGrowth(const GrowthPlan& plan, const OnSteps& on_steps);

/// growth.csv.
std::string csvOf(const std::vector<GrowthCurve>& curves);

// growth.html, and its panels in one image.

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
