// Recordings that people have labelled, sample by sample.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct Coder {
  std::string name;  ///< of its column
  /// One a sample; absent where the coder could not tell, or used another word.
  std::vector<std::optional<GazeState>> labels{};
};

struct LabelledTrace {
  GazeTrace trace;
  std::vector<Coder> coders;  ///< one or more
};

/// A TSV or CSV as `readTrace` takes it, with columns called coder, coder_NAME or label that hold
/// the words of `nameOf`.
/// @throws InputError as `readTrace`, and where there is no such column
LabelledTrace readLabelledTrace(const std::filesystem::path& file, const Screen& fallback_screen);

}  // namespace foci
