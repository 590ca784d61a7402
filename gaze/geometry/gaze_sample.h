// The types that all of the gaze room shares: screens (the default one, a headset's), samples,
// traces, states.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace foci {

/// Screen geometry: a flat screen in front of the eye. Each recording has one. A headset's screen
/// moves with the head.
struct Screen {
  glm::ivec2 size_px{0, 0};
  glm::dvec2 size_m{0.0};   ///< width, height of the visible area
  double distance_m = 0.0;  ///< from the eye to the screen's plane
  /// From the screen's centre to the point that the eye faces; x right, y up. 0 on a desk.
  glm::dvec2 faced_m{0.0};
};

/// Interpupillary distances of people.
inline constexpr double kMinIpd_mm = 40.0, kMaxIpd_mm = 80.0;
/// Of a screen from the eye, as files, studies and options may state it; 60 is in cm.
inline constexpr double kNearestScreen_m = 0.01, kFarthestScreen_m = 20.0;
inline bool isScreenDistance(double distance_m) {
  return distance_m >= kNearestScreen_m && distance_m <= kFarthestScreen_m;
}

/// Where the head is. Its frame is right-handed: x right, y up, looking along -z.
struct HeadInWorld {
  glm::dvec3 position_m{0.0};                      ///< in the recording's world
  glm::dquat world_from_head{1.0, 0.0, 0.0, 0.0};  ///< unit
};

/// What one eye sees of a headset's display: degrees from straight ahead, each above 0.
struct EyeField {
  double left_deg = 50.0, right_deg = 50.0, up_deg = 50.0, down_deg = 50.0;
  bool operator==(const EyeField&) const = default;
};

/// One eye of a headset, and the display that it looks through. The head's frame and the eye's are
/// right-handed, x right, y up; the eye looks along -z at its display's faced point.
struct HeadsetEye {
  glm::dvec3 position_m{0.0};                    ///< in the head's frame
  glm::dquat head_from_eye{1.0, 0.0, 0.0, 0.0};  ///< unit; displays may be canted
  EyeField field{};
  bool operator==(const HeadsetEye&) const = default;
};

using HeadsetEyes = std::array<HeadsetEye, 2>;  ///< left, right

enum class GazeState {
  fixation,
  saccade,
  oscillation,  ///< post-saccadic
  pursuit,      ///< smooth pursuit
  blink,
  lost,     ///< data loss
  unjudged  ///< the signal does not tell
};
inline constexpr std::size_t kGazeStates = 7;

/// The names, in the order of `GazeState`.
inline constexpr std::array<std::string_view, kGazeStates> kGazeStateNames = {
    "fixation", "saccade", "pso", "pursuit", "blink", "lost", "unjudged"};

inline std::string_view nameOf(GazeState state) {
  return kGazeStateNames[static_cast<std::size_t>(state)];
}

inline std::optional<GazeState> stateNamed(std::string_view name) {
  for (std::size_t i = 0; i < kGazeStates; ++i) {
    if (kGazeStateNames[i] == name) return static_cast<GazeState>(i);
  }
  return std::nullopt;
}

/// One eye in a sample of a binocular recording.
struct EyeSample {
  std::optional<glm::dvec2> point_px{};  ///< on the trace's screen, as `GazeSample::point_px`
  /// The eye's centre; x right, y up, looking along -z. With a head pose: in the head's frame.
  std::optional<glm::dvec3> origin_m{};
  std::optional<glm::dvec3> direction{};  ///< of the line of sight, unit, in the same frame
  std::optional<double> pupil_mm{};       ///< diameter
  std::optional<double> pupil_own{};      ///< in the tracker's own unit, if that is no length
};

struct GazeSample {
  double time_s = 0.0;  ///< on the recording's clock
  /// On the trace's screen, origin top-left. Absent in blinks and data loss.
  std::optional<glm::dvec2> point_px{};
  std::optional<double> pupil_mm{};    ///< diameter, if the recording has one in millimetres
  std::optional<double> pupil_own{};   ///< of both eyes, in the tracker's own unit (`pupil_unit`)
  bool blink = false;                  ///< the tracker itself reports a blink
  bool inferred = false;               ///< the tracker itself did not see the eye (OpenXR)
  bool queried = false;                ///< the time is not the tracker's, but that of a query
  bool after_pause = false;            ///< the recording was paused before this sample
  std::optional<double> confidence{};  ///< 0 to 1, if the recording has one
  std::array<EyeSample, 2> eyes{};     ///< left, right; empty if the recording has no single eyes
  std::optional<double> uncertainty_deg{};  ///< from a calibration: 68 % of the errors are smaller
  std::optional<HeadInWorld> head{};        ///< if the recording has one
  /// Line of sight of both eyes, unit; with a head pose in the head's frame. Only in recordings of
  /// directions.
  std::optional<glm::dvec3> direction{};
};

/// An event marker of a recording.
struct TraceMarker {
  double time_s = 0.0;
  std::string text;
};

/// A trial of an experiment, as the recording or the study states it.
struct TraceTrial {
  std::string name{};
  double first_s = 0.0, last_s = 0.0;  ///< on the recording's clock
  std::string type{};                  ///< such as a condition; empty: not stated
  std::string result{};                ///< empty: not stated
  std::vector<std::pair<std::string, std::string>> variables{};
};

/// What a recording states, and what was assumed of it.
struct TraceFacts {
  std::string format{};            ///< for reports: "EyeLink ASC, binocular", "TSV", ...
  std::optional<Screen> screen{};  ///< if the file describes one
  /// What the left eye sees of a headset's display; the right eye's field is its mirror image.
  /// Absent: the screen does not move.
  std::optional<EyeField> field{};
  /// Metres per unit of the scene that the observer saw, if the recording states it.
  std::optional<double> scene_scale_m{};
  std::vector<TraceMarker> markers{};   ///< in order of time
  std::vector<TraceTrial> trials{};     ///< in order of their beginnings
  std::string pupil_unit{};             ///< of `pupil_own`: "arbitrary", "px"; empty: none has one
  std::vector<std::string> assumed{};   ///< what the file does not state, a phrase each
  std::vector<std::string> warnings{};  ///< what looks wrong in the positions, a sentence each
};

struct GazeTrace : TraceFacts {
  double rate_Hz = 0.0;               ///< sampling rate, nominal or median
  std::vector<GazeSample> samples{};  ///< times strictly increase
  bool simulated = false;
  bool relative = false;  ///< uncalibrated: scale and origin of the positions are not known
};

/// 24 inches, 16:9, 1920 x 1080 px, seen from 0.6 m: 92 px an inch, 38 px a degree.
inline Screen defaultScreen() {
  return {.size_px = {1920, 1080}, .size_m = {0.5313, 0.2989}, .distance_m = 0.6};
}

/// Pixels per degree in the middle of a headset's view, if none are stated. Chosen by hand: half
/// of a usual headset's, so that a replay is quick.
inline constexpr double kHeadsetPixelsPerDegree = 12.0;

/// The field of an eye midway between both, which sees what either eye sees.
/// @param left_eye  the right eye's field is its mirror image
EyeField fieldOfBothEyes(const EyeField& left_eye);
EyeField fieldOfBothEyes(const HeadsetEyes& eyes);

/// A screen at one metre that fills the field. A plane's scale grows to the side; its middle has
///   R = p 180/pi pixels per tangent.
/// Width and height are even numbers of pixels.
/// @param pixels_per_degree  p, at the faced point
Screen headsetScreen(const EyeField& field, double pixels_per_degree);

}  // namespace foci
