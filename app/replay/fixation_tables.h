// Fixations and saccades as tables that need no joining: whose gaze it was, what it met, and how
// sharply the eye saw it.
#pragma once

#include <glm/gtc/constants.hpp>
#include <string>
#include <utility>
#include <vector>

#include "app/record/tables.h"
#include "app/replay/gaze_in_scene.h"
#include "app/replay/replay_inputs.h"

namespace foci {

inline constexpr double kArcminPerRad = 60.0 * 180.0 / glm::pi<double>();

inline constexpr const char *kFixationTable = "fixations.tsv", *kSaccadeTable = "saccades.tsv";

/// What the eye of a frame does.
struct EyeInFrame {
  double time_s, focus_D, pupil_mm;
};

/// Whose recording a file is: its name without extension, and the entities of BIDS (`sub-`, `ses-`)
/// in its name or above it. `gaze.rows = { participant = "A" }` names the subject, too.
struct RecordingName {
  std::string recording, subject, session;  ///< fields of a table; `n/a`: not stated
};
RecordingName recordingNameOf(const Study& study);

/// fixations.tsv: a row for each fixation of the run. Over its time it has the mean gaze, and the
/// mean focus and pupil of the frames; a fixation between two frames has those of the frame before.
///   defocus_D          = focus_D - surface_D
///   blur_radius_arcmin = pupil / 2 |defocus| in radians * 60 * 180 / pi
///   blur_radius_px     = the same on the study's screen
/// @param study   with the file names of the run
/// @param judged  of the run
/// @param frames  in order of time
std::string fixationTable(const Study& study, const ReplayedGaze& gaze, const RunEvents& judged,
                          const GazeInScene& in_scene, const std::vector<EyeInFrame>& frames);

/// saccades.tsv: a row for each saccade, with the objects of the fixations before and after it.
std::string saccadeTable(const Study& study, const ReplayedGaze& gaze, const RunEvents& judged,
                         const GazeInScene& in_scene);

/// A table of all runs: the rows of each run's table, whose recording is the run's name.
/// @param tables  name of the run and text of its table
std::string joinedTable(const std::vector<std::pair<std::string, std::string>>& tables);

}  // namespace foci
