#include "render/scene/io/point_formats.h"

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
#include "base/text.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/ply.h"
#include "render/scene/io/ply_items.h"

namespace foci {
namespace {

constexpr std::uint64_t kMostFields = 1000;  // and values of one

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

/// Reads up to the line DATA. Counts lines.
PcdHeader readPcdHeader(ply::Input& input, std::uint64_t& lines) {
  const auto refusal = [&](const auto&... what) {
    return InputError(input.name() + ":" + std::to_string(lines), what...);
  };
  const auto whole = [&](std::string_view word, std::uint64_t most = UINT64_MAX) {
    const auto value = parseInteger<std::uint64_t>(word);
    if (value && *value <= most) return *value;
    throw refusal(most == kMostFields ? "expected whole numbers up to 1000"
                                      : "expected a whole number");
  };
  PcdHeader header;
  std::uint64_t width = 0, height = 1;
  std::optional<std::uint64_t> points;
  while (header.data.empty()) {
    ++lines;
    if (input.remaining() == 0) throw refusal("the header has no line DATA");
    const auto words = wordsOf(input.line());
    if (words.empty() || words[0].starts_with('#')) continue;
    const std::string_view key = words[0];
    const auto values = std::span(words).subspan(1);
    const bool of_fields = key == "SIZE" || key == "COUNT" || key == "TYPE";
    const bool of_all = key == "WIDTH" || key == "HEIGHT" || key == "POINTS";
    if (of_fields && values.size() != header.fields.size()) {
      throw refusal("has ", values.size(), " values for ", header.fields.size(), " fields");
    }
    if (of_all && values.size() != 1) throw refusal("expected a whole number");
    if (key == "FIELDS" || key == "COLUMNS") {
      if (header.fields.size() + values.size() > kMostFields) {
        throw refusal("has more than 1000 fields");
      }
      for (const std::string_view name : values) header.fields.push_back({std::string(name)});
      ply::lowerNames(header.fields);
    }
    for (std::size_t i = 0; of_fields && i < values.size(); ++i) {
      Field& field = header.fields[i];
      if (key == "SIZE") field.size = whole(values[i], kMostFields);
      if (key == "COUNT") field.count = whole(values[i], kMostFields);
      if (key != "TYPE") continue;
      if (values[i] != "F" && values[i] != "U" && values[i] != "I") {
        throw refusal("type ", shown(values[i]), ": expected F, U or I");
      }
      field.type = values[i][0];
    }
    if (key == "WIDTH") width = whole(values[0]);
    if (key == "HEIGHT") height = whole(values[0]);
    if (key == "POINTS") points = whole(values[0]);
    if (key == "VIEWPOINT") {
      constexpr std::string_view kOrigin[] = {"0", "0", "0", "1", "0", "0", "0"};
      header.moved = !std::ranges::equal(values, kOrigin);
    }
    if (key == "DATA" && !values.empty()) header.data = std::string(values[0]);
  }
  if (header.fields.empty()) throw refusal("the header has no line FIELDS");
  if (!points && height > 0 && width > UINT64_MAX / height) throw refusal("WIDTH is too large");
  header.points = points.value_or(width * height);
  return header;
}

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
      throw InputError(file, "field ", name, " of ", field.count, " ", field.type, " of ",
                       field.size, " bytes: expected one F of 4 or 8 bytes");
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
                     "is damaged: its packed points have another length than its header says");
  }
  MemoryBudget budget(input.name(), packed_bytes);
  budget.take(bytes, 2, "its points");
  const std::vector<unsigned char> fields =
      unpackedLzf({input.take(packed_bytes), packed_bytes}, bytes);
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

/// Records from points as text.
std::vector<unsigned char> parsedRecords(ply::Input& input, const PcdHeader& pcd,
                                         std::uint64_t lines) {
  ply::Element values{.name = "vertex", .count = pcd.points, .properties = {}};
  for (const Field& field : pcd.fields) {
    values.properties.insert(values.properties.end(), field.count, ply::Property{});
  }
  ply::Header header{.format = ply::Format::ascii, .elements = {}, .lines = lines, .comments = {}};
  std::vector<unsigned char> records(pcd.points * pcd.recordBytes());
  unsigned char* to = records.data();
  for (ply::Items items(input, header, values); items.next();) {
    std::size_t at = 0;
    for (const Field& field : pcd.fields) {
      for (std::size_t k = 0; k < field.count; ++k, to += field.size) {
        const double value = items.value(at++);
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
  const PcdHeader pcd = readPcdHeader(input, lines);
  const std::size_t record = pcd.recordBytes();
  const std::uint64_t least = pcd.data == "ascii" ? pcd.fields.size() : record;
  // Packed points have some byte for each 264 of theirs, the most that LZF reaches.
  const std::uint64_t room = (input.remaining() + 1) * (pcd.data == "binary_compressed" ? 264 : 1);
  if (least == 0 || pcd.points > room / least) {
    throw InputError(input.name(), "says that it has ", pcd.points,
                     " points, more than the file has room for");
  }
  ply::Header header;
  header.format = ply::Format::little;
  header.elements = {elementOf(pcd, input.name())};
  PointCloud points;
  const auto read = [&](ply::Input& from) {
    ply::Items items(from, header, header.elements[0]);
    points = readVertices(items, input.name());
  };
  if (pcd.data == "binary") {
    read(input);
  } else if (pcd.data == "ascii" || pcd.data == "binary_compressed") {
    ply::Input unpacked(input.name(), pcd.data == "ascii" ? parsedRecords(input, pcd, lines)
                                                          : unpackedRecords(input, pcd));
    read(unpacked);
  } else {
    throw InputError(input.name() + ":" + std::to_string(lines), "DATA ", shown(pcd.data),
                     ": expected ascii, binary or binary_compressed");
  }
  if (pcd.moved) {
    points.remarks.emplace_back(
        "its viewpoint is not the origin: the points are shown in their own frame");
  }
  return points;
}

}  // namespace foci
