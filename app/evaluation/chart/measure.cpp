#include "app/evaluation/chart/measure.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>

#include "app/evaluation/cells.h"
#include "app/evaluation/frontier.h"
#include "app/evaluation/timed_runs.h"
#include "app/graphics/image.h"
#include "app/platform/output_folder.h"
#include "app/record/tables.h"
#include "base/file.h"
#include "base/quantile.h"
#include "base/text.h"
#include "render/image/metrics.h"
#include "render/image/visible_difference.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

constexpr double kAperturesApart = 1e-3;

/// A first draw, which finds its buffers cold, is its time only where it takes so many times as
/// long as all runs are to.
constexpr double kSlow = 15.0;

std::string groupName(const std::string& scene, double blur_px) {
  return scene + "_" + decimal(blur_px, 0) + "px_";
}

/// One scene at one blur: all of its cells.
class Group {
 public:
  Group(const ChartPlan& plan, const ChartScene& scene, double blur_px, const fs::path& folder,
        const ChartCells& cells, const std::function<void(std::size_t)>& on_steps)
      : plan_(plan),
        scene_(scene),
        blur_px_(blur_px),
        folder_(folder),
        cells_(cells),
        on_steps_(on_steps),
        key_(scene.id + " " + scene.input + "; " + std::to_string(plan.size_px) + " px; blur " +
             decimal(blur_px, 3) +
             " px; reference accumulate:" + std::to_string(plan.views(blur_px)) + "; ") {
    for (const ChartMethod& method : plan.methods) {
      auto cell = cells.load(nameOf(method), keyOf(method));
      if (cell && haveImages(method)) found_[method.spec()] = *cell;
    }
    reference_ = cells.loadReferenceFigures(referenceName(), key_);
  }

  /// Whether this group wants nothing more, so that its scene need not be made.
  bool isComplete() const {
    return reference_ && std::all_of(plan_.methods.begin(), plan_.methods.end(),
                                     [&](const ChartMethod& one) { return isDone(one); });
  }

  void measure(const SceneInView& seen) {
    aperture_m_ = blur_px_ / seen.largestBlurThrough_px(1.0);
    measureErrors(seen);
    for (const unsigned threads : plan_.threads) measureTimes(seen, threads);
  }

  void addTo(ChartResult& result) const {
    for (const ChartMethod& method : plan_.methods) {
      const ChartCell& cell = found_.at(method.spec());
      for (const unsigned threads : plan_.threads) {
        const std::vector<double>& ms = cell.ms.at(threads);
        result.points.push_back({.scene = scene_.id,
                                 .blur_px = blur_px_,
                                 .method = method,
                                 .threads = threads,
                                 .ms_median = median(ms),
                                 .ms_min = *std::min_element(ms.begin(), ms.end()),
                                 .psnr_dB = cell.psnr_dB,
                                 .ssim = cell.ssim,
                                 .silhouette_psnr_dB = cell.silhouette_psnr_dB,
                                 .coverage_error = cell.coverage_error,
                                 .visible_error = cell.visible_error,
                                 .expected_error = cell.expected_error,
                                 .reference_psnr_dB = reference_->split_half_psnr_dB});
      }
    }
  }

  bool isDone(const ChartMethod& method) const {
    const auto found = found_.find(method.spec());
    return found != found_.end() &&
           std::all_of(plan_.threads.begin(), plan_.threads.end(),
                       [&](unsigned threads) { return runsMissing(found->second, threads) == 0; });
  }

 private:
  std::string nameOf(const ChartMethod& method) const {
    return groupName(scene_.id, blur_px_) + method.fileName();
  }
  std::string keyOf(const ChartMethod& method) const { return key_ + method.spec(); }
  std::string referenceName() const { return groupName(scene_.id, blur_px_) + "reference"; }

  bool haveImages(const ChartMethod& method) const {
    std::error_code ignored;
    return fs::exists(folder_ / imageFile(scene_.id, blur_px_, method), ignored) &&
           fs::exists(folder_ / differenceFile(scene_.id, blur_px_, method), ignored);
  }

