#include "render/scene/io/las_coordinates.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <map>
#include <numbers>
#include <utility>

#include "base/text.h"
#include "render/scene/io/file_bytes.h"

namespace foci {
namespace {

constexpr double kUsFoot_m = 1200.0 / 3937.0, kFoot_m = 0.3048;

/// Units of length by their EPSG codes.
constexpr std::pair<unsigned, double> kLengths[] = {
    {9001, 1.0}, {9002, kFoot_m}, {9003, kUsFoot_m}, {9036, 1000.0}, {1025, 0.001}, {1033, 0.01}};

/// Numbers of GeoKeys (OGC 19-008r4, annex B).
enum GeoKey : unsigned {
  kModelType = 1024,
  kCitation = 1026,
  kAngularUnit = 2054,
  kProjectedSystem = 3072,
  kProjectedCitation = 3073,
  kProjectedUnit = 3076,
  kProjectedUnitSize = 3077,
  kVerticalUnit = 4099
};
constexpr unsigned kProjected = 1, kGeographic = 2, kGeocentric = 3;
constexpr unsigned kUserDefined = 32767;
constexpr unsigned kRadian = 9101, kGrad = 9105;

class GeoKeys {
 public:
  GeoKeys(std::span<const unsigned char> directory, std::span<const unsigned char> doubles,
          std::string_view ascii)
      : doubles_(doubles), ascii_(ascii) {
    constexpr std::size_t kEntry = 8;
    for (std::size_t at = kEntry; at + kEntry <= directory.size(); at += kEntry) {
      entries_[u16At(directory, at)] = {u16At(directory, at + 2), u16At(directory, at + 4),
                                        u16At(directory, at + 6)};
    }
  }

  std::optional<unsigned> code(unsigned key) const {
    const auto found = entries_.find(key);
    if (found == entries_.end() || found->second.location != 0) return std::nullopt;
    return found->second.value;
  }

  std::optional<double> number(unsigned key) const {
    constexpr unsigned kDoubles = 34736;
    const auto found = entries_.find(key);
    if (found == entries_.end() || found->second.location != kDoubles) return std::nullopt;
    const std::size_t at = sizeof(double) * found->second.value;
    return at + sizeof(double) <= doubles_.size() ? std::optional(doubleAt(doubles_, at))
                                                  : std::nullopt;
  }

  std::string_view text(unsigned key) const {
    constexpr unsigned kAscii = 34737;
    const auto found = entries_.find(key);
    if (found == entries_.end() || found->second.location != kAscii) return {};
    return ascii_.substr(std::min<std::size_t>(found->second.value, ascii_.size()),
                         found->second.count);
  }

 private:
  struct Entry {
    unsigned location, count, value;
  };
  std::map<unsigned, Entry> entries_;
  std::span<const unsigned char> doubles_;
  std::string_view ascii_;
};

std::optional<double> lengthOfCode(unsigned code) {
  for (const auto& [known, metres] : kLengths) {
    if (known == code) return metres;
  }
  return std::nullopt;
}

/// The unit that a name of a coordinate system ends with: "NAD83 / Ohio North (ftUS)".
std::optional<double> lengthInCitation(std::string_view citation) {
  const std::string text = lowered(citation);
  const auto has = [&](std::initializer_list<std::string_view> any) {
    return std::ranges::any_of(any, [&](auto part) { return text.find(part) != text.npos; });
  };
  if (has({"(ftus)", "us survey f", "us_survey_f", "u.s. survey f", "foot_us"})) return kUsFoot_m;
  if (has({"(ft)", "foot", "feet"})) return kFoot_m;
  if (has({"metre", "meter", "utm zone"})) return 1.0;
  return std::nullopt;
}

/// Whether the codes of projected systems in metres hold this one: UTM zones and national grids.
bool isInMetres(unsigned epsg) {
  constexpr std::pair<unsigned, unsigned> kRanges[] = {
      {32601, 32660}, {32701, 32760}, {25828, 25838}, {26901, 26923},
      {26701, 26722}, {31466, 31469}, {2154, 2154},   {27700, 27700},
      {28992, 28992}, {2056, 2056},   {3006, 3067},   {3857, 3857}};
  return std::ranges::any_of(
      kRanges, [&](const auto& range) { return epsg >= range.first && epsg <= range.second; });
}

/// A bracket of WKT: KEYWORD["text",1.5,OTHER[...]].
struct WktNode {
  std::string keyword;
  std::vector<std::string_view> values;
  std::vector<WktNode> nodes;

  const WktNode* find(std::initializer_list<std::string_view> keywords) const {
    for (const WktNode& node : nodes) {
      if (std::ranges::find(keywords, node.keyword) != keywords.end()) return &node;
    }
    return nullptr;
  }
};

class WktParser {
 public:
  explicit WktParser(std::string_view text) : text_(text) {}

  std::optional<WktNode> parse() { return node(0); }

