// Accuracy on the fit's own samples is no validation.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "base/input_error.h"

namespace foci {

/// @param file     of `others`
/// @param hasGaze  of a sample; others are passed over
/// @throws InputError where each of the first 1000 of `others` is one of `fit`
template <class Sample, class HasGaze>
void refuseOwnSamples(const std::filesystem::path& file, const std::vector<Sample>& fit,
                      const std::vector<Sample>& others, const HasGaze& hasGaze) {
  constexpr std::size_t kTested = 1000;
  std::size_t tested = 0;
  for (const Sample& sample : others) {
    if (tested == kTested) break;
    if (!hasGaze(sample)) continue;
    if (std::find(fit.begin(), fit.end(), sample) == fit.end()) return;
    ++tested;
  }
  if (tested == 0) return;
  throw InputError("--validate " + file.string(),
                   "the samples of the fit: expected others, or leave --validate out");
}

}  // namespace foci
