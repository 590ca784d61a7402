#include "app/evaluation/chart/motion.h"

#include <algorithm>
#include <cmath>
#include <list>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/evaluation_page.h"
#include "app/evaluation/excess_change.h"
#include "app/graphics/image.h"
#include "app/record/tables.h"
#include "app/session/observer_eye.h"
#include "base/text.h"
#include "render/image/metrics.h"
#include "render/lod/moment_tree.h"
#include "render/methods/method.h"
#include "render/methods/quality_level.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

// Chosen by eye: a quick run takes minutes.
constexpr int kMotionSize_px = 160, kQuickSize_px = 96;
constexpr int kQuickViews = 48, kShortPath = 12;
constexpr float kSampledFor_px = 640.0f;  // width of the images that the scenes are sampled for
constexpr double kBudgetShare = 0.5;      // of the time that `auto` takes without a budget
constexpr int kWarmUp = 8;                // frames, in which `auto` learns how long levels take

/// A scene, with the references that this path and the one before rendered.
struct MotionScene {
  MotionScene(const ChartScene& scene, const MotionPlan& plan)
      : seen(scene.make()),
        sorted(withSurfelTree(seen.scene)),
        aperture_m(plan.blur_px / seen.largestBlurThrough_px(1.0)),
        exact(makeMethod("accumulate:" + std::to_string(plan.views), seen.scene)) {}  // no nodes

  RenderSettings settingsOf(double focus_D, double pupil_mm) const {
    RenderSettings settings = seen.settings;
    settings.defocus = defocusOfLens(aperture_m * pupil_mm / kMaxPupil_mm, seen.view.focal_px,
                                     static_cast<float>(focus_D), settings.defocus.along);
    return settings;
  }

  const FrameInLab& reference(const View& view, const RenderSettings& settings) {
    auto known = std::ranges::find_if(references, [&](const Reference& one) {
      return one.view == view && one.settings == settings;
    });
    if (known == references.end()) {
      Frame frame;
      exact->render(view, settings, frame);
      known = references.insert(known, {view, settings, FrameInLab(std::move(frame))});
    }
    known->paths_ago = 0;
    return known->frame;
  }

  void endPath() {
    references.remove_if([](Reference& one) { return one.paths_ago++ > 0; });
  }

  struct Reference {
    View view;
    RenderSettings settings;
    FrameInLab frame;
    int paths_ago = 0;
  };
  SceneInView seen;
  std::optional<Scene> sorted;  // of surfels, so that all methods share their tree
  double aperture_m;
  std::unique_ptr<Method> exact;
  std::list<Reference> references{};
};

/// Renders steps one after another, as a session does.
class MotionRun {
 public:
  MotionRun(const MotionScene& scene, std::string method, std::optional<double> budget_ms)
      : scene_(scene),
        name_(std::move(method)),
        budget_ms_(budget_ms),
        method_(makeMethod(name_, scene.sorted ? *scene.sorted : scene.seen.scene)) {}

  /// The frames of a step, one for each view.
  const std::vector<Frame>& render(const MotionStep& step) {
    RenderSettings settings = settingsAt(step);
    const bool still = step.views == views_;
    if (still && settings == settings_ && !budget_ms_ && !methodInfo(name_).incremental) {
      return frames_;
    }
    views_ = step.views;
    settings_ = settings;
    frames_.resize(views_.size());
    double ms = 0.0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (still && budget_ms_) method_->prepare(views_[i], settings);
      ms += method_->render(views_[i], settings, frames_[i]).ms;
      settings.quality.keep_level = true;
    }
    ms_.push_back(ms);
    return frames_;
  }

  /// Of the frames that were rendered and not reused.
  const std::vector<double>& ms() const { return ms_; }

 private:
  /// What the method is asked for: `auto` leaves out changes too small to see, and all within a
  /// saccade.
  RenderSettings settingsAt(const MotionStep& step) {
    if (!choosesQuality(name_)) return scene_.settingsOf(step.focus_D, step.pupil_mm);
    if (!eye_) eye_ = {step.focus_D, step.rest_D, step.pupil_mm, step.gaze_px};
    if (!step.in_saccade) {
      eye_->followPupil(step.pupil_mm);
      const RenderSettings now = scene_.settingsOf(step.focus_D, eye_->pupil_mm);
      eye_->followFocus(step.focus_D, step.rest_D,
                        maxUnseenFocusChange_D(now.quality.tolerance, now.defocus.radius_px_per_D));
      const glm::dvec2 size_px(scene_.seen.view.size_px);
      const double px_per_m = kUsualPx_per_deg * 180.0 / std::numbers::pi;  // 1 m away
      eye_->followGaze(step.gaze_px, {scene_.seen.view.size_px, size_px / px_per_m, 1.0});
    }
    RenderSettings settings = scene_.settingsOf(eye_->focus_D, eye_->pupil_mm);
    if (eye_->gaze_px) {
      settings.quality.acuity = acuityAround(glm::vec2(*eye_->gaze_px), float{kUsualPx_per_deg});
    }
    if (budget_ms_) {
      settings.quality.frame_ms =
          static_cast<float>(*budget_ms_ / static_cast<double>(step.views.size()));
    }
    return settings;
  }

  const MotionScene& scene_;
  std::string name_;
  std::optional<double> budget_ms_;
  std::unique_ptr<Method> method_;
  std::optional<RenderedEye> eye_{};
  std::vector<View> views_{};
  RenderSettings settings_{};
  std::vector<Frame> frames_{};
  std::vector<double> ms_{};
};

