// The page and the table over all recordings of a batch.
#pragma once

#include <string>
#include <vector>

#include "app/replay/recordings.h"

namespace foci {

/// recordings.tsv: one row for each recording, `n/a` where it has no run.
std::string recordingsTable(const std::vector<BatchResult>& results);

/// index.html: an image of each run, and a link to its report.
/// @param study  of any of the recordings
std::string recordingsPage(const Study& study, const std::vector<BatchResult>& results);

}  // namespace foci
