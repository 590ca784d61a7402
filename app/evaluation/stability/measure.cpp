#include "app/evaluation/stability/measure.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "app/evaluation/evaluation_page.h"
#include "app/evaluation/excess_change.h"
#include "app/graphics/image.h"
#include "base/text.h"
#include "base/transformed.h"
#include "render/image/metrics.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

std::string groupName(const std::string& scene, float value) {
  return scene + "_" + dialText(value) + "_";
}

/// The file of a cell, without folder and extension.
/// @param index  of the method, or of the scene's observer
std::string cellName(const StabilityPlan& plan, const StabilityScene& scene, float value,
                     std::size_t index) {
  return groupName(scene.name, value) +
         (scene.observe ? "observer-" + std::to_string(index) : plan.methods[index].fileName());
}

/// Factor for the images: brings a scene that is too bright or too faint to see to white.
float exposureOf(const Frame& reference) {
  constexpr float kFaint = 0.2f;  // chosen by eye
  float max = 0.0f;
  for (const glm::vec4& c : reference.rgba) max = std::max({max, c.r, c.g, c.b});
  return max > 1.0f || (max > 0.0f && max < kFaint) ? 1.0f / max : 1.0f;
}

Frame exposed(Frame frame, float exposure) {
  for (glm::vec4& c : frame.rgba) c *= exposure;
  return frame;
}

/// All cells of one scene at one value of its dial.
class StabilityGroup {
 public:
  StabilityGroup(const StabilityPlan& plan, const StabilityScene& scene, float value,
                 const ChartCells& cells)
      : plan_(plan),
        scene_(scene),
        value_(value),
        cells_(cells),
        key_(scene.name + " " + scene.input + "; " + dialText(value) + "; " +
             std::to_string(plan.effort.samples) + " samples, " +
             std::to_string(plan.effort.steps) + " steps; ") {}

  void measure(const OnSteps& on_steps, Measured<StabilityPoint>& result) {
    const auto names = scoredIn(plan_, scene_);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto found = load(i, names[i]);
      ++(found ? result.kept : result.computed);
      result.rows.push_back({.scene = scene_.name,
                             .value = value_,
                             .by = names[i],
                             .score = found ? *found : compute(i, names[i])});
      on_steps(1);
    }
  }

 private:
  std::string nameOf(std::size_t index) const { return cellName(plan_, scene_, value_, index); }

  std::optional<double> load(std::size_t index, const std::string& name) const {
    if (!scene_.observe) {
      const std::string image = stabilityImage(scene_.name, value_, plan_.methods[index]);
      if (!cells_.hasImage(image) || !cells_.hasImage(differenceFileOf(image)) ||
          !cells_.hasImage(stabilityReference(scene_.name, value_))) {
        return std::nullopt;
      }
    }
    const auto lists = cells_.loadLists(nameOf(index), key_ + name);
    return lists ? std::optional(lists->at("score").front()) : std::nullopt;
  }

  double compute(std::size_t index, const std::string& name) {
    const double score = scene_.observe ? scene_.observe(index, value_) : render(index, name);
    cells_.storeLists(nameOf(index), key_ + name, {{"score", {score}}});
    return score;
  }

  double render(std::size_t index, const std::string& method) {
    if (!trial_) {
      trial_.emplace(scene_, value_, plan_.effort);
      exposure_ = exposureOf(trial_->reference());
      cells_.writeImage(stabilityReference(scene_.name, value_),
                        imageOf(exposed(trial_->reference(), exposure_)));
    }
    const double score = trial_->score(method);
    cells_.writeImages(stabilityImage(scene_.name, value_, plan_.methods[index]),
                       exposed(trial_->rendered(), exposure_),
                       exposed(trial_->reference(), exposure_));
    return score;
  }

  const StabilityPlan& plan_;
  const StabilityScene& scene_;
  float value_;
  const ChartCells& cells_;
  std::string key_;
  std::optional<StabilityTrial> trial_;
  float exposure_ = 1.0f;
};

}  // namespace

std::string dialText(float value) { return printed("%g", static_cast<double>(value)); }

std::vector<std::string> scoredIn(const StabilityPlan& plan, const StabilityScene& scene) {
  if (scene.observe) return scene.observers;
  return transformed(plan.methods, &EvaluatedMethod::spec);
}

std::string stabilityImage(const std::string& scene, float value, const EvaluatedMethod& method) {
  return "images/" + groupName(scene, value) + method.fileName() + ".png";
}

