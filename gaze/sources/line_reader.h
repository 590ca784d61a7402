// Lines of a text file in constant memory, and the numbers in them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_error.h"

namespace foci {

/// Reads lines that end in LF or CRLF; the last may lack its end. A UTF-8 byte order mark is
/// skipped. A file in gzip's format is unpacked on the way.
class LineReader {
 public:
  /// @throws InputError where the file cannot be read or is a folder
  explicit LineReader(const std::filesystem::path& file);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// @param line  valid until the next call; `kNumberPadding` more bytes may be read
  /// @return false at the end
  /// @throws InputError on a NUL byte (binary, or UTF-16) and on a line over 64 KiB
  bool next(std::string_view& line);

  /// An error at the line last read.
  InputError error(const std::string& what) const;
  const std::string& fileName() const { return name_; }

 private:
  struct Input;  // of zlib, which reads plain files, too
  bool fill();

  std::string name_;
  std::unique_ptr<Input> in_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  std::size_t number_ = 0;
};

/// Without blanks at both ends.
std::string_view trimmed(std::string_view text);

/// An outside string as an error message may show it: in quotes, printable, at most 40 bytes.
std::string shown(std::string_view text);

/// True for what recordings write where they have no value: nothing, ".", NaN, NA, n/a, null, none.
bool isAbsent(std::string_view field);

/// A finite decimal number that fills the whole field; nothing otherwise.
std::optional<double> parseNumber(std::string_view field);

/// Parts of a line at single delimiters. A field may be in double quotes, which are taken off; a
/// quote within is doubled and stays so. @param fields  reused; its views point into `line`
/// @param most  no more are needed
void splitFields(std::string_view line, char delimiter, std::vector<std::string_view>& fields,
                 std::size_t most = static_cast<std::size_t>(-1));

/// Parts of a line between runs of blanks. @param most  no more are needed
void splitWords(std::string_view line, std::vector<std::string_view>& words,
                std::size_t most = static_cast<std::size_t>(-1));

/// Either, as the delimiter is a blank or not.
void splitRow(std::string_view line, char delimiter, std::vector<std::string_view>& fields,
              std::size_t most = static_cast<std::size_t>(-1));

}  // namespace foci