/// Frames of one eye and the next, or of the left eye and the right one.
struct FramePair {
  const FrameInLab &from, &to, &exact_from, &exact_to;

  Image strip(const std::string& one, const std::string& other) const {
    const Image excess = differenceOf(minus(to.frame, from.frame),
                                      minus(exact_to.frame, exact_from.frame), kDifferenceGain);
    return gridOf({{imageOf(from.frame), imageOf(to.frame), excess}},
                  {one, other, "x " + decimal(kDifferenceGain, 0)});
  }
};

/// Measures every pair that counts.
/// @param worst  the strip of the pair with the largest excess in light
ChartCells::Lists measurePath(MotionScene& scene, MotionRun& run, std::span<const MotionStep> steps,
                              Image& worst) {
  ChartCells::Lists lists;
  std::vector<double>&light = lists["light"], &jnd = lists["jnd"], &frames = lists["frame"];
  const auto warm_up = static_cast<std::ptrdiff_t>(run.ms().size());
  const auto measure = [&](std::size_t frame, const FramePair& pair, const std::string& one,
                           const std::string& other) {
    const ExcessChange excess = excessChange(pair.from, pair.to, pair.exact_from, pair.exact_to);
    if (light.empty() || excess.light > std::ranges::max(light)) worst = pair.strip(one, other);
    light.push_back(excess.light);
    jnd.push_back(excess.jnd);
    frames.push_back(static_cast<double>(frame));
  };
  std::vector<FrameInLab> before;
  std::vector<const FrameInLab*> exact_before;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    std::vector<FrameInLab> now;
    std::vector<const FrameInLab*> exact;
    for (const Frame& frame : run.render(steps[k])) now.emplace_back(frame);
    for (const View& view : steps[k].views) {
      exact.push_back(
          &scene.reference(view, scene.settingsOf(steps[k].focus_D, steps[k].pupil_mm)));
    }
    if (now.size() == 2) {
      measure(k, {now[0], now[1], *exact[0], *exact[1]}, "left", "right");
    } else if (k > 0 && !steps[k - 1].in_saccade && !steps[k].in_saccade) {
      measure(k - 1, {before[0], now[0], *exact_before[0], *exact[0]}, std::to_string(k - 1),
              "next");
    }
    before = std::move(now);
    exact_before = exact;
  }
  lists["ms"].assign(run.ms().begin() + warm_up, run.ms().end());
  return lists;
}

/// The points of a plan without their figures. The budgets of `auto` are not known yet.
std::vector<MotionPoint> pointsWithout(const ChartScene& scene, std::string_view path) {
  std::vector<MotionPoint> points;
  for (const EvaluatedMethod& method : scene.methods) {
    points.push_back({scene.id, std::string(path), method, std::nullopt});
    if (choosesQuality(method.spec())) points.push_back({scene.id, std::string(path), method, 0.0});
  }
  return points;
}

void setFigures(MotionPoint& point, const ChartCells::Lists& lists) {
  const std::vector<double>&light = lists.at("light"), &jnd = lists.at("jnd");
  const auto worst = std::ranges::max_element(light);
  point.worst_frame =
      static_cast<int>(lists.at("frame").at(static_cast<std::size_t>(worst - light.begin())));
  point.light_worst = *worst;
  point.light_median = median(light);
  point.jnd_worst = std::ranges::max(jnd);
  point.jnd_median = median(jnd);
  point.ms_median = median(lists.at("ms"));
  if (point.budget_ms) point.budget_ms = lists.at("budget_ms").at(0);
}

bool isOwn(const EvaluatedMethod& method) {
  return methodInfo(method.spec()).family == MethodFamily::own;
}

/// Frames of the path that are rendered.
std::size_t framesOf(const MotionPlan& plan, const MotionPoint& point) {
  if (point.path == "saccade") return kMotionFrames;  // focus follows after its latency
  return static_cast<std::size_t>(isOwn(point.method) ? plan.frames : plan.other_frames);
}

