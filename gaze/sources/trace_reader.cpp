#include "gaze/sources/trace_reader.h"

#include <algorithm>
#include <cmath>

#include "base/input_error.h"
#include "base/memory_budget.h"
#include "base/text.h"
#include "gaze/sources/aria.h"
#include "gaze/sources/bids.h"
#include "gaze/sources/eyelink_asc.h"
#include "gaze/sources/eyenavgs.h"
#include "gaze/sources/file_kind.h"
#include "gaze/sources/hololens.h"
#include "gaze/sources/neon_native.h"
#include "gaze/sources/read_rows.h"
#include "gaze/sources/rounded_intervals.h"
#include "gaze/sources/tobii_glasses.h"
#include "gaze/sources/trace_doubts.h"
#include "gaze/sources/xdf.h"

namespace foci {
namespace {

// No tracker has a rate outside these limits: the unit of time must be wrong.
constexpr double kMaxDuration_s = 86'400.0;  // a day; a longer recording has a broken clock

/// Rate from the median interval, or from the mean of rounded ones, rounded to a thousandth.
double medianRate_Hz(const std::vector<GazeSample>& samples) {
  std::vector<double> interval_s(samples.size() - 1);
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    interval_s[i] = samples[i + 1].time_s - samples[i].time_s;
  }
  const auto middle = interval_s.begin() + static_cast<std::ptrdiff_t>(interval_s.size() / 2);
  std::nth_element(interval_s.begin(), middle, interval_s.end());
  if (std::all_of(interval_s.begin(), interval_s.end(), isWhole_ms)) {
    RoundedIntervals rounded(*middle);
    for (const double interval : interval_s) rounded.add(1, interval);
    if (const auto mean_s = rounded.mean_s()) return std::round(1000.0 / *mean_s) / 1000.0;
  }
  return std::round(1000.0 / *middle) / 1000.0;
}

/// The first line that is not empty.
std::string firstLineOf(const std::filesystem::path& file) {
  LineReader lines(file);
  std::string_view line;
  while (lines.next(line)) {
    if (!trimmed(line).empty()) return std::string(line);
  }
  return {};
}

bool isTobiiGlasses(const std::filesystem::path& file) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable)) return false;
  const std::string name = file.filename().string();
  const bool json = name.find(".json") != name.npos || name.find("gazedata") != name.npos;
  return json && tobiiGlassesOf(firstLineOf(file)).has_value();
}

TraceHeader readXdfTrace(const std::filesystem::path& file, const TraceColumns& columns,
                         const Screen& fallback_screen, const TakeSample& take) {
  XdfTable table = readXdf(file, columns.stream);
  NumberRows rows(file.string(), std::move(table.columns), std::move(table.values));
  TraceHeader header = readRows(rows, columns, fallback_screen, take);
  header.format = "XDF, stream " + shown(table.stream) + ", " + header.format;
  header.markers = std::move(table.markers);
  if (table.clock_offsets == 0) {
    header.assumed.push_back("clock: the stream's own, since the file has no clock offsets");
  }
  if (table.clock_resets > 0) {
    header.assumed.push_back("clock: the tracker's was reset " +
                             std::to_string(table.clock_resets) +
                             " times, and the offsets of each part hold there");
  }
  if (table.cut_off) header.warnings.push_back("the file is " + *table.cut_off);
  return header;
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

bool isUndescribed(const TraceColumns& columns) {
  return columns.time.empty() && columns.x.empty() && !columns.space.hasSight();
}

/// Of Aria's glasses, unless the study describes the columns.
std::optional<std::filesystem::path> trajectoryOf(const std::filesystem::path& file,
                                                  std::string_view first_line,
                                                  const TraceColumns& columns) {
  if (!isUndescribed(columns) || columns.space.hasHead() || !isAriaGaze(first_line)) return {};
  return ariaTrajectoryBeside(file);
}

/// Gaze has no place in the world while the head has none.
TraceHeader readAria(LineReader& lines, const AriaTrajectory& trajectory,
                     const TraceColumns& columns, const TakeSample& take) {
  std::size_t lost = 0;
  TextRows rows(lines);
  TraceHeader header = readRows(rows, columns, {}, [&](const GazeSample& gaze) {
    GazeSample sample = gaze;
    sample.head = trajectory.at(sample.time_s);
    if (!sample.head) {
      ++lost;
      sample.point_px.reset();
      sample.direction.reset();
      for (EyeSample& eye : sample.eyes) eye.direction.reset();
    }
    take(sample);
  });
  header.world_y_up = false;
  header.assumed.push_back(trajectory.assumed());
  if (lost > 0) {
    header.warnings.push_back(std::to_string(lost) +
                              " samples lie beside the trajectory, so their gaze is left out");
  }
  return header;
}

}  // namespace

