#include "calibration/screen/screen_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/calibration_file.h"

namespace foci {

std::string screenToml(const ScreenCalibration& calibration) {
  const Screen& screen = calibration.screen;
  std::string text = "# Screen calibrated by foci.\n[screen]\n";
  text += "size_px = " + exactText(screen.size_px) + "\n";
  text += "size_m = " + exactText(screen.size_m) + "\n";
  text += "distance_m = " + exactText(screen.distance_m) + "\n\n[display]\n";
  text += "gamma = " + (calibration.gamma ? exactText(*calibration.gamma) : "\"sRGB\"") + "\n";
  text += "size_from = " + quotedText(calibration.size_from) + "\n";
  text += "distance_from = " + quotedText(calibration.distance_from) + "\n";
  return text;
}

ScreenCalibration readScreen(const std::filesystem::path& file) {
  requireRegularFile(file);
  char first = 0;
  if (std::ifstream(file, std::ios::binary) >> first && first == '{') {
    return readPsychoPyMonitor(file);
  }
  CalibrationFile in(file);
  ScreenCalibration calibration;
  calibration.screen = {
      .size_px = in.size_px("screen.size_px"),
      .size_m = in.pair("screen.size_m", 0.01, 20.0),
      .distance_m = in.number("screen.distance_m", kNearestScreen_m, kFarthestScreen_m)};
  if (in.has("display.gamma")) {
    calibration.gamma = in.numberOrWord("display.gamma", "sRGB", 1.0, 4.0);
  }
  if (in.has("display.size_from")) calibration.size_from = in.text("display.size_from");
  if (in.has("display.distance_from")) calibration.distance_from = in.text("display.distance_from");
  in.refuseUnknownKeys();
  return calibration;
}

namespace {

using Json = nlohmann::json;
constexpr std::uintmax_t kMaxFile_bytes = 16 << 20;
constexpr int kMaxDepth = 32;

/// A finite number of `calibration[key]` in [low, high].
double numberIn(const Json& calibration, const char* key, double low, double high,
                const std::string& file) {
  const auto found = calibration.find(key);
  if (found == calibration.end()) throw InputError(file, std::string("no \"") + key + "\"");
  const double value = found->is_number() ? found->get<double>() : -1.0;
  if (!(value >= low && value <= high)) {
    throw InputError(file, std::string(key) + " = " + shown(found->dump()) + ": expected " +
                               Json(low).dump() + " to " + Json(high).dump() + " cm");
  }
  return value;
}

/// json_tricks wraps numpy arrays.
const Json& unwrapped(const Json& value) {
  return value.is_object() && value.contains("__ndarray__") ? value["__ndarray__"] : value;
}

/// Python writes NaN, which JSON lacks. Not within strings.
std::string withoutNan(const std::string& text) {
  std::string result;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!quoted && text.compare(i, 3, "NaN") == 0) {
      result += "null";
      i += 2;
      continue;
    }
    result += text[i];
    if (text[i] == '"') quoted = !quoted;
    if (text[i] == '\\' && i + 1 < text.size()) result += text[++i];
  }
  return result;
}

/// The mean of `values`: a number, or one for each gun. Absent where all are 1: not measured.
std::optional<double> meanGamma(const Json& values, const char* key, const std::string& file) {
  const Json guns = values.is_array() ? values : Json::array({values});
  double sum = 0.0;
  bool measured = false;
  for (const Json& gun : guns) {
    const double value = gun.is_number() ? gun.get<double>() : -1.0;
    if (!(value > 0.0 && value <= 4.0)) {
      throw InputError(file, std::string(key) + " = " + shown(values.dump()) +
                                 ": expected 1 to 4, or one such number for each gun");
    }
    measured |= value != 1.0;
    sum += value;
  }
  const double mean = sum / static_cast<double>(std::max<std::size_t>(guns.size(), 1));
  return measured && mean > 1.0 ? std::optional(mean) : std::nullopt;
}

