// What the chart's pages share: their look, and the images that a click on a point opens.
#pragma once

#include <ostream>
#include <string>

namespace foci {

/// Besides `kPageStyle`.
extern const char* const kChartStyle;

/// A table's cell. @param text  HTML
std::string cell(const std::string& text, const char* kind = "");

/// The key to the colours of the methods' families.
void writeFamilies(std::ostream& out);

/// Opens for every link in an <svg>: its image, the reference that its `data-at` names, and the
/// difference, a file named as the image with `_difference` behind.
void writeImageDialog(std::ostream& out);

}  // namespace foci
