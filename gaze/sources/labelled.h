// Recordings whose samples human coders have labelled.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

struct Coder {
  std::string name;  ///< name of the column
  /// One for each sample. Absent if the word is none of `nameOf`.
  std::vector<std::optional<GazeState>> labels{};
};

struct LabelledTrace {
  GazeTrace trace;
  std::vector<Coder> coders;  ///< one or more
};

/// Reads a table as `readTrace` does, with one column of labels for each coder. Such a column is
/// called coder, coder_NAME or label, and holds the words of `nameOf`.
/// @throws InputError as `readTrace`, and if there is no column of labels, or if a column has none
///   of those words
LabelledTrace readLabelledTrace(const std::filesystem::path& file, const Screen& fallback_screen,
                                const TraceColumns& described = {});

}  // namespace foci