 private:
  char next() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  /// Text in quotes without them, or everything up to the next mark.
  std::string_view word() {
    if (next() == '"') {
      const std::size_t end = std::min(text_.find('"', at_ + 1), text_.size());
      const std::string_view quoted = text_.substr(at_ + 1, end - at_ - 1);
      at_ = std::min(end + 1, text_.size());
      return quoted;
    }
    const std::size_t end = std::min(text_.find_first_of("[](),\"", at_), text_.size());
    const std::string_view bare = trimmed(text_.substr(at_, end - at_));
    at_ = end;
    return bare;
  }

  std::optional<WktNode> node(int depth) {
    constexpr int kMaxDepth = 32;
    WktNode node;
    for (const char c : word()) {
      node.keyword += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    if (depth > kMaxDepth || (next() != '[' && next() != '(')) return std::nullopt;
    do {
      ++at_;
      const std::size_t start = at_;
      const bool quoted = next() == '"';
      const std::string_view value = word();
      if (!quoted && (next() == '[' || next() == '(')) {
        at_ = start;
        auto inner = this->node(depth + 1);
        if (!inner) return std::nullopt;
        node.nodes.push_back(std::move(*inner));
      } else {
        node.values.push_back(value);
      }
    } while (next() == ',');
    if (next() != ']' && next() != ')') return std::nullopt;
    ++at_;
    return node;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

/// The factor of the unit of a coordinate system, to metres or radians; WKT 2 may state it for each
/// axis.
std::optional<double> unitOf(const WktNode& system) {
  const auto units = {std::string_view("UNIT"), std::string_view("LENGTHUNIT"),
                      std::string_view("ANGLEUNIT")};
  const WktNode* unit = system.find(units);
  const WktNode* axis = system.find({"AXIS"});
  if (unit == nullptr && axis != nullptr) unit = axis->find(units);
  if (unit == nullptr || unit->values.size() < 2) return std::nullopt;
  const std::optional<double> factor = parseNumber(unit->values[1]);
  return factor && *factor > 0.0 ? factor : std::nullopt;
}

/// The projected, geographic and vertical systems in a text, wherever they are.
void takeSystem(const WktNode& node, LasCoordinates& found) {
  const auto is = [&](std::initializer_list<std::string_view> keywords) {
    return std::ranges::find(keywords, node.keyword) != keywords.end();
  };
  if (is({"PROJCS", "PROJCRS", "PROJECTEDCRS", "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS"})) {
    found.unit_m = unitOf(node);
  } else if (is({"GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"})) {
    // Of a geodetic system, the axes tell: two or three angles, or three lengths.
    const WktNode* axes = node.find({"CS"});
    if (axes != nullptr && !axes->values.empty() && axes->values[0] == "Cartesian") {
      found.geocentric = true;
    } else {
      const double radian = unitOf(node).value_or(std::numbers::pi / 180.0);
      found.unit_deg = radian * 180.0 / std::numbers::pi;
    }
  } else if (is({"GEOCCS"})) {
    found.geocentric = true;
  } else if (is({"VERT_CS", "VERTCRS", "VERTICALCRS"})) {
    found.height_unit_m = unitOf(node);
  } else {
    for (const WktNode& inner : node.nodes) takeSystem(inner, found);
  }
}

}  // namespace

LasCoordinates coordinatesOfGeoKeys(std::span<const unsigned char> directory,
                                    std::span<const unsigned char> doubles,
                                    std::string_view ascii) {
  const GeoKeys keys(directory, doubles, ascii);
  LasCoordinates found;
  const auto length = [&](unsigned code) -> std::optional<double> {
    if (code == kUserDefined) return keys.number(kProjectedUnitSize);
    const std::optional<double> metres = lengthOfCode(code);
    if (!metres) {
      found.remarks.push_back("its unit of length is EPSG:" + std::to_string(code) +
                              ", which foci does not know: taken for a metre");
    }
    return metres;
  };
  if (const auto code = keys.code(kVerticalUnit)) found.height_unit_m = length(*code);
  const unsigned model = keys.code(kModelType).value_or(kProjected);
  if (model == kGeographic) {
    const unsigned unit = keys.code(kAngularUnit).value_or(0);
    found.unit_deg = unit == kRadian ? 180.0 / std::numbers::pi : unit == kGrad ? 0.9 : 1.0;
    return found;
  }
  found.geocentric = model == kGeocentric;
  if (const auto code = keys.code(kProjectedUnit)) {
    found.unit_m = length(*code);
    return found;
  }
  for (const unsigned key : {kProjectedCitation, kCitation}) {
    if (!found.unit_m) found.unit_m = lengthInCitation(keys.text(key));
  }
  const auto system = keys.code(kProjectedSystem);
  if (!found.unit_m && system && *system != kUserDefined && !isInMetres(*system)) {
    found.remarks.push_back("its coordinate system is EPSG:" + std::to_string(*system) +
                            ", whose unit the file does not state: taken for a metre; if it is "
                            "another, set scene.scale_m");
  }
  return found;
}

LasCoordinates coordinatesOfWkt(std::string_view wkt) {
  LasCoordinates found;
  if (const auto root = WktParser(wkt).parse()) takeSystem(*root, found);
  return found;
}

}  // namespace foci
