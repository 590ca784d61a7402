// The table of keys, and the TOML that it is applied to (toml11).
#include "app/study.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <toml.hpp>

#include "app/base/input_error.h"
#include "app/base/nearest.h"
#include "calibration/monitor.h"
#include "render/methods/method.h"

namespace foci {
namespace {

using Words = std::vector<std::string_view>;

/// What a key allows: numbers from `low` to `high`, each of them; texts among `words` (none: any).
struct Allowed {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  Words words = {};
};

/// A value that the key does not allow; `what` says what it does.
struct Expected {
  std::string what;
};

std::string numberText(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.begin(), text.end(), value).ptr;
  return {text.begin(), end};
}

std::string jsonText(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> escape;
      std::snprintf(escape.data(), escape.size(), "\\u%04x", c);
      json += escape.data();
    } else {
      json += c;
    }
  }
  return json + '"';
}

std::string rangeText(const Allowed& allowed) {
  return numberText(allowed.low) + " to " + numberText(allowed.high);
}

// One `read` (TOML to value, or Expected) and one `write` (value to JSON) for each type of key.

void read(const toml::value& from, const Allowed& allowed, double& to) {
  const double value = from.is_floating()  ? from.as_floating()
                       : from.is_integer() ? static_cast<double>(from.as_integer())
                                           : std::numeric_limits<double>::quiet_NaN();
  if (!(value >= allowed.low && value <= allowed.high)) throw Expected{rangeText(allowed)};
  to = value;
}

template <std::signed_integral Integer>
void read(const toml::value& from, const Allowed& allowed, Integer& to) {
  const auto fits = [&](std::int64_t value) {
    return static_cast<double>(value) >= allowed.low && static_cast<double>(value) <= allowed.high;
  };
  if (!from.is_integer() || !fits(from.as_integer())) {
    throw Expected{"an integer, " + rangeText(allowed)};
  }
  to = static_cast<Integer>(from.as_integer());
}

void read(const toml::value& from, const Allowed&, bool& to) {
  if (!from.is_boolean()) throw Expected{"true or false"};
  to = from.as_boolean();
}

void read(const toml::value& from, const Allowed& allowed, std::string& to) {
  std::string what = allowed.words.empty() ? "a text" : "one of";
  for (const auto word : allowed.words) what += " \"" + std::string(word) + "\"";
  if (!from.is_string()) throw Expected{what};
  const std::string& text = from.as_string().str;
  const bool known =
      std::find(allowed.words.begin(), allowed.words.end(), text) != allowed.words.end();
  if (text.empty() || text.find('\0') != std::string::npos || !(allowed.words.empty() || known)) {
    throw Expected{text.empty() ? what + " that is not empty" : what};
  }
  to = text;
}

void read(const toml::value& from, const Allowed&, std::filesystem::path& to) {
  std::string text;
  try {
    read(from, {}, text);
  } catch (const Expected&) {
    throw Expected{"a file's name"};
  }
  to = text;
}

template <int N, class Number>
void read(const toml::value& from, const Allowed& allowed, glm::vec<N, Number>& to) {
  const std::string what = std::to_string(N) + " numbers, each ";
  if (!from.is_array() || from.as_array().size() != N) throw Expected{what + rangeText(allowed)};
  try {
    for (int i = 0; i < N; ++i) read(from.as_array()[static_cast<std::size_t>(i)], allowed, to[i]);
  } catch (const Expected& expected) {
    throw Expected{what + expected.what};
  }
}

template <class T>
void read(const toml::value& from, const Allowed& allowed, std::optional<T>& to) {
  T value{};
  read(from, allowed, value);
  to = value;
}

std::string write(double value) { return numberText(value); }
std::string write(std::signed_integral auto value) { return std::to_string(value); }
std::string write(bool value) { return value ? "true" : "false"; }
std::string write(const std::string& value) { return jsonText(value); }
std::string write(const std::filesystem::path& value) { return jsonText(value.string()); }
template <int N, class Number>
std::string write(const glm::vec<N, Number>& value) {
  std::string text = "[";
  for (int i = 0; i < N; ++i) text += (i ? ", " : "") + write(value[i]);
  return text + "]";
}
template <class T>
std::string write(const std::optional<T>& value) {
  return value ? write(*value) : "null";
}

void read(const toml::value& from, const Allowed&, std::vector<EyeKeyframe>& to);
std::string write(const std::vector<EyeKeyframe>& path);

