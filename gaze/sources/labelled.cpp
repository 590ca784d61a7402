#include "gaze/sources/labelled.h"

#include <algorithm>

#include "base/text.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/table_preamble.h"
#include "gaze/sources/trace_reader.h"

namespace foci {
namespace {

std::optional<GazeState> stateNamed(std::string_view name) {
  for (const GazeState state : {GazeState::fixation, GazeState::saccade, GazeState::oscillation,
                                GazeState::pursuit, GazeState::blink, GazeState::lost}) {
    if (name == nameOf(state)) return state;
  }
  return std::nullopt;
}

/// @param first  the label of the first sample, for the error
void requireKnownWord(const std::filesystem::path& file, const Coder& coder,
                      const std::string& first) {
  const auto& labels = coder.labels;
  if (std::any_of(labels.begin(), labels.end(), [](const auto& label) { return label; })) return;
  throw InputError(file.string(), "column " + shown(coder.name) +
                                      ": no label is known, the first is " + shown(first) +
                                      ": expected fixation, saccade, pso, pursuit, blink or lost");
}

}  // namespace

LabelledTrace readLabelledTrace(const std::filesystem::path& file, const Screen& fallback_screen,
                                const TraceColumns& described) {
  LabelledTrace labelled{.trace = readTrace(file, described, fallback_screen), .coders = {}};
  LineReader lines(file);
  std::string_view line;
  std::vector<std::string_view> fields;
  std::vector<std::size_t> columns;
  std::vector<std::string> first_words;
  TablePreamble preamble;
  char delimiter = ',';
  while (lines.next(line)) {
    if (trimmed(line).empty() || line.starts_with('#')) continue;
    if (!columns.empty()) {
      splitRow(line, delimiter, fields);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i] >= fields.size()) throw lines.error("a label is missing");
        if (first_words.size() == i) first_words.emplace_back(fields[columns[i]]);
        labelled.coders[i].labels.push_back(stateNamed(fields[columns[i]]));
      }
      continue;
    }
    if (readSeparatorLine(line, preamble)) continue;
    delimiter = delimiterOf(line, preamble);
    splitRow(line, delimiter, fields);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (fields[i] != "coder" && fields[i] != "label" && !fields[i].starts_with("coder_")) {
        continue;
      }
      columns.push_back(i);
      labelled.coders.push_back({.name = std::string(fields[i])});
    }
    if (columns.empty()) throw lines.error("no column coder, coder_NAME or label");
  }
  if (labelled.coders.empty() ||
      labelled.coders[0].labels.size() != labelled.trace.samples.size()) {
    throw InputError(file.string(), "labels: expected one for every sample");
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    requireKnownWord(file, labelled.coders[i], first_words[i]);
  }
  return labelled;
}

}  // namespace foci
