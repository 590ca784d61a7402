#include "render/scene/io/ply.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/image/srgb.h"
#include "render/scene/io/ply_items.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

constexpr std::size_t kMaxLabels = 1000;

float toFloat(double x) { return static_cast<float>(x); }

/// The object of a label, whose name is the label; 0 for none. Absent if it is no integer, or if
/// there are too many.
std::optional<std::uint16_t> objectOf(SceneObjects& objects, double label) {
  if (objects.names.empty()) objects.names.emplace_back();
  if (std::isnan(label)) return 0;
  if (!(std::abs(label) <= 1e9) || label != std::floor(label)) return std::nullopt;
  const std::string name = decimal(label, 0);
  // Points of one object often follow each other.
  if (!objects.of.empty() && objects.names[objects.of.back()] == name) return objects.of.back();
  const auto found = std::find(objects.names.begin() + 1, objects.names.end(), name);
  if (found != objects.names.end()) {
    return static_cast<std::uint16_t>(found - objects.names.begin());
  }
  if (objects.names.size() > kMaxLabels) return std::nullopt;
  objects.names.push_back(name);
  return static_cast<std::uint16_t>(objects.names.size() - 1);
}

/// The properties of the vertices that a point cloud has arrays for. Other properties are skipped.
struct Layout {
  std::vector<std::size_t> position, normal, color;
  std::optional<std::size_t> intensity, radius, opacity, label;

  Layout(const ply::Items& items, const std::string& file)
      : position(items.findAll({"x", "y", "z"})),
        normal(items.findAll({"nx", "ny", "nz"})),
        color(ply::colorOf(items)) {
    if (position.empty()) {
      throw InputError(
          file, items.find("packed_position")
                    ? "is a compressed PLY of Gaussians: splat-transform makes a plain PLY of it"
                    : "element vertex: expected properties x, y and z");
    }
    const auto first = [&](std::initializer_list<std::string_view> names) {
      std::optional<std::size_t> found;
      for (const std::string_view name : names) found = found ? found : items.find(name);
      return found;
    };
    intensity = first(
        {"intensity", "scalar_intensity", "reflectivity", "reflectance", "scalar_reflectance"});
    radius = first({"radius"});
    opacity = ply::opacityOf(items);
    label = first({"label", "class", "object_id", "scalar_label"});
  }
};

bool areBlack(const std::vector<glm::vec3>& colors) {
  return std::ranges::all_of(colors, [](const glm::vec3& c) { return c == glm::vec3(0.0f); });
}

constexpr std::size_t kWriteBlock = 1 << 20;  // bytes written together

}  // namespace

PointCloud readVertices(ply::Items& items, const std::string& file) {
  Layout layout(items, file);
  const std::uint64_t count = items.element().count;
  PointCloud points;
  points.position_m.reserve(count);
  if (!layout.color.empty()) points.color.reserve(count);
  if (!layout.normal.empty()) points.normal.reserve(count);
  if (layout.radius) points.radius_m.reserve(count);
  if (layout.opacity) points.opacity.reserve(count);
  if (layout.label) points.objects.of.reserve(count);
  std::vector<float> intensity;
  ScanPositions positions(points);
  const bool fine = items.property(layout.position[0]).type == ply::Scalar::float64;
  while (items.next()) {
    // A float has lost what an origin nearby would keep.
    const glm::dvec3 p = items.vector(layout.position);
    if (!(fine ? positions.append(p) : positions.appendInPlace(p))) continue;
    if (!layout.color.empty()) points.color.emplace_back(items.vector(layout.color));
    if (!layout.normal.empty()) points.normal.push_back(unitNormal(items.vector(layout.normal)));
    if (layout.intensity) {
      const double value = items.value(*layout.intensity);
      intensity.push_back(std::isfinite(value) ? toFloat(value) : 0.0f);
    }
    if (layout.radius) {
      const double radius = items.value(*layout.radius);
      points.radius_m.push_back(radius > 0.0 && radius <= kFarthest_m ? toFloat(radius) : 0.0f);
    }
    if (layout.opacity) points.opacity.push_back(toFloat(items.value(*layout.opacity)));
    if (!layout.label) continue;
    const auto object = objectOf(points.objects, items.value(*layout.label));
    if (object) {
      points.objects.of.push_back(*object);
      continue;
    }
    points.remarks.push_back("its property " + items.property(*layout.label).name +
                             " has fractions or over 1000 labels: its points are no objects");
    points.objects = {};
    layout.label.reset();
  }
  positions.finish(file);
  if (!fine && points.size() > 1 && losesDetail(points.position_m)) {
    points.remarks.emplace_back(
        "the points are so far from the origin that floats lose their detail: save them with "
        "coordinates in doubles, or nearer to the origin");
  }
  if (!layout.color.empty()) {
    ply::linearise(points.color, items.property(layout.color[0]).type, file, "vertex",
                   points.remarks);
  }
  if (areBlack(points.color)) {  // or none
    const char* const instead = layout.intensity ? kIntensityInstead : kGreyInstead;
    if (!layout.color.empty()) points.remarks.emplace_back(instead);
    points.color = layout.intensity
                       ? greyOf(intensity)
                       : std::vector<glm::vec3>(points.size(), glm::vec3(kUncolouredLight));
  }
  if (layout.opacity) {
    ply::normaliseOpacity(points.opacity, items.property(*layout.opacity).type, file);
  }
  remarkDark(points);
  dropPlainOpacity(points);
  return points;
}

PointCloud readPly(const std::filesystem::path& path) {
  ply::Input input(path);
  ply::Header header = ply::readHeader(input);
  ply::Items items = ply::verticesIn(input, header);
  PointCloud points = readVertices(items, input.name());
  if (auto edges = ply::edgesRemark(header)) points.remarks.push_back(std::move(*edges));
  return points;
}

void writePly(const std::filesystem::path& path, const PointCloud& points,
              const PlyProperty& further) {
  std::ofstream file(path, std::ios::binary);
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                    std::to_string(points.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!points.normal.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
  out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!points.radius_m.empty()) out += "property float radius\n";
  if (!points.opacity.empty()) out += "property float opacity\n";
  if (!further.values.empty()) out += "property float " + further.name + "\n";
  out += "end_header\n";

  static_assert(std::endian::native == std::endian::little);
  const auto put = [&out](const auto& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (std::size_t i = 0; file && i < points.size(); ++i) {
    put(points.position_m[i]);
    if (!points.normal.empty()) put(points.normal[i]);
    for (int c = 0; c < 3; ++c) {
      const float linear = std::clamp(points.color[i][c], 0.0f, 1.0f);
      out += static_cast<char>(std::lround(255.0f * srgbFromLinear(linear)));
    }
    if (!points.radius_m.empty()) put(points.radius_m[i]);
    if (!points.opacity.empty()) put(points.opacity[i]);
    if (!further.values.empty()) put(further.values[i]);
    if (out.size() >= kWriteBlock) {
      file << out;
      out.clear();
    }
  }
  file << out << std::flush;
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace foci
