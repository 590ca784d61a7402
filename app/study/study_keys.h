// The keys of a study: names, types, ranges, meaning. Heavy to compile (toml11): for study*.cpp
// alone.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <toml.hpp>

#include "app/study/study.h"

namespace foci {

using KeyNames = std::set<std::string, std::less<>>;

/// Sets every key of a TOML document.
/// @param file  for messages
/// @return the names of the keys set
/// @throws InputError naming file, line, key and value for whatever is not as the table says
KeyNames setKeys(Study& study, const toml::table& table, const std::string& file);

/// Sets one key of the table (another asserts). @throws Expected
void setKey(Study& study, std::string_view key, const toml::value& value);

/// A text from outside, printable and short.
std::string shownName(std::string_view name);

}  // namespace foci
