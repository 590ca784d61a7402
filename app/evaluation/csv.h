// Fields of CSV files (RFC 4180).
#pragma once

#include <string>

namespace foci {

/// A field, in double quotes if it holds a comma, a double quote or a line break.
inline std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace foci
