// The gaze source that `foci live --source` names, and what a dropped file shows.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/live/options.h"
#include "app/platform/warnings.h"
#include "app/study/study_request.h"
#include "gaze/events/gaze_events.h"
#include "gaze/live/live_source.h"
#include "gaze/live/trace_player.h"

namespace foci {

/// A recording that plays.
struct Playback {
  std::string file;               ///< as the user named it
  std::vector<GazeEvent> events;  ///< on the recording's clock
  std::vector<TraceMarker> markers;
  /// The head in the scene at a time of the player's clock; empty: the study places the eye.
  std::function<HeadInWorld(double time_s)> head = {};
  std::vector<glm::dvec3> path_m = {};  ///< of the head, in the scene
};

struct NamedSource {
  std::unique_ptr<LiveSource> source;
  MouseSource* mouse = nullptr;    ///< set if the source is the mouse, which the window moves
  PushedSource* pushed = nullptr;  ///< set if the source is the socket, which brings its samples
  TracePlayer* player = nullptr;   ///< set if the source is a recording
  Screen screen;                   ///< that its samples are on
  Warnings warnings = {};          ///< of a recording
  /// Tells a calibrated webcam that the observer looks at this point now. Returns false if it sees
  /// no eyes. Other sources have none.
  std::function<bool(const glm::dvec2& point_px)> lookedAt = {};
  Playback playback = {};
  /// With the recording's head and display, or the study's `eye.path`, on the recording's clock.
  std::optional<Study> study = {};
};

/// @param name  pupil:HOST:PORT
/// @throws InputError
std::unique_ptr<LiveSource> openPupil(const std::string& name, const Screen& screen);

/// @param name  mouse; trace:FILE (or trace:simulated); pupil:HOST:PORT; lsl[:NAME]; socket[:RATE];
///   webcam[:N|FILE]. A map of foci calibrate gaze in the study is applied to all but the mouse.
/// @throws InputError for an unknown source
NamedSource openLiveSource(const std::string& name, const Study& study);

/// What the window shows once a file is dropped on it: a scene or a study, or else a recording,
/// which plays in the study that is shown.
/// @param options  of the command, for a scene or a study: --size, --device and --no-cache
/// @param source   of the gaze so far
/// @throws InputError
LiveNext openedFile(const std::filesystem::path& file, const StudyRequest& options,
                    const std::string& source, const Study& now);

}  // namespace foci
