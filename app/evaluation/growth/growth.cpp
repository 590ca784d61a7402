#include "app/evaluation/growth/growth.h"

#include <tbb/global_control.h>

#include <cassert>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "app/evaluation/scene_in_view.h"
#include "app/platform/machine.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/lod/moment_tree.h"
#include "render/scene/gaussian_tree.h"
#include "render/scene/scene.h"

namespace foci {
namespace {

constexpr double kGalleryAtStep1 = 1.94e6;  // surfels of `makeGallery(1)`
constexpr double kBytesPerSplat = 300.0;    // of all methods at most
constexpr double kAspect = 9.0 / 16.0;
constexpr std::size_t kMaxRuns = 7;

/// Sizes in images 640 px wide. Chosen by eye, within the time that `foci chart --help` states.
struct GrowthSizes {
  double base_splats;
  std::vector<double> splats, pixels, blurs_px, views;
};
const GrowthSizes kFullGrowth{1e6,
                              {1e5, 3e5, 1e6, 3e6, 1e7, 3e7},
                              {1e5, 2.304e5, 9.216e5, 3.6864e6, 8.2944e6},
                              {0.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0},
                              {1.0, 4.0, 16.0, 64.0}};
const GrowthSizes kQuickGrowth{
    3e5, {1e5, 3e5, 1e6}, {1e5, 9.216e5, 2.0736e6}, {0.0, 4.0, 16.0, 128.0}, {1.0, 4.0, 16.0}};

struct Spent {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  std::clock_t cpu_start = std::clock();

  void addTo(std::vector<double>& ms, std::vector<double>& cpu_ms) const {
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    ms.push_back(took.count());
    cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
  }
};

/// A scene with its level of detail, and the cost of that.
struct GrownScene {
  GrowthPoint prepared;
  SceneInView seen;
  double blur_per_aperture;  // px for an aperture of 1 m

  explicit GrownScene(const GrowthPoint& point)
      : prepared(point),
        seen(point.axis == GrowthAxis::blur
                 ? planeInView(static_cast<int>(std::lround(std::sqrt(point.splats))),
                               static_cast<int>(std::lround(std::sqrt(point.pixels))))
                 : galleryInView(static_cast<int>(std::lround(std::sqrt(point.pixels / kAspect))),
                                 static_cast<float>(std::sqrt(kGalleryAtStep1 / point.splats)))),
        blur_per_aperture(seen.largestBlurThrough_px(1.0)) {
    forgetPeakMemory();
    std::vector<double> ms, cpu_ms;
    const Spent spent;
    auto surfels = std::get<SurfelCloud>(std::move(seen.scene.splats));
    prepared.splats = static_cast<double>(surfels.size());
    if (point.gaussians) {
      seen.scene = {withTree(gaussiansOf(surfels))};
    } else {
      seen.scene = {withTree(surfels)};
    }
    spent.addTo(ms, cpu_ms);
    prepared.ms = ms[0];
    prepared.cpu_ms = cpu_ms[0];
    prepared.memory_GB = peakMemory_GB();
  }
};

/// Renders as `measureChart` does: `auto` has compared its levels, no frame can be reused, and the
/// first frame does not count unless it is slow.
void measureFrames(GrowthPoint& point, const GrownScene& scene, double timing_ms) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, point.threads);
  const double aperture_m = point.blur_px / scene.blur_per_aperture;
  forgetPeakMemory();
  const auto method = makeMethod(point.method, scene.seen.scene);
  if (choosesQuality(point.method)) {
    RenderSettings checked = scene.seen.settingsThrough(aperture_m);
    checked.quality.check = ErrorCheck::at_once;
    method->pass(scene.seen.view, checked);
  }
  Frame frame;
  std::vector<double> ms, cpu_ms;
  double left_ms = kSlowFirst * timing_ms;
  while (left_ms > 0.0 && ms.size() <= kMaxRuns) {
    const double off = ms.size() % 2 == 0 ? 0.0 : kAperturesApart;
    const RenderSettings settings = scene.seen.settingsThrough(aperture_m * (1.0 - off));
    const Spent spent;
    point.quality_level = method->render(scene.seen.view, settings, frame).quality_level;
    spent.addTo(ms, cpu_ms);
    left_ms = ms.size() == 1 && cpu_ms[0] < left_ms ? timing_ms : left_ms - cpu_ms.back();
  }
  const auto first = ms.size() > 1 ? 1 : 0;
  point.ms = median({ms.begin() + first, ms.end()});
  point.cpu_ms = median({cpu_ms.begin() + first, cpu_ms.end()});
  point.memory_GB = peakMemory_GB();
}