std::string stabilityReference(const std::string& scene, float value) {
  return "images/" + groupName(scene, value) + "reference.png";
}

std::size_t stepsOf(const StabilityPlan& plan) {
  std::size_t steps = 0;
  for (const StabilityScene& scene : plan.scenes) {
    steps += scene.values.size() * scoredIn(plan, scene).size();
  }
  return steps;
}

std::vector<fs::path> measuredFiles(const StabilityPlan& plan, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const StabilityScene& scene : plan.scenes) {
    for (const float value : scene.values) {
      for (std::size_t i = 0; i < scoredIn(plan, scene).size(); ++i) {
        files.push_back(folder / "cells" / (cellName(plan, scene, value, i) + ".json"));
      }
      if (scene.observe) continue;
      files.push_back(folder / stabilityReference(scene.name, value));
      for (const EvaluatedMethod& method : plan.methods) {
        const std::string image = stabilityImage(scene.name, value, method);
        files.push_back(folder / image);
        files.push_back(folder / differenceFileOf(image));
      }
    }
  }
  return files;
}

Measured<StabilityPoint> measureStability(const StabilityPlan& plan, const ChartCells& cells,
                                          const OnSteps& on_steps) {
  Measured<StabilityPoint> result;
  for (const StabilityScene& scene : plan.scenes) {
    for (const float value : scene.values) {
      StabilityGroup(plan, scene, value, cells).measure(on_steps, result);
    }
  }
  return result;
}

std::string csvOf(const StabilityPlan& plan, const std::vector<StabilityPoint>& points) {
  std::string csv = "scene,dial,value,method,score,of,good\n";
  for (const StabilityScene& scene : plan.scenes) {
    for (const StabilityPoint& one : points) {
      if (one.scene != scene.name) continue;
      csv += rowOf<','>(csvField(one.scene), csvField(scene.dial), dialText(one.value),
                        csvField(one.by), decimal(one.score, 6), csvField(scene.score),
                        scene.isGood(one.score) ? "yes" : "no");
    }
  }
  return csv;
}

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

namespace {

constexpr double kMax_dB = 99.0;  // PSNR of equal frames is infinite: charts need a number

}  // namespace

StabilityTrial::StabilityTrial(const StabilityScene& scene, float value,
                               const StabilityEffort& effort)
    : setup_(scene.setup(value)), effort_(effort) {
  assert(!scene.observe);
}

Frame StabilityTrial::render(std::string_view method, const SurfelCloud& cloud) const {
  Frame frame;
  RenderSettings settings = setup_.settings;
  settings.quality.check = ErrorCheck::of_still;  // as `foci render`
  makeMethod(method, cloud)->render(setup_.view, settings, frame);
  return frame;
}

const std::vector<Frame>& StabilityTrial::references() {
  if (!references_.empty()) return references_;
  View view = setup_.view;
  RenderSettings settings = setup_.settings;
  for (int k = 0; k <= (setup_.step ? effort_.steps : 0); ++k) {
    if (k > 0) setup_.step(view, settings);
    if (setup_.truth) {
      references_.push_back(setup_.truth(view, settings, effort_.samples));
    } else {
      makeMethod("accumulate:" + std::to_string(effort_.samples), setup_.cloud)
          ->render(view, settings, references_.emplace_back());
    }
  }
  return references_;
}

const Frame& StabilityTrial::reference() { return references().back(); }

double StabilityTrial::popping(std::string_view method) {
  const auto tested = makeMethod(method, setup_.cloud);
  View view = setup_.view;
  RenderSettings settings = setup_.settings;
  double max = 0.0;
  tested->render(view, settings, rendered_);
  for (std::size_t k = 1; k < references().size(); ++k) {
    const FrameInLab before(rendered_);
    setup_.step(view, settings);
    tested->render(view, settings, rendered_);
    max = std::max(max, excessChange(before, FrameInLab(rendered_), FrameInLab(references()[k - 1]),
                                     FrameInLab(references()[k]))
                            .light);
  }
  return max;
}

double StabilityTrial::score(std::string_view method) {
  if (setup_.step) return popping(method);
  rendered_ = render(method, setup_.cloud);
  if (setup_.without) rendered_ = minus(std::move(rendered_), render(method, *setup_.without));
  if (setup_.score) return setup_.score(rendered_);
  return std::min(psnr_dB(rendered_, reference()), kMax_dB);
}

}  // namespace foci
