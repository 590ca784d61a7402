// Lines of a text file in constant memory, and the fields in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/gunzip.h"
#include "base/input_error.h"
#include "base/mapped_file.h"
#include "base/text.h"

namespace foci {

/// A file that packs some bytes again and again would fill the memory.
/// @throws InputError if so much comes of so few bytes of a packed file
void requirePackedRecording(const std::string& file, std::int64_t unpacked_B,
                            std::int64_t packed_B);

/// A file, plain or in gzip format (RFC 1952), byte by byte.
class PackedFile {
 public:
  /// @throws InputError if it cannot be read
  explicit PackedFile(const std::filesystem::path& file);

  /// @return the number of bytes read, at most `count`; 0 at the end
  /// @throws InputError if a packed file is damaged or cut off, also in a later member, and if it
  /// unpacks to far more than a recording does
  std::size_t read(char* to, std::size_t count);

 private:
  MappedFile file_;
  std::ifstream plain_;  // a mapped file that shrinks would end the program
  std::optional<Gunzip> packed_{};
  std::int64_t unpacked_B_ = 0;
};

/// A place in a recording that is being read.
class Place {
 public:
  virtual ~Place() = default;
  /// An error at this place.
  virtual InputError error(const std::string& what) const = 0;
};

/// Reads lines that end in LF or CRLF; the last line may have no end. It skips a UTF-8 byte order
/// mark, and unpacks files in gzip format.
class LineReader final : public Place {
 public:
  /// @throws InputError if the file cannot be read or is a folder
  explicit LineReader(const std::filesystem::path& file);
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// @param line  valid until the next call
  /// @return false at the end of the file
  /// @throws InputError on a NUL byte (binary, or UTF-16) and on a line over 64 KiB
  bool next(std::string_view& line);

  /// Whether the latest line has its line end; the last line of a cut file has none.
  bool isEnded() const { return ended_; }

  /// Of the latest line; the first is 1.
  std::size_t number() const { return number_; }

  /// At the latest line.
  InputError error(const std::string& what) const override;
  const std::string& fileName() const { return name_; }

 private:
  bool fill();

  std::string name_;
  std::unique_ptr<PackedFile> file_{};  // null: at its end
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  std::size_t number_ = 0;
  bool ended_ = true;
};

/// @param lower  in lower case
bool equalsIgnoringCase(std::string_view text, std::string_view lower);

/// Whether a field means "no value": an empty field, ".", "-", NA, n/a, null, none, or NaN, also as
/// programs on Windows print it ("-nan(ind)", "1.#QNAN").
bool isAbsent(std::string_view field);

inline constexpr std::size_t kAllFields = static_cast<std::size_t>(-1);

/// Splits a line at each delimiter. Quotes around a field are removed. A doubled quote within a
/// quoted field stays doubled.
/// @param fields      overwritten; its views point into `line`
/// @param max_fields  ignore the rest of the line after so many
void splitFields(std::string_view line, char delimiter, std::vector<std::string_view>& fields,
                 std::size_t max_fields = kAllFields);

/// Splits a line at runs of blanks and tabs. Parameters as `splitFields`.
/// @param with_quotes  what stands in quotes is one word
void splitWords(std::string_view line, std::vector<std::string_view>& words,
                std::size_t max_words = kAllFields, bool with_quotes = false);

/// `splitWords` if the delimiter is a blank, else `splitFields`.
void splitRow(std::string_view line, char delimiter, std::vector<std::string_view>& fields,
              std::size_t max_fields = kAllFields);

}  // namespace foci