  int runsMissing(const ChartCell& cell, unsigned threads) const {
    const double runs = plan_.timing_ms / cell.first_ms;
    const int wanted = static_cast<int>(std::clamp(runs, 1.0, double{1.0 * plan_.max_runs}));
    const auto ms = cell.ms.find(threads);
    const auto had = ms == cell.ms.end() ? 0 : static_cast<int>(ms->second.size());
    return std::max(0, wanted - had);
  }

  void writeImage(const std::string& file, const Image& image) const {
    const auto bytes = pngOf(image);
    replaceFile(folder_ / file, std::string(bytes.begin(), bytes.end()));
  }

  void measureErrors(const SceneInView& seen) {
    const RenderSettings settings = seen.settingsThrough(aperture_m_);
    auto reference = cells_.loadReference(referenceName(), key_);
    const bool missing = std::any_of(plan_.methods.begin(), plan_.methods.end(),
                                     [&](const auto& m) { return !found_.contains(m.spec()); });
    if (missing && !reference) {
      reference.emplace();
      reference->views = plan_.views(blur_px_);
      reference->split_half_psnr_dB =
          makeMethod("accumulate:" + std::to_string(reference->views), seen.cloud)
              ->render(seen.view, settings, reference->frame)
              .split_half_psnr_dB.value();
      writeImage(referenceFile(scene_.id, blur_px_), imageOf(reference->frame));
      cells_.storeReference(referenceName(), key_, *reference);
      reference_ = cells_.loadReferenceFigures(referenceName(), key_);
    }
    on_steps_(1);

    std::vector<std::uint8_t> band;
    if (missing) {
      Frame pinhole;
      RenderSettings sharp = seen.settings;
      sharp.depth = true;
      makeMethod("pinhole", seen.cloud)->render(seen.view, sharp, pinhole);
      band = silhouetteBand(pinhole, settings.defocus);
    }
    for (const ChartMethod& method : plan_.methods) {
      if (!found_.contains(method.spec())) {
        Frame frame;
        const auto& drawn = reference->frame;
        const RenderStats stats = methodOf(method, seen).render(seen.view, settings, frame);
        auto visible = visibleDifference(frame, drawn, kUsualPx_per_deg);
        ChartCell cell{.psnr_dB = psnr_dB(frame, drawn),
                       .ssim = ssim(frame, drawn),
                       .silhouette_psnr_dB = silhouettePsnr_dB(frame, drawn, band),
                       .coverage_error = coverageError(frame, drawn),
                       .visible_error = quantile(visible, 0.95),
                       .expected_error = stats.tolerance_error,
                       .first_ms = stats.ms};
        if (stats.ms > kSlow * plan_.timing_ms) cell.ms[plan_.threads.back()] = {stats.ms};
        writeImage(imageFile(scene_.id, blur_px_, method), imageOf(frame));
        writeImage(differenceFile(scene_.id, blur_px_, method),
                   differenceOf(frame, drawn, kDifferenceGain));
        cells_.store(nameOf(method), keyOf(method), cell);
        found_[method.spec()] = cell;
      }
      on_steps_(1);
    }
  }

  void measureTimes(const SceneInView& seen, unsigned threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Frame frame;
    std::vector<TimedRun> runs;
    for (const ChartMethod& method : plan_.methods) {
      ChartCell& cell = found_[method.spec()];
      const int missing = runsMissing(cell, threads);
      if (missing == 0) {
        on_steps_(1);
        continue;
      }
      runs.push_back(
          {.run_ms =
               [&, this] {
                 std::vector<double>& ms = cell.ms[threads];
                 const double off = ms.size() % 2 == 0 ? kAperturesApart : 0.0;
                 ms.push_back(
                     methodOf(method, seen)
                         .render(seen.view, seen.settingsThrough(aperture_m_ * (1.0 + off)), frame)
                         .ms);
                 cells_.store(nameOf(method), keyOf(method), cell);
                 if (runsMissing(cell, threads) == 0) on_steps_(1);
                 return ms.back();
               },
           .runs = missing});
    }
    runInTurn(runs);
  }

  Method& methodOf(const ChartMethod& method, const SceneInView& seen) {
    auto& made = made_[method.spec()];
    if (!made) made = makeMethod(method.spec(), seen.cloud);
    return *made;
  }

