// manifest.json: enough to run it again to the same bytes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/replay.h"
#include "app/study.h"
#include "gaze/gaze.h"

namespace foci {

struct InputFile {
  std::filesystem::path path;
  std::string sha256;
};

struct ManifestFacts {
  std::string command;
  unsigned threads = 0;
  std::vector<InputFile> inputs;
  std::string frames_sha256;  ///< of the 8-bit sRGB bytes of all frames, in order, before encoding
};

std::string manifestJson(const Study& study, const GazeTrace& trace, const ReplaySummary& summary,
                         const ManifestFacts& facts);

/// `--json`: the summary as one line.
std::string summaryJson(const ReplaySummary& summary);

}  // namespace foci
