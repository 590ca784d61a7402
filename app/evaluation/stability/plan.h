// The plan of `foci chart --stability`: scenes with the values of their dials, and methods.
#pragma once

#include <vector>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/evaluation_choice.h"
#include "app/evaluation/stability/scenes.h"
#include "app/evaluation/stability/trial.h"

namespace foci {

struct StabilityPlan {
  bool quick = false;
  StabilityEffort effort = {};
  std::vector<StabilityScene> scenes = {};  ///< with the values to measure
  std::vector<EvaluatedMethod> methods = {};
};

/// A plan of every method with one setting, unless the user chose others. `choice.size_px` has no
/// effect: the scenes have sizes of their own.
/// @throws InputError for an unknown scene or method, or a scan that cannot be read
StabilityPlan planStability(const EvaluationChoice& choice);

}  // namespace foci
