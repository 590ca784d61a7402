// One point of gaze from two eyes, without a jump when the tracker loses one of them.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace foci {

/// The mean of both eyes' points. While one eye is missing, the result is the other eye's point,
/// moved by half of the usual offset between the two. The offset is an exponentially weighted mean
/// of the last moments, because the two lines of sight need not cross on the screen.
class Cyclopean {
 public:
  /// @param time_s  never decreases
  /// @return nothing if both eyes are missing
  std::optional<glm::dvec2> combine(double time_s, const std::optional<glm::dvec2>& left_px,
                                    const std::optional<glm::dvec2>& right_px);

 private:
  std::optional<glm::dvec2> half_px_{};  // half of the usual offset, from left to right
  double time_s_ = 0.0;                  // when both eyes were last seen
};

}  // namespace foci
