// The Stanford polygon format (Turk 1994).
#include "render/scene/io/ply_items.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/input_error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "render/scene/io/mesh_files.h"

namespace foci::ply {
namespace {

constexpr double kRangeSlack = 1e-3;  // tolerance of floats meant to be 0 or 1
constexpr double kByte = 255.0;

/// The greatest integer of a type; 1 for floats.
double fullRange(Scalar type) {
  if (isFloat(type)) return 1.0;
  const bool is_signed = type == Scalar::int8 || type == Scalar::int16 || type == Scalar::int32;
  return std::ldexp(1.0, 8 * static_cast<int>(sizeOf(type)) - (is_signed ? 1 : 0)) - 1.0;
}

constexpr const char* kUnitOrBytes =
    ": expected 0 to 1 or 0 to 255, or an integer type of full range";

/// The value of a full colour or opacity: of its type, or 255 if none is larger.
/// @param refusal  of a value, by its place
template <typename Refusal>
double whiteOf(std::span<const float> stored, Scalar type, const Refusal& refusal) {
  constexpr double kFloatBytes = 16.0;  // brighter floats are no light of 0 to 1 that is too bright
  const bool floats = isFloat(type);
  const double full = fullRange(type), slack = floats ? kRangeSlack : 0.0;
  // The float of the greatest 32-bit integer is one more.
  const double most = floats ? kByte : full + (full > 1e9 ? 1.0 : 0.0);
  std::size_t greatest = 0;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (!(stored[i] >= -slack && stored[i] <= most)) throw refusal(i);
    if (stored[i] > stored[greatest]) greatest = i;
  }
  const double value = stored.empty() ? 0.0 : double{stored[greatest]};
  if (floats && value > 1.0 + slack && value <= kFloatBytes) throw refusal(greatest);
  const bool bytes = floats ? value > 1.0 + slack : full > kByte && value > 0.0 && value <= kByte;
  return bytes ? kByte : full;
}

float linearOfSrgb(double s) {
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

}  // namespace

const Element* elementNamed(const Header& header, std::string_view name) {
  const auto found = std::ranges::find(header.elements, name, &Element::name);
  return found == header.elements.end() ? nullptr : &*found;
}

std::optional<std::string> edgesRemark(const Header& header) {
  const Element* const edges = elementNamed(header, "edge");
  if (edges == nullptr || edges->count == 0) return std::nullopt;
  return counted(edges->count, "edge") + " left out: foci shows points, triangles and Gaussians";
}

std::vector<std::string> textureNames(const Header& header) {
  constexpr std::string_view kKey = "texturefile";
  std::vector<std::string> names;
  for (const std::string_view comment : header.comments) {
    if (lowered(comment).starts_with(kKey))
      names.emplace_back(plainName(comment.substr(kKey.size())));
  }
  return names;
}

Items::Items(Input& input, Header& header, const Element& element)
    : input_(input),
      header_(header),
      element_(element),
      swap_(mustSwap(header.format)),
      records_(header.format != Format::ascii &&
               std::ranges::none_of(element.properties, &Property::list)) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    places_.push_back({records_ ? record_bytes_ : i});
    record_bytes_ += sizeOf(element.properties[i].type);
  }
  row_.resize(element.properties.size());
}

bool Items::next() {
  if (read_ == element_.count) return false;
  ++read_;
  if (header_.format == Format::ascii) {
    readText();
  } else if (records_) {
    record_ = input_.take(record_bytes_);
  } else {
    readLists();
  }
  return true;
}

std::optional<std::size_t> Items::find(std::string_view name, bool list) const {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < element_.properties.size(); ++i) {
    const Property& property = element_.properties[i];
    if (property.name != name) continue;
    const std::string what = element_.name + " property " + std::string(name);
    if (property.list && !list) throw InputError(input_.name(), what, " is a list");
    if (found) throw InputError(input_.name(), what, " is there twice");
    found = i;
  }
  return found;
}

std::vector<std::size_t> Items::findAll(std::initializer_list<std::string_view> names) const {
  std::vector<std::size_t> all;
  for (const std::string_view name : names) {
    const auto found = find(name);
    if (found) all.push_back(*found);
  }
  if (all.size() < names.size()) all.clear();
  return all;
}

double Items::value(std::size_t property) const {
  if (!records_) return row_[places_[property].at];
  return scalarAt(record_ + places_[property].at, element_.properties[property].type, swap_);
}

float Items::floatValue(std::size_t property) const {
  if (records_ && !swap_ && element_.properties[property].type == Scalar::float32) {
    float value = 0.0f;  // nearly all files of Gaussians: twice as fast
    std::memcpy(&value, record_ + places_[property].at, sizeof(value));
    return value;
  }
  const double wide = value(property);
  return static_cast<float>(std::isfinite(wide) ? std::clamp(wide, -1e30, 1e30) : wide);
}

glm::dvec3 Items::vector(std::span<const std::size_t> properties) const {
  return {value(properties[0]), value(properties[1]), value(properties[2])};
}

std::span<const double> Items::list(std::size_t property) const {
  return std::span(lists_).subspan(places_[property].at, places_[property].length);
}

std::string Items::where() const {
  if (header_.format == Format::ascii) return input_.name() + ":" + std::to_string(header_.lines);
  return input_.name() + ": " + element_.name + " " + std::to_string(read_);
}

std::string Items::itemName() const {
  const bool plain = element_.name == "vertex" || element_.name == "face";
  return plain ? "a " + element_.name : "an item of element " + shown(element_.name);
}

