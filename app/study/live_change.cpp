#include "app/study/live_change.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

/// Those that may name a file.
constexpr std::string_view kWavefrontKey = "observer.wavefront", kFieldKey = "observer.field";

}  // namespace

std::string remoteValue(const Study& study, const std::string& key, const std::string& toml) {
  if (key != kWavefrontKey && key != kFieldKey) return toml;
  Study named = study;
  setKey(named, key, toml, "change");
  const auto& name = key == kFieldKey ? named.observer.field.file : named.observer.wavefront.file;
  if (!name) return toml;
  if (!study.remote.folder) {
    throw InputError(key,
                     "names a file: expected remote.folder in the study, whose files remote "
                     "control may name");
  }
  std::error_code error;
  const auto folder = std::filesystem::canonical(*study.remote.folder, error);
  const auto file = std::filesystem::canonical(folder / *name, error);  // follows links
  const bool inside =
      std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
  if (error || !inside || !std::filesystem::is_regular_file(file, error)) {
    throw InputError(key, "expected the name of a file in remote.folder, " + folder.string());
  }
  return quotedText(file.string());
}

void changeLive(Study& study, Session& session, const std::string& key, const std::string& toml) {
  Study changed = study;
  setKey(changed, key, changesLive(key) ? toml : "null", "change");  // refuses an unknown key
  if (!changesLive(key)) throw InputError(key, "does not change while foci runs");
  checkStudy(changed);
  session.changeSettings(sessionSettingsOf(changed));
  study = std::move(changed);
}

}  // namespace foci
