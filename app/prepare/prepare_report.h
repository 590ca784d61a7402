// The page beside a prepared scene: what it is made of, and histograms of its kernels' sums.
#pragma once

#include <string>

#include "app/prepare/prepare_command.h"

namespace foci {

/// A whole HTML page that opens from disk.
std::string prepareReport(const PrepareRequest& request, const PrepareSummary& summary);

}  // namespace foci
