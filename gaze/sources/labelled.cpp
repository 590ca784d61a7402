#include "gaze/sources/labelled.h"

#include "base/text.h"
#include "gaze/sources/line_reader.h"
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

}  // namespace

LabelledTrace readLabelledTrace(const std::filesystem::path& file, const Screen& fallback_screen,
                                const TraceColumns& described) {
  LabelledTrace labelled{.trace = readTrace(file, described, fallback_screen), .coders = {}};
  LineReader lines(file);
  std::string_view line;
  std::vector<std::string_view> fields;
  std::vector<std::size_t> columns;
  char delimiter = '\t';
  while (lines.next(line)) {
    if (trimmed(line).empty() || line.starts_with('#')) continue;
    if (!columns.empty()) {
      splitFields(line, delimiter, fields);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i] >= fields.size()) throw lines.error("a label is missing");
        labelled.coders[i].labels.push_back(stateNamed(fields[columns[i]]));
      }
      continue;
    }
    if (line.find(delimiter) == std::string_view::npos) delimiter = ',';
    splitFields(line, delimiter, fields);
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
  return labelled;
}

}  // namespace foci