/// Moves to the next line that has a word.
void Items::readLine() {
  for (line_ = {}, at_ = 0; trimmed(line_).empty();) {
    if (input_.remaining() == 0) {
      if (broken_line_) {
        throw InputError(input_.name() + ":" + std::to_string(*broken_line_), "too few values for ",
                         itemName());
      }
      throw InputError(input_.name(), "ends after ", read_ - 1, " of ", element_.count,
                       " items of element ", shown(element_.name));
    }
    ++header_.lines;
    line_ = input_.line();
  }
}

double Items::nextNumber() {
  at_ = std::min(line_.find_first_not_of(" \t", at_), line_.size());
  if (at_ == line_.size()) {
    if (!broken_line_) broken_line_ = header_.lines;
    readLine();
    at_ = line_.find_first_not_of(" \t");
  }
  const std::size_t end = std::min(line_.find_first_of(" \t", at_), line_.size());
  const std::string_view word = line_.substr(at_, end - at_);
  at_ = end;
  const auto value = numberOf(word);
  if (!value) throw InputError(where(), "expected a number, found ", shown(word));
  return *value;
}

void Items::readText() {
  broken_line_.reset();
  readLine();
  lists_.clear();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    row_[i] = nextNumber();
    if (!element_.properties[i].list) continue;
    const double length = row_[i];
    if (!(length >= 0.0 && length <= static_cast<double>(input_.remaining() + line_.size())) ||
        length != std::floor(length)) {
      throw InputError(where(), "list ", element_.properties[i].name, " has ", exactText(length),
                       " items: is the file cut off?");
    }
    places_[i] = {lists_.size(), static_cast<std::size_t>(length)};
    for (std::size_t k = 0; k < places_[i].length; ++k) lists_.push_back(nextNumber());
  }
  if (line_.find_first_not_of(" \t\r", at_) == std::string_view::npos) return;
  if (!broken_line_) throw InputError(where(), "too many values for ", itemName());
  throw InputError(input_.name() + ":" + std::to_string(*broken_line_), "too few values for ",
                   itemName());
}

void Items::readLists() {
  lists_.clear();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Property& property = element_.properties[i];
    const std::size_t bytes = sizeOf(property.type);
    if (!property.list) {
      row_[i] = scalarAt(input_.take(bytes), property.type, swap_);
      continue;
    }
    const std::uint64_t length = listLength(input_, property, swap_);
    places_[i] = {lists_.size(), static_cast<std::size_t>(length)};
    const unsigned char* const from = input_.take(length * bytes);
    lists_.resize(lists_.size() + length);
    double* to = lists_.data() + places_[i].at;
    for (std::uint64_t k = 0; k < length; ++k) {
      *to++ = scalarAt(from + k * bytes, property.type, swap_);
    }
  }
}

Items verticesIn(Input& input, Header& header) {
  for (const Element& element : header.elements) {
    if (element.name == "vertex") return {input, header, element};
    skipElement(input, element, header);
  }
  throw InputError(input.name(), "has no element vertex");
}

void linearise(std::span<glm::vec3> stored, Scalar type, const std::string& file,
               const std::string& what, std::vector<std::string>& remarks) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  const std::span values(reinterpret_cast<const float*>(stored.data()), 3 * stored.size());
  const double white = whiteOf(values, type, [&](std::size_t i) {
    return InputError(file, what, " ", i / 3 + 1, " has the colour ", exactText(double{values[i]}),
                      kUnitOrBytes);
  });
  if (white != fullRange(type)) {
    remarks.emplace_back(isFloat(type) ? "its colours are floats of 0 to 255"
                                       : "its colours are 0 to 255 in a type of larger range, in "
                                         "which they would be nearly black: shown as 0 to 255");
  }
  std::array<float, 256> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = linearOfSrgb(static_cast<double>(i) / kByte);
  }
  parallelFor(stored.size(), [&](std::size_t i) {
    for (int c = 0; c < 3; ++c) {
      const double byte = double{stored[i][c]} * kByte / white, rounded = std::nearbyint(byte);
      const bool whole = std::abs(byte - rounded) < 1e-9 && rounded >= 0.0 && rounded <= kByte;
      stored[i][c] = whole ? bytes[static_cast<std::size_t>(rounded)]
                           : linearOfSrgb(std::clamp(byte / kByte, 0.0, 1.0));
    }
  });
}

std::vector<std::size_t> colorOf(const Items& items) {
  for (const auto& names : {std::array{"r", "g", "b"}, std::array{"red", "green", "blue"},
                            std::array{"diffuse_red", "diffuse_green", "diffuse_blue"}}) {
    auto found = items.findAll({names[0], names[1], names[2]});
    if (!found.empty()) return found;
  }
  return {};
}

std::optional<std::size_t> opacityOf(const Items& items) {
  for (const char* name : {"opacity", "alpha"}) {
    if (const auto found = items.find(name)) return found;
  }
  return items.findAll({"r", "g", "b"}).empty() ? std::nullopt : items.find("a");
}

void normaliseOpacity(std::span<float> stored, Scalar type, const std::string& file) {
  const double white = whiteOf(stored, type, [&](std::size_t i) {
    return InputError(file, "vertex ", i + 1, " has the opacity ", exactText(double{stored[i]}),
                      kUnitOrBytes);
  });
  for (float& value : stored) {
    value = static_cast<float>(std::clamp(double{value} / white, 0.0, 1.0));
  }
}

}  // namespace foci::ply