std::string cellOf(const MotionPoint& point) {
  return point.scene + "_" + point.path + "_" + point.method.fileName() +
         (point.budget_ms ? "_budget" : "");
}

}  // namespace

MotionPlan planMotion(const EvaluationChoice& choice) {
  MotionPlan plan{.quick = choice.quick};
  plan.size_px = choice.size_px.value_or(choice.quick ? kQuickSize_px : kMotionSize_px);
  plan.frames = choice.quick ? kShortPath : kMotionFrames;
  plan.other_frames = kShortPath;
  const double all_views = std::numbers::pi * plan.blur_px * plan.blur_px;  // formulas.md, 7
  plan.views = choice.quick ? kQuickViews : static_cast<int>(std::ceil(all_views));
  plan.scenes = chosenScenes(choice, plan.size_px, SettingRange::quick,
                             kSampledFor_px / static_cast<float>(plan.size_px));
  if (!choice.quick || !choice.methods.empty()) return plan;
  for (ChartScene& scene : plan.scenes) std::erase_if(scene.methods, std::not_fn(isOwn));
  return plan;
}

std::string MotionPoint::by() const {
  return method.spec() + (budget_ms ? ", " + milliseconds(*budget_ms) + " ms" : "");
}

std::string MotionPoint::strip() const { return "images/" + cellOf(*this) + ".png"; }

std::vector<fs::path> measuredFiles(const MotionPlan& plan, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const ChartScene& scene : plan.scenes) {
    for (const std::string_view path : kMotionPaths) {
      for (const MotionPoint& point : pointsWithout(scene, path)) {
        files.push_back(folder / point.strip());
        files.push_back(folder / "cells" / (cellOf(point) + ".json"));
      }
    }
  }
  return files;
}

std::size_t stepsOf(const MotionPlan& plan) { return measuredFiles(plan, "").size() / 2; }

Measured<MotionPoint> measureMotion(const MotionPlan& plan, const ChartCells& cells,
                                    const OnSteps& on_steps) {
  Measured<MotionPoint> result;
  for (const ChartScene& planned : plan.scenes) {
    std::optional<MotionScene> scene;
    if (!planned.input.empty()) result.warnings = scene.emplace(planned, plan).seen.warnings;
    for (const std::string_view path : kMotionPaths) {
      std::vector<MotionStep> steps;
      bool computes = false;
      for (MotionPoint& point : pointsWithout(planned, path)) {
        const std::size_t frames = framesOf(plan, point);
        const std::string key = planned.input + "; " + std::to_string(plan.size_px) + " px; " +
                                std::to_string(plan.views) + " views; " + std::to_string(frames) +
                                " frames; " + threadsText(threadCounts().back()) + "; ";
        auto lists = cells.loadLists(cellOf(point), key);
        const bool of_new_budget = point.budget_ms && computes;  // the point before is the same
        if (of_new_budget || !cells.hasImage(point.strip())) lists.reset();
        computes = !lists;
        ++(lists ? result.kept : result.computed);
        if (!lists) {
          if (!scene) scene.emplace(planned, plan);
          if (steps.empty()) steps = motionSteps(path, scene->seen);
          if (point.budget_ms) point.budget_ms = kBudgetShare * result.rows.back().ms_median;
          MotionRun run(*scene, point.method.spec(), point.budget_ms);
          for (int i = 0; point.budget_ms && i < kWarmUp; ++i) run.render(steps.front());
          Image worst;
          lists = measurePath(*scene, run, std::span(steps).first(frames), worst);
          if (point.budget_ms) (*lists)["budget_ms"] = {*point.budget_ms};
          cells.writeImage(point.strip(), worst);
          cells.storeLists(cellOf(point), key, *lists);
        }
        setFigures(point, *lists);
        result.rows.push_back(point);
        on_steps(1);
      }
      if (scene) scene->endPath();
    }
  }
  return result;
}

std::string csvOf(const std::vector<MotionPoint>& points) {
  std::string csv =
      "scene,path,method,setting,budget_ms,light_worst,light_median,jnd_worst,jnd_median,"
      "worst_frame,ms_median\n";
  for (const MotionPoint& one : points) {
    csv += rowOf<','>(csvField(one.scene), one.path, one.method.name,
                      one.method.setting ? std::to_string(*one.method.setting) : "n/a",
                      orAbsent(one.budget_ms, 4), decimal(one.light_worst, 6),
                      decimal(one.light_median, 6), decimal(one.jnd_worst, 6),
                      decimal(one.jnd_median, 6), one.worst_frame, decimal(one.ms_median, 4));
  }
  return csv;
}

}  // namespace foci
