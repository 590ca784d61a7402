// What the user chose to evaluate, and what it gives.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "base/input_error.h"
#include "base/nearest.h"
#include "base/rows.h"
#include "base/transformed.h"

namespace foci {

struct EvaluationChoice {
  bool quick = false;
  std::optional<ScanView> scan = {};      ///< instead of the statue
  std::optional<int> size_px = {};        ///< width of the images
  std::vector<std::string> scenes = {};   ///< names; empty: all scenes
  std::vector<std::string> methods = {};  ///< `name` or `name:N`; empty: all methods
};

/// Called with the number of steps done since the last call.
using OnSteps = std::function<void(std::size_t)>;

/// What an evaluation has measured.
template <class Row>
struct Measured {
  std::vector<Row> rows = {};
  std::size_t computed = 0, kept = 0;      ///< cells that this run measured, and found complete
  std::vector<std::string> warnings = {};  ///< of the scan
};

/// Removes the scenes that the user did not choose.
/// @param nameOf  the name of a scene
/// @throws InputError if the user chose an unknown scene
template <class Scene, class NameOf>
void keepChosen(std::vector<Scene>& scenes, const EvaluationChoice& choice, const NameOf& nameOf) {
  if (choice.scenes.empty()) return;
  const std::vector<std::string> known = transformed(scenes, nameOf);
  const auto contains = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const std::string& name : choice.scenes) {
    if (!contains(known, name)) {
      const auto near = nearWord(name, known);
      throw InputError("--scene " + name, near ? "expected a known scene; the nearest is " + *near
                                               : "expected one of " + listed(known));
    }
  }
  std::erase_if(scenes,
                [&](const Scene& scene) { return !contains(choice.scenes, nameOf(scene)); });
}

}  // namespace foci
