// The known name that a misspelt one most likely means.
#pragma once

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

namespace foci {

/// Levenshtein's distance: the least number of insertions, deletions and replacements.
inline int editDistance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = std::exchange(row[0], static_cast<int>(i) + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// @param known  not empty; the first of equally near ones is taken
inline std::string_view nearestName(std::string_view name,
                                    const std::vector<std::string_view>& known) {
  name = name.substr(0, 80);  // a hostile name may be long
  return *std::min_element(known.begin(), known.end(), [&](auto a, auto b) {
    return editDistance(name, a) < editDistance(name, b);
  });
}

}  // namespace foci
