// What the pages of the evaluations share: their look, and the dialog that a click on a point
// opens.
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace foci {

/// The style of all three pages, besides `kPageStyle`.
extern const char* const kEvaluationStyle;

/// The style of the pages of `foci chart`, besides `kEvaluationStyle`.
extern const char* const kChartStyle;

/// A number in HTML; an infinity sign if it is not finite.
std::string numberHtml(double value, int digits);

/// "41.3 dB"; "exact" if it is infinite.
std::string decibels(double value);

/// "1 thread", "8 threads".
std::string threadsText(unsigned threads);

/// The key to the colours of the methods' families, and of other renderers.
void writeFamilies(std::ostream& out, bool imported = false);

/// A dial of a page: radio buttons, of which one is chosen.
/// @param choices  value and text of each, HTML
std::string dialHtml(const char* name, const char* title,
                     const std::vector<std::pair<std::string, std::string>>& choices,
                     const std::string& chosen);

/// Hides each panel that has data of a dial's name other than what the dial shows.
extern const char* const kPanelScript;

/// A dialog that every link in an <svg> opens. The dialog shows the image that the link names, the
/// reference in the link's `data-at`, and the difference (`differenceFileOf` the image).
void writeImageDialog(std::ostream& out);

/// "a.png" to "a_difference.png".
std::string differenceFileOf(std::string image);

}  // namespace foci
