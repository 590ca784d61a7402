#include "render/scene/io/point_formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/las_coordinates.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

constexpr std::size_t kHeader = 227;        // bytes that all versions have
constexpr std::size_t kHeader14 = 255;      // up to the 64-bit number of points of version 1.4
constexpr std::uint8_t kCompressed = 0xc0;  // bits of the point format that LASzip sets
constexpr std::size_t kIntensityAt = 12;

struct PointFormat {
  std::size_t bytes;     // at least
  std::size_t color_at;  // 0: none
};
constexpr PointFormat kFormats[] = {{20, 0}, {28, 0},  {26, 20}, {34, 28}, {57, 0}, {63, 28},
                                    {30, 0}, {36, 30}, {38, 30}, {59, 0},  {67, 30}};

struct LasHeader {
  std::uint64_t data_at = 0, points = 0;
  PointFormat format{};
  bool has_classes = false;     ///< from version 1.1 on
  bool has_wide_class = false;  ///< formats 6 to 10
  std::size_t record_bytes = 0;
  glm::dvec3 scale{1.0}, offset{0.0};
  LasCoordinates coordinates{};
};

/// Records of variable length: of the coordinate system, by number.
using LasRecords = std::map<unsigned, std::span<const unsigned char>>;
constexpr unsigned kGeoKeys = 34735, kGeoDoubles = 34736, kGeoAscii = 34737, kWkt = 2112;

std::string_view textOf(std::span<const unsigned char> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.substr(0, text.find('\0'));
}

/// @param at, end  of the records
/// @param late     they lie behind the points, as in version 1.4
void readRecords(const FileBytes& file, std::uint64_t at, std::uint64_t end, std::uint32_t count,
                 bool late, LasRecords& records) {
  constexpr std::size_t kUserAt = 2, kNumberAt = 18, kLengthAt = 20;
  const std::uint64_t head = late ? 60 : 54;
  for (std::uint32_t i = 0; i < count && at <= end && end - at >= head; ++i) {
    const auto header = file.part(at, head);
    const std::uint64_t length = late ? u64At(header, kLengthAt) : u16At(header, kLengthAt);
    at += head;
    if (length > end - at) return;
    const std::string_view user = textOf(header.subspan(kUserAt, kNumberAt - kUserAt));
    if (user.starts_with("LASF_Projection")) {
      records[u16At(header, kNumberAt)] = file.part(at, length);
    }
    at += length;
  }
}

LasCoordinates coordinatesOf(LasRecords& records, bool prefers_wkt) {
  const bool by_wkt = !records[kWkt].empty() && (prefers_wkt || records[kGeoKeys].empty());
  LasCoordinates found = by_wkt ? coordinatesOfWkt(textOf(records[kWkt]))
                                : coordinatesOfGeoKeys(records[kGeoKeys], records[kGeoDoubles],
                                                       textOf(records[kGeoAscii]));
  for (auto* const unit : {&found.unit_m, &found.height_unit_m, &found.unit_deg}) {
    constexpr double kMost = 1e6;
    if (*unit && !(**unit >= 1.0 / kMost && **unit <= kMost)) unit->reset();
  }
  return found;
}

