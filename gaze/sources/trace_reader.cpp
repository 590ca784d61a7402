#include "gaze/sources/trace_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/input_error.h"
#include "base/memory_budget.h"
#include "base/quantile.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/recording_formats.h"
#include "gaze/sources/rows.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/trace_doubts.h"
#include "gaze/sources/trace_summary.h"

namespace foci {
namespace {

// No tracker has a rate outside these limits: the unit of time must be wrong.
constexpr double kMaxDuration_s = 86'400.0;  // a day; a longer recording has a broken clock

/// Rate from the median interval, or from the mean of rounded ones, rounded to a thousandth.
double medianRate_Hz(const std::vector<GazeSample>& samples) {
  std::vector<double> interval_s(samples.size() - 1);
  TimeStep step;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    interval_s[i] = samples[i + 1].time_s - samples[i].time_s;
    step.add(interval_s[i]);
  }
  RoundedIntervals rounded(quantile(interval_s, 0.5), step.step_s());
  for (const double each_s : interval_s) rounded.add(1, each_s);
  return rounded.rate_Hz();
}

TraceHeader readTable(const RecordingFile& file, const Screen& fallback_screen,
                      const TakeSample& take) {
  LineReader lines(file.path());
  TextRows rows(lines);
  return readRows(rows, file.columns(), fallback_screen, take);
}

const RecordingFormat kPlainTable{.read = readTable};

/// @throws InputError if the file is none
const RecordingFormat& formatOf(const RecordingFile& file) {
  if (kNeonNative.is(file)) return kNeonNative;
  requireRegularFile(file.path());
  if (kTobiiGlasses.is(file)) return kTobiiGlasses;
  requireGazeText(file.path());
  for (const RecordingFormat* format :
       {&kBids, &kXdf, &kEyeLinkAsc, &kEyeNavGs, &kHoloLens, &kAria}) {
    if (format->is(file)) return *format;
  }
  return kPlainTable;
}

/// Nothing for a file that cannot be read: whoever reads it says why.
const RecordingFormat* formatSoFar(const RecordingFile& file) {
  try {
    return std::filesystem::exists(file.path()) ? &formatOf(file) : nullptr;
  } catch (const std::exception&) {
    return nullptr;
  }
}

/// The fallback replaces what the recording does not state of its screen, and `assumed` says so.
void fillScreen(const Screen& fallback, TraceHeader& header) {
  const Screen stated = header.screen.value_or(Screen{});
  header.screen = screenInForce(stated, fallback);
  std::string filled;
  const auto note = [&](bool is_filled, const char* what) {
    if (is_filled) filled += (filled.empty() ? "" : ", ") + std::string(what);
  };
  note(stated.size_px.x <= 0 && fallback.size_px.x > 0, "screen.size_px");
  note(stated.size_m.x <= 0.0 && fallback.size_m.x > 0.0, "screen.size_m");
  note(stated.distance_m <= 0.0 && fallback.distance_m > 0.0, "screen.distance_m");
  if (filled.empty()) return;
  header.assumed.push_back("screen: the study's " + filled +
                           ", since the recording does not state " +
                           (filled.find(',') == filled.npos ? "it" : "them"));
}

/// Gives uncalibrated positions the extent of a screen: 98 % of them along the wider axis span 30
/// deg, and the medians lie in the middle.
void scaleRelative(GazeTrace& trace) {
  constexpr double kSpan_deg = 30.0, kOutside = 0.01;
  glm::dvec2 middle{0.0};
  double extent = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> values;
    for (const GazeSample& sample : trace.samples) {
      if (sample.point_px) values.push_back((*sample.point_px)[axis]);
    }
    std::ranges::sort(values);
    const auto at = [&](double share) {
      return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    middle[axis] = at(0.5);
    extent = std::max(extent, at(1.0 - kOutside) - at(kOutside));
  }
  const double degrees = extent > 0.0 ? kSpan_deg / extent : 1.0;
  for (GazeSample& sample : trace.samples) {
    if (!sample.point_px) continue;
    constexpr double kMost_deg = 80.0;  // a spike stays on the plane of the screen
    sample.point_px = pointAtEccentricity_px(
        *trace.screen, glm::clamp(degrees * (*sample.point_px - middle), -kMost_deg, kMost_deg));
  }
  trace.relative = true;
}

}  // namespace

const std::string& RecordingFile::firstLine() const {
  if (first_line_) return *first_line_;
  LineReader lines(path_);
  std::string_view line;
  while (lines.next(line) && trimmed(line).empty()) {
  }
  return first_line_.emplace(line);
}

TraceHeader streamTrace(const std::filesystem::path& file, const TraceColumns& columns,
                        const Screen& fallback_screen, const TakeSample& take) {
  TraceDoubts doubts;
  double last_s = 0.0;
  const RecordingFile recording(file, columns);
  TraceHeader header =
      formatOf(recording).read(recording, fallback_screen, [&](const GazeSample& sample) {
        doubts.add(sample);
        last_s = sample.time_s;
        take(sample);
      });
  if (header.trials.empty()) header.trials = trialsIn(header.markers, kTrialMessage, last_s);
  if (columns.space.from_head) {
    header.assumed.push_back("gaze: straight ahead of the head (gaze.from_head)");
  }
  fillScreen(fallback_screen, header);
  doubts.state(columns, header);
  return header;
}

