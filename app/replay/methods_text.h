// methods.md and references.bib of a run: paragraphs for the methods section of a paper, with
// citations as Pandoc and Quarto take them.
#pragma once

#include <string>

#include "app/replay/report.h"

namespace foci {

struct MethodsText {
  std::string markdown, bibtex;
};

MethodsText methodsOf(const GazeTrace& trace, const ReportFacts& facts);

/// "0.50 m", "infinity", "behind the eye".
std::string distanceText(double focus_D);

/// How the eye focuses, its pupil and its optics, in sentences: plain text, each after a blank.
std::string eyeSentences(const Study& study);

}  // namespace foci
