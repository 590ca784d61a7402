// XDF files of the Lab Streaming Layer (github.com/sccn/xdf, specification 1.0).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Whether a file begins with XDF's magic bytes.
bool isXdf(const std::filesystem::path& file);

/// What the header of a stream says: the XML of the Lab Streaming Layer, alive or in a file.
struct LslStream {
  std::string name{}, type{}, format{};
  std::size_t channels = 0;
  double rate_Hz = 0.0;             ///< nominal; 0: irregular
  std::string columns{"time [s]"};  ///< of a table (TSV): time, and the channels' labels and units

  bool hasTexts() const { return format == "string" && channels > 0; }
  bool hasNumbers() const { return format != "string" && channels > 0; }
  /// A stream of numbers whose type or name has "gaze" or "eye" in it.
  bool isGaze() const;
};

/// @param file  for errors
/// @throws InputError unless it has up to 1024 channels
LslStream lslStreamOf(std::string_view xml, const std::string& file);

struct XdfTable {
  std::string text;    ///< a table (TSV) of the gaze stream: time [s] and its channels
  std::string stream;  ///< its name
  /// Samples of the streams of texts, in order of time on the recorder's clock. The texts of
  /// several channels are joined by blanks.
  std::vector<TraceMarker> markers;
  std::size_t clock_offsets = 0;  ///< measured between the clocks of tracker and recorder
};

/// The gaze stream of a file as a table. Columns have the channels' labels and units. Times are on
/// the recorder's clock: the line through the clock offsets, by least squares, is added to the
/// stream's times. A sample without a time follows the one before by 1 / nominal rate.
/// @param stream  a stream's name; empty: the only stream of gaze (`LslStream::isGaze`)
/// @throws InputError if the file is damaged, or if there is no such stream or more than one
XdfTable readXdf(const std::filesystem::path& file, std::string_view stream);

}  // namespace foci
