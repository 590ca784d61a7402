// Eye tracking in the Brain Imaging Data Structure (BIDS 1.11): *_physio.tsv.gz without a header
// line, described by JSON files beside it and higher up in the data set. The columns are timestamp,
// x_coordinate, y_coordinate, pupil_size and blink, with the metadata's units. Names that begin
// with left_ or right_ belong to one eye, and so do all columns if RecordedEye is left or right. A
// pupil that is not in millimetres keeps its unit. The screen is that of StimulusPresentation in
// _events.json, in older data sets in _physio.json. Positions count from ScreenOrigin: a corner of
// the screen, or its centre with y up.
//
// With a recording of the other eye, samples have both eyes if their times agree within half of an
// interval; their point is the `Cyclopean` point.
//
// The rows of _events.tsv are trials. Their onsets count from the start of the task, StartTime
// before the first sample. The messages of _physioevents.tsv are markers, on the recording's own
// clock.

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/bids.h"
#include "gaze/sources/column_names.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::pair<std::string_view, std::string_view> kEyes[] = {
    {"_recording-eye1_", "_recording-eye2_"}, {"_recording-left_", "_recording-right_"}};

/// The columns' names with their units.
std::string headerOf(const fs::path& file, const BidsMetadata& metadata) {
  const auto columns = metadata.physio.find("Columns");
  const std::string where = metadata.files.back().string();
  if (columns == metadata.physio.end() || !columns->is_array() || columns->empty()) {
    throw InputError(where,
                     "Columns: expected a list of names here, or in a _physio.json higher "
                     "up that applies to " +
                         file.filename().string());
  }
  std::string header;
  for (const Json& column : *columns) {
    if (!column.is_string()) throw InputError(where, "Columns: expected names");
    const std::string name = column.get<std::string>();
    if (name.find_first_of("\t\n\r\"[(") != std::string::npos || name.size() > 256) {
      throw InputError(where, "Columns: " + shown(name) + ": expected a plain name");
    }
    const std::string unit = metadata.unitOf(name);
    header += (header.empty() ? "" : "\t") + name + (unit.empty() ? "" : " [" + unit + "]");
  }
  return header;
}

/// Where positions count from: -1 left or bottom, 0 centre, 1 right or top.
struct ScreenOrigin {
  int x = -1, y = 1;
};

std::optional<ScreenOrigin> originIn(const BidsMetadata& metadata) {
  if (!metadata.stimulus.is_object()) return ScreenOrigin{};
  const auto origin = metadata.stimulus.find("ScreenOrigin");
  if (origin == metadata.stimulus.end()) return ScreenOrigin{};
  std::string words = origin->is_string() ? origin->get<std::string>() : "";
  for (const Json& word : origin->is_array() ? *origin : Json::array()) {
    if (word.is_string()) words += " " + word.get<std::string>();
  }
  const auto has = [&](std::string_view word) { return words.find(word) != words.npos; };
  const bool centre = has("cent") || has("middle");
  if (!centre && (has("left") == has("right") || has("top") == has("bottom"))) return std::nullopt;
  return ScreenOrigin{.x = has("left")    ? -1
                           : has("right") ? 1
                                          : 0,
                      .y = has("bottom") ? -1
                           : has("top")  ? 1
                                         : 0};
}