/// A key of the table T: Study, or EyeKeyframe within `eye.path`.
template <class T>
struct Key {
  std::string_view name;
  std::string_view meaning;
  Allowed allowed;
  void (*read)(const toml::value&, const Allowed&, T&);
  std::string (*write)(const T&);
};

/// @param at  the member that the key sets
template <class T, auto at>
Key<T> key(std::string_view name, std::string_view meaning, Allowed allowed = {}) {
  return {name, meaning, std::move(allowed),
          [](const toml::value& from, const Allowed& a, T& to) { read(from, a, at(to)); },
          [](const T& from) { return write(at(from)); }};
}

#define FOCI_KEY(member, ...)                                    \
  key < Study, [](auto& study) -> auto& { return study.member; } \
  > (__VA_ARGS__)
#define FOCI_KEYFRAME_KEY(member, ...)                                 \
  key < EyeKeyframe, [](auto& frame) -> auto& { return frame.member; } \
  > (__VA_ARGS__)

constexpr double kFar_m = 1e6;  // positions beyond it leave a float no millimetre

const std::vector<Key<EyeKeyframe>>& keyframeKeys() {
  static const std::vector<Key<EyeKeyframe>> keys = {
      FOCI_KEYFRAME_KEY(time_s, "time_s", "after the recording's first sample, s", {0, 1e6}),
      FOCI_KEYFRAME_KEY(position_m, "position_m", "where the eye is, m", {-kFar_m, kFar_m}),
      FOCI_KEYFRAME_KEY(look_at_m, "look_at_m", "what the screen's centre shows, m",
                        {-kFar_m, kFar_m}),
      FOCI_KEYFRAME_KEY(up, "up", "upwards; absent: eye.up", {-1, 1}),
  };
  return keys;
}

Words methodNames() {
  Words names;
  for (const MethodInfo& method : methods()) names.push_back(method.name);
  return names;
}

const std::vector<Key<Study>>& studyKeys() {
  static const std::vector<Key<Study>> keys = {
      FOCI_KEY(scene.file, "scene.file", "a PLY point cloud"),
      FOCI_KEY(scene.builtin, "scene.builtin", "built-in scene, where there is no file",
               {.words = {"gallery", "plane"}}),
      FOCI_KEY(scene.scale_m, "scene.scale_m", "metres a unit of the file", {1e-6, 1e6}),
      FOCI_KEY(scene.background, "scene.background", "linear RGB behind everything", {0, 1}),
      FOCI_KEY(eye.position_m, "eye.position_m", "where the eye is, m", {-kFar_m, kFar_m}),
      FOCI_KEY(eye.look_at_m, "eye.look_at_m", "what the screen's centre shows, m",
               {-kFar_m, kFar_m}),
      FOCI_KEY(eye.up, "eye.up", "upwards", {-1, 1}),
      FOCI_KEY(eye.path, "eye.path", "keyframes of a moving eye, instead of position and look_at"),
      FOCI_KEY(screen.monitor, "screen.monitor", "a PsychoPy monitor (JSON), instead of sizes"),
      FOCI_KEY(screen.size_px, "screen.size_px", "width and height, px", {16, 16384}),
      FOCI_KEY(screen.size_m, "screen.size_m", "width and height of the visible area, m",
               {0.01, 20}),
      FOCI_KEY(screen.distance_m, "screen.distance_m", "eye to screen, m", {0.01, 100}),
      FOCI_KEY(observer.pupil_mm, "observer.pupil_mm", "diameter of the pupil, mm", {0.5, 12}),
      FOCI_KEY(observer.retina_mm, "observer.retina_mm", "lens to retina, mm", {10, 40}),
      FOCI_KEY(gaze.source, "gaze.source", "\"simulated\", or a recording (TSV, CSV, ASC)"),
      FOCI_KEY(gaze.columns.time, "gaze.time", "column of the time"),
      FOCI_KEY(gaze.columns.x, "gaze.x", "column of the horizontal position"),
      FOCI_KEY(gaze.columns.y, "gaze.y", "column of the vertical position"),
      FOCI_KEY(gaze.columns.pupil, "gaze.pupil", "column of the pupil's diameter, mm"),
      FOCI_KEY(gaze.columns.blink, "gaze.blink", "column that marks blinks"),
      FOCI_KEY(gaze.columns.time_scale_s, "gaze.time_scale_s", "seconds a unit of time",
               {1e-12, 3600}),
      FOCI_KEY(gaze.units, "gaze.units", "of the position",
               {.words = {"auto", "px", "deg", "normalised"}}),
      FOCI_KEY(gaze.events.saccade_deg_s, "gaze.saccade_deg_s", "faster is a saccade, deg/s",
               {1, 1000}),
      FOCI_KEY(gaze.events.window_s, "gaze.window_s", "samples that the speed is taken over, s",
               {0.002, 0.5}),
      FOCI_KEY(gaze.events.max_gap_s, "gaze.max_gap_s", "losses up to this are filled, s", {0, 1}),
      FOCI_KEY(gaze.events.max_blink_s, "gaze.max_blink_s", "longer losses are no blinks, s",
               {0, 10}),
      FOCI_KEY(focus.cone_deg, "focus.cone_deg",
               "half-angle of the cone in which the surface is sought, deg", {0.01, 20}),
      FOCI_KEY(focus.coverage, "focus.coverage", "share of the cone that a surface must fill",
               {0.01, 1}),
      FOCI_KEY(focus.accommodation.on, "focus.accommodation", "false: focus jumps to its target"),
      FOCI_KEY(focus.accommodation.latency_s, "focus.latency_s", "before focus begins to move, s",
               {0, 5}),
      FOCI_KEY(focus.accommodation.time_constant_s, "focus.time_constant_s",
               "of the exponential approach, s", {0.001, 10}),
      FOCI_KEY(focus.accommodation.resting_D, "focus.resting_D", "before there is a target, D",
               {0, 10}),
      FOCI_KEY(render.method, "render.method", "how depth of field is drawn: `foci methods`",
               {.words = methodNames()}),
      FOCI_KEY(output.size_px, "output.size_px", "width and height of the pictures, px",
               {16, 8192}),
      FOCI_KEY(output.fps, "output.fps", "frames a second", {1, 1000}),
      FOCI_KEY(output.seconds, "output.seconds", "from, to: after the recording's first sample, s",
               {0, 1e6}),
      FOCI_KEY(output.marker, "output.marker", "a mark where the observer looks"),
      FOCI_KEY(output.split, "output.split", "left half sharp, right half as the eye sees"),
      FOCI_KEY(seed, "seed", "of the simulated observer", {0, 9007199254740992.0}),
  };
  return keys;
}

