// Faces as hard as real ones. Lashes hang over the eyes, and the whites are shaded, in all of them;
// each adds one difficulty. The trackers are counted on them, and gaze is calibrated on one.
#pragma once

#include <string>
#include <vector>

#include "tests/faces/face.h"

namespace foci::faces {

struct HardFace {
  std::string what;
  Person person;
  Moment moment{};
  Photography how{};
};

/// With lashes, shaded whites and narrower lids.
Person hardPerson(std::uint32_t index);

/// Uneven light and some noise.
Photography hardLight(std::uint32_t seed);

/// Each difficulty with this many people.
std::vector<HardFace> hardFaces(std::uint32_t people);

}  // namespace foci::faces
