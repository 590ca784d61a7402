// Accuracy on the fit's own samples is no validation.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "base/input_error.h"

namespace foci {

/// @param file  of `others`
/// @throws InputError where each of the first 1000 of `others` is one of `fit`
template <class Sample>
void refuseOwnSamples(const std::filesystem::path& file, const std::vector<Sample>& fit,
                      const std::vector<Sample>& others) {
  constexpr std::size_t kTested = 1000;
  const auto end = others.begin() + static_cast<std::ptrdiff_t>(std::min(others.size(), kTested));
  const bool own = std::all_of(others.begin(), end, [&](const Sample& sample) {
    return std::find(fit.begin(), fit.end(), sample) != fit.end();
  });
  if (!others.empty() && own) {
    throw InputError("--validate " + file.string(),
                     "the samples of the fit: expected others, or leave --validate out");
  }
}

}  // namespace foci
