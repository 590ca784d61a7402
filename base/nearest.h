// "Did you mean": the known word nearest to a mistyped one.
#pragma once

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace foci {

/// Levenshtein distance (1966): the smallest number of insertions, deletions and replacements of
/// one character that turn `a` into `b`.
inline std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

/// The largest distance at which two words are still spellings of the same one: a third of their
/// letters, rounded; none in a single letter.
inline std::size_t spellingDistance(std::string_view a, std::string_view b) {
  return (std::min(a.size(), b.size()) + 1) / 3;
}

/// Whether `b` may be what `a` was meant to be. Two neighbours in the wrong order are one error.
inline bool isMisspelt(std::string_view a, std::string_view b) {
  if (a.size() > 64 || b.size() > 64) return false;
  std::size_t distance = editDistance(a, b);
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    std::string swapped(a);
    std::swap(swapped[i], swapped[i + 1]);
    distance = std::min(distance, editDistance(swapped, b) + 1);
  }
  return distance <= spellingDistance(a, b);
}

/// The known word that `word` is a misspelling of; nothing if none is close.
inline std::optional<std::string> nearWord(std::string_view word,
                                           const std::vector<std::string>& known) {
  const std::string* best = nullptr;
  for (const std::string& one : known) {
    if (!isMisspelt(word, one)) continue;
    if (!best || editDistance(word, one) < editDistance(word, *best)) best = &one;
  }
  return best ? std::optional(*best) : std::nullopt;
}

/// The known word with the smallest edit distance to the first 64 characters of `word`; the first
/// one of several. @param known  not empty
inline std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  const std::string_view head = word.substr(0, 64);
  return *std::ranges::min_element(known, [&](const auto& a, const auto& b) {
    return editDistance(head, a) < editDistance(head, b);
  });
}

}  // namespace foci