std::optional<std::string> recordingKindOf(const std::filesystem::path& file) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable)) return std::nullopt;
  const RecordingFormat* const found = formatSoFar(RecordingFile(file, {}));
  return found && found->name ? std::optional<std::string>(found->name) : std::nullopt;
}

std::vector<std::filesystem::path> companionsOf(const std::filesystem::path& file) {
  const RecordingFormat* const format = formatSoFar(RecordingFile(file, {}));
  if (!format || !format->companions) return {};
  return format->companions(file);
}

std::vector<std::pair<std::string, std::string>> peopleOf(const std::filesystem::path& file,
                                                          const TraceColumns& columns) {
  std::vector<std::pair<std::string, std::string>> people;
  if (formatSoFar(RecordingFile(file, columns)) != &kPlainTable) return people;
  try {
    LineReader lines(file);
    TextRows rows(lines);
    const RowGroups groups = recogniseTable(rows, columns).groups;
    if (groups.people.empty() && groups.watched.empty()) return people;
    readRows(rows, columns, {}, [](const GazeSample&) {});
  } catch (const SeveralPeople& found) {
    for (const std::string& value : found.values) people.emplace_back(found.column, value);
  } catch (const InputError&) {
    // Whoever reads the file says why.
  }
  return people;
}

SpacePreview previewSpace(const std::filesystem::path& file, const TraceColumns& columns) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable)) return {};
  if (columns.space.hasHead()) return {.has_head = true};
  const RecordingFormat* const format = formatSoFar(RecordingFile(file, columns));
  return format && format->preview ? format->preview(file) : SpacePreview{};
}

GazeTrace readTrace(const std::filesystem::path& file, const TraceColumns& columns,
                    const Screen& fallback_screen, std::optional<double> rate_Hz) {
  GazeTrace trace;
  MemoryBudget budget(file);
  for (const auto& companion : companionsOf(file)) budget.addFile(companion);
  const TraceHeader header =
      streamTrace(file, columns, fallback_screen, [&](const GazeSample& sample) {
        budget.take(1, sizeof sample, "its samples");
        trace.samples.push_back(sample);
      });
  static_cast<TraceFacts&>(trace) = header;
  const std::string name = file.string();
  if (trace.samples.size() < 2) {
    throw InputError(name, counted(trace.samples.size(), "sample") + ": expected at least 2");
  }
  if (std::ranges::none_of(trace.samples,
                           [](const GazeSample& sample) { return sample.point_px.has_value(); })) {
    throw InputError(name, "no sample has a position: expected gaze" +
                               (trace.warnings.empty() ? "" : "; " + trace.warnings.front()));
  }

  if (header.units == GazeUnits::relative && !columns.mapped_later) scaleRelative(trace);
  trace.rate_Hz = rate_Hz ? *rate_Hz : medianRate_Hz(trace.samples);
  if (!(trace.rate_Hz >= kMinRate_Hz && trace.rate_Hz <= kMaxRate_Hz)) {
    throw InputError(name,
                     significant(trace.rate_Hz) +
                         " samples a second: expected 5 to 20000; is the unit of time right?");
  }
  const double span_s = trace.samples.back().time_s - trace.samples.front().time_s;
  if (!(span_s <= kMaxDuration_s)) {
    throw InputError(name, "lasts " + significant(span_s) + " s: expected at most a day");
  }
  return trace;
}

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

namespace {

struct AxisWord {
  std::string_view text;
  glm::dvec3 direction;
};

const std::array<AxisWord, 6> kWords = {{{"right", {1.0, 0.0, 0.0}},
                                         {"left", {-1.0, 0.0, 0.0}},
                                         {"up", {0.0, 1.0, 0.0}},
                                         {"down", {0.0, -1.0, 0.0}},
                                         {"back", {0.0, 0.0, 1.0}},
                                         {"forward", {0.0, 0.0, -1.0}}}};

}  // namespace

std::optional<AxisConvention> AxisConvention::named(std::string_view text) {
  AxisConvention axes;
  for (int column = 0; column < 3; ++column) {
    const std::size_t end = column < 2 ? text.find('-') : text.size();
    if (end == text.npos) return std::nullopt;
    bool known = false;
    for (const AxisWord& word : kWords) {
      if (word.text != text.substr(0, end)) continue;
      axes.from_other_[column] = word.direction;
      known = true;
    }
    if (!known) return std::nullopt;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  // Two axes along one line have no volume.
  if (std::abs(glm::determinant(axes.from_other_)) < 0.5) return std::nullopt;
  return axes;
}

glm::dquat AxisConvention::rotation(const glm::dquat& q) const {
  const glm::dmat3 turned = from_other_ * glm::mat3_cast(q) * glm::transpose(from_other_);
  return glm::normalize(glm::quat_cast(turned));
}

}  // namespace foci
