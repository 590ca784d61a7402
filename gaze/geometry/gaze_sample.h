// The types that all of the gaze room shares: screen geometry, samples, traces, states.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

/// Screen geometry: a flat screen whose centre the eye faces. Each recording has one.
struct Screen {
  glm::ivec2 size_px{0, 0};
  glm::dvec2 size_m{0.0};   ///< width, height of the visible area
  double distance_m = 0.0;  ///< from the eye to the screen's centre
};

enum class GazeState {
  fixation,
  saccade,
  oscillation,  ///< post-saccadic
  pursuit,      ///< smooth pursuit
  blink,
  lost  ///< data loss
};

/// "fixation", "saccade", "pso", "pursuit", "blink", "lost".
std::string_view nameOf(GazeState state);

/// One eye in a sample of a binocular recording.
struct EyeSample {
  std::optional<glm::dvec2> point_px{};   ///< on the trace's screen, as `GazeSample::point_px`
  std::optional<glm::dvec3> origin_m{};   ///< the eye's centre; x right, y up, looking along -z
  std::optional<glm::dvec3> direction{};  ///< of the line of sight, unit, in the same frame
  std::optional<double> pupil_mm{};       ///< diameter
};

struct GazeSample {
  double time_s = 0.0;  ///< on the recording's clock
  /// On the trace's screen, origin top-left. Absent in blinks and data loss.
  std::optional<glm::dvec2> point_px{};
  std::optional<double> pupil_mm{};    ///< diameter, if the recording has one in millimetres
  bool blink = false;                  ///< the tracker itself reports a blink
  std::optional<double> confidence{};  ///< 0 to 1, if the recording has one
  std::array<EyeSample, 2> eyes{};     ///< left, right; empty if the recording has no single eyes
  std::optional<double> uncertainty_deg{};  ///< from a calibration: 68 % of the errors are smaller
};

struct GazeTrace {
  std::string format;                 ///< for reports: "EyeLink ASC, binocular", "TSV", ...
  std::optional<Screen> screen{};     ///< if the file describes one
  double rate_Hz = 0.0;               ///< sampling rate, nominal or median
  std::vector<GazeSample> samples{};  ///< times strictly increase
  bool simulated = false;
  std::vector<std::string> warnings{};  ///< what looks wrong in the positions, a sentence each
};

}  // namespace foci
