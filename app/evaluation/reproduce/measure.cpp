#include "app/evaluation/reproduce/measure.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "app/evaluation/timed_runs.h"
#include "app/record/tables.h"
#include "base/text.h"
#include "render/image/metrics.h"
#include "render/methods/method.h"

namespace foci {
namespace {

const std::vector<std::string> kMethods = {"paper", "paper-lod", "sweep", kOurs, "accumulate:200"};
constexpr std::size_t kAccumulated = 200;

bool accumulates(const std::string& method) { return method.starts_with("accumulate"); }

std::size_t framesOf(const std::string& method) { return accumulates(method) ? kAccumulated : 1; }

/// Averaging equal views says nothing.
bool isMeasured(const std::string& method, std::size_t aperture) {
  return aperture > 0 || !accumulates(method);
}

int runsOf(const std::string& method, const ReproduceEffort& effort) {
  return accumulates(method) ? effort.accumulate_runs : effort.runs;
}

/// A field of a CSV file (RFC 4180).
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
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
    for (const std::string& method : kMethods) {
      if (!isMeasured(method, aperture)) continue;
      const std::size_t runs = static_cast<std::size_t>(runsOf(method, effort)) * threads.size();
      frames += (1 + runs) * framesOf(method);
    }
  }
  return frames;
}

SceneResult measureScene(const ReproduceScene& scene, const ReproduceEffort& effort,
                         const std::vector<unsigned>& threads,
                         const std::function<void(std::size_t)>& on_frames) {
  SceneResult result;
  Frame pinhole;
  RenderSettings sharp = scene.settingsAt(0);
  sharp.depth = true;
  makeMethod("sweep", scene.cloud)->render(scene.view, sharp, pinhole);

  std::map<std::string, std::unique_ptr<Method>> methods;
  for (const std::string& method : kMethods) {
    methods[method] = makeMethod(method, scene.cloud);
  }

  // Once each for what they draw.
  std::vector<ReproduceRow> drawn;
  for (std::size_t aperture = 0; aperture < kApertures; ++aperture) {
    const RenderSettings settings = scene.settingsAt(aperture);
    const double blur_px_max = scene.largestBlur_px(aperture);
    ReproduceReference& reference = result.reference[aperture];
    reference.views = referenceViews(scene, aperture, effort);
    reference.split_half_psnr_dB =
        makeMethod("accumulate:" + std::to_string(reference.views), scene.cloud)
            ->render(scene.view, settings, reference.frame)
            .split_half_psnr_dB;
    on_frames(static_cast<std::size_t>(reference.views));
    const auto band = silhouetteBand(pinhole, settings.defocus);
    for (const auto& [name, method] : methods) {
      if (!isMeasured(name, aperture)) continue;
      Frame frame;
      const RenderStats stats = method->render(scene.view, settings, frame);
      drawn.push_back({.scene = scene.name,
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

  // In turn for how long they take.
  for (const unsigned count : threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
    Frame frame;
    std::vector<TimedRun> runs;
    runs.reserve(drawn.size());
    for (const ReproduceRow& row : drawn) {
      runs.push_back(
          {.run_ms =
               [&, method = methods[row.method].get()] {
                 const double ms =
                     method->render(scene.view, scene.settingsAt(row.aperture), frame).ms;
                 on_frames(framesOf(row.method));
                 return ms;
               },
           .runs = runsOf(row.method, effort)});
    }
    runInTurn(runs);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      ReproduceRow row = drawn[i];
      row.threads = count;
      row.ms_median = median(runs[i].ms);
      row.ms_min = *std::min_element(runs[i].ms.begin(), runs[i].ms.end());
      result.rows.push_back(std::move(row));
    }
  }

  // As the table lists them.
  const auto placeOf = [&](const ReproduceRow& row) {
    return std::tuple(row.aperture, std::find(kMethods.begin(), kMethods.end(), row.method),
                      row.threads);
  };
  std::stable_sort(
      result.rows.begin(), result.rows.end(),
      [&](const ReproduceRow& a, const ReproduceRow& b) { return placeOf(a) < placeOf(b); });
  return result;
}

std::string csvOf(const std::vector<ReproduceRow>& rows) {
  std::string csv =
      "scene,aperture,blur_px_max,method,lod,kfragments,points,ms_median,ms_min,threads,psnr_dB,"
      "ssim,silhouette_psnr_dB\n";
  for (const ReproduceRow& row : rows) {
    const auto& silhouette = row.silhouette_psnr_dB;
    csv += field(row.scene) + ',' + decimal(row.aperture_m, 6) + ',' + decimal(row.blur_px_max, 3) +
           ',' + row.method + ',' + (row.lod ? "yes" : "no") + ',' + decimal(row.kfragments, 3) +
           ',' + std::to_string(row.points) + ',' + decimal(row.ms_median, 4) + ',' +
           decimal(row.ms_min, 4) + ',' + std::to_string(row.threads) + ',' +
           decimalOrInf(row.psnr_dB, 3) + ',' + decimal(row.ssim, 6) + ',' +
           (silhouette ? decimalOrInf(*silhouette, 3) : "n/a") + '\n';
  }
  return csv;
}

}  // namespace foci
