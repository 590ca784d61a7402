#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/reproduce/reproduce.h"
#include "base/text.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"

namespace foci {
namespace {

const std::vector<std::string> kReproduceMethods = {"paper", "paper-lod", "sweep", kOurs,
                                                    "accumulate:200"};
constexpr std::size_t kAccumulated = 200;

bool accumulates(const std::string& method) { return method.starts_with("accumulate"); }

std::size_t framesOf(const std::string& method) { return accumulates(method) ? kAccumulated : 1; }

/// Without blur, the views of `accumulate` are equal: nothing to measure.
bool isMeasured(const std::string& method, std::size_t aperture) {
  return aperture > 0 || !accumulates(method);
}

int runsOf(const std::string& method, const ReproduceEffort& effort) {
  return accumulates(method) ? effort.accumulate_runs : effort.runs;
}

}  // namespace

int referenceViews(const ReproduceScene& scene, std::size_t aperture,
                   const ReproduceEffort& effort) {
  if (aperture == 0) return 1;
  const double radius_px = scene.largestBlur_px(aperture);
  const double views = std::ceil(std::numbers::pi * radius_px * radius_px);
  return static_cast<int>(
      std::clamp(views, double{1.0 * effort.min_views}, double{1.0 * effort.max_views}));
}

std::size_t framesToMeasure(const ReproduceScene& scene, const ReproduceEffort& effort,
                            const std::vector<unsigned>& threads) {
  std::size_t frames = 0;
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    frames += static_cast<std::size_t>(referenceViews(scene, aperture, effort));
    for (const std::string& method : kReproduceMethods) {
      if (!isMeasured(method, aperture)) continue;
      const std::size_t runs = static_cast<std::size_t>(runsOf(method, effort)) * threads.size();
      frames += (1 + runs) * framesOf(method);
    }
  }
  return frames;
}

namespace {

using MethodsByName = std::map<std::string, std::unique_ptr<Method>>;
using OnFrames = std::function<void(std::size_t)>;

ReproduceReference renderReference(const ReproduceScene& scene, std::size_t aperture,
                                   const ReproduceEffort& effort, const OnFrames& on_frames) {
  ReproduceReference reference{
      .views = referenceViews(scene, aperture, effort), .split_half_psnr_dB = {}, .frame = {}};
  reference.split_half_psnr_dB =
      makeMethod("accumulate:" + std::to_string(reference.views), scene.scene)
          ->render(scene.view, scene.settingsAt(aperture), reference.frame)
          .split_half_psnr_dB;
  on_frames(static_cast<std::size_t>(reference.views));
  return reference;
}

/// Renders each method once at each aperture and compares its frame with the reference. Fills the
/// result's references and frames.
/// @return rows without times
std::vector<ReproduceRow> measureErrors(const ReproduceScene& scene, const ReproduceEffort& effort,
                                        const MethodsByName& methods, const OnFrames& on_frames,
                                        SceneResult& result) {
  Frame pinhole;
  RenderSettings sharp = scene.settingsAt(0);
  sharp.depth = true;
  makeMethod("sweep", scene.scene)->render(scene.view, sharp, pinhole);

  std::vector<ReproduceRow> rows;
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    const RenderSettings settings = scene.settingsAt(aperture);
    const double blur_px_max = scene.largestBlur_px(aperture);
    ReproduceReference& reference = result.reference[aperture];
    reference = renderReference(scene, aperture, effort, on_frames);
    const auto band = silhouetteBand(pinhole, settings.defocus);
    for (const auto& [name, method] : methods) {
      if (!isMeasured(name, aperture)) continue;
      Frame frame;
      const RenderStats stats = method->render(scene.view, settings, frame);
      rows.push_back({.scene = scene.name,
                      .aperture = aperture,
                      .aperture_m = scene.apertures_m[aperture],
                      .blur_px_max = blur_px_max,
                      .method = name,
                      .lod = name.find("-lod") != std::string::npos,
                      .kfragments = static_cast<double>(stats.fragments) / 1000.0,
                      .points = stats.splats / framesOf(name),
                      .psnr_dB = psnr_dB(frame, reference.frame),
                      .ssim = ssim(frame, reference.frame),
                      .silhouette_psnr_dB = silhouettePsnr_dB(frame, reference.frame, band)});
      on_frames(framesOf(name));
      if (!accumulates(name)) result.frames[name][aperture] = std::move(frame);
    }
  }
  return rows;
}

/// Times all rows, which take turns, and adds them to the result.
void measureTimes(const ReproduceScene& scene, const ReproduceEffort& effort,
                  const std::vector<ReproduceRow>& rows, unsigned threads,
                  const MethodsByName& methods, const OnFrames& on_frames, SceneResult& result) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  Frame frame;
  std::vector<TimedRun> runs;
  runs.reserve(rows.size());
  for (const ReproduceRow& row : rows) {
    runs.push_back({.run_ms =
                        [&, method = methods.at(row.method).get()] {
                          const double ms =
                              method->render(scene.view, scene.settingsAt(row.aperture), frame).ms;
                          on_frames(framesOf(row.method));
                          return ms;
                        },
                    .runs = runsOf(row.method, effort)});
  }
  runInTurn(runs);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ReproduceRow row = rows[i];
    row.threads = threads;
    row.ms_median = median(runs[i].ms);
    row.ms_min = *std::min_element(runs[i].ms.begin(), runs[i].ms.end());
    result.rows.push_back(std::move(row));
  }
}

/// Sorts rows by aperture, then method, then threads: the order of the page's table.
void sortRows(std::vector<ReproduceRow>& rows) {
  const auto placeOf = [&](const ReproduceRow& row) {
    return std::tuple(row.aperture, std::ranges::find(kReproduceMethods, row.method), row.threads);
  };
  std::ranges::stable_sort(
      rows, [&](const ReproduceRow& a, const ReproduceRow& b) { return placeOf(a) < placeOf(b); });
}

}  // namespace

SceneResult measureScene(const ReproduceScene& scene, const ReproduceEffort& effort,
                         const std::vector<unsigned>& threads, const OnFrames& on_frames) {
  SceneResult result;
  MethodsByName methods;
  for (const std::string& method : kReproduceMethods) {
    methods[method] = makeMethod(method, scene.scene);
  }
  const auto rows = measureErrors(scene, effort, methods, on_frames, result);
  for (const unsigned count : threads) {
    measureTimes(scene, effort, rows, count, methods, on_frames, result);
  }
  sortRows(result.rows);
  return result;
}

std::string csvOf(const std::vector<ReproduceRow>& rows) {
  std::string csv =
      "scene,aperture,blur_px_max,method,lod,kfragments,points,ms_median,ms_min,threads,psnr_dB,"
      "ssim,silhouette_psnr_dB\n";
  for (const ReproduceRow& row : rows) {
    const auto& silhouette_dB = row.silhouette_psnr_dB;
    csv += rowOf<','>(csvField(row.scene), decimal(row.aperture_m, 6), decimal(row.blur_px_max, 3),
                      row.method, row.lod ? "yes" : "no", decimal(row.kfragments, 3), row.points,
                      decimal(row.ms_median, 4), decimal(row.ms_min, 4), row.threads,
                      decimalOrInf(row.psnr_dB, 3), decimal(row.ssim, 6),
                      silhouette_dB ? decimalOrInf(*silhouette_dB, 3) : "n/a");
  }
  return csv;
}

}  // namespace foci
