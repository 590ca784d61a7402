// The gaze source that `foci live --source` names.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>

#include "app/platform/warnings.h"
#include "app/study/study.h"
#include "gaze/live/live_source.h"

namespace foci {

struct NamedSource {
  std::unique_ptr<LiveSource> source;
  MouseSource* mouse = nullptr;    ///< set if the source is the mouse, which the window moves
  PushedSource* pushed = nullptr;  ///< set if the source is the socket, which brings its samples
  Screen screen;                   ///< that its samples are on
  Warnings warnings = {};          ///< of a recording
  /// Tells a calibrated webcam that the observer looks at this point now. Returns false if it sees
  /// no eyes. Other sources have none.
  std::function<bool(const glm::dvec2& point_px)> lookedAt = {};
};

/// @param name  mouse; trace:FILE (or trace:simulated); pupil:HOST:PORT; lsl[:NAME]; socket[:RATE];
///   webcam[:N|FILE]. A map of foci calibrate gaze in the study is applied to all but the mouse.
/// @throws InputError for an unknown source
NamedSource openLiveSource(const std::string& name, const Study& study);

}  // namespace foci
