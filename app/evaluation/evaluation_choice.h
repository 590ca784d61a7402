// What the user chose to evaluate.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "base/input_error.h"
#include "base/nearest.h"

namespace foci {

struct EvaluationChoice {
  bool quick = false;
  std::optional<ScanView> scan = {};      ///< instead of the statue
  std::optional<int> size_px = {};        ///< width of the images
  std::vector<std::string> scenes = {};   ///< names; empty: all scenes
  std::vector<std::string> methods = {};  ///< `name` or `name:N`; empty: all methods
};

/// Removes the scenes that the user did not choose.
/// @param nameOf  the name of a scene
/// @throws InputError if the user chose an unknown scene
template <class Scene, class NameOf>
void keepChosen(std::vector<Scene>& scenes, const EvaluationChoice& choice, const NameOf& nameOf) {
  if (choice.scenes.empty()) return;
  std::vector<std::string> known;
  known.reserve(scenes.size());
  for (const Scene& scene : scenes) known.push_back(nameOf(scene));
  const auto contains = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const std::string& name : choice.scenes) {
    if (!contains(known, name)) {
      const auto near = nearWord(name, known);
      std::string all;
      for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
      throw InputError("--scene " + name, near ? "expected a known scene; the nearest is " + *near
                                               : "expected one of " + all);
    }
  }
  std::erase_if(scenes,
                [&](const Scene& scene) { return !contains(choice.scenes, nameOf(scene)); });
}

}  // namespace foci
