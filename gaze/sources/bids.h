// Eye tracking as the Brain Imaging Data Structure has it: `*_physio.tsv.gz` without a header line,
// and a JSON file of the same name that says what its columns are.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "gaze/sources/trace_reader.h"

namespace foci {

/// The JSON beside a recording whose name ends in _physio.tsv or _physio.tsv.gz, if there is one.
std::optional<std::filesystem::path> bidsSidecarOf(const std::filesystem::path& file);

/// Columns timestamp, x_coordinate, y_coordinate, pupil_size (in mm, or it is absent), with the
/// units that the sidecar says; left_ and right_ before the last three for two eyes. The screen is
/// StimulusPresentation's.
/// @throws InputError
TraceHeader readBids(const std::filesystem::path& file, const std::filesystem::path& sidecar,
                     const Screen& fallback_screen, const TakeSample& take);

/// Writes such a pair, sample by sample, in constant memory.
class BidsWriter {
 public:
  /// @param file  ends in _physio.tsv.gz
  /// @param eyes  whether to write the points and pupils of both eyes, too
  /// @throws InputError on another name, std::runtime_error where it cannot be written
  BidsWriter(const std::filesystem::path& file, bool eyes);
  ~BidsWriter();
  BidsWriter(const BidsWriter&) = delete;
  BidsWriter& operator=(const BidsWriter&) = delete;

  void add(const GazeSample& sample);

  /// Writes the sidecar, too. @param screen  quantities that are 0 are left out
  /// @throws std::runtime_error where not all could be written
  void finish(const TraceHeader& header, double rate_Hz);

  /// Where the sidecar of `file` goes.
  static std::filesystem::path sidecarFor(const std::filesystem::path& file);

 private:
  struct Output;
  std::filesystem::path file_;
  bool eyes_;
  std::unique_ptr<Output> out_;
};

}  // namespace foci
