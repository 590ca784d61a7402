// JSON as text: outside bytes that are not UTF-8, and numbers that are not finite.
#pragma once

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace foci {

/// The value, on one line unless there is an indentation. Bytes that are not UTF-8, e.g. of a file
/// name, become U+FFFD.
inline std::string jsonText(const nlohmann::ordered_json& json, int indent = -1) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// The number, or the text "inf" if it is not finite: JSON has no infinity.
inline nlohmann::ordered_json jsonNumber(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json("inf");
}

/// The inverse of `jsonNumber`.
inline double numberInJson(const nlohmann::ordered_json& json) {
  return json.is_string() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

}  // namespace foci
