// Gaze to focus: samples go in as they come, the eye's state comes out whenever a frame asks.
#pragma once

#include <functional>
#include <optional>

#include "gaze/events/online_events.h"
#include "gaze/focus/accommodation.h"
#include "gaze/focus/vergence.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Distance in metres from the eye to the surface it would focus in a cone around a direction, or
/// nothing where there is none. A pure function of its arguments; the eye's pose is the one of
/// `time_s`.
/// @param direction_eye   unit, in the eye frame (x right, y up, looking along -z)
/// @param half_angle_rad  of the cone
using SurfaceDistance = std::function<std::optional<double>(
    double time_s, const glm::dvec3& direction_eye, double half_angle_rad)>;

struct FollowSettings {
  EventSettings events{};
  AccommodationSettings accommodation{};
  double cone_half_angle_deg =
      0.5;  ///< as wide as a good tracker's error; wider where a sample says so
  /// Where both eyes are recorded, the target is the mean of the surface's distance and of that at
  /// which the lines of sight meet, weighted by their variances; on a miss it is the latter alone.
  bool vergence = false;
  double eye_error_deg = 0.5;    ///< standard deviation of one eye's direction, > 0
  double surface_error_D = 0.1;  ///< of the surface's distance, e.g. at its edges, > 0
  double ipd_m = 0.063;          ///< where the recording does not say it
};

/// The eye at the time of a frame.
struct EyeNow {
  double time_s = 0.0;
  std::optional<GazeSample> sample{};  ///< the newest
  GazeState state = GazeState::lost;   ///< lost, too, when no sample has come for long
  double state_time_s = 0.0;           ///< the sample that it is of
  std::optional<glm::dvec2>
      fixation_px;  ///< held in saccades, blinks, losses; absent before the first
  std::optional<double>
      surface_distance_m;  ///< along the fixation's line of sight; absent on a miss
  std::optional<DioptreEstimate>
      vergence{};                    ///< of the newest fixated sample; off, or one eye: absent
  std::optional<double> target_D{};  ///< held likewise, and on a miss; absent before the first
  double focus_D = 0.0;              ///< the resting focus before the first target
};

/// Follows one recording, or one live source. For each frame: push every sample up to its time,
/// then ask `at`.
///
/// The surface is asked once a frame in fixation (the eye itself may move), and besides at the
/// sample at which the fixation begins or has moved by half the cone's half-angle, so that the
/// latency of accommodation runs from there and not from the next frame. In saccades, blinks and
/// losses it is not asked: the target holds.
///
/// In noise the surface holds, too: where the cone's answer is another one by more than
/// `surface_error_D`, but the one before is still met within a standard deviation of the
/// fixation's error around it, that one stays.
class GazeFollower {
 public:
  /// @param screen   that the samples are on, with all of its quantities known
  /// @param rate_Hz  nominal rate of the samples
  GazeFollower(const Screen& screen, double rate_Hz, SurfaceDistance surface,
               const FollowSettings& settings = {});

  /// @param sample  later than the one before, and not before the last frame's time
  void push(const GazeSample& sample);

  /// See `Accommodation`.
  void setFarPoint(double far_point_D) { accommodation_.setFarPoint(far_point_D); }

  /// @param time_s  not before the newest sample nor the last frame
  EyeNow at(double time_s);

 private:
  /// The last question to the surface, in the current fixation.
  struct Look {
    double time_s = 0.0;
    glm::dvec2 point_px{0.0};
    std::optional<double> distance_m{};
  };

  bool isFixating() const;
  void look(double time_s);
  std::optional<double> surfaceAround(double time_s, const glm::dvec3& sight,
                                      double half_angle_rad) const;

  Screen screen_;
  SurfaceDistance surface_;
  FollowSettings settings_;
  OnlineEvents events_;
  Accommodation accommodation_;
  double longest_silence_s_;
  std::optional<GazeSample> newest_{};
  GazeNow now_{};
  std::optional<Look> looked_{};
  std::optional<double> held_D_{};  // the surface of the last look that met one
  std::optional<DioptreEstimate> vergence_{};
};

}  // namespace foci
