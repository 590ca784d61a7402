// Reads the header of a PLY file, and the bytes after it in blocks. Private to the readers of
// scenes, which all read through `Input`.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace foci::ply {

enum class Format { ascii, little, big };
enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Scalar type = Scalar::float32;
  bool list = false;
  Scalar count_type = Scalar::uint8;  ///< type of a list's length
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::uint64_t lines = 0;            ///< lines read so far, for messages
  std::vector<std::string> comments;  ///< without the word "comment"
};

std::size_t sizeOf(Scalar type);
inline bool isFloat(Scalar type) { return type == Scalar::float32 || type == Scalar::float64; }

/// A file read front to back through one block of memory; one packed by gzip is unpacked first.
class Input {
 public:
  /// @throws InputError if there is no readable regular file
  explicit Input(const std::filesystem::path& path);
  /// Bytes that were unpacked from the file of this name.
  Input(std::string name, std::vector<unsigned char> content)
      : name_(std::move(name)), size_(content.size()), block_(std::move(content)), end_(size_) {}

  const std::string& name() const { return name_; }
  std::uint64_t offset() const { return offset_; }
  std::uint64_t remaining() const { return offset_ < size_ ? size_ - offset_ : 0; }

  /// The next `bytes` bytes, at most kBlock; valid until the next call.
  /// @throws InputError at the end of the file
  const unsigned char* take(std::size_t bytes);
  void skip(std::uint64_t bytes);

  /// The next line without its end, `\n` or `\r\n`. Valid until the next call.
  /// @throws InputError for a line longer than kBlock, or at the end of the file
  std::string_view line();

  static constexpr std::size_t kBlock = 1 << 20;

 private:
  void fill();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
  std::uint64_t offset_ = 0;  // of the next byte to hand out
  std::vector<unsigned char> block_;
  std::size_t begin_ = 0, end_ = 0;  // the unread bytes of block_
};

/// Reads up to `end_header` and checks every element's count against the remaining bytes. Names of
/// properties are in lower case, but for those of two that differ in case alone.
/// @throws InputError with file and line
Header readHeader(Input& input);

/// Whether the bytes of values are in the other order than this machine's.
bool mustSwap(Format format);
double scalarAt(const unsigned char* bytes, Scalar type, bool swap);

/// The number of values of a list of a binary file, which come next.
/// @throws InputError if the file has fewer bytes than that
std::uint64_t listLength(Input& input, const Property& property, bool swap);

/// Moves behind an element. Counts the lines of an ASCII file.
void skipElement(Input& input, const Element& element, Header& header);

}  // namespace foci::ply