/// Converts positions that count from another point than the upper left corner. The study's own
/// gaze.scale and gaze.offset replace this.
/// @param header  names and units of the columns
TraceColumns fromUpperLeft(TraceColumns columns, const BidsMetadata& metadata,
                           const std::string& header, const Screen& screen,
                           std::vector<std::string>& assumed) {
  const bool converts = columns.scale != glm::dvec2(1.0) || columns.offset != glm::dvec2(0.0);
  const auto isAngle = [&](const Json& column) {
    return degreesPer(metadata.unitOf(column.get<std::string>())) > 0.0;
  };
  const bool degrees = columns.units.value_or(GazeUnits::px) == GazeUnits::deg ||
                       std::ranges::any_of(metadata.physio.at("Columns"), isAngle);
  if (converts || degrees || columns.mapped_later) return columns;
  const auto origin = originIn(metadata);
  const std::string where = metadata.files.back().string();
  if (!origin) {
    throw InputError(where,
                     "ScreenOrigin: expected a corner such as [\"top\", \"left\"], or "
                     "[\"center\", \"center\"]; a study converts other positions with gaze.scale "
                     "and gaze.offset");
  }
  if (origin->x == -1 && origin->y == 1) return columns;
  const bool fractions = columns.units.value_or(GazeUnits::px) == GazeUnits::normalised ||
                         header.find(" [norm") != header.npos;
  const glm::dvec2 size = fractions ? glm::dvec2(1.0) : glm::dvec2(screen.size_px);
  if (size.x <= 0.0 || size.y <= 0.0) {
    throw InputError(where,
                     "ScreenOrigin is not the upper left corner: expected ScreenResolution, "
                     "too");
  }
  // From the right, x counts to the left; from the bottom and the centre, y counts upwards.
  columns.scale = {origin->x == 1 ? -1.0 : 1.0, origin->y == 1 ? 1.0 : -1.0};
  columns.offset = {0.5 * (origin->x + 1) * size.x, 0.5 * (1 - origin->y) * size.y};
  if (origin->y == 0) {
    assumed.emplace_back("positions count upwards from the screen's centre (gaze.scale)");
  }
  return columns;
}

/// What foci assumed as it converted the recording.
void takeAssumed(const BidsMetadata& metadata, TraceHeader& header) {
  constexpr std::string_view kThen = "as foci converted it: ";
  constexpr std::size_t kMaxBytes = 200;
  const auto assumed = metadata.physio.find("FociAssumed");
  if (assumed == metadata.physio.end() || !assumed->is_array()) return;
  for (const Json& each : *assumed) {
    if (!each.is_string()) continue;
    std::string text = each.get<std::string>().substr(0, kMaxBytes);
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    header.assumed.push_back(text.starts_with(kThen) ? text : std::string(kThen) + text);
  }
}

std::string factsOf(const BidsMetadata& metadata, const std::string& header) {
  std::string facts = "RecordedEye " + shown(metadata.text("RecordedEye"));
  const auto rate = metadata.physio.find("SamplingFrequency");
  if (rate != metadata.physio.end()) facts += ", " + rate->dump() + " Hz";
  std::string columns = header;
  for (std::size_t at = 0; (at = columns.find('\t', at)) != columns.npos; at += 2) {
    columns.replace(at, 1, ", ");
  }
  const Screen screen = metadata.screen();
  facts += ", columns " + columns;
  if (screen.size_px.x > 0) {
    facts += ", screen " + std::to_string(screen.size_px.x) + " x " +
             std::to_string(screen.size_px.y) + " px";
  }
  if (screen.size_m.x > 0.0) {
    facts += ", " + significant(screen.size_m.x) + " x " + significant(screen.size_m.y) + " m";
  }
  if (screen.distance_m > 0.0) facts += ", " + significant(screen.distance_m) + " m away";
  return facts;
}

/// 0: left, 1: right; nothing for both together.
std::optional<std::size_t> sideOf(const BidsMetadata& metadata) {
  const std::string eye = metadata.text("RecordedEye");
  if (eye == "left") return 0;
  if (eye == "right") return 1;
  return std::nullopt;
}

