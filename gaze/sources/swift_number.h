// Fast parsing of a table's decimal numbers, eight characters in one step (Lemire 2021, "Number
// parsing at a gigabyte per second"). The recordings' readers use this path first, and
// `parseNumber` for any other text.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "base/text.h"

namespace foci {

/// So many bytes behind a field must be readable.
inline constexpr std::size_t kNumberPadding = 8;

static_assert(std::endian::native == std::endian::little);

/// Parses an optional minus sign and up to 15 characters: digits, with at most one decimal point
/// among the last 8. The digits as an integer and the power of ten are then exact doubles, so their
/// quotient is the nearest double (Clinger 1990).
/// @param field  followed by `kNumberPadding` readable bytes of any value
/// @return nothing for any other text, even if it is a number
inline std::optional<double> swiftNumber(std::string_view field) {
  static constexpr double kPowers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7};
  constexpr std::uint64_t kZeros = 0x3030303030303030, kOnes = 0x0101010101010101,
                          kHighs = 0x8080808080808080;
  const char* at = field.data();
  std::size_t length = field.size();
  if (length == 0) return std::nullopt;
  const bool negative = *at == '-';
  at += negative;
  length -= negative;
  if (length == 0 || length > 15) return std::nullopt;

  std::uint64_t head = 0;  // the digits before the last eight characters
  for (; length > 8; --length) {
    const auto digit = static_cast<unsigned char>(*at++ - '0');
    if (digit > 9) return std::nullopt;
    head = 10 * head + digit;
  }
  std::uint64_t text = 0;
  std::memcpy(&text, at, sizeof text);
  // Move the last character to the highest byte, and fill with zeros before the first.
  const auto unused = static_cast<unsigned>(8 * (8 - length));
  text = unused == 0 ? text : text << unused | kZeros >> (64 - unused);

  // Remove the point: move the digits before it by one byte.
  const std::uint64_t points = text ^ 0x2e2e2e2e2e2e2e2e;
  const std::uint64_t found = (points - kOnes) & ~points & kHighs;
  int decimals = 0;
  std::uint64_t scale = 100'000'000;  // of `head`
  if (found != 0) {
    if (length == 1) return std::nullopt;
    const int byte = std::countr_zero(found) / 8;
    decimals = 7 - byte;
    const std::uint64_t before = (std::uint64_t{1} << (8 * byte)) - 1;
    const std::uint64_t after = byte == 7 ? 0 : ~std::uint64_t{0} << (8 * (byte + 1));
    text = (text & after) | (text & before) << 8 | 0x30;
    scale = 10'000'000;
  }
  if ((((text + 0x4646464646464646) | (text - kZeros)) & kHighs) != 0) return std::nullopt;
  text -= kZeros;
  text = text * 10 + (text >> 8);
  constexpr std::uint64_t kPairs = 0x000000ff000000ff;
  const std::uint64_t digits =
      ((text & kPairs) * 0x000f424000000064 + ((text >> 16) & kPairs) * 0x0000271000000001) >> 32;
  const double value =
      static_cast<double>(static_cast<std::int64_t>(head * scale + digits)) / kPowers[decimals];
  return negative ? -value : value;
}

/// A number in any form that `parseNumber` takes. @param field  as of `swiftNumber`
inline std::optional<double> fieldNumber(std::string_view field) {
  const auto swift = swiftNumber(field);
  return swift ? swift : parseNumber(trimmed(field));
}

}  // namespace foci
