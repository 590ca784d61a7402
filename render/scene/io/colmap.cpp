#include "render/scene/io/point_formats.h"

#include <algorithm>
#include <cstdint>

#include "base/input_error.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

constexpr std::size_t kCountBytes = 8;
// A point: number, position, colour, error, and the number of images that show it.
constexpr std::size_t kPlaceAt = 8, kColorAt = 32, kErrorAt = 35, kTrackAt = 43, kFixedBytes = 51;
constexpr std::uint64_t kImageBytes = 8;  // of each image in a point's track

}  // namespace

bool isColmapFile(const std::filesystem::path& path) {
  constexpr std::uint64_t kLookedAt = 16;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  const FileBytes file(path);
  if (file.size() < kCountBytes + kFixedBytes) return false;
  const std::uint64_t count = u64At(file.all(), 0);
  if (count == 0 || count > (file.size() - kCountBytes) / kFixedBytes) return false;
  std::uint64_t at = kCountBytes;
  for (std::uint64_t i = 0; i < std::min(count, kLookedAt); ++i) {
    if (file.size() - at < kFixedBytes) return false;
    const auto point = file.part(at, kFixedBytes);
    const double error = doubleAt(point, kErrorAt);
    const std::uint64_t images = u64At(point, kTrackAt);
    at += kFixedBytes;
    if (!isNearEnough(dvec3At(point, kPlaceAt)) || !(error >= -1.0 && error < 1e6)) return false;
    if (images > (file.size() - at) / kImageBytes) return false;
    at += kImageBytes * images;
  }
  return true;
}

PointCloud readColmap(const std::filesystem::path& path) {
  const FileBytes file(path);
  const std::uint64_t count = u64At(file.part(0, kCountBytes), 0);
  if (count > (file.size() - kCountBytes) / kFixedBytes) {
    throw InputError(file.name(), "says that it has ", count,
                     " points: the file has room for at most ",
                     (file.size() - kCountBytes) / kFixedBytes);
  }
  PointCloud points;
  points.format = "COLMAP points";
  points.y_is_down = true;
  ScanPositions positions(points);
  std::uint64_t at = kCountBytes;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto point = file.part(at, kFixedBytes);
    const std::uint64_t images = u64At(point, kTrackAt);
    at += kFixedBytes;
    if (images > (file.size() - at) / kImageBytes) {
      throw InputError(file.name(), "point ", i + 1, " is seen in ", images,
                       " images, more than the file has room for");
    }
    at += kImageBytes * images;
    if (!positions.append(dvec3At(point, kPlaceAt))) continue;
    const auto rgb = point.subspan(kColorAt);
    points.color.push_back(linearColor(glm::vec3(rgb[0], rgb[1], rgb[2]) / 255.0f));
  }
  positions.finish(file.name());
  return points;
}

}  // namespace foci