#undef FOCI_KEY
#undef FOCI_KEYFRAME_KEY

/// A value as a message shows it: one short line.
std::string shownValue(const toml::value& value) {
  std::string text;
  switch (value.type()) {
    case toml::value_t::integer:
      text = std::to_string(value.as_integer());
      break;
    case toml::value_t::floating:
      text = numberText(value.as_floating());
      break;
    case toml::value_t::boolean:
      text = value.as_boolean() ? "true" : "false";
      break;
    case toml::value_t::string:
      text = jsonText(value.as_string().str);
      break;
    case toml::value_t::table:
      text = "{...}";
      break;
    case toml::value_t::array:
      for (const auto& element : value.as_array()) {
        text += (text.empty() ? "" : ", ") + shownValue(element);
        if (text.size() > 60) break;
      }
      text = "[" + text + "]";
      break;
    default:
      text = "a date or time";
      break;
  }
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

/// A text from outside, printable and short.
std::string shownName(std::string_view name) {
  const std::string quoted = jsonText(std::string(name.substr(0, 60)));
  return quoted.substr(1, quoted.size() - 2);
}

std::string place(const std::string& file, const toml::value& value) {
  return file + ":" + std::to_string(value.location().line());
}

/// Applies a TOML table of keys with the given prefix to `to`.
/// @return the names of the keys set
template <class T>
std::set<std::string, std::less<>> apply(const std::vector<Key<T>>& keys, const toml::table& table,
                                         const std::string& prefix, const std::string& file,
                                         T& to) {
  std::set<std::string, std::less<>> given;
  for (const auto& [name, value] : table) {
    const std::string full = prefix + name;
    const auto found =
        std::find_if(keys.begin(), keys.end(), [&](const auto& key) { return key.name == full; });
    const bool is_section = std::any_of(keys.begin(), keys.end(), [&](const auto& key) {
      return key.name.starts_with(full + ".");
    });
    if (found != keys.end()) {
      try {
        found->read(value, found->allowed, to);
      } catch (const Expected& expected) {
        throw InputError(place(file, value),
                         full + " = " + shownValue(value) + ": expected " + expected.what);
      }
      given.insert(full);
    } else if (is_section && value.is_table() && prefix.empty()) {
      given.merge(apply(keys, value.as_table(), full + ".", file, to));
    } else if (is_section) {
      throw InputError(place(file, value),
                       full + " = " + shownValue(value) + ": expected a section, [" + full + "]");
    } else {
      std::vector<std::string> known;
      for (const auto& key : keys) known.emplace_back(key.name);
      throw InputError(place(file, value), "unknown key " + shownName(full) + ": did you mean " +
                                               nearest(full, known) + "?");
    }
  }
  return given;
}

void read(const toml::value& from, const Allowed&, std::vector<EyeKeyframe>& to) {
  const std::string what = "a list of at most 10000 { time_s, position_m, look_at_m }";
  if (!from.is_array() || from.as_array().empty() || from.as_array().size() > 10000) {
    throw Expected{what};
  }
  for (const toml::value& element : from.as_array()) {
    if (!element.is_table()) throw Expected{what};
    EyeKeyframe frame;
    // The file's name is put before it by the caller, who knows it; the line is the element's own.
    std::set<std::string, std::less<>> given;
    try {
      given = apply(keyframeKeys(), element.as_table(), "", "", frame);
    } catch (const InputError& error) {
      const std::string_view text = error.what();
      throw Expected{"a list of keyframes, but line " + std::string(text.substr(1))};
    }
    for (const char* needed : {"time_s", "position_m", "look_at_m"}) {
      if (!given.contains(needed)) {
        throw Expected{std::string(needed) + " in each keyframe"};
      }
    }
    to.push_back(frame);
  }
}

std::string write(const std::vector<EyeKeyframe>& path) {
  std::string text = "[";
  for (const EyeKeyframe& frame : path) {
    text += text.size() > 1 ? ", {" : "{";
    for (const auto& key : keyframeKeys()) {
      text += (key.name == "time_s" ? "\"" : ", \"") + std::string(key.name) +
              "\": " + key.write(frame);
    }
    text += "}";
  }
  return text + "]";
}

constexpr std::size_t kMaxFile_bytes = 4 << 20;
constexpr std::size_t kMaxLine_bytes = 2000;
constexpr int kMaxDepth = 16;

/// toml11 recurses into nested values and keys: what would exhaust its stack is refused before.
void refuseDeepNesting(const std::string& text, const std::string& file) {
  int depth = 0, line = 1;
  std::size_t line_start = 0;
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto where = [&] { return file + ":" + std::to_string(line); };
    if (c == '\0') throw InputError(where(), "holds a NUL byte: not TOML");
    if (c == '\n') {
      ++line;
      line_start = i + 1;
      quote = 0;  // strings of several lines are no values of a study
    } else if (i - line_start > kMaxLine_bytes) {
      throw InputError(where(),
                       "expected lines of at most " + std::to_string(kMaxLine_bytes) + " bytes");
    } else if (quote) {
      if (c == '\\' && quote == '"')
        ++i;
      else if (c == quote)
        quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxDepth) throw InputError(where(), "nested too deeply");
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

/// The first line of toml11's report, without its function's name.
std::string firstLine(const std::exception& error) {
  std::string text = error.what();
  text = text.substr(0, text.find('\n'));
  if (text.starts_with("[error] ")) text = text.substr(8);
  if (text.starts_with("toml::")) text = text.substr(std::min(text.size(), text.find(": ") + 2));
  return shownName(text).empty() ? "not TOML" : text.substr(0, 200);
}

toml::value parseToml(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(file, "is a folder, expected a study (TOML)");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(file, "cannot be read");
  std::string text(kMaxFile_bytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxFile_bytes) throw InputError(file, "over 4 MiB: not a study");
  refuseDeepNesting(text, file);
  try {
    std::istringstream stream(text);
    return toml::parse(stream, file);
  } catch (const toml::exception& error) {
    throw InputError(file + ":" + std::to_string(error.location().line()), firstLine(error));
  } catch (const std::exception& error) {
    throw InputError(file, firstLine(error));
  }
}

void resolve(std::filesystem::path& path, const std::filesystem::path& folder) {
  if (path.is_relative()) path = (folder / path).lexically_normal();
}

}  // namespace

Study readStudy(const std::filesystem::path& file) {
  const toml::value document = parseToml(file);
  Study study;
  study.file = file;
  const auto given = apply(studyKeys(), document.as_table(), "", file.string(), study);

  const auto refuseBoth = [&](const char* one, const char* other) {
    if (given.contains(one) && given.contains(other)) {
      throw InputError(file.string(),
                       std::string(one) + " and " + other + ": expected only one of them");
    }
  };
  refuseBoth("scene.file", "scene.builtin");
  refuseBoth("screen.monitor", "screen.size_px");
  refuseBoth("screen.monitor", "screen.size_m");
  refuseBoth("screen.monitor", "screen.distance_m");
  refuseBoth("eye.path", "eye.position_m");
  refuseBoth("eye.path", "eye.look_at_m");

  const std::filesystem::path folder = file.parent_path();
  if (study.scene.file) resolve(*study.scene.file, folder);
  if (study.screen.monitor) resolve(*study.screen.monitor, folder);
  if (!study.gazeIsSimulated()) {
    std::filesystem::path trace = study.gaze.source;
    resolve(trace, folder);
    study.gaze.source = trace.string();
  }
  study.screen.is_default = std::none_of(given.begin(), given.end(), [](const std::string& name) {
    return name.starts_with("screen.");
  });
  if (study.screen.monitor) {
    const Screen screen = readPsychoPyMonitor(*study.screen.monitor);
    study.screen.size_px = screen.size_px;
    study.screen.size_m = screen.size_m;
    study.screen.distance_m = screen.distance_m;
  }
  return study;
}

void overrideKey(Study& study, std::string_view key, const OptionValue& value,
                 const std::string& option) {
  const auto& keys = studyKeys();
  const auto found = std::find_if(keys.begin(), keys.end(), [&](auto& k) { return k.name == key; });
  assert(found != keys.end());
  const toml::value toml = std::visit(
      [](const auto& v) -> toml::value {
        // Whole numbers may be meant for an integer key; a real key takes them as well.
        const auto number = [](double d) -> toml::value {
          if (std::abs(d) < 1e15 && d == std::floor(d)) return static_cast<std::int64_t>(d);
          return d;
        };
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, double>) {
          return number(v);
        } else if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::string>) {
          return toml::value(v);
        } else {
          toml::array array;
          for (const double element : v) array.push_back(number(element));
          return array;
        }
      },
      value);
  try {
    found->read(toml, found->allowed, study);
  } catch (const Expected& expected) {
    throw InputError(option, "expected " + expected.what);
  }
}

