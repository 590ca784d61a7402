#include "render/scene/io/pcd.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/memory_budget.h"
#include "base/number.h"
#include "base/text.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/ply.h"
#include "render/scene/io/ply_items.h"

namespace foci {
namespace {

using Words = std::vector<std::string_view>;
constexpr std::size_t kMostFields = 1000;

Words splitAtBlanks(std::string_view line) {
  Words words;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// A field of a point: `count` values of `size` bytes.
struct Field {
  std::string name;
  std::size_t size = 4, count = 1;
  char type = 'F';
  bool isPacked() const { return (name == "rgb" || name == "rgba") && size == 4 && count == 1; }
};

struct PcdHeader {
  std::vector<Field> fields;
  std::uint64_t points = 0;
  std::string data;
  bool moved = false;  ///< the viewpoint is not the origin
  std::size_t recordBytes() const {
    std::size_t bytes = 0;
    for (const Field& field : fields) bytes += field.size * field.count;
    return bytes;
  }
};

/// Reads up to the line DATA.
class PcdHeaderReader {
 public:
  explicit PcdHeaderReader(ply::Input& input) : input_(input) {}

  PcdHeader read(std::uint64_t& lines) {
    std::uint64_t width = 0, height = 1;
    std::optional<std::uint64_t> points;
    while (header_.data.empty()) {
      ++lines_;
      if (input_.remaining() == 0) throw refusal("the header has no line DATA");
      const Words words = splitAtBlanks(trimmed(input_.line()));
      if (words.empty() || words[0].starts_with('#')) continue;
      const std::span<const std::string_view> values = std::span(words).subspan(1);
      if (words[0] == "FIELDS" || words[0] == "COLUMNS") takeNames(values);
      if (words[0] == "SIZE") take(values, [](Field& f, std::uint64_t n) { f.size = n; });
      if (words[0] == "COUNT") take(values, [](Field& f, std::uint64_t n) { f.count = n; });
      if (words[0] == "TYPE") takeTypes(values);
      if (words[0] == "WIDTH") width = number(values);
      if (words[0] == "HEIGHT") height = number(values);
      if (words[0] == "POINTS") points = number(values);
      if (words[0] == "VIEWPOINT") {
        const Words origin = {"0", "0", "0", "1", "0", "0", "0"};
        header_.moved = !std::equal(values.begin(), values.end(), origin.begin(), origin.end());
      }
      if (words[0] == "DATA" && !values.empty()) header_.data = std::string(values[0]);
    }
    if (header_.fields.empty()) throw refusal("the header has no line FIELDS");
    if (!points && height > 0 && width > UINT64_MAX / height) throw refusal("WIDTH is too large");
    header_.points = points.value_or(width * height);
    lines = lines_;
    return std::move(header_);
  }

 private:
  InputError refusal(const std::string& what) const {
    return {input_.name() + ":" + std::to_string(lines_), what};
  }

  std::uint64_t number(std::span<const std::string_view> words) const {
    const auto value = words.size() == 1 ? parseInteger<std::uint64_t>(words[0]) : std::nullopt;
    if (!value) throw refusal("expected a whole number");
    return *value;
  }

  void takeNames(std::span<const std::string_view> names) {
    if (names.size() > kMostFields) throw refusal("has more than 1000 fields");
    for (const std::string_view name : names) header_.fields.push_back({std::string(name)});
  }

  template <class Set>
  void take(std::span<const std::string_view> words, const Set& set) {
    expectOneForEachField(words);
    for (std::size_t i = 0; i < words.size(); ++i) {
      const auto value = parseInteger<std::uint64_t>(words[i]);
      if (!value || *value > kMostFields) throw refusal("expected whole numbers up to 1000");
      set(header_.fields[i], *value);
    }
  }

  void takeTypes(std::span<const std::string_view> words) {
    expectOneForEachField(words);
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] != "F" && words[i] != "U" && words[i] != "I") {
        throw refusal("type " + shown(words[i]) + ": expected F, U or I");
      }
      header_.fields[i].type = words[i][0];
    }
  }

  void expectOneForEachField(std::span<const std::string_view> words) const {
    if (words.size() == header_.fields.size()) return;
    throw refusal("has " + std::to_string(words.size()) + " values for " +
                  std::to_string(header_.fields.size()) + " fields");
  }