LasHeader readLasHeader(const FileBytes& file) {
  const auto refuse = [&](const auto&... what) { return InputError(file.name(), what...); };
  if (file.size() < kHeader) throw refuse("is no LAS file: shorter than its header");
  const auto raw = file.all();
  if (textOf(raw).substr(0, 4) != "LASF") {
    throw refuse("is no LAS file: expected LASF in its first bytes");
  }
  const unsigned major = raw[24], minor = raw[25];
  if (major != 1 || minor > 4) {
    throw refuse("is LAS ", major, ".", minor, ": expected version 1.0 to 1.4");
  }
  LasHeader header;
  header.data_at = u32At(raw, 96);
  header.points = u32At(raw, 107);
  const unsigned format = raw[104];
  if ((format & kCompressed) != 0) {
    throw refuse(
        "is compressed (LAZ), which foci does not read: laszip -i scan.laz -o scan.las, or pdal "
        "translate scan.laz scan.las, makes a LAS file of it");
  }
  if (format >= std::size(kFormats)) {
    throw refuse("has point format ", format, ": expected 0 to 10");
  }
  header.format = kFormats[format];
  header.has_classes = minor > 0;
  header.has_wide_class = format >= 6;
  header.record_bytes = u16At(raw, 105);
  if (header.record_bytes < header.format.bytes) {
    throw refuse("has points of ", header.record_bytes, " bytes: point format ", format, " needs ",
                 header.format.bytes);
  }
  header.scale = dvec3At(raw, 131);
  header.offset = dvec3At(raw, 155);
  if (minor == 4) {
    if (file.size() < kHeader14) throw refuse("ends in its header");
    header.points = std::max(header.points, u64At(raw, 247));
  }
  const std::uint64_t fixed = minor == 4 ? kHeader14 : kHeader;
  if (header.data_at < fixed || header.data_at > file.size()) {
    throw refuse("says that its points begin at byte ", header.data_at,
                 ", which is not behind its header");
  }
  LasRecords records;
  const std::uint64_t header_bytes = u16At(raw, 94);
  if (header_bytes >= fixed) {
    readRecords(file, header_bytes, header.data_at, u32At(raw, 100), false, records);
  }
  if (minor == 4) {
    readRecords(file, u64At(raw, 235), file.size(), u32At(raw, 243), true, records);
  }
  constexpr unsigned kEncodingAt = 6, kPrefersWkt = 1u << 4u;
  header.coordinates = coordinatesOf(records, (u16At(raw, kEncodingAt) & kPrefersWkt) != 0);
  const std::uint64_t room = (file.size() - header.data_at) / header.record_bytes;
  if (header.points > room) {
    throw refuse("says that it has ", header.points, " points: the file has room for at most ",
                 room);
  }
  return header;
}

/// Places in a unit that x, y and z share.
class LasPlaces {
 public:
  LasPlaces(const LasCoordinates& coordinates, PointCloud& points)
      : coordinates_(coordinates), points_(points), unit_m_(coordinates.unit_m.value_or(1.0)) {
    if (coordinates.unit_deg) unit_m_ = 1.0;
    height_ = coordinates.height_unit_m.value_or(unit_m_) / unit_m_;
    points.unit_m = unit_m_;  // without a statement metres, as in nearly all surveys
    points.up_axis = 2;
  }

  glm::dvec3 placeOf(glm::dvec3 p) {
    p.z *= height_;
    if (!coordinates_.unit_deg) return p;
    if (!middle_deg_ && std::isfinite(p.x) && std::isfinite(p.y)) startAt(p);
    const glm::dvec2 from = middle_deg_.value_or(glm::dvec2(0.0));
    const glm::dvec2 turn_deg = *coordinates_.unit_deg * glm::dvec2(p) - from;
    return {turn_deg.x * degree_m_.x, turn_deg.y * degree_m_.y, p.z};
  }

  void finish() const {
    auto& remarks = points_.remarks;
    remarks.insert(remarks.end(), coordinates_.remarks.begin(), coordinates_.remarks.end());
    if (middle_deg_) {
      remarks.push_back("x and y are longitude and latitude in degrees: shown in metres from " +
                        significant(middle_deg_->x, 9) + " " + significant(middle_deg_->y, 9));
    }
    if (height_ != 1.0) {
      remarks.push_back("heights are in units of " + significant(height_ * unit_m_, 7) +
                        " m, x and y in units of " + significant(unit_m_, 7) +
                        " m: heights are scaled to match");
    }
    if (coordinates_.geocentric) {
      remarks.emplace_back(
          "its coordinates start at the middle of the Earth, so no axis points upwards: project "
          "them, e.g. with pdal's filters.reprojection");
    }
  }

