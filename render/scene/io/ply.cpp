#include "render/scene/io/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

using ply::Element;
using ply::Format;
using ply::Header;
using ply::Input;
using ply::Property;
using ply::Scalar;

constexpr float kRangeSlack = 1e-3f;  // tolerance of floats meant to be 0 or 1

constexpr std::size_t kMaxLabels = 1000;

// The meaning of a vertex property. Other properties are skipped.
enum Slot {
  kX,
  kY,
  kZ,
  kNx,
  kNy,
  kNz,
  kRed,
  kGreen,
  kBlue,
  kIntensity,
  kRadius,
  kOpacity,
  kLabel,
  kSlots
};
using Vertex = std::array<double, kSlots>;

float linearOfSrgb(double s) {
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

/// One property of the vertex element, and the slot that takes its value.
struct Column {
  Property property;
  std::optional<Slot> slot;
  double scale = 1.0;  // 1 over the full range of an integer colour or opacity
};

double fullRange(Scalar type) {
  switch (type) {
    case Scalar::int8:
      return std::numeric_limits<std::int8_t>::max();
    case Scalar::uint8:
      return std::numeric_limits<std::uint8_t>::max();
    case Scalar::int16:
      return std::numeric_limits<std::int16_t>::max();
    case Scalar::uint16:
      return std::numeric_limits<std::uint16_t>::max();
    case Scalar::int32:
      return std::numeric_limits<std::int32_t>::max();
    case Scalar::uint32:
      return std::numeric_limits<std::uint32_t>::max();
    case Scalar::float32:
    case Scalar::float64:
      return 1.0;
  }
  return 1.0;
}

bool hasProperty(const Element& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& property) { return property.name == name; });
}

/// Maps the columns of the vertex element to the arrays of a point cloud.
class Layout {
 public:
  Layout(const Element& element, const std::string& file) : file_(file) {
    for (const Property& property : element.properties) columns_.push_back({property, {}, 1.0});
    const bool position = take({"x", "y", "z"}, kX);
    fine_ = std::any_of(columns_.begin(), columns_.end(), [](const Column& column) {
      return column.slot == kX && column.property.type == Scalar::float64;
    });
    if (!position)
      throw InputError(file, hasProperty(element, "packed_position")
                                 ? "is a compressed PLY of Gaussians: splat-transform "
                                   "makes a plain PLY of it"
                                 : "element vertex: expected properties x, y and z");
    has_normal_ = take({"nx", "ny", "nz"}, kNx);
    const bool letters = take({"r", "g", "b"}, kRed);
    has_color_ = letters || take({"red", "green", "blue"}, kRed) ||
                 take({"diffuse_red", "diffuse_green", "diffuse_blue"}, kRed);
    has_intensity_ =
        !has_color_ && (take({"intensity"}, kIntensity) || take({"scalar_intensity"}, kIntensity));
    has_radius_ = take({"radius"}, kRadius);
    has_opacity_ = take({"opacity"}, kOpacity) || take({"alpha"}, kOpacity) ||
                   (letters && take({"a"}, kOpacity));
    has_label_ = take({"label"}, kLabel) || take({"class"}, kLabel) ||
                 take({"object_id"}, kLabel) || take({"scalar_label"}, kLabel);
    for (Column& column : columns_) {
      const bool unit = column.slot && (*column.slot == kOpacity ||
                                        (*column.slot >= kRed && *column.slot <= kBlue));
      if (unit) column.scale = 1.0 / fullRange(column.property.type);
      if (column.property.list) fixed_size_ = false;
      record_bytes_ += ply::sizeOf(column.property.type);
    }
    for (std::size_t i = 0; i < srgb8_.size(); ++i) {
      srgb8_[i] = linearOfSrgb(static_cast<double>(i) / 255.0);
    }
  }

  const std::vector<Column>& columns() const { return columns_; }
  bool fixedSize() const { return fixed_size_; }
  bool hasFloats() const { return !fine_; }  // positions
  std::size_t recordBytes() const { return record_bytes_; }
  const std::vector<float>& intensity() const { return intensity_; }  // empty with colours

  void reserve(PointCloud& points, std::size_t count) const {
    points.position_m.reserve(count);
    points.color.reserve(count);
    if (has_normal_) points.normal.reserve(count);
    if (has_radius_) points.radius_m.reserve(count);
    if (has_opacity_) points.opacity.reserve(count);
    if (has_label_) points.objects.of.reserve(count);
  }