TraceHeader streamTrace(const std::filesystem::path& file, const TraceColumns& columns,
                        const Screen& fallback_screen, const TakeSample& take) {
  const bool neon = !neonNativeFiles(file).empty();
  const bool native = !neon && isTobiiGlasses(file);
  if (!neon) requireRegularFile(file);
  if (!neon && !native) requireGazeText(file);
  TraceDoubts doubts;
  const TakeSample both = [&](const GazeSample& sample) {
    doubts.add(sample);
    take(sample);
  };
  TraceHeader header;
  if (neon) {
    NeonTable table = readNeonNative(file);
    NumberRows rows(file.string(), std::move(table.columns), std::move(table.values));
    header = readRows(rows, columns, fallback_screen, both);
    header.format = "Neon, native recording";
  } else if (!bidsMetadataOf(file).empty()) {
    header = readBids(file, columns, fallback_screen, both);
  } else if (native) {
    LineReader lines(file);
    NumberRows rows = readTobiiGlasses(lines);
    header = readRows(rows, columns, fallback_screen, both);
    header.format = "Tobii Pro Glasses, native recording, binocular";
  } else if (isXdf(file)) {
    header = readXdfTrace(file, columns, fallback_screen, both);
  } else {
    const std::string first = firstLineOf(file);
    LineReader lines(file);
    if (startsEyeLinkAsc(first) || (isUndescribed(columns) && isEyeLinkSample(first))) {
      header = readEyeLinkAsc(lines, columns, both);
    } else if (isUndescribed(columns) && isEyeNavGs(first)) {
      header = readEyeNavGs(lines, columns, both);
    } else if (isUndescribed(columns) && isHoloLens(first)) {
      header = readHoloLens(lines, columns, both);
    } else if (const auto trajectory = trajectoryOf(file, first, columns)) {
      header = readAria(lines, AriaTrajectory(*trajectory, first), columns, both);
    } else {
      TextRows rows(lines);
      header = readRows(rows, columns, fallback_screen, both);
    }
  }
  if (columns.space.from_head) {
    header.assumed.push_back("gaze: straight ahead of the head (gaze.from_head)");
  }
  fillScreen(fallback_screen, header);
  for (std::string& doubt : doubts.sentences(header, columns)) {
    header.warnings.push_back(std::move(doubt));
  }
  return header;
}

std::vector<std::filesystem::path> companionsOf(const std::filesystem::path& file) {
  std::vector<std::filesystem::path> companions = neonNativeFiles(file);
  if (!companions.empty()) {
    std::erase(companions, file);
    return companions;
  }
  companions = bidsMetadataOf(file);
  const bool bids = !companions.empty();
  if (const auto other = bids ? bidsOtherEyeOf(file) : std::nullopt) {
    companions.push_back(*other);
    for (auto& metadata : bidsMetadataOf(*other)) {
      if (std::ranges::find(companions, metadata) == companions.end()) {
        companions.push_back(std::move(metadata));
      }
    }
  }
  std::error_code unreadable;
  const std::filesystem::path setting = file.parent_path() / "scene_setting.csv";
  const auto trajectory = ariaTrajectoryBeside(file);
  if (!bids && trajectory && std::filesystem::is_regular_file(file, unreadable) &&
      isAriaGaze(firstLineOf(file))) {
    companions.push_back(*trajectory);
  }
  if (!bids && std::filesystem::is_regular_file(file, unreadable) &&
      std::filesystem::is_regular_file(setting, unreadable) && isEyeNavGs(firstLineOf(file))) {
    companions.push_back(setting);
  }
  return companions;
}

std::vector<std::pair<std::string, std::string>> peopleOf(const std::filesystem::path& file,
                                                          const TraceColumns& columns) {
  std::vector<std::pair<std::string, std::string>> people;
  try {
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(file, unreadable)) return people;
    if (!bidsMetadataOf(file).empty() || isXdf(file) || isTobiiGlasses(file)) return people;
    if (startsEyeLinkAsc(firstLineOf(file))) return people;
    LineReader lines(file);
    TextRows rows(lines);
    const auto found = peopleIn(rows, columns);
    if (!found) return people;
    for (const std::string& value : found->values)
      people.emplace_back(rows.names()[found->at], value);
  } catch (const InputError&) {
    return {};  // whoever reads the file says why
  }
  return people;
}

SpacePreview previewSpace(const std::filesystem::path& file, const TraceColumns& columns) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable)) return {};
  if (columns.space.hasHead()) return {.has_head = true};
  try {
    if (!isUndescribed(columns) || isXdf(file)) return {};
    const std::string first = firstLineOf(file);
    if (isHoloLens(first) || trajectoryOf(file, first, columns)) return {.has_head = true};
    if (!isEyeNavGs(first)) return {};
  } catch (const InputError&) {
    return {};  // whoever reads the file says why
  }
  return {.has_head = true, .scene_scale_m = eyeNavGsSceneScale_m(file)};
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
  trace.format = header.format;
  trace.screen = header.screen;
  trace.field = header.field;
  trace.scene_scale_m = header.scene_scale_m;
  trace.markers = header.markers;
  trace.assumed = header.assumed;
  trace.warnings = header.warnings;
  const std::string name = file.string();
  if (trace.samples.size() < 2) {
    throw InputError(name, std::to_string(trace.samples.size()) + " samples: expected at least 2");
  }
  if (std::none_of(trace.samples.begin(), trace.samples.end(),
                   [](const GazeSample& sample) { return sample.point_px.has_value(); })) {
    throw InputError(name, "no sample has a position: expected gaze" +
                               (trace.warnings.empty() ? "" : "; " + trace.warnings.front()));
  }

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

}  // namespace foci
