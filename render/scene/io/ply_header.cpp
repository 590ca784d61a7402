#include "render/scene/io/ply_header.h"

#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/ply_items.h"

namespace foci::ply {
namespace {

constexpr std::size_t kMaxHeaderLines = 10000;

std::optional<Scalar> scalarNamed(std::string_view name) {
  // Old and new names, in the order of `Scalar`.
  static constexpr std::pair<std::string_view, std::string_view> kNames[] = {
      {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
      {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
  for (std::size_t i = 0; i < std::size(kNames); ++i) {
    if (name == kNames[i].first || name == kNames[i].second) return static_cast<Scalar>(i);
  }
  return std::nullopt;
}

Property propertyOf(const std::vector<std::string_view>& words, const std::string& where) {
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3) {
    throw InputError(where, "property: expected a type and a name, or list, two types and a name");
  }
  Property property{.name = std::string(words.back()), .list = list};
  for (std::size_t i = list ? 2 : 1; i + 1 < words.size(); ++i) {
    const auto type = scalarNamed(words[i]);
    if (!type) {
      throw InputError(where, "property type ", shown(words[i]),
                       ": expected char, uchar, short, ushort, int, uint, float or double");
    }
    (list && i == 2 ? property.count_type : property.type) = *type;
  }
  if (list && isFloat(property.count_type)) {
    throw InputError(where, "list ", shown(property.name),
                     " is counted by a float: expected an integer type");
  }
  return property;
}

/// Smallest number of bytes of one item of the element.
std::uint64_t leastSize(const Element& element, Format format) {
  if (format == Format::ascii) return 2 * element.properties.size();  // a digit and a separator
  std::uint64_t bytes = 0;
  for (const Property& p : element.properties) bytes += sizeOf(p.list ? p.count_type : p.type);
  return bytes;
}

void checkCounts(const Header& header, const Input& input) {
  // The last line of an ASCII file may lack its end.
  std::uint64_t left = input.remaining() + (header.format == Format::ascii ? 1 : 0);
  for (const Element& element : header.elements) {
    if (element.count == 0) continue;  // PCL then writes no properties, either
    if (element.properties.empty()) {
      throw InputError(input.name(), "element ", shown(element.name), " has no properties");
    }
    const std::uint64_t size = leastSize(element, header.format);
    if (element.count > left / size) {
      throw InputError(input.name(), "element ", shown(element.name), " has ", element.count,
                       " items: the file has room for at most ", left / size);
    }
    left -= element.count * size;
  }
}

template <typename T>
double load(const unsigned char* bytes, bool swap) {
  std::array<unsigned char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (swap) std::ranges::reverse(raw);
  return static_cast<double>(std::bit_cast<T>(raw));
}

}  // namespace

std::size_t sizeOf(Scalar type) {
  static constexpr std::array<std::size_t, 8> kSize{1, 1, 2, 2, 4, 4, 4, 8};
  return kSize[static_cast<std::size_t>(type)];
}

const unsigned char* Input::take(std::size_t bytes) {
  constexpr std::uint64_t kReleased = std::uint64_t{1} << 24;  // bytes at a time
  const unsigned char* const data = file_.part(offset_, bytes).data();
  const std::uint64_t done = offset_ / kReleased;
  offset_ += bytes;
  // What the last call handed out stays in memory.
  if (done > 0 && offset_ / kReleased > done) file_.release((done - 1) * kReleased, kReleased);
  return data;
}

std::string_view Input::line() {
  constexpr std::size_t kLongest = 1 << 20;
  const auto rest = file_.all().subspan(offset_);
  const std::string_view ahead(reinterpret_cast<const char*>(rest.data()),
                               std::min(rest.size(), kLongest + 1));
  const std::size_t length = std::min(ahead.find('\n'), ahead.size());
  if (length > kLongest) throw InputError(name(), "has a line longer than 1 MiB");
  take(std::max<std::size_t>(std::min(length + 1, rest.size()), 1));
  const std::string_view text = ahead.substr(0, length);
  return text.ends_with('\r') ? text.substr(0, length - 1) : text;
}

double scalarAt(const unsigned char* bytes, Scalar type, bool swap) {
  static constexpr std::array kLoad{load<std::int8_t>,   load<std::uint8_t>, load<std::int16_t>,
                                    load<std::uint16_t>, load<std::int32_t>, load<std::uint32_t>,
                                    load<float>,         load<double>};
  return kLoad[static_cast<std::size_t>(type)](bytes, swap);
}

bool mustSwap(Format format) {
  return (format == Format::big) == (std::endian::native == std::endian::little);
}

std::uint64_t listLength(Input& input, const Property& property, bool swap) {
  const double items = scalarAt(input.take(sizeOf(property.count_type)), property.count_type, swap);
  if (items < 0.0 || items > static_cast<double>(input.remaining())) {
    throw InputError(input.name(), "byte ", input.offset(), ": list ", property.name, " has ",
                     static_cast<std::int64_t>(items), " items, more than the file has room for");
  }
  return static_cast<std::uint64_t>(items);
}

void skipElement(Input& input, const Element& element, Header& header) {
  if (header.format == Format::ascii) {
    for (Items items(input, header, element); items.next();) {
    }
    return;
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const Property& property : element.properties) {
      const std::uint64_t length =
          property.list ? listLength(input, property, mustSwap(header.format)) : 1;
      input.skip(length * sizeOf(property.type));
    }
  }
}

Header readHeader(Input& input) {
  if (input.remaining() == 0) throw InputError(input.name(), "is empty");
  Header header;
  const auto where = [&] { return input.name() + ":" + std::to_string(header.lines); };
  const auto next = [&] {
    if (++header.lines > kMaxHeaderLines || input.remaining() == 0) {
      throw InputError(where(), "the header has no end_header");
    }
    return input.line();
  };

  std::string_view magic = trimmed(withoutByteOrderMark(next()));
  while (magic.empty()) magic = trimmed(next());
  if (magic != "ply") {
    throw InputError(where(), "not a PLY file: expected ply, found ", shown(magic));
  }
  bool has_format = false;
  for (;;) {
    const std::string_view line = next();
    const auto words = wordsOf(line);
    if (words.empty() || words[0] == "obj_info") continue;
    if (words[0] == "comment") {
      header.comments.emplace_back(trimmed(trimmed(line).substr(words[0].size())));
      continue;
    }
    if (words[0] == "end_header") break;
    if (words[0] == "format" && !has_format) {
      constexpr std::array kNames{"ascii", "binary_little_endian", "binary_big_endian"};
      const auto* const name = std::ranges::find(kNames, words.size() == 3 ? words[1] : "");
      if (name == kNames.end()) {
        throw InputError(
            where(), shown(line),
            ": expected format ascii, binary_little_endian or binary_big_endian, and 1.0");
      }
      has_format = true;
      header.format = static_cast<Format>(name - kNames.begin());
    } else if (words[0] == "element") {
      const auto count = words.size() == 3 ? parseInteger<std::uint64_t>(words[2]) : std::nullopt;
      if (!count) {
        throw InputError(where(), shown(line), ": expected element, a name and a whole number");
      }
      header.elements.push_back({std::string(words[1]), *count, {}});
    } else if (words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(propertyOf(words, where()));
    } else {
      throw InputError(where(), shown(line), ": expected format, element, property or comment");
    }
  }
  if (!has_format) throw InputError(input.name(), "the header names no format");
  for (Element& element : header.elements) lowerNames(element.properties);
  checkCounts(header, input);
  return header;
}

}  // namespace foci::ply
