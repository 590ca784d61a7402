// What the whole gaze room speaks of: screens, samples, traces, states.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

/// A flat screen that the eye faces at its centre, or the one that a recording was made on.
struct Screen {
  glm::ivec2 size_px{0, 0};
  glm::dvec2 size_m{0.0};   ///< width, height of the visible area
  double distance_m = 0.0;  ///< eye to screen centre
};

enum class GazeState { fixation, saccade, oscillation, pursuit, blink, lost };

/// "fixation", "saccade", "pso" (post-saccadic oscillation), "pursuit", "blink", "lost".
std::string_view nameOf(GazeState state);

/// What a binocular recording knows of one eye.
struct EyeSample {
  std::optional<glm::dvec2> point_px{};   ///< on the trace's screen, as `GazeSample::point_px`
  std::optional<glm::dvec3> origin_m{};   ///< its centre; x right, y up, looking along -z
  std::optional<glm::dvec3> direction{};  ///< of its line of sight, unit, in the same frame
  std::optional<double> pupil_mm{};       ///< diameter
};

struct GazeSample {
  double time_s = 0.0;  ///< on the recording's clock
  std::optional<glm::dvec2>
      point_px{};  ///< on the trace's screen, origin top-left; absent in a blink or a loss
  std::optional<double> pupil_mm{};    ///< diameter, where the recording has one in millimetres
  bool blink = false;                  ///< the tracker itself says so
  std::optional<double> confidence{};  ///< 0 to 1, where the recording has one
  std::array<EyeSample, 2> eyes{};     ///< left, right; empty where the recording tells no eyes
  std::optional<double> uncertainty_deg{};  ///< 68 % of the errors are smaller; from a calibration
};

struct GazeTrace {
  std::string format;  ///< as recognised, for reports: "EyeLink ASC, binocular", "TSV", ...
  std::optional<Screen> screen{};     ///< where the file says so
  double rate_Hz = 0.0;               ///< nominal or median
  std::vector<GazeSample> samples{};  ///< time strictly increasing
  bool simulated = false;
};

}  // namespace foci
