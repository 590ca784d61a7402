// The tables that a replay writes: frames.tsv, events.tsv.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "app/session.h"
#include "gaze/events/gaze_events.h"

namespace foci {

/// frames.tsv, row by row; `n/a` where a value is absent.
class FrameTable {
 public:
  FrameTable(const std::filesystem::path& file, std::string method);

  /// @throws std::runtime_error where the file cannot be written
  void add(std::size_t frame, const FrameRecord& record);
  void finish();

 private:
  std::string file_, method_;
  std::ofstream out_;
};

/// events.tsv. @param events  with points on the screen of the pictures, px
std::string eventTable(const std::vector<GazeEvent>& events);

/// `value` with `digits` after the point, never "-0".
std::string decimal(double value, int digits);

/// The same; "inf" for what is not finite.
std::string decimalOrInf(double value, int digits);

/// 12345.6 as 12,346.
std::string thousands(double value);

/// Milliseconds, as many digits as are worth reading.
std::string milliseconds(double ms);

}  // namespace foci