 private:
  /// Lengths of a degree on the ellipsoid of WGS 84 (Snyder, Map Projections, 1987, eq. 4-20 and
  /// 4-21).
  void startAt(const glm::dvec3& p) {
    constexpr double kEquator_m = 6378137.0, kEccentricity2 = 0.0066943799901413165;
    middle_deg_ = *coordinates_.unit_deg * glm::dvec2(p);
    const double latitude = glm::radians(middle_deg_->y), sine = std::sin(latitude);
    const double under = 1.0 - kEccentricity2 * sine * sine;
    degree_m_ = {glm::radians(kEquator_m * std::cos(latitude) / std::sqrt(under)),
                 glm::radians(kEquator_m * (1.0 - kEccentricity2) / (under * std::sqrt(under)))};
  }

  const LasCoordinates& coordinates_;
  PointCloud& points_;
  double unit_m_ = 1.0, height_ = 1.0;
  std::optional<glm::dvec2> middle_deg_;
  glm::dvec2 degree_m_{0.0};
};

/// Whether a point is to be left out: withheld, or noise, which is low (7) or high (18; reserved in
/// formats 0 to 5). LAS 1.4 R15, tables 8, 9, 16 and 17. In version 1.0 each user had own classes.
bool isNoise(std::span<const unsigned char> record, const LasHeader& header) {
  constexpr unsigned kFlagsAt = 15, kWideClassAt = 16, kLow = 7, kHigh = 18, kClassBits = 31;
  if (!header.has_classes) return false;
  const unsigned flags = record[kFlagsAt];
  if (!header.has_wide_class) return (flags & 128u) != 0 || (flags & kClassBits) == kLow;
  return (flags & 4u) != 0 || record[kWideClassAt] == kLow || record[kWideClassAt] == kHigh;
}

}  // namespace

PointCloud readLas(const std::filesystem::path& path) {
  const FileBytes file(path, /*unpacks_gzip=*/true);
  const LasHeader header = readLasHeader(file);
  PointCloud points;
  points.position_m.reserve(header.points);
  std::vector<std::array<std::uint16_t, 3>> codes;
  std::vector<float> intensity;
  const bool has_color = header.format.color_at != 0;
  if (has_color) codes.reserve(header.points);
  intensity.reserve(header.points);
  LasPlaces places(header.coordinates, points);
  ScanPositions positions(points);
  std::uint16_t brightest = 0;
  const auto recordOf = [&](std::uint64_t i) {
    return file.all().subspan(header.data_at + i * header.record_bytes, header.record_bytes);
  };
  std::uint64_t noise = 0;
  while (noise < header.points && isNoise(recordOf(noise), header)) ++noise;
  const bool shows_noise = noise == header.points;  // nothing else is there
  noise = 0;
  for (std::uint64_t i = 0; i < header.points; ++i) {
    const auto record = recordOf(i);
    if (!shows_noise && isNoise(record, header)) {
      ++noise;
      continue;
    }
    const glm::dvec3 steps(valueAt<glm::ivec3>(record, 0));
    if (!positions.append(places.placeOf(steps * header.scale + header.offset))) continue;
    intensity.push_back(u16At(record, kIntensityAt));
    if (!has_color) continue;
    codes.push_back(valueAt<std::array<std::uint16_t, 3>>(record, header.format.color_at));
    brightest = std::max({brightest, codes.back()[0], codes.back()[1], codes.back()[2]});
  }
  if (noise > 0) {
    points.remarks.push_back(counted(noise, "point") + " of noise, or withheld: left out");
  }
  positions.finish(file.name());
  places.finish();
  if (has_color && brightest > 0) {
    const float white = brightest > 255 ? 65535.0f : 255.0f;
    points.color.reserve(codes.size());
    for (const auto& [r, g, b] : codes)
      points.color.push_back(linearColor(glm::vec3(r, g, b) / white));
    remarkDark(points);
  } else {
    points.color = greyOf(intensity);
    const auto& grey = points.color;
    const bool varies = std::ranges::adjacent_find(grey, std::not_equal_to<>()) != grey.end();
    if (has_color) points.remarks.emplace_back(varies ? kIntensityInstead : kGreyInstead);
  }
  return points;
}

}  // namespace foci
