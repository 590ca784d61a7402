// `--set KEY=VALUE`: any key of a study from the command line.
#include <string>
#include <utility>

#include "app/study/study.h"
#include "app/study/study_keys.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/toml_file.h"

namespace foci {
namespace {

/// Keys of which a study has only one: setting the first removes the second.
constexpr std::pair<std::string_view, std::string_view> kReplaced[] = {
    {"scene.builtin", "scene.file"},
    {"eye.position_m", "eye.path"},
    {"eye.look_at_m", "eye.path"},
    {"eye.path", "eye.position_m"},
    {"eye.path", "eye.look_at_m"},
    {"screen.size_px", "screen.monitor"},
    {"screen.size_m", "screen.monitor"},
    {"screen.distance_m", "screen.monitor"},
    {"screen.gamma", "screen.monitor"},
    {"observer.wavefront", "observer.age_years"},
    {"observer.age_years", "observer.wavefront"},
};

/// Whether the text is one TOML value.
bool isTomlValue(const std::string& text) {
  try {
    return parseToml("value = " + text, "").table().size() == 1;
  } catch (const std::exception&) {
    return false;
  }
}

/// Sets a key to a TOML value, or to the text itself where the key does not take it as TOML: a file
/// named 2024, a column named 3.
void setToText(Study& study, const std::string& key, const std::string& text,
               const std::string& where) {
  if (text != "null" && !isTomlValue(text)) {
    setKey(study, key, quotedText(text), where);
    return;
  }
  try {
    setKey(study, key, text, where);
  } catch (const InputError& refusal) {
    try {
      setKey(study, key, quotedText(text), where);
    } catch (const InputError&) {
      throw InputError(refusal.what());
    }
  }
}

}  // namespace

void setKeyByOption(Study& study, const std::string& assignment) {
  const std::size_t at = assignment.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == assignment.size()) {
    throw InputError("--set " + shownName(assignment),
                     "expected KEY=VALUE, e.g. observer.pupil_mm=3");
  }
  const std::string key = assignment.substr(0, at), where = "--set";
  setToText(study, key, assignment.substr(at + 1), where);
  for (const auto& [set, removed] : kReplaced) {
    if (key == set) setKey(study, removed, "null", where);
  }
  if (key == "screen.monitor" && study.screen.monitor) {
    overrideKey(study, key, study.screen.monitor->string(), where);  // reads the monitor
  }
  if (decidesAngles(key)) study.screen.is_default = false;
}

}  // namespace foci
