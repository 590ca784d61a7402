#include "gaze/sources/labelled.h"

#include <algorithm>

#include "base/text.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

/// A coder judges each sample: `unjudged` is no label.
std::optional<GazeState> labelNamed(std::string_view name) {
  const auto state = stateNamed(name);
  return state == GazeState::unjudged ? std::nullopt : state;
}

/// @param first  the label of the first sample, for the error
void requireKnownWord(const std::filesystem::path& file, const Coder& coder,
                      const std::string& first) {
  const auto& labels = coder.labels;
  if (std::ranges::any_of(labels, [](const auto& label) { return label.has_value(); })) return;
  throw InputError(file.string(), "column " + shown(coder.name) +
                                      ": no label is known, the first is " + shown(first) +
                                      ": expected fixation, saccade, pso, pursuit, blink or lost");
}

}  // namespace

LabelledTrace readLabelledTrace(const std::filesystem::path& file, const Screen& fallback_screen,
                                const TraceColumns& described) {
  LabelledTrace labelled{.trace = readTrace(file, described, fallback_screen), .coders = {}};
  LineReader lines(file);
  TextRows rows(lines);
  std::vector<std::size_t> columns;
  std::vector<std::string> first_words;
  for (std::size_t i = 0; i < rows.names().size(); ++i) {
    const std::string& name = rows.names()[i];
    if (name != "coder" && name != "label" && !name.starts_with("coder_")) continue;
    columns.push_back(i);
    labelled.coders.push_back({.name = name});
  }
  if (columns.empty()) throw rows.error("no column coder, coder_NAME or label");
  while (rows.next()) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] >= rows.size()) throw rows.error("a label is missing");
      if (first_words.size() == i) first_words.emplace_back(rows.text(columns[i]));
      labelled.coders[i].labels.push_back(labelNamed(rows.text(columns[i])));
    }
  }
  if (labelled.coders[0].labels.size() != labelled.trace.samples.size()) {
    throw InputError(file.string(), "labels: expected one for every sample");
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    requireKnownWord(file, labelled.coders[i], first_words[i]);
  }
  return labelled;
}

}  // namespace foci
