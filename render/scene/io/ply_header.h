// Reads the header of a PLY file, and the bytes after it in blocks. Private to the readers of
// scenes, which all read through `Input`.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.h"
#include "render/scene/io/file_bytes.h"

namespace foci::ply {

enum class Format { ascii, little, big };  // in the order of their names in `readHeader`
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

  bool has(std::string_view property) const {
    return std::ranges::find(properties, property, &Property::name) != properties.end();
  }
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::uint64_t lines = 0;            ///< lines read so far, for messages
  std::vector<std::string> comments;  ///< without the word "comment"
};

std::size_t sizeOf(Scalar type);
inline bool isFloat(Scalar type) { return type == Scalar::float32 || type == Scalar::float64; }

/// A file read front to back; one packed by gzip is unpacked first.
class Input {
 public:
  /// @throws InputError if there is no readable regular file
  explicit Input(const std::filesystem::path& path) : file_(path, /*unpacks_gzip=*/true) {}
  /// Bytes that were unpacked from the file of this name.
  Input(std::string name, std::vector<unsigned char> content)
      : file_(std::move(name), std::move(content)) {}

  const std::string& name() const { return file_.name(); }
  std::uint64_t offset() const { return offset_; }
  std::uint64_t remaining() const { return file_.size() - offset_; }

  /// The next `bytes` bytes. @throws InputError at the end of the file
  const unsigned char* take(std::size_t bytes);
  void skip(std::uint64_t bytes) { take(bytes); }

  /// The next line without its end, `\n` or `\r\n`.
  /// @throws InputError for a line longer than 1 MiB, or at the end of the file
  std::string_view line();

 private:
  FileBytes file_;
  std::uint64_t offset_ = 0;  // of the next byte to hand out
};

/// Puts names in lower case, but for those that are taken then.
template <typename Named>
void lowerNames(std::vector<Named>& all) {
  for (Named& each : all) {
    std::string lower = lowered(each.name);
    const bool taken = std::ranges::find(all, lower, &Named::name) != all.end();  // itself, too
    if (!taken) each.name = std::move(lower);
  }
}

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