struct FittedLine {
  double slope, residual;  ///< the residual is a sum of squares
};

FittedLine lineThrough(std::span<const glm::dvec2> points) {
  glm::dvec2 mean(0.0);
  for (const glm::dvec2& one : points) mean += one / static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const glm::dvec2& one : points) {
    const glm::dvec2 d = one - mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  assert(xx > 0.0);
  return {xy / xx, yy - xy * xy / xx};
}

}  // namespace

const char* nameOf(GrowthAxis axis) {
  constexpr const char* kNames[] = {"splats", "pixels", "blur", "views", "threads"};
  return kNames[static_cast<std::size_t>(axis)];
}

GrowthPlan planGrowth(bool quick, int width_px, double memory_GB, unsigned threads) {
  const GrowthSizes& sizes = quick ? kQuickGrowth : kFullGrowth;
  const double scale = std::pow(width_px / 640.0, 2.0);
  std::vector<double> threads_up;
  for (unsigned n = 1; n < threads; n *= 2) threads_up.push_back(n);
  threads_up.push_back(threads);
  const std::vector<std::pair<GrowthAxis, std::vector<double>>> axes{
      {GrowthAxis::splats, sizes.splats},
      {GrowthAxis::views, sizes.views},
      {GrowthAxis::threads, threads_up},
      {GrowthAxis::pixels, sizes.pixels},
      {GrowthAxis::blur, sizes.blurs_px}};
  GrowthPlan plan{.quick = quick, .timing_ms = scale * (quick ? 60.0 : 500.0)};
  for (const bool gaussians : {false, true}) {
    for (const auto& [axis, values] : axes) {
      for (const double value : values) {
        const auto at = [&, axis = axis](GrowthAxis of, double base) {
          return axis == of ? value : base;
        };
        GrowthPoint point{.axis = axis,
                          .size = value,
                          .gaussians = gaussians,
                          .splats = scale * at(GrowthAxis::splats, sizes.base_splats),
                          .pixels = scale * at(GrowthAxis::pixels, 640.0 * 640.0 * kAspect),
                          .blur_px = at(GrowthAxis::blur, 16.0),
                          .threads = static_cast<unsigned>(at(GrowthAxis::threads, threads))};
        if (point.splats * kBytesPerSplat > 1e9 * memory_GB) break;
        std::vector<std::string> methods{"auto", "sweep-lod:7", "accumulate:16"};
        if (!gaussians) methods.emplace_back("paper-lod");
        if (axis == GrowthAxis::splats) methods.emplace_back(kPrepare);
        if (axis == GrowthAxis::views) {
          const std::string n = ":" + decimal(value, 0);
          methods = {"sweep-lod" + n, "accumulate" + n};
        }
        for (const std::string& method : methods) {
          point.method = method;
          plan.points.push_back(point);
        }
      }
    }
  }
  const auto of_pixels = std::ranges::count(plan.points, GrowthAxis::pixels, &GrowthPoint::axis);
  if (of_pixels == 0) {
    throw InputError("--growth",
                     "half of the free memory, " + decimal(memory_GB, 1) +
                         " GB, does not hold its scenes: use --quick or a smaller --size");
  }
  return plan;
}

Measured<GrowthCurve> measureGrowth(const GrowthPlan& plan, const OnSteps& on_steps) {
  std::optional<GrownScene> scene;
  const auto sceneOf = [](const GrowthPoint& one) {
    return std::tuple(one.axis == GrowthAxis::blur, one.gaussians, one.splats, one.pixels);
  };
  const GrowthPoint* of = nullptr;
  std::vector<GrowthPoint> measured;
  for (const GrowthPoint& point : plan.points) {
    if (!of || sceneOf(*of) != sceneOf(point)) {
      scene.reset();
      scene.emplace(point);
      of = &point;
    }
    GrowthPoint& one = measured.emplace_back(point.method == kPrepare ? scene->prepared : point);
    one.method = point.method;
    one.splats = scene->prepared.splats;
    one.pixels = double{1.0 * scene->seen.view.size_px.x} * scene->seen.view.size_px.y;
    if (one.axis == GrowthAxis::splats) one.size = one.splats;
    if (one.axis == GrowthAxis::pixels) one.size = one.pixels;
    if (one.method != kPrepare) measureFrames(one, *scene, plan.timing_ms);
    on_steps(1);
  }
  return {.rows = curvesOf(measured), .computed = measured.size()};
}