  const ChartPlan& plan_;
  const ChartScene& scene_;
  double blur_px_;
  const fs::path& folder_;
  const ChartCells& cells_;
  const std::function<void(std::size_t)>& on_steps_;
  std::string key_;
  double aperture_m_ = 0.0;
  std::optional<ChartReference> reference_;  // without its frame
  std::map<std::string, ChartCell> found_;   // by spec
  std::map<std::string, std::unique_ptr<Method>> made_;
};

}  // namespace

std::string imageFile(const std::string& scene, double blur_px, const ChartMethod& method) {
  return "images/" + groupName(scene, blur_px) + method.fileName() + ".png";
}

std::string differenceFile(const std::string& scene, double blur_px, const ChartMethod& method) {
  return "images/" + groupName(scene, blur_px) + method.fileName() + "_difference.png";
}

std::string referenceFile(const std::string& scene, double blur_px) {
  return "images/" + groupName(scene, blur_px) + "reference.png";
}

std::size_t stepsOf(const ChartPlan& plan) {
  return plan.scenes.size() * plan.blurs_px.size() *
         (1 + plan.methods.size() * (1 + plan.threads.size()));
}

ChartResult measureChart(const ChartPlan& plan, const fs::path& folder,
                         const std::function<void(std::size_t)>& on_steps) {
  const ChartCells cells(folder / "cells", programKey());
  ChartResult result;
  for (const ChartScene& scene : plan.scenes) {
    std::optional<SceneInView> seen;
    for (const double blur_px : plan.blurs_px) {
      Group group(plan, scene, blur_px, folder, cells, on_steps);
      const auto done = static_cast<std::size_t>(
          std::count_if(plan.methods.begin(), plan.methods.end(),
                        [&](const auto& one) { return group.isDone(one); }));
      result.kept += done;
      result.computed += plan.methods.size() - done;
      if (group.isComplete()) {
        on_steps(1 + plan.methods.size() * (1 + plan.threads.size()));
      } else {
        if (!seen) seen = scene.make();
        fs::create_directories(folder / "cells");
        fs::create_directories(folder / "images");
        group.measure(*seen);
      }
      group.addTo(result);
    }
  }
  markFrontiers(result.points);
  return result;
}

double worthOf_dB(const ChartPoint& point) {
  return std::min(point.psnr_dB, point.reference_psnr_dB);
}

void markFrontiers(std::vector<ChartPoint>& points) {
  std::map<std::tuple<std::string, double, unsigned>, std::vector<ChartPoint*>> panels;
  for (ChartPoint& one : points) panels[{one.scene, one.blur_px, one.threads}].push_back(&one);
  for (auto& [panel, members] : panels) {
    std::vector<double> ms, dB;
    for (const ChartPoint* one : members) {
      ms.push_back(one->ms_median);
      dB.push_back(worthOf_dB(*one));
    }
    const std::vector<bool> on = paretoFrontier(ms, dB);
    for (std::size_t i = 0; i < members.size(); ++i) members[i]->on_frontier = on[i];
  }
}

std::string csvOf(const std::vector<ChartPoint>& points) {
  std::string csv =
      "scene,blur_px,method,setting,threads,ms_median,ms_min,psnr_dB,ssim,silhouette_psnr_dB,"
      "coverage_error,reference_psnr_dB,on_frontier,visible_error,expected_error\n";
  for (const ChartPoint& one : points) {
    const auto& silhouette = one.silhouette_psnr_dB;
    csv += one.scene + ',' + decimal(one.blur_px, 0) + ',' + one.method.name + ',' +
           (one.method.setting ? std::to_string(*one.method.setting) : "n/a") + ',' +
           std::to_string(one.threads) + ',' + decimal(one.ms_median, 4) + ',' +
           decimal(one.ms_min, 4) + ',' + decimalOrInf(one.psnr_dB, 3) + ',' +
           decimal(one.ssim, 6) + ',' + (silhouette ? decimalOrInf(*silhouette, 3) : "n/a") + ',' +
           decimal(one.coverage_error, 6) + ',' + decimalOrInf(one.reference_psnr_dB, 3) + ',' +
           (one.on_frontier ? "yes" : "no") + ',' + decimal(one.visible_error, 3) + ',' +
           (one.expected_error ? decimal(*one.expected_error, 3) : "n/a") + '\n';
  }
  return csv;
}

}  // namespace foci
