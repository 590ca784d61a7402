// Numbers in JSON, which has no infinity.
#pragma once

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace foci {

/// The number, or "inf" in place of all that is not finite.
inline nlohmann::ordered_json jsonNumber(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json("inf");
}

/// The other way round.
inline double numberInJson(const nlohmann::ordered_json& json) {
  return json.is_string() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

}  // namespace foci
