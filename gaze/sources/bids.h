// Eye tracking in the Brain Imaging Data Structure: `*_physio.tsv.gz` without a header line, and a
// JSON file of the same name (the sidecar) that describes the columns.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "gaze/sources/trace_reader.h"

namespace foci {

/// The sidecar of a recording whose name ends in _physio.tsv or _physio.tsv.gz, if it exists.
std::optional<std::filesystem::path> bidsSidecarOf(const std::filesystem::path& file);

/// Reads the columns timestamp, x_coordinate, y_coordinate, pupil_size and blink, with the
/// sidecar's units. Names that begin with left_ or right_ belong to one eye. A pupil that is not in
/// millimetres is ignored. The screen geometry comes from StimulusPresentation, and so does the
/// corner that positions count from: the upper left or the lower left one.
/// @param described  as in `streamTrace`
/// @throws InputError
TraceHeader readBids(const std::filesystem::path& file, const std::filesystem::path& sidecar,
                     const TraceColumns& described, const Screen& fallback_screen,
                     const TakeSample& take);

/// The recording of the other eye: `recording-eye2` beside `recording-eye1`, or the reverse, if it
/// has a sidecar.
std::optional<std::filesystem::path> bidsOtherEyeOf(const std::filesystem::path& file);

/// Reads a recording as `readBids`, and the other eye's beside it. A sample has both eyes if their
/// times agree within half of an interval; its point is their `Cyclopean` point.
/// @param other  as `bidsOtherEyeOf` finds it
/// @throws InputError also unless the sidecars' RecordedEye are left and right
TraceHeader readBidsEyes(const std::filesystem::path& file, const std::filesystem::path& other,
                         const TraceColumns& described, const Screen& fallback_screen,
                         const TakeSample& take);

/// Writes a recording and its sidecar, sample by sample, in constant memory.
class BidsWriter {
 public:
  /// @param file  ends in _physio.tsv.gz
  /// @param eyes  also write the point and the pupil of each eye
  /// @throws InputError on another name, std::runtime_error if the file cannot be written
  BidsWriter(const std::filesystem::path& file, bool eyes);
  ~BidsWriter();
  BidsWriter(const BidsWriter&) = delete;
  BidsWriter& operator=(const BidsWriter&) = delete;

  void add(const GazeSample& sample);

  /// Closes the recording and writes the sidecar. Quantities of the screen that are 0 are left out.
  /// @throws std::runtime_error if not everything could be written
  void finish(const TraceHeader& header, double rate_Hz);

  /// Name of the sidecar of `file`. @throws InputError if `file` has another ending
  static std::filesystem::path sidecarFor(const std::filesystem::path& file);

 private:
  struct Output;
  std::filesystem::path file_;
  bool eyes_;
  std::unique_ptr<Output> out_;
};

}  // namespace foci
