#include "gaze/geometry/axis_convention.h"

#include <array>
#include <cmath>

namespace foci {
namespace {

struct AxisWord {
  std::string_view text;
  glm::dvec3 direction;
};

const std::array<AxisWord, 6> kWords = {{{"right", {1.0, 0.0, 0.0}},
                                         {"left", {-1.0, 0.0, 0.0}},
                                         {"up", {0.0, 1.0, 0.0}},
                                         {"down", {0.0, -1.0, 0.0}},
                                         {"back", {0.0, 0.0, 1.0}},
                                         {"forward", {0.0, 0.0, -1.0}}}};

}  // namespace

std::optional<AxisConvention> AxisConvention::named(std::string_view text) {
  AxisConvention axes;
  for (int column = 0; column < 3; ++column) {
    const std::size_t end = column < 2 ? text.find('-') : text.size();
    if (end == text.npos) return std::nullopt;
    bool known = false;
    for (const AxisWord& word : kWords) {
      if (word.text != text.substr(0, end)) continue;
      axes.from_other_[column] = word.direction;
      known = true;
    }
    if (!known) return std::nullopt;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  // Two axes along one line have no volume.
  if (std::abs(glm::determinant(axes.from_other_)) < 0.5) return std::nullopt;
  return axes;
}

glm::dquat AxisConvention::rotation(const glm::dquat& q) const {
  const glm::dmat3 turned = from_other_ * glm::mat3_cast(q) * glm::transpose(from_other_);
  return glm::normalize(glm::quat_cast(turned));
}

}  // namespace foci
