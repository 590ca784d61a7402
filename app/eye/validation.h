// foci against published measurements: each figure with its source, its bounds and the value here.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/platform/output_guard.h"

namespace foci {

struct ValidationFigure {
  std::string group;      ///< what is validated
  std::string what = {};  ///< under which conditions
  std::string unit;
  std::string source;  ///< publication
  double expected = 0.0, tolerance = 0.0, value = 0.0;
  int digits = 2;
  std::string known_miss = {};  ///< why it is out of bounds; empty: it may not be

  bool inBounds() const;
};

/// Computes every figure. Progress on standard error.
std::vector<ValidationFigure> validationFigures();

/// The figures as a table (TSV) and as a page (HTML).
std::string validationTable(const std::vector<ValidationFigure>& figures);
std::string validationPage(const std::vector<ValidationFigure>& figures);

/// The files that `foci validate` writes.
std::vector<std::filesystem::path> validationFiles(const std::filesystem::path& out);

/// Computes the figures and writes the files.
std::vector<ValidationFigure> validate(const std::filesystem::path& out, const OutputGuard& guard);

}  // namespace foci
