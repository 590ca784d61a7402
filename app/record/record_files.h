// The tables of a live record that a replay reads. Times are whole microseconds and numbers have
// every digit, so they read back to the same bits.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "app/study/session_settings_of.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// `time_s` rounded to a microsecond, as it reads back from six decimals.
double wholeMicroseconds(double time_s);

/// gaze.tsv: every sample, in order of arrival. `readTrace` reads back all that a replay uses. Of
/// each eye that is its point on the screen.
class GazeTable {
 public:
  /// @param screen  that the samples are on
  GazeTable(const std::filesystem::path& file, const Screen& screen);

  /// @throws std::runtime_error where the file cannot be written
  void add(const GazeSample& sample);
  void flush();

 private:
  std::string file_;
  std::ofstream out_;
};

/// head.tsv: the poses of a head in the scene, of each frame and of each sample of gaze. They read
/// back to the same bits.
struct HeadRow {
  double time_s = 0.0;
  bool of_sample = false;
  bool inferred = false;  ///< the sample's gaze
  HeadInWorld head{};
};
std::string headHeader();
std::string headRow(const HeadRow& row);
/// @throws InputError
std::vector<HeadRow> readHeads(const std::filesystem::path& file);
/// Gives the samples their heads; both are in order of time.
void giveHeads(const std::vector<HeadRow>& rows, std::vector<GazeSample>& samples);

struct RecordedFrame {
  double time_s = 0.0;
  std::string method;
  /// Time of the newest sample that the frame knew; -infinity: none. Samples that were measured
  /// before a frame may arrive after it.
  double known_s = 0.0;
};

/// Frames of a frames.tsv. Without a column gaze_time_s each frame knows all samples before it.
/// @return not empty; times increase
/// @throws InputError
std::vector<RecordedFrame> readFrames(const std::filesystem::path& file);

/// Frames per second of a live run, to a thousandth and from 1 to 1000.
/// @param span_s     from the first frame to the last
/// @param otherwise  if they do not tell
double meanRate_Hz(std::size_t frames, double span_s, double otherwise);

/// changes.tsv: one line for each change.
std::string changesHeader();
std::string changeRow(const Change& change);

/// event_markers.tsv: a header line, then `time<tab>text`.
/// @return in order of time @throws InputError
std::vector<TraceMarker> readEventMarkers(const std::filesystem::path& file);

/// @return in order of time
/// @throws InputError, also for keys that do not change while a session runs
std::vector<Change> readChanges(const std::filesystem::path& file);

}  // namespace foci
