// The facts of a scene as text and as JSON: what `foci info` prints, and `foci prepare` of its
// input.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "app/study/framing.h"

namespace foci {

/// A line a fact: counts, bounds, units, materials, opacity, normals. Ends with a line break.
std::string sceneText(const SceneFacts& facts, const Framing& framing);

nlohmann::ordered_json sceneJson(const SceneFacts& facts, const Framing& framing);

}  // namespace foci