void checkStudy(const Study& study) {
  const std::string file = study.file.string();
  const auto refuse = [&](const std::string& what) { throw InputError(file, what); };
  const auto checkPose = [&](const glm::dvec3& position_m, const glm::dvec3& look_at_m,
                             const glm::dvec3& up, const std::string& name) {
    const glm::dvec3 sight = look_at_m - position_m;
    if (!(glm::length(sight) > 1e-6)) refuse(name + ": expected look_at_m away from position_m");
    if (!(glm::length(up) > 1e-6) ||
        !(glm::length(glm::cross(glm::normalize(sight), glm::normalize(up))) > 1e-4)) {
      refuse(name + ": expected up not along the line of sight");
    }
  };

  if (study.eye.position_m.has_value() != study.eye.look_at_m.has_value()) {
    refuse("eye.position_m and eye.look_at_m: expected both or neither");
  }
  if (study.eye.position_m) {
    checkPose(*study.eye.position_m, *study.eye.look_at_m, study.eye.up, "eye");
  } else if (study.eye.path.empty() && study.scene.file) {
    refuse("eye.position_m: expected for a scene from a file, as is eye.look_at_m");
  }
  for (std::size_t i = 0; i < study.eye.path.size(); ++i) {
    const EyeKeyframe& frame = study.eye.path[i];
    checkPose(frame.position_m, frame.look_at_m, frame.up.value_or(study.eye.up),
              "eye.path[" + std::to_string(i) + "]");
    if (i > 0 && !(frame.time_s > study.eye.path[i - 1].time_s)) {
      refuse("eye.path[" + std::to_string(i) + "].time_s = " + numberText(frame.time_s) +
             ": expected later than the keyframe before");
    }
  }
  if (study.output.seconds && !(study.output.seconds->y > study.output.seconds->x)) {
    refuse("output.seconds = " + write(*study.output.seconds) + ": expected from before to");
  }
  if (study.output.size_px.x % 2 != 0 || study.output.size_px.y % 2 != 0) {
    refuse("output.size_px = " + write(study.output.size_px) +
           ": expected even numbers, as H.264 wants");
  }
}

std::vector<ResolvedKey> resolvedKeys(const Study& study) {
  std::vector<ResolvedKey> resolved;
  for (const auto& key : studyKeys()) {
    resolved.push_back({key.name, key.meaning, key.write(study)});
  }
  return resolved;
}

Screen Study::screenInForce() const {
  return {.size_px = screen.size_px, .size_m = screen.size_m, .distance_m = screen.distance_m};
}

}  // namespace foci
