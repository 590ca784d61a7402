// `foci join`: the parts of a run become the run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/replay/part.h"
#include "app/replay/run_writer.h"

namespace foci {

/// Puts parts in order.
/// @throws InputError unless they are the parts of one run, each frame in one of them
std::vector<Part> inOrder(std::vector<Part> parts);

/// Writes the files of a replay to `out`, with the bytes that one process would have written. Only
/// times (`render_ms`), and what the manifest says of command and machine, may differ.
/// @param parts  `inOrder`
/// @param study  `studyOf` a part
/// @throws InputError, std::runtime_error
RunResult join(const std::vector<Part>& parts, const Study& study, const std::filesystem::path& out,
               const std::string& command, const OutputGuard& guard);

}  // namespace foci
