// JSON: its text, and values that may be absent, have components, or are not finite.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace nlohmann {

/// null: absent.
template <class T>
struct adl_serializer<std::optional<T>> {
  static void to_json(auto& json, const std::optional<T>& value) {
    json = nullptr;
    if (value) json = *value;
  }
  static void from_json(const auto& json, std::optional<T>& value) {
    value.reset();
    if (!json.is_null()) json.get_to(value.emplace());
  }
};

/// A vector is the list of its components.
template <int N, class T>
struct adl_serializer<glm::vec<N, T>> {
  static void to_json(auto& json, const glm::vec<N, T>& value) {
    for (int i = 0; i < N; ++i) json.push_back(value[i]);
  }
  static void from_json(const auto& json, glm::vec<N, T>& value) {
    for (int i = 0; i < N; ++i) json.at(static_cast<std::size_t>(i)).get_to(value[i]);
  }
};

}  // namespace nlohmann

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
