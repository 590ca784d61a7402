#include "app/cli/screen_options.h"

#include <CLI/CLI.hpp>

#include "app/cli/option_values.h"
#include "base/input_error.h"
#include "base/number.h"

namespace foci {
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
  command.add_option("--screen-px", options.size_px, "resolution, if the file does not state it")
      ->type_name("WxH");
  command.add_option("--screen-m", options.size_m, "size of the visible area, metres")
      ->type_name("WxH");
  command.add_option("--distance-m", options.distance_m, "distance from eye to screen, metres")
      ->type_name("D");
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
    if (!distance_m || *distance_m < 0.01 || *distance_m > 20) {
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
