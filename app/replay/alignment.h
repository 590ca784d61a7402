// How a headset recording lies in a scene: the offset, uniform scale and rotation about the
// vertical under which most gaze meets surfaces, and how sure that is.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"
#include "render/scene/scene.h"

namespace foci {

/// A line of sight of a recording with head poses, in the recording's world.
struct Sight {
  double time_s = 0.0;
  glm::dvec3 eye_m{0.0}, direction{0.0};  ///< midway between the eyes; unit
  std::optional<double> vergence_D = {};  ///< of both eyes
};

struct RecordedSights {
  std::vector<Sight> sights;
  double sigma_D = 0.0;  ///< error of vergence against surfaces; 0: there is no vergence
};

/// At most 240 sights, at even steps of the samples that have gaze and head. The error is 0.1 D, as
/// `vergenceDisagrees` has it, together with the noise between neighbouring samples.
/// @param ipd_m  where the recording has no origins of the eyes
RecordedSights sightsOf(const GazeTrace& trace, const Screen& screen, double ipd_m);

/// How far away gaze probably was, metres of the recording: by vergence, at most 5 m; else 2 m.
double probableDistance_m(const Sight& sight);

/// How gaze meets the scene under an alignment.
struct AlignmentFit {
  SceneAlignment alignment;
  /// Mean over sights of: 0 without a surface at 0.1 to 100 m of the recording; else 1 without
  /// vergence V; else exp(-e^2 / 2 sigma^2) with the error e = scale/distance - V, dioptres of the
  /// recording.
  double score = 0.0;
  double met = 0.0;                               ///< share of the sights that meet a surface
  std::vector<double> scores = {};                ///< by sight
  std::vector<std::optional<double>> met_m = {};  ///< distance of the surface, by sight
};

/// A step from the best alignment, and how much the score falls by it.
struct AlignmentNeighbour {
  std::string step;  ///< "0.12 m along x"
  double drop = 0.0;
  bool as_good = false;
};

struct AlignmentSearch {
  AlignmentFit now, best;
  double sigma_D = 0.0;                             ///< 0: the recording has no vergence
  std::vector<AlignmentNeighbour> neighbours = {};  ///< of `best`
  std::optional<AlignmentFit> rival = {};           ///< best of the poses elsewhere
  std::size_t rivals = 0;                           ///< poses elsewhere that do as well as `best`
  bool now_as_good = false;                         ///< `now` does as well as `best`

  enum class Verdict { keep, propose, ambiguous, nothing_fits };
  Verdict verdict() const;
};

/// Below this share, no pose counts as a fit.
inline constexpr double kLeastFit = 0.5;

/// What to search; a test may search less.
struct AlignmentRange {
  int scales = 7;  ///< steps of a quarter octave to either side of the present scale
  double yaw_deg = 15.0;
};

/// Searches all rotations about the vertical, scales from 0.3 to 3.4 times the present one, and
/// places of what was looked at within the scene: first in voxels, from a grid of poses; the best
/// of these step by step, at last in the scene itself (`SurfaceQuery`).
///
/// Two poses do as well if the mean difference of their scores, over blocks of 0.3 s, is below two
/// standard errors, or below 0.01. A pose is elsewhere if it moves what is looked at by more than
/// 15 % of its distance.
/// @param looks   not empty
/// @param now     as it stands. If it turns the recording's y axis to another direction than `up`,
///                the proposals turn it to `up`
/// @param up      unit, of the scene
AlignmentSearch searchAlignment(const Scene& scene, const RecordedSights& looks,
                                const SceneAlignment& now, const glm::dvec3& up,
                                const AlignmentRange& range = {});

/// A sentence: what was found, and what it says.
std::string verdictText(const AlignmentSearch& search);

/// Lines of a study that align it so.
std::string alignmentToml(const SceneAlignment& alignment);

}  // namespace foci
