// The tables of a live run's record that a replay takes up again. Times are whole microseconds and
// numbers are written to the last bit, so that what is read back is what was.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "app/session/session.h"

namespace foci {

/// `time_s` at the nearest whole microsecond, as six decimals read back give it.
double wholeMicroseconds(double time_s);

/// gaze.tsv: every sample in order of arrival. What a replay uses of a sample comes back from
/// `readTrace` as it was; of an eye, its point on the screen.
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

/// A frame as a record names it.
struct RecordedFrame {
  double time_s = 0.0;
  std::string method;
};

/// Times and methods of a frames.tsv.
/// @return not empty; times increase
/// @throws InputError
std::vector<RecordedFrame> readFrames(const std::filesystem::path& file);

/// changes.tsv: a line a change.
std::string changesHeader();
std::string changeRow(const Change& change);

/// @return in order of time
/// @throws InputError, also for keys that do not change while a session runs
std::vector<Change> readChanges(const std::filesystem::path& file);

}  // namespace foci
