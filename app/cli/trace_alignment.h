// `foci trace info REC --scene SCENE`: how a headset recording lies in a scene.
#pragma once

#include <string>

#include "app/cli/trace_options.h"

namespace foci {

struct AlignmentOptions {
  std::string scene{}, up{}, out{"alignment.svg"};
  bool overwrite = false;
};

void addAlignmentOptions(CLI::App& command, AlignmentOptions& options);

/// Draws the recording in the scene, and prints how well it fits, and what would fit better.
/// @param trace  its study, if there is one, has the scene unless the option names it
/// @throws InputError
void showAlignment(const std::string& recording, const TraceOptions& trace,
                   const AlignmentOptions& options, bool json);

}  // namespace foci
