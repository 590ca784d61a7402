// The part of the report that holds the surfels of a mesh against its triangles.
#pragma once

#include <string>

#include "app/prepare/prepare.h"

namespace foci {

/// CSS of the section, besides `kPageStyle`.
extern const char* const kFidelityStyle;

/// Figures, a map of all views and the worst view, as HTML; or why there are none.
std::string fidelitySection(const PrepareSummary& summary);

/// The figures in one sentence, for a terminal; or why there are none.
std::string fidelityText(const PrepareSummary& summary);

}  // namespace foci
