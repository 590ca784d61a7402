// The table of keys, and the TOML that it is applied to (toml11).
#include "app/study.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>
#include <toml.hpp>

#include "app/base/input_error.h"
#include "app/base/nearest.h"
#include "app/toml_text.h"
#include "app/toml_values.h"
#include "calibration/camera.h"
#include "calibration/gaze_map_file.h"
#include "calibration/screen_file.h"
#include "calibration/webcam_calibration.h"
#include "render/methods/method.h"

namespace foci {

// The type of `eye.path`, beside those of toml_values.h.
static void read(const toml::value& from, const Allowed&, std::vector<EyeKeyframe>& to);
static std::string write(const std::vector<EyeKeyframe>& path);

namespace {

/// A key of the table T: Study, or EyeKeyframe within `eye.path`.
template <class T>
struct Key {
  std::string_view name;
  std::string_view meaning;
  Allowed allowed;
  void (*read)(const toml::value&, const Allowed&, T&);
  std::string (*write)(const T&);
  void (*reset)(T&);
};

/// @param at  the member that the key sets
template <class T, auto at>
Key<T> key(std::string_view name, std::string_view meaning, Allowed allowed = {}) {
  return {name,
          meaning,
          std::move(allowed),
          [](const toml::value& from, const Allowed& a, T& to) { read(from, a, at(to)); },
          [](const T& from) { return write(at(from)); },
          [](T& to) {
            T fresh;
            at(to) = at(fresh);
          }};
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

const std::vector<Key<Study>>& studyKeys() {
  static const std::vector<Key<Study>> keys = {
      FOCI_KEY(scene.file, "scene.file",
               "points (PLY), a mesh (OBJ, glTF, STL, PLY) or a prepared scene (.foci)"),
      FOCI_KEY(scene.builtin, "scene.builtin", "built-in scene, where there is no file",
               {.words = {"gallery", "plane"}}),
      FOCI_KEY(scene.scale_m, "scene.scale_m", "metres a unit of the file", {1e-6, 1e6}),
      FOCI_KEY(scene.background, "scene.background", "linear RGB behind everything", {0, 1}),
      FOCI_KEY(eye.position_m, "eye.position_m", "where the eye is, m", {-kFar_m, kFar_m}),
      FOCI_KEY(eye.look_at_m, "eye.look_at_m", "what the screen's centre shows, m",
               {-kFar_m, kFar_m}),
      FOCI_KEY(eye.up, "eye.up", "upwards", {-1, 1}),
      FOCI_KEY(eye.path, "eye.path", "keyframes of a moving eye, instead of position and look_at"),
      FOCI_KEY(screen.monitor, "screen.monitor",
               "a calibrated screen (foci calibrate screen, PsychoPy), instead of sizes"),
      FOCI_KEY(screen.size_px, "screen.size_px", "width and height, px", {16, 16384}),
      FOCI_KEY(screen.size_m, "screen.size_m", "width and height of the visible area, m",
               {0.01, 20}),
      FOCI_KEY(screen.distance_m, "screen.distance_m", "eye to screen, m", {0.01, 100}),
      FOCI_KEY(observer.pupil_mm, "observer.pupil_mm", "diameter of the pupil, mm", {0.5, 12}),
      FOCI_KEY(observer.retina_mm, "observer.retina_mm", "lens to retina, mm", {10, 40}),
      FOCI_KEY(observer.between_eyes_mm, "observer.between_eyes_mm",
               "from one pupil to the other, mm", {40, 80}),
      FOCI_KEY(gaze.source, "gaze.source",
               "\"simulated\", a recording (TSV, CSV, ASC), or webcam:VIDEO"),
      FOCI_KEY(gaze.map, "gaze.map", "map of foci calibrate gaze, for a recording or a webcam"),
      FOCI_KEY(gaze.camera, "gaze.camera", "camera of foci calibrate camera"),
      FOCI_KEY(gaze.columns.time, "gaze.time", "column of the time"),
      FOCI_KEY(gaze.columns.x, "gaze.x", "column of the horizontal position"),
      FOCI_KEY(gaze.columns.y, "gaze.y", "column of the vertical position"),
      FOCI_KEY(gaze.columns.pupil, "gaze.pupil", "column of the pupil's diameter, mm"),
      FOCI_KEY(gaze.columns.blink, "gaze.blink", "column that marks blinks"),
      FOCI_KEY(gaze.columns.time_scale_s, "gaze.time_scale_s", "seconds a unit of time",
               {1e-12, 3600}),
      FOCI_KEY(gaze.units, "gaze.units", "of the position",
               {.words = {"auto", "px", "deg", "normalised"}}),
      FOCI_KEY(gaze.rate_Hz, "gaze.rate_Hz",
               "nominal samples a second; absent: the recording's median", {5, 20000}),
      FOCI_KEY(gaze.events.saccade_deg_s, "gaze.saccade_deg_s", "faster is a saccade, deg/s",
               {1, 1000}),
      FOCI_KEY(gaze.events.window_s, "gaze.window_s", "samples that the speed is taken over, s",
               {0.002, 0.5}),
      FOCI_KEY(gaze.events.delay_s, "gaze.delay_s", "how late a sample's state may be known, s",
               {0, 0.2}),
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
      FOCI_KEY(focus.accommodation.far_time_constant_s, "focus.far_time_constant_s",
               "of the approach to a farther target, s; absent: the same", {0.001, 10}),
      FOCI_KEY(focus.accommodation.age_years, "focus.age_years",
               "limits how near the eye focuses; absent: no limit", {1, 120}),
      FOCI_KEY(focus.vergence, "focus.vergence",
               "true: the distance at which both lines of sight meet counts, too"),
      FOCI_KEY(focus.accommodation.resting_D, "focus.resting_D", "before there is a target, D",
               {0, 10}),
      FOCI_KEY(focus.fixed_D, "focus.fixed_D",
               "focus stays there, whatever is looked at, D; absent: it follows", {0, 20}),
      FOCI_KEY(render.method, "render.method", "how depth of field is drawn: `foci methods`",
               {.expected = expectedMethod}),
      FOCI_KEY(render.shading, "render.shading",
               "how much of the colour falls off with the angle of surface to sight", {0, 1}),
      FOCI_KEY(output.size_px, "output.size_px",
               "width and height of the pictures, px; absent: the screen's", {16, 8192}),
      FOCI_KEY(output.fps, "output.fps", "frames a second", {1, 1000}),
      FOCI_KEY(output.seconds, "output.seconds", "from, to: after the recording's first sample, s",
               {0, 1e6}),
      FOCI_KEY(output.marker, "output.marker", "a mark where the observer looks"),
      FOCI_KEY(output.split, "output.split", "left half sharp, right half as the eye sees"),
      FOCI_KEY(output.view, "output.view",
               "one eye in the middle, or both: left beside right, left above right, left red",
               {.words = {"mono", "side-by-side", "top-bottom", "anaglyph"}}),
      FOCI_KEY(record.frames, "record.frames",
               "frames.tsv of a live run: its times and methods, instead of output.fps"),
      FOCI_KEY(record.changes, "record.changes", "changes.tsv of a live run"),
      FOCI_KEY(seed, "seed", "of the simulated observer", {0, 9007199254740992.0}),
  };
  return keys;
}

#undef FOCI_KEY
#undef FOCI_KEYFRAME_KEY

/// A text from outside, printable and short.
std::string shownName(std::string_view name) {
  const std::string quoted = jsonText(std::string(name.substr(0, 60)));
  return quoted.substr(1, quoted.size() - 2);
}

std::string place(const std::string& file, const toml::value& value) {
  return file + ":" + std::to_string(value.location().line());
}

InputError notAsExpected(const std::string& file, const std::string& key, const toml::value& value,
                         const std::string& expected) {
  return {place(file, value), key + " = " + shownValue(value) + ": expected " + expected};
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
        throw notAsExpected(file, full, value, expected.what);
      }
      given.insert(full);
    } else if (is_section && value.is_table() && prefix.empty()) {
      given.merge(apply(keys, value.as_table(), full + ".", file, to));
    } else if (is_section) {
      throw notAsExpected(file, full, value, "a section of keys");
    } else {
      std::vector<std::string> known;
      std::transform(keys.begin(), keys.end(), std::back_inserter(known),
                     [](const auto& key) { return std::string(key.name); });
      throw InputError(place(file, value), "unknown key " + shownName(full) + ": did you mean " +
                                               nearest(full, known) + "?");
    }
  }
  return given;
}

}  // namespace

