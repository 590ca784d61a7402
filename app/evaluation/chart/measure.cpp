#include <tbb/global_control.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "app/evaluation/chart/chart.h"
#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/evaluation_page.h"
#include "app/graphics/image.h"
#include "render/lod/moment_tree.h"
#include "render/methods/quality_level.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

/// All cells of one scene at one blur.
class ChartGroup {
 public:
  ChartGroup(const ChartPlan& plan, const ChartScene& scene, double blur_px,
             const ChartCells& cells, const OnSteps& on_steps)
      : plan_(plan),
        scene_(scene),
        blur_px_(blur_px),
        cells_(cells),
        on_steps_(on_steps),
        key_(plan.key(scene, blur_px)) {
    for (const EvaluatedMethod& method : scene.methods) {
      auto cell = cells.load(nameOf(method), keyOf(method));
      const std::string image = imageFile(scene.id, blur_px, method);
      if (cell && cells.hasImage(image) && cells.hasImage(differenceFileOf(image)))
        found_[method.spec()] = *cell;
    }
    reference_ = cells.loadReferenceFigures(referenceName(), key_);
  }

  /// True if every cell is measured: then the scene need not be made.
  bool isComplete() const {
    return reference_ && std::ranges::all_of(scene_.methods, [&](const EvaluatedMethod& one) {
             return isDone(one);
           });
  }

  /// The reference renders `seen`, every surfel, so that it does not depend on the tree's order.
  /// @param shared  its scene; surfels in the order of the tree that all methods share
  void measure(const SceneInView& seen, const Scene& shared) {
    shared_ = &shared;
    aperture_m_ = blur_px_ / seen.largestBlurThrough_px(1.0);
    measureErrors(seen);
    for (const unsigned threads : plan_.threads) measureTimes(seen, threads);
  }

  void addTo(Measured<ChartPoint>& result) const {
    for (const EvaluatedMethod& method : scene_.methods) {
      const ChartCell& cell = found_.at(method.spec());
      for (const unsigned threads : plan_.threads) {
        const std::vector<double>& ms = cell.ms.at(threads);
        ChartPoint& point = result.rows.emplace_back(ChartPoint{cell.errors});
        point.scene = scene_.id;
        point.blur_px = blur_px_;
        point.method = method;
        point.threads = threads;
        point.ms_median = median(ms);
        point.ms_min = *std::ranges::min_element(ms);
        point.reference_psnr_dB = reference_->split_half_psnr_dB;
      }
    }
  }

  bool isDone(const EvaluatedMethod& method) const {
    const auto found = found_.find(method.spec());
    return found != found_.end() && std::ranges::all_of(plan_.threads, [&](unsigned threads) {
             return runsMissing(found->second, threads) == 0;
           });
  }

 private:
  std::string nameOf(const EvaluatedMethod& method) const {
    return stemOf(imageFile(scene_.id, blur_px_, method));
  }
  std::string keyOf(const EvaluatedMethod& method) const { return key_ + method.spec(); }
  std::string referenceName() const { return stemOf(referenceFile(scene_.id, blur_px_)); }
  static std::string stemOf(const std::string& image) { return fs::path(image).stem().string(); }

  int runsMissing(const ChartCell& cell, unsigned threads) const {
    const double runs = plan_.timing_ms / cell.first_ms;
    const int wanted = static_cast<int>(std::clamp(runs, 1.0, double{1.0 * plan_.max_runs}));
    const auto ms = cell.ms.find(threads);
    const auto had = ms == cell.ms.end() ? 0 : static_cast<int>(ms->second.size());
    return std::max(0, wanted - had);
  }

  /// Renders the reference, and the first frame of each method that has no cell yet.
  void measureErrors(const SceneInView& seen) {
    const RenderSettings settings = seen.settingsThrough(aperture_m_);
    const bool missing = std::ranges::any_of(
        scene_.methods, [&](const auto& m) { return !found_.contains(m.spec()); });
    auto reference = cells_.loadReference(referenceName(), key_);
    if (missing && !reference) reference = renderReference(seen, settings);
    on_steps_(1);

    Compared compared;
    if (missing) {
      Frame pinhole;
      RenderSettings sharp = seen.settings;
      sharp.depth = true;
      makeMethod("pinhole", *shared_)->render(seen.view, sharp, pinhole);
      compared = comparedWith(reference->frame, pinhole, settings.defocus);
    }
    for (const EvaluatedMethod& method : scene_.methods) {
      if (!found_.contains(method.spec())) measureFirstFrame(method, seen, settings, compared);
      on_steps_(1);
    }
  }

  ChartReference renderReference(const SceneInView& seen, const RenderSettings& settings) {
    ChartReference reference{.views = plan_.views(blur_px_)};
    reference.split_half_psnr_dB = makeMethod(plan_.reference(scene_, blur_px_), seen.scene)
                                       ->render(seen.view, settings, reference.frame)
                                       .split_half_psnr_dB.value();
    cells_.writeImage(referenceFile(scene_.id, blur_px_), imageOf(reference.frame));
    cells_.storeReference(referenceName(), key_, reference);
    reference_ = cells_.loadReferenceFigures(referenceName(), key_);
    return reference;
  }

