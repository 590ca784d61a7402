// Text to numbers, the same in every locale.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <optional>
#include <string_view>
#include <system_error>

namespace foci {

/// A finite decimal number, with or without a sign. The number must fill the whole text, so that
/// "1 " and "1px" give nothing.
inline std::optional<double> parseNumber(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool fills = error == std::errc() && end == text.data() + text.size();
  return fills && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// A decimal integer that fills the whole text and fits into the type. No plus sign.
template <std::integral Integer>
std::optional<Integer> parseInteger(std::string_view text) {
  Integer value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool fills = error == std::errc() && end == text.data() + text.size();
  return fills ? std::optional(value) : std::nullopt;
}

}  // namespace foci