  ply::Input& input_;
  PcdHeader header_;
  std::uint64_t lines_ = 0;
};

/// The type of one value; absent for integers of 64 bits, which no used field has.
std::optional<ply::Scalar> scalarOf(const Field& field) {
  using ply::Scalar;
  const bool is_signed = field.type == 'I';
  if (field.type == 'F' && field.size == 4) return Scalar::float32;
  if (field.type == 'F' && field.size == 8) return Scalar::float64;
  if (field.type == 'F') return std::nullopt;
  if (field.size == 1) return is_signed ? Scalar::int8 : Scalar::uint8;
  if (field.size == 2) return is_signed ? Scalar::int16 : Scalar::uint16;
  if (field.size == 4) return is_signed ? Scalar::int32 : Scalar::uint32;
  return std::nullopt;
}

/// A point as an item of a binary PLY, with the names that its points have there.
ply::Element elementOf(const PcdHeader& header, const std::string& file) {
  ply::Element element{.name = "vertex", .count = header.points, .properties = {}};
  const auto add = [&](std::string name, ply::Scalar type) {
    element.properties.push_back({.name = std::move(name), .type = type});
  };
  for (const Field& field : header.fields) {
    if (field.isPacked()) {  // 0xAARRGGBB, little endian
      for (const char* name : {"blue", "green", "red", "_"}) add(name, ply::Scalar::uint8);
      continue;
    }
    const auto type = scalarOf(field);
    std::string name = field.name;
    if (name.starts_with("normal_")) name = "n" + name.substr(7);
    const bool used = name == "x" || name == "y" || name == "z";
    if (used && (!type || field.count != 1)) {
      throw InputError(file, "field " + name + " of " + std::to_string(field.count) + " " +
                                 field.type + " of " + std::to_string(field.size) +
                                 " bytes: expected one F of 4 or 8 bytes");
    }
    if (type && field.count == 1) {
      add(name, *type);
    } else {
      for (std::size_t i = 0; i < field.size * field.count; ++i) add("_", ply::Scalar::uint8);
    }
  }
  return element;
}

/// Unpacks LZF (liblzf) to exactly `count` bytes; nothing if it is damaged. A byte below 32 counts
/// bytes to copy, less one. Others hold a length in three bits, and the distance back in 13.
std::vector<unsigned char> unpackedLzf(std::span<const unsigned char> packed, std::size_t count) {
  constexpr unsigned kLiterals = 32, kLong = 7;
  std::vector<unsigned char> out;
  out.reserve(count);
  for (std::size_t at = 0; at < packed.size();) {
    const unsigned control = packed[at++];
    if (control < kLiterals) {
      const std::size_t length = control + 1;
      if (length > packed.size() - at || length > count - out.size()) return {};
      out.insert(out.end(), packed.begin() + static_cast<std::ptrdiff_t>(at),
                 packed.begin() + static_cast<std::ptrdiff_t>(at + length));
      at += length;
      continue;
    }
    std::size_t length = control >> 5u;
    if (length == kLong) {
      if (at == packed.size()) return {};
      length += packed[at++];
    }
    length += 2;
    if (at == packed.size()) return {};
    const std::size_t back = ((control & 31u) << 8u | packed[at++]) + 1;
    if (back > out.size() || length > count - out.size()) return {};
    for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - back]);
  }
  if (out.size() != count) out.clear();
  return out;
}