TraceHeader readEye(const fs::path& file, const BidsMetadata& metadata,
                    const TraceColumns& described, const Screen& fallback_screen,
                    const TakeSample& take) {
  const std::string type = metadata.text("PhysioType");
  const std::string names = headerOf(file, metadata);
  if ((!type.empty() && type != "eyetrack") || names.find("x_coordinate") == names.npos) {
    const bool named = !described.x.empty() || described.namesEye(0) || described.namesEye(1);
    if (!named) {
      throw InputError(file.string(),
                       "physiology without gaze: expected PhysioType eyetrack and "
                       "the column x_coordinate");
    }
  }
  const std::string system = metadata.text("SampleCoordinateSystem");
  if (!system.empty() && system != "gaze-on-screen" && described.x.empty() &&
      !described.mapped_later) {
    throw InputError(metadata.files.back().string(),
                     "SampleCoordinateSystem " + shown(system) +
                         ": expected gaze-on-screen; if the columns are positions on the screen, "
                         "name them with gaze.x and gaze.y");
  }
  LineReader lines(file);
  TablePreamble before{.screen = metadata.screen(), .of_samples = true};
  const double rate_Hz = metadata.number("SamplingFrequency").value_or(0.0);
  if (rate_Hz >= kMinRate_Hz && rate_Hz <= kMaxRate_Hz) before.rate_Hz = rate_Hz;
  TextRows rows(lines, before, names);
  rows.skipNames();
  rows.survey(1, [&] {
    const std::size_t columns = rows.names().size(), fields = rows.sizeUpToText(columns);
    if (fields == columns) return;
    throw rows.error(std::to_string(fields) + " fields, but Columns names " +
                     std::to_string(columns) + ": expected a name for each");
  });
  Screen screen = fallback_screen;
  if (before.screen.size_px.x > 0) screen.size_px = before.screen.size_px;
  std::vector<std::string> assumed;
  const TraceColumns upright = fromUpperLeft(described, metadata, names, screen, assumed);
  const auto side = sideOf(metadata);
  TraceHeader header = readRows(rows, upright, fallback_screen, [&](const GazeSample& sample) {
    if (!side || sample.eyes[0].point_px || sample.eyes[1].point_px) return take(sample);
    GazeSample own = sample;
    own.eyes[*side] = {
        .point_px = own.point_px, .pupil_mm = own.pupil_mm, .pupil_own = own.pupil_own};
    take(own);
  });
  header.format = "BIDS eye tracking" + header.format.substr(std::min<std::size_t>(
                                            header.format.find(','), header.format.size()));
  header.assumed.insert(header.assumed.begin(), assumed.begin(), assumed.end());
  takeAssumed(metadata, header);
  for (const auto& [key, stated] : {std::pair("ScreenSize", before.screen.size_m.x),
                                    std::pair("ScreenDistance", before.screen.distance_m)}) {
    if (stated > 0.0) continue;
    if (!metadata.stimulus.is_object() || !metadata.stimulus.contains(key)) continue;
    const std::string value = metadata.stimulus[key].dump();
    if (value.find_first_of("123456789") == value.npos) continue;  // "n/a"
    header.warnings.push_back(std::string(key) + " is " + value.substr(0, 40) +
                              ", which is not 0.01 to 20 m: it is left out; is it in metres?");
  }
  return header;
}

/// @throws InputError that names the metadata, if there are no rows
void requireRows(const RecordingFile& file, const BidsMetadata& metadata) {
  if (!trimmed(file.firstLine()).empty()) return;
  throw InputError(
      file.path().string(),
      "empty: the data file has no rows, as in most official examples; its metadata: " +
          factsOf(metadata, headerOf(file.path(), metadata)));
}

/// Finds the other eye's sample of a time.
class OtherEye {
 public:
  OtherEye(const fs::path& file, const BidsMetadata& metadata, const TraceColumns& described,
           const Screen& fallback_screen) {
    readEye(file, metadata, described, fallback_screen,
            [&](const GazeSample& sample) { samples_.push_back(sample); });
    if (samples_.size() < 2) throw InputError(file.string(), "expected at least 2 samples");
    const double span_s = samples_.back().time_s - samples_.front().time_s;
    reach_s_ = 0.5 * span_s / static_cast<double>(samples_.size() - 1);
  }

  /// @param time_s  does not decrease
  const GazeSample* at(double time_s) {
    while (next_ < samples_.size() && samples_[next_].time_s < time_s - reach_s_) ++next_;
    const bool near = next_ < samples_.size() && samples_[next_].time_s <= time_s + reach_s_;
    return near ? &samples_[next_] : nullptr;
  }

 private:
  std::vector<GazeSample> samples_{};
  double reach_s_ = 0.0;
  std::size_t next_ = 0;
};