  /// @param positions  appends to `points`
  /// @param where      names the vertex; called for messages only
  template <typename Where>
  void append(PointCloud& points, ScanPositions& positions, const Vertex& v, const Where& where) {
    // A float has lost what an origin nearby would keep.
    const glm::dvec3 p(v[kX], v[kY], v[kZ]);
    if (!(fine_ ? positions.append(p) : positions.appendInPlace(p))) return;
    points.color.push_back(has_color_ ? glm::vec3(linear(v[kRed], where), linear(v[kGreen], where),
                                                  linear(v[kBlue], where))
                                      : glm::vec3(kUncolouredLight));
    if (has_intensity_)
      intensity_.push_back(std::isfinite(v[kIntensity]) ? toFloat(v[kIntensity]) : 0.0f);
    if (has_normal_) points.normal.push_back(normalOf({v[kNx], v[kNy], v[kNz]}));
    if (has_radius_) {
      const bool sized = v[kRadius] > 0.0 && v[kRadius] <= kFarthest_m;
      points.radius_m.push_back(sized ? toFloat(v[kRadius]) : 0.0f);
    }
    if (has_opacity_) points.opacity.push_back(unitRange(v[kOpacity], "opacity", where));
    if (has_label_) points.objects.of.push_back(objectOf(points.objects, v[kLabel], where));
  }

 private:
  static float toFloat(double x) { return static_cast<float>(x); }

  static glm::vec3 normalOf(const glm::dvec3& n) {
    const double length = glm::length(n);
    const bool usable = length > 1e-12 && length < 1e150;  // false for NaN
    return usable ? glm::vec3(n / length) : glm::vec3(0.0f);
  }

  template <typename Where>
  float unitRange(double value, const char* what, const Where& where) const {
    if (!(value >= -kRangeSlack && value <= 1.0 + kRangeSlack)) {
      throw InputError(where(), std::string(what) + " " + std::to_string(value) +
                                    ": expected 0 to 1, or an integer type of full range");
    }
    return std::clamp(toFloat(value), 0.0f, 1.0f);
  }

  /// The object of a label. Its name is the label.
  template <typename Where>
  static std::uint16_t objectOf(SceneObjects& objects, double label, const Where& where) {
    if (!(std::abs(label) <= 1e9) || label != std::floor(label)) {
      throw InputError(where(), "label " + decimal(label, 3) + ": expected an integer");
    }
    const std::string name = decimal(label, 0);
    if (objects.names.empty()) objects.names.emplace_back();
    // Points of one object often follow each other.
    if (!objects.of.empty() && objects.names[objects.of.back()] == name) return objects.of.back();
    const auto found = std::find(objects.names.begin() + 1, objects.names.end(), name);
    if (found == objects.names.end()) {
      if (objects.names.size() > kMaxLabels) {
        throw InputError(where(), "has more than " + std::to_string(kMaxLabels) +
                                      " labels: is the property one of instances?");
      }
      objects.names.push_back(name);
      return static_cast<std::uint16_t>(objects.names.size() - 1);
    }
    return static_cast<std::uint16_t>(found - objects.names.begin());
  }

  template <typename Where>
  float linear(double srgb, const Where& where) const {
    const double byte = srgb * 255.0;
    const double rounded = std::nearbyint(byte);
    if (std::abs(byte - rounded) < 1e-9 && rounded >= 0.0 && rounded <= 255.0) {
      return srgb8_[static_cast<std::size_t>(rounded)];
    }
    return linearOfSrgb(unitRange(srgb, "colour", where));
  }

  /// Assigns the columns of these names to consecutive slots, all or none.
  bool take(std::initializer_list<std::string_view> names, int first_slot) {
    std::vector<Column*> found;
    for (const std::string_view name : names) {
      for (Column& column : columns_) {
        if (column.property.name != name) continue;
        if (column.property.list) {
          throw InputError(file_, "vertex property " + std::string(name) + " is a list");
        }
        found.push_back(&column);
      }
    }
    if (found.size() > names.size()) {
      throw InputError(file_, "vertex property " + found[1]->property.name + " is there twice");
    }
    if (found.size() < names.size()) return false;
    for (Column* column : found) column->slot = static_cast<Slot>(first_slot++);
    return true;
  }