  void measureFirstFrame(const EvaluatedMethod& method, const SceneInView& seen,
                         const RenderSettings& settings, const Compared& compared) {
    Frame frame;
    RenderSettings checked = settings;
    checked.quality.check = ErrorCheck::at_once;
    if (choosesQuality(method.spec())) methodOf(method).pass(seen.view, checked);
    const RenderStats stats = methodOf(method).render(seen.view, settings, frame);
    ChartCell cell{.errors = scoresOf(frame, compared), .first_ms = stats.ms};
    cell.errors.expected_error = stats.tolerance_error;
    cell.errors.tolerance_met = stats.tolerance_met;
    cell.errors.quality_level = stats.quality_level;
    if (stats.ms > kSlowFirst * plan_.timing_ms) cell.ms[plan_.threads.back()] = {stats.ms};
    cells_.writeImages(imageFile(scene_.id, blur_px_, method), frame, *compared.reference);
    cells_.store(nameOf(method), keyOf(method), cell);
    found_[method.spec()] = cell;
  }

  /// Times every method that has runs left; the methods take turns.
  void measureTimes(const SceneInView& seen, unsigned threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Frame frame;
    std::vector<TimedRun> runs;
    for (const EvaluatedMethod& method : scene_.methods) {
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
                     methodOf(method)
                         .render(seen.view, seen.settingsThrough(aperture_m_ * (1.0 - off)), frame)
                         .ms);
                 cells_.store(nameOf(method), keyOf(method), cell);
                 if (runsMissing(cell, threads) == 0) on_steps_(1);
                 return ms.back();
               },
           .runs = missing});
    }
    runInTurn(runs);
  }

  Method& methodOf(const EvaluatedMethod& method) {
    auto& made = made_[method.spec()];
    if (!made) made = makeMethod(method.spec(), *shared_);
    return *made;
  }

  const ChartPlan& plan_;
  const ChartScene& scene_;
  double blur_px_;
  const ChartCells& cells_;
  const OnSteps& on_steps_;
  std::string key_;
  double aperture_m_ = 0.0;
  std::optional<ChartReference> reference_;  // without its frame
  std::map<std::string, ChartCell> found_;   // by spec
  const Scene* shared_ = nullptr;
  std::map<std::string, std::unique_ptr<Method>> made_;
};

}  // namespace

std::size_t stepsOf(const ChartPlan& plan) {
  std::size_t steps = 0;
  for (const ChartScene& scene : plan.scenes) {
    steps += plan.blurs_px.size() * (1 + scene.methods.size() * (1 + plan.threads.size()));
  }
  return steps;
}

std::vector<fs::path> measuredFiles(const ChartPlan& plan, const fs::path& folder) {
  std::vector<fs::path> files;
  const auto add = [&](const std::string& image) {
    files.push_back(folder / image);
    files.push_back(folder / "cells" / fs::path(image).stem().concat(".json"));
  };
  for (const ChartScene& scene : plan.scenes) {
    for (const double blur_px : plan.blurs_px) {
      const std::string reference = referenceFile(scene.id, blur_px);
      add(reference);
      files.push_back(folder / "cells" / fs::path(reference).stem().concat(".rgba"));
      for (const EvaluatedMethod& method : scene.methods) {
        add(imageFile(scene.id, blur_px, method));
        files.push_back(folder / differenceFileOf(imageFile(scene.id, blur_px, method)));
      }
    }
  }
  return files;
}

Measured<ChartPoint> measureChart(const ChartPlan& plan, const ChartCells& cells,
                                  const OnSteps& on_steps) {
  Measured<ChartPoint> result;
  for (const ChartScene& scene : plan.scenes) {
    std::optional<SceneInView> seen;
    std::optional<Scene> sorted;
    if (!scene.input.empty()) {  // its warnings stand on the page, also if all cells are kept
      seen = scene.make();
      result.warnings = seen->warnings;
    }
    for (const double blur_px : plan.blurs_px) {
      ChartGroup group(plan, scene, blur_px, cells, on_steps);
      const auto done = static_cast<std::size_t>(
          std::ranges::count_if(scene.methods, [&](const auto& one) { return group.isDone(one); }));
      result.kept += done;
      result.computed += scene.methods.size() - done;
      if (group.isComplete()) {
        on_steps(1 + scene.methods.size() * (1 + plan.threads.size()));
      } else {
        if (!seen) seen = scene.make();
        if (!sorted) sorted = withSurfelTree(seen->scene);
        group.measure(*seen, sorted ? *sorted : seen->scene);
      }
      group.addTo(result);
    }
  }
  return result;
}

}  // namespace foci
