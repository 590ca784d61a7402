#include "render/scene/io/foci_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <utility>

#include "render/scene/io/foci_container.h"
#include "render/scene/io/foci_gaussians.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

static_assert(sizeof(glm::vec3) == 12);

constexpr std::uint32_t kOriented = 1, kWithOpacity = 2, kMesh = 4, kPlainColors = 8, kBodies = 64,
                        kObjects = 128;
constexpr std::uint32_t kUpAxisX = 16, kUpAxes = 48,
                        kFlags = 255;  // an up axis is a multiple of kUpAxisX

std::uint32_t flagsOf(const PreparedScene& scene) {
  const SurfelOrigin& origin = scene.origin;
  return (scene.cloud.oriented ? kOriented : 0) | (scene.cloud.opacity.empty() ? 0 : kWithOpacity) |
         (origin.mesh ? kMesh : 0) | (origin.plain_colors ? kPlainColors : 0) |
         (scene.cloud.bodies.of_surfel.empty() ? 0 : kBodies) |
         (scene.cloud.objects.empty() ? 0 : kObjects) |
         (origin.up_axis ? kUpAxisX * static_cast<std::uint32_t>(*origin.up_axis + 1) : 0);
}

SurfelOrigin originOf(std::uint32_t flags) {
  SurfelOrigin origin{.mesh = (flags & kMesh) != 0, .plain_colors = (flags & kPlainColors) != 0};
  const int axis = static_cast<int>((flags & kUpAxes) / kUpAxisX);
  if (axis > 0) origin.up_axis = axis - 1;
  return origin;
}

/// Names, each ended by a zero.
std::vector<char> joined(const std::vector<std::string>& names) {
  std::vector<char> all;
  for (const std::string& name : names) {
    all.insert(all.end(), name.begin(), name.end());
    all.push_back('\0');
  }
  return all;
}

std::vector<std::string> namesIn(ByteSpan bytes) {
  std::vector<std::string> names{{}};
  for (const unsigned char byte : bytes) {
    if (byte == 0) {
      names.emplace_back();
    } else {
      names.back().push_back(static_cast<char>(byte));
    }
  }
  names.pop_back();
  return names;
}

bool finite(const glm::vec3& v, float most) {
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

bool sound(const SurfelCloud& cloud, std::size_t i) {
  const glm::vec3 &u = cloud.axis_u_m[i], &v = cloud.axis_v_m[i], &color = cloud.color[i];
  return finite(cloud.position_m[i], kFarthest_m) && finite(u, kFarthest_m) &&
         finite(v, kFarthest_m) && glm::dot(u, u) > 0.0f && glm::dot(v, v) > 0.0f &&
         glm::length(glm::cross(glm::normalize(u), glm::normalize(v))) > 0.5f &&
         finite(color, std::numeric_limits<float>::max()) && color.x >= 0.0f && color.y >= 0.0f &&
         color.z >= 0.0f && cloud.area_m2[i] > 0.0f &&
         cloud.area_m2[i] <= std::numeric_limits<float>::max() &&
         (cloud.opacity.empty() || (cloud.opacity[i] >= 0.0f && cloud.opacity[i] <= 1.0f)) &&
         (cloud.bodies.of_surfel.empty() || cloud.bodies.of_surfel[i] <= kMaxBodies);
}

/// @param file  of version kFociSurfels or kFociMore. @throws InputError
PreparedScene readFociSurfels(const FociContainer& file) {
  const FociHeader& header = file.header();
  const bool bodies = (header.flags & kBodies) != 0, objects = (header.flags & kObjects) != 0;
  if ((header.flags & ~kFlags) != 0 || (header.version == kFociMore) != (bodies || objects))
    file.refuse("is not a .foci scene");
  if (header.count == 0) file.refuse("has no surfels");
  if (header.count > std::numeric_limits<std::uint32_t>::max() - 1) {
    file.refuse("is not a .foci scene: its sizes contradict each other");
  }
  const std::uint64_t n = header.count;
  std::vector<std::uint64_t> sizes = {
      12 * n, 12 * n, 12 * n, 12 * n, 4 * n, (header.flags & kWithOpacity) != 0 ? 4 * n : 0};
  if (bodies) sizes.push_back(2 * n);
  if (objects) {
    sizes.push_back(2 * n);
    const std::uint64_t so_far = std::accumulate(sizes.begin(), sizes.end(), sizeof(FociHeader));
    sizes.push_back(header.file_bytes > so_far ? header.file_bytes - so_far : 0);  // the names
  }
  const std::vector<ByteSpan> arrays = file.arrays(sizes);

  SurfelCloud cloud;
  const auto fill = [](auto& values, ByteSpan array) {
    values.resize(array.size() / sizeof(values[0]));
    if (!array.empty()) std::memcpy(static_cast<void*>(values.data()), array.data(), array.size());
  };
  fill(cloud.position_m, arrays[0]);
  fill(cloud.axis_u_m, arrays[1]);
  fill(cloud.axis_v_m, arrays[2]);
  fill(cloud.color, arrays[3]);
  fill(cloud.area_m2, arrays[4]);
  fill(cloud.opacity, arrays[5]);
  if (bodies) fill(cloud.bodies.of_surfel, arrays[6]);
  if (objects) {
    fill(cloud.objects.of, arrays[arrays.size() - 2]);
    cloud.objects.names = namesIn(arrays.back());
  }
  cloud.oriented = (header.flags & kOriented) != 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!sound(cloud, i)) file.refuse("surfel " + std::to_string(i) + " is not sound");
  }
  for (const std::uint16_t object : cloud.objects.of) {
    if (object >= cloud.objects.names.size()) file.refuse("has a surfel of an unknown object");
  }
  completeBodies(cloud);
  return {std::move(cloud), originOf(header.flags)};
}

}  // namespace

bool isSceneFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;  // a pipe never ends
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  // Half of the magic is enough; the rest shows how a transfer has altered the file.
  std::array<unsigned char, 4> start{};
  return file && std::fread(start.data(), 1, start.size(), file.get()) == start.size() &&
         std::equal(start.begin(), start.end(), kFociMagic.begin());
}

void writeSceneFile(const std::filesystem::path& path, const PreparedScene& scene) {
  const SurfelCloud& cloud = scene.cloud;
  if (cloud.gaussians) {
    writeFociGaussians(path, scene);
    return;
  }
  assert(!cloud.empty());
  const std::vector<std::uint16_t>& bodies = cloud.bodies.of_surfel;
  std::vector<ByteSpan> arrays = {bytesOf(cloud.position_m), bytesOf(cloud.axis_u_m),
                                  bytesOf(cloud.axis_v_m),   bytesOf(cloud.color),
                                  bytesOf(cloud.area_m2),    bytesOf(cloud.opacity)};
  if (!bodies.empty()) arrays.push_back(bytesOf(bodies));
  const std::vector<char> names = joined(cloud.objects.names);
  if (!cloud.objects.empty()) {
    arrays.push_back(bytesOf(cloud.objects.of));
    arrays.push_back(bytesOf(names));
  }
  writeFoci(path,
            {.version = bodies.empty() && cloud.objects.empty() ? kFociSurfels : kFociMore,
             .flags = flagsOf(scene),
             .count = cloud.size()},
            arrays);
}

PreparedScene readSceneFile(const std::filesystem::path& path) {
  const FociContainer file(path);
  return file.header().version == kFociGaussians ? readFociGaussians(file) : readFociSurfels(file);
}

}  // namespace foci
