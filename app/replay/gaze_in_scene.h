// Gaze in the scene: the line of sight of each sample, the surface it meets and the object there.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/record/tables.h"
#include "app/replay/replay_inputs.h"
#include "app/study/study.h"
#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_events.h"
#include "render/scene/scene.h"

namespace foci {

/// Where a line of sight meets the scene. The world frame is that of the scene, metres.
struct SightHit {
  glm::dvec3 point_m{0.0};
  double distance_m = 0.0;
  glm::dvec3 normal{0.0};  ///< unit, towards the eye; 0 where unknown (Gaussians)
  std::size_t object = 0;  ///< number of the object; 0: none
};

struct SightSample {
  double time_s = 0.0;   ///< on the recording's clock
  double lasts_s = 0.0;  ///< until the next sample; after a gap, three sampling intervals
  GazeState state = GazeState::lost;
  bool valid = false;                        ///< there is gaze: no blink, no data loss
  glm::dvec3 origin_m{0.0}, direction{0.0};  ///< of the eye; direction of unit length, if valid
  glm::dvec3 up{0.0, 1.0, 0.0};              ///< of the eye
  std::optional<SightHit> hit = {};
  std::optional<double> pupil_mm = {}, pupil_own = {};  ///< as recorded
};

/// A fixation in the scene.
struct SightFixation {
  double onset_s = 0.0, duration_s = 0.0;
  std::optional<SightHit> hit = {};  ///< mean point and distance; the object with the most time
  double share = 0.0;                ///< of the time with gaze, on that object
  double surface_D = 0.0;            ///< mean reciprocal of the distance, where there is a `hit`
  glm::dvec3 direction{0.0};         ///< mean line of sight, unit; 0 without any
};

/// How an object was looked at.
struct ObjectLooks {
  std::string name;
  std::optional<double> first_look_s = {};  ///< onset of the first fixation on it
  double dwell_s = 0.0;                     ///< time of all samples on it
  std::size_t fixations = 0;
  std::size_t visits = 0;                      ///< runs of fixations on it, without one elsewhere
  std::optional<double> mean_distance_m = {};  ///< over the time of the samples
};

struct GazeInScene {
  std::vector<SightSample> samples;
  std::vector<SightFixation> fixations;
  std::vector<ObjectLooks> objects;  ///< by number; [0] is what is on no object
  /// By surfel or Gaussian: time of gaze, and that per area. Empty unless asked for.
  std::vector<double> attention_s = {}, heat_s_per_m2 = {};
  glm::dvec3 up{0.0, 1.0,
                0.0};  ///< of the scene, unit: the study's, or the mean of a recorded head's
};

/// Azimuth to the right and elevation of a direction in the world, degrees. Azimuth 0 is -z without
/// its part along `up`, or y where that is nothing.
glm::dvec2 azimuthElevation_deg(const glm::dvec3& direction, const glm::dvec3& up);

/// The samples of an event.
/// @param samples  in order of time
std::span<SightSample> samplesDuring(const GazeEvent& event, std::span<SightSample> samples);

/// Makes a fixation of each pursuit that rests on a point of the scene: to keep it in view, the
/// eyes turn while the head moves past it. Let p be the median of the points that its sights meet,
/// and u the direction to p from where the eye is. Gaze less the turn of u must be a fixation by
/// the rule of `StableGaze`. An eye that does not move changes nothing.
/// @param samples  in order of time; their states follow
void fixateRestingPoints(std::vector<GazeEvent>& events, std::span<SightSample> samples,
                         const EventRules& rules);

/// Looks along each sample of the replayed time, within the study's cone about the line of sight,
/// as the eye does to focus. Shapes of the study come before the scene's own objects. Keys of the
/// eye that change during the run move it.
/// @param judged     of the run. Where the recording has a head, pursuit that rests on a point of
///                   the scene becomes fixation (`fixateRestingPoints`)
/// @param attention  whether to share the time of each sample among what it meets
GazeInScene lookIntoScene(const Study& study, const ReplayedGaze& gaze, const Scene& scene,
                          RunEvents& judged, bool attention);

/// Three numbers as fields of a table.
std::string vectorText(const glm::dvec3& v, int digits);

/// The pupil in the tracker's own unit: of both eyes their mean.
std::optional<double> ownPupilOf(const GazeSample& sample);

/// A pupil as recorded, and its unit.
std::string pupilText(const std::optional<double>& pupil_mm, const std::optional<double>& pupil_own,
                      const std::string& own_unit);

/// The object that a line of sight met; `n/a` if it is none.
std::string objectText(const GazeInScene& gaze, const std::optional<SightHit>& hit);

/// gaze3d.tsv; `n/a` where a value is absent.
/// @param trials      in order of their beginnings
/// @param pupil_unit  of `pupil_own`
std::string sightTable(const GazeInScene& gaze, const std::vector<TraceTrial>& trials,
                       const std::string& pupil_unit);

/// objects.tsv: for each trial, and for the time between trials, a row for each object.
std::string objectTable(const GazeInScene& gaze, const std::vector<TraceTrial>& trials);

}  // namespace foci
