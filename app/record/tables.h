// The tables that a replay writes: frames.tsv, events.tsv.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "app/session/frame_record.h"
#include "app/study/study.h"
#include "gaze/events/event_labels.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/recording_quality.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// A number as a field of a table; `n/a` where it is absent.
std::string orAbsent(const std::optional<double>& value, int digits);

/// frames.tsv, row by row; `n/a` where a value is absent.
class FrameTable {
 public:
  /// @param trials  for the column trial, in order of their beginnings
  explicit FrameTable(const std::filesystem::path& file, std::vector<TraceTrial> trials = {});

  /// @throws std::runtime_error where the file cannot be written
  void add(std::size_t frame, const FrameRecord& record);
  void flush() { out_.flush(); }
  void finish();

 private:
  std::string file_;
  std::ofstream out_;
  std::vector<TraceTrial> trials_;
};

/// events.tsv.
/// @param events    with points on the screen of the images, px
/// @param trials    in order of their beginnings
/// @param detector  adds the columns probability and detector
std::string eventTable(const std::vector<GazeEvent>& events, const std::vector<TraceTrial>& trials,
                       std::optional<Detector> detector = std::nullopt);

struct RunEvents {
  /// That begin or end within the run, on the study's screen.
  std::vector<GazeEvent> events{};
  std::vector<GazeState> states{};      ///< of every sample of the recording
  RecordingQuality quality{};           ///< of the recording
  std::vector<std::string> warnings{};  ///< `eventWarnings`
};

/// The events within [from_s, to_s).
/// @param trace  with its screen
RunEvents eventsOfRun(const Study& study, const GazeTrace& trace, double from_s, double to_s);

std::size_t countOf(const std::vector<GazeEvent>& events, GazeState kind);

}  // namespace foci