/// Records from the fields one after another, as `binary_compressed` holds them.
std::vector<unsigned char> unpackedRecords(ply::Input& input, const PcdHeader& header) {
  const auto word = [&] { return u32At(std::span(input.take(4), 4), 0); };
  const std::uint64_t packed_bytes = word(), bytes = word();
  const std::size_t record = header.recordBytes();
  if (bytes != header.points * record || packed_bytes > input.remaining()) {
    throw InputError(input.name(),
                     "is damaged: its packed points have another length than its "
                     "header says");
  }
  MemoryBudget budget(input.name(), packed_bytes);
  budget.take(bytes, 2, "its points");
  std::vector<unsigned char> packed;
  for (std::uint64_t left = packed_bytes; left > 0;) {
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(left, ply::Input::kBlock));
    const unsigned char* const from = input.take(part);
    packed.insert(packed.end(), from, from + part);
    left -= part;
  }
  const std::vector<unsigned char> fields = unpackedLzf(packed, bytes);
  if (fields.size() != bytes)
    throw InputError(input.name(), "is damaged: its points do not unpack");
  std::vector<unsigned char> records(bytes);
  std::size_t from = 0, in_record = 0;
  for (const Field& field : header.fields) {
    const std::size_t each = field.size * field.count;
    for (std::uint64_t i = 0; i < header.points && each > 0; ++i, from += each) {
      std::memcpy(records.data() + i * record + in_record, fields.data() + from, each);
    }
    in_record += each;
  }
  return records;
}

template <typename T>
void put(unsigned char* to, double value) {
  const T narrow = static_cast<T>(value);
  std::memcpy(to, &narrow, sizeof(T));
}

/// Records from points as text, a line each.
std::vector<unsigned char> parsedRecords(ply::Input& input, const PcdHeader& header,
                                         std::uint64_t lines) {
  std::vector<unsigned char> records(header.points * header.recordBytes());
  unsigned char* to = records.data();
  for (std::uint64_t i = 0; i < header.points;) {
    if (input.remaining() == 0) {
      throw InputError(input.name(), "ends after " + std::to_string(i) + " of " +
                                         std::to_string(header.points) + " points");
    }
    ++lines;
    const std::string_view line = trimmed(input.line());
    if (line.empty()) continue;
    ++i;
    std::size_t at = 0;
    for (const Field& field : header.fields) {
      for (std::size_t k = 0; k < field.count; ++k, to += field.size) {
        const double value = ply::numberAt(line, at, input.name(), lines);
        // A packed colour as a float is its bits.
        if (field.type == 'F' && field.size == 4) put<float>(to, value);
        if (field.type == 'F' && field.size == 8) put<double>(to, value);
        const double whole = std::isfinite(value) ? std::clamp(value, -9e18, 9e18) : 0.0;
        const auto integer = static_cast<std::int64_t>(whole);
        if (field.type != 'F') std::memcpy(to, &integer, std::min<std::size_t>(field.size, 8));
      }
    }
  }
  return records;
}

}  // namespace

bool isPcd(std::string_view start) {
  return start.starts_with("# .PCD") || start.starts_with("VERSION 0.") ||
         start.starts_with("VERSION .");
}

PointCloud readPcd(const std::filesystem::path& path) {
  ply::Input input(path);
  std::uint64_t lines = 0;
  const PcdHeader pcd = PcdHeaderReader(input).read(lines);
  const std::size_t record = pcd.recordBytes();
  const std::uint64_t least = pcd.data == "ascii" ? pcd.fields.size() : record;
  // Packed points have some byte for each 264 of theirs, the most that LZF reaches.
  const std::uint64_t room = (input.remaining() + 1) * (pcd.data == "binary_compressed" ? 264 : 1);
  if (least == 0 || pcd.points > room / least || record > ply::Input::kBlock) {
    throw InputError(input.name(), "says that it has " + std::to_string(pcd.points) +
                                       " points, more than the file has room for");
  }
  ply::Header header;
  header.format = ply::Format::little;
  header.elements = {elementOf(pcd, input.name())};
  PointCloud points;
  const auto read = [&](ply::Input& from) {
    ply::Items items(from, header, header.elements[0]);
    points = readVertices(items, pcd.points, input.name());
  };
  if (pcd.data == "binary") {
    read(input);
  } else if (pcd.data == "ascii" || pcd.data == "binary_compressed") {
    ply::Input unpacked(input.name(), pcd.data == "ascii" ? parsedRecords(input, pcd, lines)
                                                          : unpackedRecords(input, pcd));
    read(unpacked);
  } else {
    throw InputError(input.name() + ":" + std::to_string(lines),
                     "DATA " + shown(pcd.data) + ": expected ascii, binary or binary_compressed");
  }
  if (pcd.moved) {
    points.remarks.emplace_back(
        "its viewpoint is not the origin: the points are shown in their own frame");
  }
  return points;
}

}  // namespace foci