static void read(const toml::value& from, const Allowed&, std::vector<EyeKeyframe>& to) {
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

static std::string write(const std::vector<EyeKeyframe>& path) {
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

namespace {

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
  const std::string text = readTomlText(path);
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

/// The calibrated screen's own numbers, where the study names one.
void takeMonitor(Study& study) {
  if (!study.screen.monitor) return;
  const Screen screen = readScreen(*study.screen.monitor).screen;
  study.screen.size_px = screen.size_px;
  study.screen.size_m = screen.size_m;
  study.screen.distance_m = screen.distance_m;
  study.screen.is_default = false;
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
  if (study.gaze.map) resolve(*study.gaze.map, folder);
  if (study.gaze.camera) resolve(*study.gaze.camera, folder);
  if (study.record.frames) resolve(*study.record.frames, folder);
  if (study.record.changes) resolve(*study.record.changes, folder);
  if (auto place = webcamPlaceOf(study.gaze.source)) {
    if (!place->device) {
      resolve(place->file, folder);
      study.gaze.source = "webcam:" + place->file.string();
    }
  } else if (!study.gazeIsSimulated()) {
    std::filesystem::path trace = study.gaze.source;
    resolve(trace, folder);
    study.gaze.source = trace.string();
  }
  study.screen.is_default = std::none_of(given.begin(), given.end(), [](const std::string& name) {
    return name.starts_with("screen.");
  });
  takeMonitor(study);
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
  if (key == "screen.monitor") takeMonitor(study);
}

void setKey(Study& study, std::string_view key, const std::string& text, const std::string& where) {
  const auto& keys = studyKeys();
  const auto found = std::find_if(keys.begin(), keys.end(), [&](auto& k) { return k.name == key; });
  if (found == keys.end()) throw InputError(where, "unknown key " + shownName(key));
  if (text == "null") {
    found->reset(study);
    return;
  }
  try {
    std::istringstream stream("value = " + text);
    const toml::value document = toml::parse(stream, where);
    found->read(document.as_table().at("value"), found->allowed, study);
  } catch (const Expected& expected) {
    throw InputError(where,
                     std::string(key) + " = " + shownName(text) + ": expected " + expected.what);
  } catch (const std::exception&) {
    throw InputError(where, std::string(key) + " = " + shownName(text) + ": expected a TOML value");
  }
}

void checkStudy(const Study& study) {
  const std::string file = study.file.string();
  const auto refuse = [&](const std::string& what) { throw InputError(file, what); };
  if (study.gaze.map && study.gazeIsSimulated()) {
    refuse("gaze.map: expected a recording to map, not simulated gaze");
  }
  if (webcamPlaceOf(study.gaze.source)) {
    if (!study.gaze.map) {
      refuse(
          "gaze.source: a webcam needs gaze.map (--gaze-map): foci calibrate gaze --source webcam");
    }
    readWebcamCalibration(*study.gaze.map);
  } else if (study.gaze.map) {
    readGazeMap(*study.gaze.map);
  }
  if (study.gaze.camera) readCamera(*study.gaze.camera);
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
  const glm::ivec2 size_px = study.pictureSize_px();
  if ((study.output.view == "side-by-side" && size_px.x % 2 != 0) ||
      (study.output.view == "top-bottom" && size_px.y % 2 != 0)) {
    refuse("output.view = \"" + study.output.view +
           "\": expected pictures of an even number of px, to be halved");
  }
  if (study.output.seconds && !(study.output.seconds->y > study.output.seconds->x)) {
    refuse("output.seconds = " + write(*study.output.seconds) + ": expected from before to");
  }
}

std::vector<ResolvedKey> resolvedKeys(const Study& study) {
  std::vector<ResolvedKey> resolved;
  for (const auto& key : studyKeys()) {
    std::string allowed;
    for (const auto word : key.allowed.words) {
      allowed += (allowed.empty() ? "\"" : ", \"") + std::string(word) + "\"";
    }
    if (std::isfinite(key.allowed.high)) allowed = rangeText(key.allowed);
    resolved.push_back({key.name, key.meaning, key.write(study), allowed});
  }
  return resolved;
}

Screen Study::screenInForce() const {
  return {.size_px = screen.size_px, .size_m = screen.size_m, .distance_m = screen.distance_m};
}

}  // namespace foci