std::vector<GrowthCurve> curvesOf(const std::vector<GrowthPoint>& points) {
  std::vector<GrowthCurve> curves;
  for (const GrowthPoint& point : points) {
    const bool views = point.axis == GrowthAxis::views;
    const std::string method =
        point.method.substr(0, views ? point.method.find(':') : std::string::npos);
    auto found = std::ranges::find_if(curves, [&](const GrowthCurve& one) {
      const GrowthPoint& other = one.points.front();
      return one.method == method && other.axis == point.axis && other.gaussians == point.gaussians;
    });
    if (found == curves.end()) found = curves.insert(found, {.method = method});
    found->points.push_back(point);
  }
  std::erase_if(curves, [](const GrowthCurve& one) { return one.points.size() < 2; });
  for (GrowthCurve& curve : curves) {
    std::vector<glm::dvec2> time, memory;
    for (const GrowthPoint& point : curve.points) {
      time.emplace_back(point.size, point.time_ms());
      memory.emplace_back(point.size, point.leastMemory_GB());
    }
    curve.time = fitGrowth(time);
    curve.memory = fitGrowth(memory);
  }
  return curves;
}

GrowthFit fitGrowth(const std::vector<glm::dvec2>& curve) {
  std::vector<glm::dvec2> logs;
  for (const glm::dvec2& one : curve) {
    if (one.x > 0.0) logs.push_back(glm::log(one));
  }
  const std::span<const glm::dvec2> all(logs);
  GrowthFit fit{.exponent = lineThrough(all).slope};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; all.size() >= 4 && k + 1 < all.size(); ++k) {
    const FittedLine before = lineThrough(all.first(k + 1)), after = lineThrough(all.subspan(k));
    if (before.residual + after.residual >= least) continue;
    least = before.residual + after.residual;
    fit.bend = {.at = std::exp(all[k].x), .before = before.slope, .after = after.slope};
  }
  if (fit.bend && std::abs(fit.bend->after - fit.bend->before) <= kMinBend) fit.bend.reset();
  return fit;
}

std::string growthText(const GrowthFit& fit, double unit) {
  std::string text = decimal(fit.exponent, 2);
  if (fit.bend) {
    text += "; " + decimal(fit.bend->before, 2) + " up to " + significant(fit.bend->at / unit, 2) +
            ", then " + decimal(fit.bend->after, 2);
  }
  return text;
}

double costAt(const std::vector<glm::dvec2>& curve, double size) {
  std::size_t end = 1;
  while (end + 1 < curve.size() && curve[end].x < size) ++end;
  const glm::dvec2 from = glm::log(curve[end - 1]), to = glm::log(curve[end]);
  return std::exp(glm::mix(from.y, to.y, (std::log(size) - from.x) / (to.x - from.x)));
}

std::string nameOf(const GrowthCurve& curve) {
  const GrowthPoint& point = curve.points.front();
  return curve.method + " over " + nameOf(point.axis) +
         (point.gaussians ? ", Gaussians" : ", surfels");
}

std::string csvOf(const std::vector<GrowthCurve>& curves) {
  std::string csv =
      "axis,size,splats_are,method,splats,pixels,blur_px,threads,ms_median,cpu_ms_median,memory_GB,"
      "quality_level\n";
  for (const GrowthCurve& curve : curves) {
    for (const GrowthPoint& one : curve.points) {
      csv += rowOf<','>(nameOf(one.axis), exactText(one.size),
                        one.gaussians ? "Gaussians" : "surfels", one.method, exactText(one.splats),
                        exactText(one.pixels), exactText(one.blur_px), one.threads,
                        decimal(one.ms, 3), decimal(one.cpu_ms, 3), decimal(one.memory_GB, 3),
                        one.quality_level ? textOf(*one.quality_level) : "n/a");
    }
  }
  return csv;
}

}  // namespace foci
