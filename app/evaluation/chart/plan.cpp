#include "app/evaluation/chart/chart.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/scene_in_view.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/methods/method.h"

namespace foci {
namespace {

// So wide, a method pays for pixels as it does on a display. In smaller images it pays for surfels.
constexpr int kSize_px = 640;

// Blurs, views and times of both plans are chosen by eye, within the time that `foci chart --help`
// states.
ChartPlan fullPlan() {
  return {.quick = false,
          .size_px = kSize_px,
          .blurs_px = {1.0, 4.0, 12.0, 40.0},
          .min_views = 256,
          .max_views = 1024,
          .rays = 512,
          .timing_ms = 300.0,
          .max_runs = 7};
}

ChartPlan quickPlan() {
  return {.quick = true,
          .size_px = kSize_px,
          .blurs_px = {4.0, 16.0},
          .min_views = 64,
          .max_views = 128,
          .rays = 128,
          .timing_ms = 60.0,
          .max_runs = 3};
}

std::vector<ChartScene> everyScene(int size_px, const std::optional<ScanView>& scan,
                                   float spacing) {
  constexpr float kPlaneSamples = 512.0f;  // along a side, as in the 2003 paper
  const auto plane_samples = static_cast<int>(kPlaneSamples / spacing);
  const float step_px = spacing * kGalleryStep_px;
  std::vector<ChartScene> all;
  if (scan) {  // first, so that a bad scan is reported at once
    all.push_back({.id = "scan",
                   .title = scan->file.filename().string(),
                   .input = scanKey(*scan),
                   .make = [=, view = *scan] { return scanInView(view, size_px); },
                   .gaussians = holdsGaussians(scan->file)});
  }
  all.push_back({"plane", "a textured plane, tilted", "",
                 [=] { return planeInView(plane_samples, size_px); }});
  all.push_back({"gallery", "a gallery, things from 0.25 to 6 m", "",
                 [=] { return galleryInView(size_px, step_px); }});
  all.push_back({"mask", "a half-transparent mask before a figure in focus", "",
                 [=] { return maskInView(size_px, step_px); }});
  all.push_back(
      {"fence", "thin wires before a wall in focus", "", [=] { return fenceInView(size_px); }});
  all.push_back({"ball", "a textured mesh before a light background", "",
                 [=] { return ballInView(size_px); }, ChartTruth::triangles});
  all.push_back({.id = "garden",
                 .title = "3D Gaussians: a ball, blades, a veil, boards",
                 .make = [=] { return gardenInView(size_px); },
                 .gaussians = true});
  if (!scan) {
    all.push_back({"statue", "a stone lion", "", [=] { return statueInView(size_px); }});
  }
  return all;
}

/// The methods that render Gaussians. @param variants  adds what other renderers of Gaussians do
std::vector<EvaluatedMethod> ofGaussians(const std::vector<EvaluatedMethod>& asked, bool variants) {
  std::vector<EvaluatedMethod> able;
  for (const EvaluatedMethod& method : asked) {
    const auto info = std::ranges::find(methods(), method.name.substr(0, method.name.find(':')),
                                        &MethodInfo::name);
    if (info == methods().end() || !info->gaussians) continue;
    able.push_back(method);
    if (!variants) continue;
    for (const std::string_view variant : info->variants) {
      able.push_back({method.name + ":" + std::string(variant), std::nullopt});
    }
  }
  return able;
}

}  // namespace

int ChartPlan::views(double blur_px) const {
  const double views = std::ceil(std::numbers::pi * blur_px * blur_px);
  return static_cast<int>(std::clamp(views, double{1.0 * min_views}, double{1.0 * max_views}));
}

std::string ChartPlan::reference(const ChartScene& scene, double blur_px) const {
  const std::string traced = "raytrace:" + std::to_string(rays);
  const bool triangles = scene.truth == ChartTruth::triangles && !expectedMethod(traced);
  return triangles ? traced : "accumulate:" + std::to_string(views(blur_px));
}

std::string ChartPlan::key(const ChartScene& scene, double blur_px) const {
  return scene.id + " " + scene.input + "; " + std::to_string(size_px) + " px; blur " +
         decimal(blur_px, 3) + " px; reference " + reference(scene, blur_px) + "; ";
}

std::vector<ChartScene> chosenScenes(const EvaluationChoice& choice, int size_px,
                                     SettingRange range, float spacing) {
  std::vector<ChartScene> scenes = everyScene(size_px, choice.scan, spacing);
  keepChosen(scenes, choice, [](const ChartScene& scene) { return scene.id; });
  const std::vector<EvaluatedMethod> asked = evaluatedMethods(choice.methods, range);
  for (ChartScene& scene : scenes) {
    scene.methods = scene.gaussians ? ofGaussians(asked, choice.methods.empty()) : asked;
    if (!scene.methods.empty()) continue;
    if (scene.input.empty() && choice.scenes.empty()) continue;
    throw InputError(scene.input.empty() ? "--scene " + scene.id : choice.scan->file.string(),
                     "holds Gaussians, which none of the chosen methods renders (foci methods)");
  }
  std::erase_if(scenes, [](const ChartScene& scene) { return scene.methods.empty(); });
  return scenes;
}

ChartPlan planChart(const EvaluationChoice& choice) {
  ChartPlan plan = choice.quick ? quickPlan() : fullPlan();
  plan.size_px = choice.size_px.value_or(plan.size_px);
  plan.threads = threadCounts();
  if (plan.quick) plan.threads.erase(plan.threads.begin(), plan.threads.end() - 1);
  plan.scenes =
      chosenScenes(choice, plan.size_px, plan.quick ? SettingRange::quick : SettingRange::full);
  return plan;
}

}  // namespace foci