/// As PsychoPy's Monitor.getGamma: the third column of `gammaGrid` below its first row, which is of
/// all guns together and may stand alone, unless all are 1; else `gamma`.
std::optional<double> gammaIn(const Json& fields, const std::string& file) {
  const auto stated = [](const Json& value) { return value.is_number() || value.is_array(); };
  const Json grid = unwrapped(fields.value("gammaGrid", Json()));
  if (stated(grid)) {
    Json guns = Json::array();
    const std::size_t rows = grid.is_array() ? grid.size() : 0;
    for (std::size_t row = rows == 1 ? 0 : 1; row < (rows == 1 ? 1 : 4); ++row) {
      const bool has = (rows == 1 || rows == 4) && grid[row].is_array() && grid[row].size() > 2;
      guns.push_back(has ? grid[row][2] : Json());
    }
    if (const auto gamma = meanGamma(guns, "gammaGrid", file)) return gamma;
  }
  const Json gamma = unwrapped(fields.value("gamma", Json()));
  return stated(gamma) ? meanGamma(gamma, "gamma", file) : std::nullopt;
}

}  // namespace

ScreenCalibration readPsychoPyMonitor(const std::filesystem::path& file) {
  const std::string name = file.string(), text = withoutNan(bytesOfFile(file, kMaxFile_bytes));
  bool too_deep = false;
  const auto shallow = [&](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > kMaxDepth;
    return !too_deep;
  };
  const auto document = Json::parse(text, shallow, false);
  if (document.is_discarded() || too_deep) throw InputError(name, "not JSON");

  // A file holds one calibration, or several by name, of which PsychoPy takes the last in the
  // alphabet.
  std::string source = "PsychoPy monitor";
  Json fields = document;
  if (document.is_object() && !document.empty() && !document.contains("sizePix")) {
    const auto last = std::prev(document.end());
    fields = *last;
    if (document.size() > 1) source += ", calibration " + shown(last.key());
  }
  if (!fields.is_object()) throw InputError(name, "not a PsychoPy monitor");

  if (!fields.contains("sizePix")) {
    throw InputError(name, "no \"sizePix\": not a PsychoPy monitor");
  }
  const Json& size = unwrapped(fields["sizePix"]);
  glm::ivec2 size_px{0};
  for (int i = 0; i < 2 && size.is_array() && size.size() == 2; ++i) {
    if (size[i].is_number())
      size_px[i] = static_cast<int>(std::clamp(size[i].get<double>(), 0.0, 1e6));
  }
  if (size_px.x < 16 || size_px.y < 16 || size_px.x > 16384 || size_px.y > 16384) {
    throw InputError(name, "sizePix = " + shown(size.dump()) + ": expected two of 16 to 16384 px");
  }
  const double width_m = numberIn(fields, "width", 1.0, 2000.0, name) / 100.0;
  const double distance_m =
      numberIn(fields, "distance", 100.0 * kNearestScreen_m, 100.0 * kFarthestScreen_m, name) /
      100.0;
  ScreenCalibration monitor{.screen = {.size_px = size_px,
                                       .size_m = {width_m, width_m * size_px.y / size_px.x},
                                       .distance_m = distance_m},
                            .size_from = source,
                            .distance_from = source};
  monitor.gamma = gammaIn(fields, name);
  return monitor;
}

std::string psychoPyMonitor(const Screen& screen, std::optional<double> gamma,
                            const std::string& name) {
  nlohmann::ordered_json calibration = {{"sizePix", {screen.size_px.x, screen.size_px.y}},
                                        {"width", 100.0 * screen.size_m.x},
                                        {"distance", 100.0 * screen.distance_m},
                                        {"notes", "foci"}};
  if (gamma) calibration["gamma"] = *gamma;
  return nlohmann::ordered_json{{name, calibration}}.dump(2) + "\n";
}

}  // namespace foci
