// What the program's pages have in common: they open from disk, with everything inside.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace foci {

/// The pages' style sheet; light and dark as the reader's system is.
extern const char* const kPageStyle;

/// Text from outside as HTML text or attribute.
std::string escaped(const std::string& text);

/// Base64 (RFC 4648) of a stream of bytes, in constant memory.
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

/// A number and what it is, as a cell of a `numbers` block.
std::string numberCell(const std::string& value, const std::string& what);

}  // namespace foci
