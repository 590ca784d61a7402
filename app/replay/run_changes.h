// What changed in the course of a replayed live run, for its report.
#pragma once

#include <string>
#include <vector>

#include "app/study/session_settings_of.h"
#include "app/study/study.h"

namespace foci {

/// A key that took another value at a frame of the run.
struct SettingChange {
  double time_s = 0.0;
  std::string key;
  std::string from, to;  ///< as JSON; "null": absent
};

struct RunChanges {
  Study start;                         ///< in force at the first frame
  std::vector<SettingChange> changes;  ///< after it, in order of time
  std::vector<TraceMarker> markers;    ///< from the first frame to the last
};

/// @param changes  in order of time; those before the first frame go into `start`
RunChanges changesOfRun(const Study& study, const std::vector<Change>& changes,
                        const std::vector<TraceMarker>& markers, double first_s, double last_s);

/// "observer.pupil_mm 2, 4, 8; eye.position_m 245 times": each key with its values, or how often it
/// changed. Empty without changes.
std::string changesText(const std::vector<SettingChange>& changes);

/// The values of a key: at the start, then after each change. Empty if it never changed.
std::vector<std::string> valuesOf(const std::vector<SettingChange>& changes,
                                  const std::string& key);

/// A line or label on the time axis: an event marker or a change.
struct RunMark {
  double time_s = 0.0;
  bool is_change = false;
  std::string text;  ///< plain
};

/// Changes and markers in order of time.
std::vector<RunMark> marksOf(const RunChanges& run);

/// A table of the marks, numbered as in the charts; empty without marks.
std::string marksTable(const std::vector<RunMark>& marks);

}  // namespace foci
