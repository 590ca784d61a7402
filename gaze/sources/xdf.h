// XDF files of the Lab Streaming Layer (github.com/sccn/xdf, specification 1.0).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Whether a file begins with XDF's magic bytes, unpacked.
bool isXdf(const std::filesystem::path& file);

/// What the header of a stream says: the XML of the Lab Streaming Layer, alive or in a file.
struct LslStream {
  std::string name{}, type{}, format{};
  std::size_t channels = 0;
  double rate_Hz = 0.0;                          ///< nominal; 0: irregular
  std::vector<std::string> columns{"time [s]"};  ///< and the channels' labels with their units

  bool hasTexts() const { return format == "string" && channels > 0; }
  bool hasNumbers() const { return format != "string" && channels > 0; }
  /// A stream of texts, or of numbers that come now and then, whose type is "Markers".
  bool isMarkers() const;
  /// A stream of numbers whose type or name has "gaze" or "eye" in it.
  bool isGaze() const;
};

/// @param file  for errors
/// @throws InputError unless it has up to 1024 channels
LslStream lslStreamOf(std::string_view xml, const std::string& file);

struct XdfTable {
  std::string stream{};                ///< its name
  std::vector<std::string> columns{};  ///< as `LslStream::columns`
  std::vector<double> values{};        ///< of the columns, row after row
  /// Samples of the streams of markers, in order of time on the recorder's clock. The texts of
  /// several channels are joined by blanks.
  std::vector<TraceMarker> markers{};
  std::size_t clock_offsets = 0;         ///< measured between the clocks of tracker and recorder
  int clock_resets = 0;                  ///< of the tracker's clock
  std::optional<std::string> cut_off{};  ///< where the file ends within a chunk
};

/// The gaze stream of a file, packed with gzip (.xdfz) or not. Times are on the recorder's clock
/// (recorder_clock.h). A sample without a time follows the one before by 1 / nominal rate.
/// @param stream  a stream's name, or its number in the file, such as "#2"; empty: the only stream
///   of gaze (`LslStream::isGaze`)
/// @throws InputError if there is no such stream or more than one
XdfTable readXdf(const std::filesystem::path& file, std::string_view stream);

}  // namespace foci
