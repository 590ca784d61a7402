// The keys of a study: names, types, ranges, meaning. toml11 is heavy to compile, so only
// study*.cpp include this.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>

#include "app/study/study.h"
#include "calibration/toml_file.h"

namespace foci {

using KeyNames = std::set<std::string, std::less<>>;

/// Sets every key of a TOML document.
/// @param file  for messages
/// @return the names of the keys set
/// @throws InputError naming file, line, key and value where the table of keys forbids something
KeyNames setKeys(Study& study, const TomlDocument& document, const std::string& file);

/// Sets one key, which the table must have (asserted). @throws Expected
void setKey(Study& study, std::string_view key, const toml::value& value);

/// Whether a key of the screen decides angles: with it, the study names its screen.
bool decidesAngles(std::string_view key);

/// A text from outside, made printable and short for a message.
std::string shownName(std::string_view name);

}  // namespace foci
