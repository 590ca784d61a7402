#include "app/study/study_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

using Json = nlohmann::ordered_json;

/// Whether a key needs no quotes in TOML.
bool isBare(const std::string& name) {
  constexpr const char* kBare = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
  return !name.empty() && name.find_first_not_of(kBare) == name.npos;
}

/// Numbers, texts and lists look the same in JSON and TOML; tables do not.
std::string tomlOf(const Json& json) {
  if (json.is_array()) return "[" + listed(json, ", ", tomlOf) + "]";
  if (!json.is_object()) return json.dump();
  std::string text;
  for (const auto& [name, value] : json.items()) {
    if (value.is_null() || value == "") continue;
    text += (text.empty() ? "" : ", ") + (isBare(name) ? name : quotedText(name)) + " = " +
            tomlOf(value);
  }
  return "{" + text + "}";
}

/// The value of a key in a file: a list of tables has a line for each.
std::string tomlInFile(const Json& json) {
  if (!json.is_array() || json.empty() || !json.front().is_object()) return tomlOf(json);
  return "[\n  " + listed(json, ",\n  ", tomlOf) + "\n]";
}

/// The value of a key. @throws InputError for a file whose name is not UTF-8, as TOML has to be
Json valueOf(const Study& study, const ResolvedKey& key) {
  Json value = Json::parse(key.json, nullptr, false);
  if (!value.is_discarded()) return value;
  throw InputError(study.file.string(),
                   std::string(key.name) +
                       ": a name that is not UTF-8, which no study can hold: expected another name "
                       "of the file, or of a folder above it");
}

/// A file as a study in `folder` names it.
std::filesystem::path namedIn(const std::filesystem::path& folder,
                              const std::filesystem::path& file) {
  const std::filesystem::path absolute = std::filesystem::absolute(file).lexically_normal();
  const std::filesystem::path home =
      std::filesystem::absolute(folder.empty() ? "." : folder).lexically_normal();
  const std::filesystem::path relative = absolute.lexically_relative(home);
  const bool below = !relative.empty() && *relative.begin() != "..";
  return below ? relative : absolute;
}

bool isPlace(std::string_view key) { return key == "scene.scale_m" || key.starts_with("eye."); }

/// The keys that have a value and are `wanted`, under their sections.
/// @param after  what a line has after the value
template <class Wanted, class After>
std::string sectionsOfKeys(const Study& study, const Wanted& wanted, const After& after) {
  std::string above, text, section;
  for (const ResolvedKey& key : resolvedKeys(study)) {
    const Json value = valueOf(study, key);
    if (value.is_null() || value == Json::array() || value == "" || !wanted(key)) continue;
    if (study.scene.file && key.name == "scene.builtin") continue;
    const std::string in(sectionOf(key.name)), name(leafOf(key.name));
    const std::string line = name + " = " + tomlInFile(value) + after(key) + "\n";
    if (!in.empty() && std::exchange(section, in) != in) text += "\n[" + in + "]\n";
    (in.empty() ? above : text) += line;
  }
  return above + text;
}

}  // namespace

std::string tomlOfJson(const std::string& json) { return tomlOf(Json::parse(json)); }

std::string annotatedStudyToml(const Study& study, const std::filesystem::path& folder,
                               const std::string& comment) {
  Study moved = study;
  for (auto* path :
       {&moved.scene.file, &moved.screen.spectra, &moved.observer.wavefront.file,
        &moved.observer.field.file, &moved.gaze.map, &moved.gaze.camera, &moved.record.frames,
        &moved.record.changes, &moved.record.markers, &moved.record.head, &moved.remote.folder}) {
    if (*path) **path = namedIn(folder, **path);
  }
  for (ScenePart& part : moved.scene.parts) part.file = namedIn(folder, part.file);
  const std::filesystem::path source = moved.gaze.source;
  if (std::filesystem::exists(source)) moved.gaze.source = namedIn(folder, source).string();
  moved.screen.monitor.reset();

  std::string above, line;
  std::istringstream lines(comment);
  while (std::getline(lines, line)) above += "# " + line + "\n";
  const bool moves = !moved.eye.path.empty();
  const auto wanted = [&](const ResolvedKey& key) {
    if (moves && (key.name == "eye.position_m" || key.name == "eye.look_at_m")) return false;
    return isPlace(key.name) || !key.is_default;
  };
  return above + sectionsOfKeys(moved, wanted, [](const ResolvedKey& key) {
           return "  # " + std::string(key.meaning);
         });
}

std::string studyToml(const Study& study) {
  Study moved = study;
  for (auto* path : {&moved.scene.file, &moved.screen.spectra, &moved.observer.wavefront.file,
                     &moved.observer.field.file, &moved.gaze.map, &moved.gaze.camera}) {
    if (*path) **path = std::filesystem::absolute(**path);
  }
  for (ScenePart& part : moved.scene.parts) part.file = std::filesystem::absolute(part.file);
  moved.screen.monitor.reset();
  return sectionsOfKeys(
      moved, [](const ResolvedKey&) { return true; }, [](const ResolvedKey&) { return ""; });
}

std::string studyKeysMarkdown() {
  std::string text =
      "# The study file\n\n"
      "A study is a TOML file. Every key may be left out. foci refuses an unknown key and names "
      "the nearest known one. Paths\nare relative to the study. This page is the output of `foci "
      "keys --markdown`.\n";
  std::vector<std::pair<std::string, std::string>> rows;  // keys that mean the same share a row
  const auto finish = [&] {
    for (const auto& [names, rest] : rows) text.append("| ").append(names).append(rest);
    rows.clear();
  };
  std::string section = "none yet";
  for (const ResolvedKey& key : resolvedKeys(Study{})) {
    const std::string in(sectionOf(key.name)), name(leafOf(key.name));
    if (in != section) {
      finish();
      text += in.empty() ? "\n## Above the first section\n" : "\n## [" + in + "]\n";
      text += "\n| key | what | allowed (default) |\n|---|---|---|\n";
      section = in;
    }
    const bool absent = key.json == "null" || key.json == "[]" || key.json == "\"\"";
    std::string rest = " | " + std::string(key.meaning) + " |";  // without empty cells at the end
    if (!key.allowed.empty()) rest += " " + key.allowed;
    if (!absent) rest += " (`" + tomlOf(Json::parse(key.json)) + "`)";
    if (!key.allowed.empty() || !absent) rest += " |";
    rest += "\n";
    const auto same =
        std::ranges::find_if(rows, [&](const auto& row) { return row.second == rest; });
    if (same == rows.end()) {
      rows.emplace_back("`" + name + "`", rest);
    } else {
      same->first += ", `" + name + "`";
    }
  }
  finish();
  return text;
}

}  // namespace foci