TraceHeader readBothEyes(const fs::path& file, const BidsMetadata& metadata, const fs::path& other,
                         const BidsMetadata& of_other, const TraceColumns& described,
                         const Screen& fallback_screen, const TakeSample& take) {
  const auto side = sideOf(metadata), other_side = sideOf(of_other);
  if (!side || !other_side || *side == *other_side) {
    throw InputError((side ? of_other : metadata).files.back().string(),
                     "RecordedEye: expected left in one and right in the other of two eyes' files");
  }
  OtherEye other_eye(other, of_other, described, fallback_screen);
  Cyclopean cyclopean;
  std::size_t samples = 0, alone = 0;
  TraceHeader header =
      readEye(file, metadata, described, fallback_screen, [&](const GazeSample& own) {
        GazeSample sample = own;
        const GazeSample* partner = other_eye.at(own.time_s);
        ++samples;
        alone += !partner;
        if (partner) {
          sample.eyes[*other_side] = partner->eyes[*other_side];
          sample.blink = own.blink && partner->blink;
          for (const auto pupil : {&GazeSample::pupil_mm, &GazeSample::pupil_own}) {
            const auto &ours = own.*pupil, &theirs = partner->*pupil;
            if (ours && theirs) sample.*pupil = 0.5 * (*ours + *theirs);
          }
        }
        sample.point_px =
            cyclopean.combine(own.time_s, sample.eyes[0].point_px, sample.eyes[1].point_px);
        take(sample);
      });
  if (header.format.find("binocular") == header.format.npos) header.format += ", binocular";
  header.assumed.push_back("the other eye: " + other.filename().string());
  constexpr double kMany = 0.05;
  if (static_cast<double>(alone) > kMany * static_cast<double>(samples)) {
    header.warnings.push_back(counted(alone, "sample") +
                              " without one of the other eye at the same time: are the clocks of "
                              "both files the same?");
  }
  return header;
}

/// The recording of the other eye: `recording-eye2` beside `recording-eye1`, or the reverse.
std::optional<fs::path> otherEyeOf(const fs::path& file) {
  for (const auto& [one, two] : kEyes) {
    for (const auto& [own, theirs] : {std::pair(one, two), std::pair(two, one)}) {
      std::string name = file.filename().string();
      const std::size_t at = name.find(own);
      if (at == name.npos) continue;
      const fs::path other = file.parent_path() / name.replace(at, own.size(), theirs);
      std::error_code error;
      if (fs::is_regular_file(other, error) && bidsMetadata(other)) return other;
    }
  }
  return std::nullopt;
}

/// The rows of `_events.tsv`, with onsets as the file has them. A row without duration lasts until
/// the next one.
std::vector<TraceTrial> trialsOf(const fs::path& events) {
  NamedTable table(events, "onset and duration, tab-separated");
  table.withoutComments();
  const std::size_t onset = table.column("onset"), duration = table.column("duration");
  const auto type = table.find("trial_type");
  std::optional<std::size_t> number;
  for (const char* name : {"trial_number", "trial_id", "trial"}) {
    if (!number) number = table.find(name);
  }
  const auto textIn = [&](const std::optional<std::size_t>& column) {
    const std::string_view text = column ? table.text(*column) : std::string_view();
    return isAbsent(text) ? std::string() : std::string(text);
  };
  std::vector<TraceTrial> trials;
  std::size_t row = 0;
  while (table.next()) {
    ++row;
    const auto first_s = table.number(onset);
    if (!first_s) continue;
    const double duration_s = table.number(duration).value_or(0.0);
    TraceTrial trial{.name = textIn(number), .first_s = *first_s, .type = textIn(type)};
    if (trial.name.empty()) trial.name = std::to_string(row);
    trial.last_s = duration_s > 0.0 ? *first_s + duration_s : HUGE_VAL;
    trials.push_back(std::move(trial));
  }
  std::ranges::stable_sort(trials, {}, &TraceTrial::first_s);
  for (std::size_t i = 0; i + 1 < trials.size(); ++i) {
    if (trials[i].last_s == HUGE_VAL) trials[i].last_s = trials[i + 1].first_s;
  }
  return trials;
}

