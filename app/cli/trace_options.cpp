#include "app/cli/commands.h"
#include "app/study/study.h"
#include "app/study/study_request.h"
#include "app/study/study_words.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

TraceDescription studysDescription(const std::string& file) {
  if (file.empty()) return {};
  const Study study = readStudy(file);
  TraceDescription description{.columns = study.columnsInForce(), .events = study.gaze.events};
  if (!study.screen.is_default) description.screen = study.screenInForce();
  return description;
}

GazeUnits unitsOf(const std::string& name) {
  for (const auto& [word, units] : kStudyWords<std::optional<GazeUnits>>) {
    if (word == name && units) return *units;
  }
  throw InputError("--units " + name, "expected px, deg, normalised or relative");
}

}  // namespace

void addTraceOptions(CLI::App& command, TraceOptions& o) {
  addOption(command, "--time", o.columns.time, "NAME", "name of the time column (gaze.time)");
  addOption(command, "--x", o.columns.x, "NAME",
            "name of the column of horizontal positions (gaze.x)");
  addOption(command, "--y", o.columns.y, "NAME",
            "name of the column of vertical positions (gaze.y)");
  addOption(command, "--units", o.units, "px|deg|normalised|relative",
            "unit of the positions (gaze.units)");
  addOption(command, "--rows", o.rows, "COLUMN=VALUE",
            "column and value of the rows to read (gaze.rows)");
  addOption(command, "--time-scale-s", o.time_scale_s, "S",
            "length of a unit of time, seconds (gaze.time_scale_s)");
  addOption(command, "--study", o.study, "FILE",
            "study whose [gaze] describes the recording, and whose [screen] is used if the "
            "recording states none");
  addScreenOptions(command, o.screen);
}

TraceDescription descriptionOf(const TraceOptions& options) {
  TraceDescription description = studysDescription(options.study);
  TraceColumns& columns = description.columns;
  if (!options.columns.time.empty()) columns.time = options.columns.time;
  if (!options.columns.x.empty()) columns.x = options.columns.x;
  if (!options.columns.y.empty()) columns.y = options.columns.y;
  if (columns.rate_Hz && !columns.time.empty()) {
    throw InputError(options.study,
                     "gaze.rate_Hz and gaze.time (--time): expected only one of them; for a column "
                     "of row numbers give gaze.time_scale_s = 1 / rate");
  }
  if (options.time_scale_s != 0.0) {
    if (!(options.time_scale_s >= 1e-12 && options.time_scale_s <= 3600.0)) {
      throw InputError("--time-scale-s", "expected seconds per unit of time, 1e-12 to 3600");
    }
    columns.time_scale_s = options.time_scale_s;
  }
  if (!options.rows.empty()) {
    const std::size_t at = options.rows.find('=');
    if (at == options.rows.npos) {
      throw InputError("--rows " + options.rows, "expected COLUMN=VALUE, e.g. participant=A");
    }
    columns.rows = {{options.rows.substr(0, at), options.rows.substr(at + 1)}};
  }
  if (!options.units.empty()) columns.units = unitsOf(options.units);
  description.screen = screenInForce(screenOf(options.screen), description.screen);
  return description;
}

void withTraceHints(const TraceOptions& options, const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    const std::string what = error.what();
    const bool names_a_key = what.find("gaze.") != what.npos;
    if (!names_a_key || !options.study.empty() || what.find("--") != what.npos) throw;
    throw InputError(what +
                     " (a study's keys: give --study FILE, or --time, --x, --y, --units, --rows, "
                     "--time-scale-s)");
  }
}

namespace {

/// "1024x768" within limits.
glm::dvec2 sizeOf(const std::string& option, const std::string& text, double low, double high,
                  const std::string& expected) {
  const glm::dvec2 size = pairOf(option, text, 'x', expected);
  if (size.x < low || size.x > high || size.y < low || size.y > high) {
    throw InputError(option + " " + text, "expected " + expected);
  }
  return size;
}

}  // namespace

void addScreenOptions(CLI::App& command, ScreenOptions& options) {
  addOption(command, "--screen-px", options.size_px, "WxH",
            "resolution, if the file does not state it");
  addOption(command, "--screen-m", options.size_m, "WxH", "size of the visible area, metres");
  addOption(command, "--distance-m", options.distance_m, "D",
            "distance from eye to screen, metres");
}

Screen screenOf(const ScreenOptions& options) {
  Screen screen;
  if (!options.size_px.empty()) {
    screen.size_px = sizeOf("--screen-px", options.size_px, 16, 16384, "16 to 16384 px, WxH");
  }
  if (!options.size_m.empty()) {
    screen.size_m = sizeOf("--screen-m", options.size_m, 0.01, 20, "0.01 to 20 m, WxH");
  }
  if (!options.distance_m.empty()) {
    const auto distance_m = parseNumber(options.distance_m);
    if (!distance_m || !isScreenDistance(*distance_m)) {
      throw InputError("--distance-m " + options.distance_m, "expected 0.01 to 20 m");
    }
    screen.distance_m = *distance_m;
  }
  return screen;
}

void requireWholeScreen(const Screen& screen, const std::string& file) {
  std::string missing;
  if (screen.size_px.x <= 0 || screen.size_px.y <= 0) missing += " --screen-px WxH";
  if (screen.size_m.x <= 0.0 || screen.size_m.y <= 0.0) missing += " --screen-m WxH";
  if (screen.distance_m <= 0.0) missing += " --distance-m D";
  if (!missing.empty()) throw InputError(file, "does not state its whole screen: give" + missing);
}

}  // namespace foci
