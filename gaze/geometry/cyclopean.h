// One point of gaze from two eyes, without a jump where one of them is lost.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace foci {

/// The mean of both eyes' points; where one is lost, the other one's, moved by half of what lay
/// between them in the last second or so (the eyes need not cross on the screen).
class Cyclopean {
 public:
  /// @param time_s  not before the last
  std::optional<glm::dvec2> combine(double time_s, const std::optional<glm::dvec2>& left_px,
                                    const std::optional<glm::dvec2>& right_px);

 private:
  std::optional<glm::dvec2> half_px_{};  // from left to right
  double time_s_ = 0.0;                  // when both were last seen
};

}  // namespace foci
