// Two or more runs side by side: one page and one table.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/platform/output_guard.h"
#include "app/replay/compared_run.h"

namespace foci {

/// compare.tsv: one row for each run.
std::string compareTable(const std::vector<ComparedRun>& runs);

/// compare.html: figures, dwell times, focus over time, and pictures with their difference from
/// those of the first run.
std::string comparePage(const std::vector<ComparedRun>& runs);

/// Files of a comparison in `out`.
std::vector<std::filesystem::path> compareFiles(const std::filesystem::path& out);

/// Reads the runs and writes both files. @throws InputError, std::runtime_error
void compareRuns(const std::vector<std::filesystem::path>& folders,
                 const std::filesystem::path& out, const OutputGuard& guard);

}  // namespace foci
