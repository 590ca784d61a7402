#include "base/base64.h"

namespace foci {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

void Base64::add(const std::uint8_t* bytes, std::size_t count) {
  std::string text;
  text.reserve(count / 3 * 4 + 8);
  for (std::size_t i = 0; i < count; ++i) {
    bits_ = bits_ << 8 | bytes[i];
    if (++held_ == 3) put(text, 4);
  }
  out_ << text;
}

void Base64::finish() {
  if (held_ == 0) return;
  const int digits = held_ + 1;
  bits_ <<= 8 * (3 - held_);
  std::string text;
  put(text, digits);
  out_ << text.append(static_cast<std::size_t>(4 - digits), '=');
}

void Base64::put(std::string& text, int digits) {
  for (int i = 0; i < digits; ++i) text += kDigits[bits_ >> (18 - 6 * i) & 63];
  bits_ = 0;
  held_ = 0;
}

std::vector<std::uint8_t> bytesOfBase64(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t value = kDigits.find(c);
    if (value == std::string_view::npos) continue;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
  }
  return bytes;
}

}  // namespace foci
