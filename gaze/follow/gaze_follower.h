// From gaze to focus: samples go in as they arrive, and each frame asks for the eye's state.
#pragma once

#include <functional>
#include <optional>

#include "gaze/events/online_events.h"
#include "gaze/focus/accommodation.h"
#include "gaze/focus/vergence.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/geometry/sampling_rate.h"

namespace foci {

/// Distance in metres from the eye to the surface that it would focus within a cone; nothing if the
/// cone meets no surface. The result depends on the arguments alone.
/// @param time_s          selects the eye's pose
/// @param direction_eye   the cone's axis: unit, in the eye frame (x right, y up, looking along -z)
/// @param half_angle_rad  the cone's half-angle
using SurfaceDistance = std::function<std::optional<double>(
    double time_s, const glm::dvec3& direction_eye, double half_angle_rad)>;

struct FollowSettings {
  EventSettings events{};
  AccommodationSettings accommodation{};
  /// The error of a good tracker. A sample with a larger `uncertainty_deg` widens its cone.
  double cone_half_angle_deg = 0.5;
  /// With recordings of both eyes, the target is the mean of the surface's distance and the
  /// vergence distance, weighted by their variances. Without a surface it is the vergence distance
  /// alone.
  bool vergence = false;
  double eye_error_deg = 0.5;    ///< standard deviation of one eye's direction, > 0
  double surface_error_D = 0.1;  ///< standard deviation of the surface's distance, > 0
  double ipd_m = 0.063;  ///< interpupillary distance, if the recording has no origins of the eyes
};

/// The eye at the time of a frame.
struct EyeNow {
  double time_s = 0.0;
  std::optional<GazeSample> sample{};  ///< the newest sample
  GazeState state = GazeState::lost;   ///< also `lost` if no sample has come for long
  double state_time_s = 0.0;           ///< time of the sample that `state` belongs to
  /// Keeps its value through saccades, blinks and data loss. Absent before the first fixation.
  std::optional<glm::dvec2> fixation_px;
  /// Time of the sample whose head sees the fixation there.
  double fixation_time_s = 0.0;
  /// Along the fixation's line of sight; absent if the cone meets no surface.
  std::optional<double> surface_distance_m;
  /// Mean over the samples of the fixation so far. Its error is that of the directions, which
  /// calibration leaves: it does not shrink with the number of samples. Absent with one eye, and
  /// for eyes without directions unless `FollowSettings::vergence`.
  std::optional<DioptreEstimate> vergence{};
  /// Keeps its value as `fixation_px` does, and where there is no surface. Absent before the first.
  std::optional<double> target_D{};
  double focus_D = 0.0;  ///< the resting focus before the first target
};

/// When the follower asks for the surface during a fixation.
enum class AskSurface {
  always,     ///< as a frame needs it
  whenMoved,  ///< gaze, or the eye, has moved by more than noise since the last question
};

/// Whether the lines of sight of a fixation meet elsewhere than on its surface: by more than three
/// standard errors of the difference, as one in 370 do by chance.
/// @return nothing without vergence or surface
std::optional<bool> vergenceDisagrees(const EyeNow& eye);

/// Follows one recording or one live source. For each frame, push every sample up to the frame's
/// time, then call `at`.
///
/// With head poses, a fixation rests in the world. The follower then asks for the surface at the
/// time of the sample that has the fixation's point, because this point belongs to that pose.
///
/// During a fixation the follower asks for the surface once a frame, because the eye itself may
/// move. `AskSurface::whenMoved` spares the question while gaze rests. It also asks at the sample
/// where the fixation begins, or has moved by half of the cone's half-angle. So the latency of
/// accommodation starts at this sample and not at the next frame. During saccades, blinks and data
/// loss the target keeps its value.
///
/// Noise does not make the focus jump at an edge. If the cone meets another surface than before, by
/// more than `surface_error_D`, the follower also asks in a ring around the fixation. The ring's
/// radius is the fixation's standard error. If a cone of the ring still meets the former surface,
/// the focus stays there.
class GazeFollower {
 public:
  /// @param screen   the screen of the samples, with known size and distance
  /// @param rate_Hz  nominal sampling rate; samples that come at another rate are judged by theirs
  GazeFollower(const Screen& screen, double rate_Hz, SurfaceDistance surface,
               const FollowSettings& settings = {});

  /// @param sample  later than the previous sample. It may be older than the last frame, which did
  ///                not know it yet: focus then answers from that frame on
  void push(const GazeSample& sample);

  /// See `Accommodation::setFarPoint`.
  void setFarPoint(double far_point_D) { accommodation_.setFarPoint(far_point_D); }

  /// The eye itself has moved, so that the next `at` asks for the surface.
  void noteEyeMoved() { eye_moved_ = true; }

  /// The eye's state at the time of a frame.
  /// @param time_s  not before the newest sample or the last frame
  EyeNow at(double time_s, AskSurface ask = AskSurface::always);

 private:
  /// The last question to the surface, in the current fixation.
  struct Look {
    double time_s = 0.0;
    glm::dvec2 point_px{0.0};
    std::optional<double> distance_m{};
  };

  bool isFixating() const;
  bool hasMoved() const;
  void look(double time_s);
  void converge(const GazeSample& sample);
  std::optional<double> surfaceAround(double time_s, const glm::dvec3& sight,
                                      double half_angle_rad) const;

  Screen screen_;
  SurfaceDistance surface_;
  FollowSettings settings_;
  RateWatch watch_;
  OnlineEvents events_;
  Accommodation accommodation_;
  double longest_silence_s_;
  std::optional<GazeSample> newest_{};
  GazeNow now_{};
  std::optional<Look> looked_{};
  double last_asked_s_ = 0.0;          // by `at`
  bool eye_moved_ = false;             // since then
  std::optional<double> surface_D_{};  // of the latest look that met a surface
  std::optional<DioptreEstimate> vergence_{};
  double vergence_sum_D_ = 0.0;
  int vergence_count_ = 0;  // samples of the fixation
};

}  // namespace foci
