// Texts side by side: the fields of a table's row, and lists.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.h"

namespace foci {

/// Parts (`concat`) with tabs, or another character, between them.
template <char kBetween = '\t', typename First, typename... More>
std::string tabbed(const First& first, const More&... more) {
  std::string fields = concat(first);
  ((fields += kBetween, fields += concat(more)), ...);
  return fields;
}

/// A row of a table: its fields, and the line break.
template <char kBetween = '\t', typename... Fields>
std::string rowOf(const Fields&... fields) {
  return tabbed<kBetween>(fields...) + '\n';
}

/// A field of CSV (RFC 4180): in double quotes if it holds a comma, a double quote or a line break.
inline std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// The fields of a row between tabs.
inline std::vector<std::string> fieldsOf(std::string_view row) {
  std::vector<std::string> fields(1);
  for (const char c : row) {
    if (c == '\t') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

/// The elements of a list in one text.
/// @param textOf  an element's text
template <typename List, typename TextOf = std::identity>
std::string listed(const List& list, std::string_view between = ", ", const TextOf& textOf = {}) {
  std::string text;
  for (const auto& each : list) {
    if (!text.empty()) text += between;
    text += std::invoke(textOf, each);
  }
  return text;
}

}  // namespace foci
