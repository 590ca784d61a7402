// Bytes as text: Base64 (RFC 4648).
#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

/// Writes a stream of bytes as Base64, in constant memory.
class Base64 {
 public:
  explicit Base64(std::ostream& out) : out_(out) {}

  void add(const std::uint8_t* bytes, std::size_t count);
  void finish();

 private:
  void put(std::string& text, int digits);

  std::ostream& out_;
  std::uint32_t bits_ = 0;
  int held_ = 0;
};

/// The bytes of a text in Base64. Other characters, such as line ends and padding, are ignored.
std::vector<std::uint8_t> bytesOfBase64(std::string_view text);

}  // namespace foci
