#include "app/evaluation/stability/plan.h"

namespace foci {
namespace {

// Chosen by eye: with 160 samples the reference's noise lies well below every score that is wanted.
constexpr StabilityEffort kFullEffort{.samples = 160, .steps = 8};
constexpr StabilityEffort kQuickEffort{.samples = 64, .steps = 3};

}  // namespace

StabilityPlan planStability(const EvaluationChoice& choice) {
  StabilityPlan plan{.quick = choice.quick,
                     .effort = choice.quick ? kQuickEffort : kFullEffort,
                     .scenes = stabilityScenes()};
  if (choice.scan) plan.scenes.push_back(thinnedScan(*choice.scan));
  keepChosen(plan.scenes, choice, [](const StabilityScene& scene) { return scene.name; });
  plan.methods = evaluatedMethods(choice.methods, SettingRange::one);
  if (!plan.quick) return plan;
  for (StabilityScene& scene : plan.scenes) {
    const std::vector<float>& all = scene.values;
    scene.values = {all.front(), all[all.size() / 2], all.back()};
  }
  return plan;
}

}  // namespace foci
