// The report on a prepared scene: its facts, and histograms of the sums of its kernels.
#pragma once

#include <string>

#include "app/prepare/prepare.h"

namespace foci {

/// A complete HTML page.
std::string prepareReport(const PrepareRequest& request, const PrepareSummary& summary);

}  // namespace foci