  std::string file_;
  std::vector<Column> columns_;
  std::array<float, 256> srgb8_{};
  std::vector<float> intensity_;
  bool has_normal_ = false, has_color_ = false, has_intensity_ = false, has_radius_ = false,
       has_opacity_ = false, has_label_ = false;
  bool fine_ = false;  // positions are doubles
  bool fixed_size_ = true;
  std::size_t record_bytes_ = 0;
};

void readBinary(Input& input, Layout& layout, std::uint64_t count, bool swap, PointCloud& points,
                ScanPositions& positions) {
  Vertex vertex{};
  const auto where = [&] {
    return input.name() + ": before byte " + std::to_string(input.offset());
  };
  for (std::uint64_t i = 0; i < count; ++i) {
    const unsigned char* bytes = layout.fixedSize() ? input.take(layout.recordBytes()) : nullptr;
    for (const Column& column : layout.columns()) {
      const std::size_t size = ply::sizeOf(column.property.type);
      if (column.property.list) {
        ply::skipList(input, column.property, swap);
        continue;
      }
      if (!layout.fixedSize()) bytes = input.take(size);
      if (column.slot) {
        vertex[*column.slot] = ply::scalarAt(bytes, column.property.type, swap) * column.scale;
      }
      bytes += size;
    }
    layout.append(points, positions, vertex, where);
  }
}

void readAscii(Input& input, Layout& layout, std::uint64_t count, Header& header,
               PointCloud& points, ScanPositions& positions) {
  Vertex vertex{};
  const auto where = [&] { return input.name() + ":" + std::to_string(header.lines); };
  for (std::uint64_t i = 0; i < count; ++i) {
    ++header.lines;
    if (input.remaining() == 0) {
      throw InputError(where(), "ends after " + std::to_string(i) + " of " + std::to_string(count) +
                                    " vertices");
    }
    const std::string_view line = input.line();
    std::size_t at = 0;
    for (const Column& column : layout.columns()) {
      const double value = ply::numberAt(line, at, input.name(), header.lines);
      if (column.property.list) {
        for (double item = 0.0; item < value; ++item) {
          ply::numberAt(line, at, input.name(), header.lines);
        }
      } else if (column.slot) {
        vertex[*column.slot] = value * column.scale;
      }
    }
    if (line.find_first_not_of(" \t", at) != std::string_view::npos) {
      throw InputError(where(), "too many values for a vertex");
    }
    layout.append(points, positions, vertex, where);
  }
}

}  // namespace

PointCloud readPly(const std::filesystem::path& path) {
  Input input(path);
  Header header = ply::readHeader(input);
  PointCloud points;
  for (const Element& element : header.elements) {
    if (element.name.starts_with("tristrip") && element.count > 0) {
      throw InputError(input.name(),
                       "has triangle strips, which foci does not read: MeshLab can save it with "
                       "faces");
    }
  }
  for (const Element& element : header.elements) {
    if (element.name != "vertex") {
      ply::skipElement(input, element, header);
      continue;
    }
    Layout layout(element, input.name());
    layout.reserve(points, element.count);
    ScanPositions positions(points);
    if (header.format == Format::ascii) {
      readAscii(input, layout, element.count, header, points, positions);
    } else {
      readBinary(input, layout, element.count, ply::mustSwap(header.format), points, positions);
    }
    if (points.size() == 0) {
      throw InputError(input.name(), points.dropped == 0
                                         ? "has no points"
                                         : "none of its " + std::to_string(points.dropped) +
                                               " points has a finite position");
    }
    positions.finish();
    if (layout.hasFloats() && points.size() > 1 && losesDetail(points.position_m)) {
      points.remarks.emplace_back(
          "the points are so far from the origin that floats lose their detail: save them with "
          "coordinates in doubles, or nearer to the origin");
    }
    if (!layout.intensity().empty()) points.color = greyOf(layout.intensity());
    if (std::all_of(points.color.begin(), points.color.end(),
                    [](const glm::vec3& color) { return color == glm::vec3(0.0f); })) {
      points.color.assign(points.size(), glm::vec3(kUncolouredLight));
      points.remarks.push_back("all colours are 0: shown in grey");
    }
    remarkDark(points);
    if (!points.opacity.empty() && std::all_of(points.opacity.begin(), points.opacity.end(),
                                               [](float opacity) { return opacity == 0.0f; })) {
      points.remarks.push_back(
          "the opacity of all points is 0, so none is seen: leave out the property alpha or "
          "opacity to see them");
    }
    return points;
  }
  throw InputError(input.name(), "has no element vertex");
}

}  // namespace foci
