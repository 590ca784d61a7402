// The summary of a run for people.
#pragma once

#include <string>

#include "app/record/manifest.h"

namespace foci {

std::string summaryText(const RunSummary& summary);

}  // namespace foci