/// @param first_s, last_s  of the samples
void addTrials(const BidsMetadata& metadata, double first_s, double last_s, TraceHeader& header) {
  if (!metadata.events) return;
  std::vector<TraceTrial> trials = trialsOf(*metadata.events);
  const double task_s = first_s - metadata.number("StartTime").value_or(0.0);
  const auto anyWithin = [&](double from_s) {
    return std::ranges::any_of(trials, [&](const TraceTrial& trial) {
      return trial.first_s + from_s <= last_s && trial.last_s + from_s > first_s;
    });
  };
  const std::string name = metadata.events->filename().string();
  double from_s = task_s;
  if (!trials.empty() && !anyWithin(task_s)) {
    if (!anyWithin(0.0)) {
      header.warnings.push_back("no event of " + name +
                                " lies within the recording, so it has no trials: do its onsets "
                                "count from the start of the task, and is StartTime right?");
      return;
    }
    from_s = 0.0;
    header.assumed.push_back("trials: onsets of " + name + " on the recording's own clock");
  }
  for (TraceTrial& trial : trials) {
    trial.first_s += from_s;
    trial.last_s = trial.last_s == HUGE_VAL ? last_s : trial.last_s + from_s;
    if (trial.first_s <= last_s && trial.last_s > first_s) header.trials.push_back(trial);
  }
}

/// The messages of the tracker.
std::vector<TraceMarker> messagesOf(const BidsMetadata& metadata) {
  std::vector<TraceMarker> messages;
  const auto columns = metadata.physioevents.find("Columns");
  if (!metadata.messages || columns == metadata.physioevents.end()) return messages;
  const auto at = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(*columns, Json(name)) - columns->begin());
  };
  const std::size_t onset = at("onset"), message = at("message");
  if (std::max(onset, message) >= columns->size()) return messages;
  std::string names;
  for (std::size_t i = 0; i < columns->size(); ++i)
    names += (i > 0 ? "\tc" : "c") + std::to_string(i);
  LineReader lines(*metadata.messages);
  TextRows rows(lines, {}, names);
  rows.withoutComments();
  while (rows.next()) {
    if (rows.size() <= std::max(onset, message) || rows.isAbsent(message)) continue;
    if (const auto time_s = rows.number(onset)) {
      messages.push_back({*time_s, std::string(rows.text(message))});
    }
  }
  std::ranges::stable_sort(messages, {}, &TraceMarker::time_s);
  return messages;
}

TraceHeader readBids(const RecordingFile& recording, const Screen& fallback_screen,
                     const TakeSample& take) {
  const fs::path& file = recording.path();
  const TraceColumns& described = recording.columns();
  const auto metadata = bidsMetadata(file);
  requireRows(recording, *metadata);
  std::optional<double> first_s;
  double last_s = 0.0;
  const TakeSample timed = [&](const GazeSample& sample) {
    last_s = sample.time_s;
    if (!first_s) first_s = last_s;
    take(sample);
  };
  const auto other = otherEyeOf(file);
  TraceHeader header = other ? readBothEyes(file, *metadata, *other, *bidsMetadata(*other),
                                            described, fallback_screen, timed)
                             : readEye(file, *metadata, described, fallback_screen, timed);
  header.markers = messagesOf(*metadata);
  addTrials(*metadata, first_s.value_or(0.0), last_s, header);
  return header;
}

std::vector<fs::path> bidsCompanionsOf(const fs::path& file) {
  const auto metadata = bidsMetadata(file);
  std::vector<fs::path> companions = metadata->files;
  for (const auto& table : {metadata->events, metadata->messages}) {
    if (table) companions.push_back(*table);
  }
  if (const auto other = otherEyeOf(file)) {
    companions.push_back(*other);
    const auto of_other = bidsMetadata(*other);
    for (const fs::path& json : of_other->files) {
      if (std::ranges::find(companions, json) == companions.end()) companions.push_back(json);
    }
  }
  return companions;
}

}  // namespace

const RecordingFormat kBids{
    .name = "BIDS",
    .is = [](const RecordingFile& file) { return bidsMetadata(file.path()).has_value(); },
    .read = readBids,
    .companions = bidsCompanionsOf};

}  // namespace foci
