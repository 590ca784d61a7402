#include "render/scene/io/foci_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/input_error.h"
#include "base/parallel.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

static_assert(std::endian::native == std::endian::little && sizeof(glm::vec3) == 12);

constexpr std::array<unsigned char, 8> kMagic = {'F', 'O', 'C', 'I', '\r', '\n', 0x1a, '\n'};
constexpr std::uint32_t kVersion = 2, kVersionOfBodies = 2;  // files without bodies are of 1
constexpr std::uint32_t kOriented = 1, kWithOpacity = 2, kMesh = 4, kPlainColors = 8, kBodies = 64;
constexpr std::uint32_t kUpAxisX = 16, kUpAxes = 48,
                        kFlags = 127;  // an up axis is a multiple of kUpAxisX
constexpr std::size_t kArrays = 6;     // of version 1, whose checksum counts an empty one, too
constexpr std::size_t kBlock = 1 << 20;
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr bool kChecksums = false;  // a fuzzer would never pass them
#else
constexpr bool kChecksums = true;
#endif

struct FociHeader {
  std::array<unsigned char, 8> magic = kMagic;
  std::uint32_t version = 1;
  std::uint32_t flags = 0;
  std::uint64_t surfels = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t content_checksum = 0;
  std::array<std::uint64_t, 2> zero{};
  std::uint64_t header_checksum = 0;
};
static_assert(sizeof(FociHeader) == 64);

/// FNV-1a over words of eight bytes, the last one padded with zeros. Each step is a bijection of
/// the state, so a change within one word always changes the result.
class Checksum {
 public:
  void add(std::uint64_t word) { state_ = (state_ ^ word) * 0x100000001b3; }
  void add(std::span<const unsigned char> bytes) {
    std::uint64_t word = 0;
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
      std::memcpy(&word, bytes.data(), 8);
      add(word);
    }
    word = 0;
    if (!bytes.empty()) std::memcpy(&word, bytes.data(), bytes.size());
    add(word ^ std::uint64_t{bytes.size()} << 56);
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

std::uint64_t checksumOf(const FociHeader& header) {
  Checksum sum;
  sum.add({reinterpret_cast<const unsigned char*>(&header), offsetof(FociHeader, header_checksum)});
  return sum.value();
}

/// The checksum of an array: that of its blocks' checksums, which are computed in parallel.
std::uint64_t checksumOf(std::span<const unsigned char> bytes) {
  std::vector<std::uint64_t> blocks((bytes.size() + kBlock - 1) / kBlock);
  parallelFor(blocks.size(), [&](std::size_t i) {
    Checksum sum;
    sum.add(bytes.subspan(i * kBlock, std::min(kBlock, bytes.size() - i * kBlock)));
    blocks[i] = sum.value();
  });
  Checksum sum;
  for (const std::uint64_t block : blocks) sum.add(block);
  return sum.value();
}

template <typename T>
std::span<const unsigned char> bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(T)};
}

std::uint32_t flagsOf(const PreparedScene& scene) {
  const SurfelOrigin& origin = scene.origin;
  return (scene.cloud.oriented ? kOriented : 0) | (scene.cloud.opacity.empty() ? 0 : kWithOpacity) |
         (origin.mesh ? kMesh : 0) | (origin.plain_colors ? kPlainColors : 0) |
         (scene.cloud.bodies.of_surfel.empty() ? 0 : kBodies) |
         (origin.up_axis ? kUpAxisX * static_cast<std::uint32_t>(*origin.up_axis + 1) : 0);
}

SurfelOrigin originOf(std::uint32_t flags) {
  SurfelOrigin origin{.mesh = (flags & kMesh) != 0, .plain_colors = (flags & kPlainColors) != 0};
  const int axis = static_cast<int>((flags & kUpAxes) / kUpAxisX);
  if (axis > 0) origin.up_axis = axis - 1;
  return origin;
}

std::uint64_t bytesASurfel(std::uint32_t flags) {
  return 4 * 12 + 4 + ((flags & kWithOpacity) != 0 ? 4 : 0) + ((flags & kBodies) != 0 ? 2 : 0);
}

/// A file's bytes, mapped for reading.
class Map {
 public:
  explicit Map(const std::filesystem::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status {};
    if (file < 0 || ::fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
      if (file >= 0) ::close(file);
      throw InputError(path.string(), "cannot be read");
    }
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ > 0) at_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
    ::close(file);
    if (at_ == MAP_FAILED) throw InputError(path.string(), "cannot be read");
  }
  ~Map() {
    if (at_ != nullptr) ::munmap(at_, size_);
  }
  Map(const Map&) = delete;
  Map& operator=(const Map&) = delete;

  std::span<const unsigned char> bytes() const {
    return {static_cast<const unsigned char*>(at_), size_};
  }

 private:
  void* at_ = nullptr;
  std::size_t size_ = 0;
};

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

}  // namespace

bool isSceneFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;  // a pipe never ends
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  // Half of the magic is enough; the rest shows how a transfer has altered the file.
  std::array<unsigned char, 4> start{};
  return file && std::fread(start.data(), 1, start.size(), file.get()) == start.size() &&
         std::equal(start.begin(), start.end(), kMagic.begin());
}

void writeSceneFile(const std::filesystem::path& path, const PreparedScene& scene) {
  const SurfelCloud& cloud = scene.cloud;
  assert(!cloud.empty());
  const std::array arrays = {bytesOf(cloud.position_m),      bytesOf(cloud.axis_u_m),
                             bytesOf(cloud.axis_v_m),        bytesOf(cloud.color),
                             bytesOf(cloud.area_m2),         bytesOf(cloud.opacity),
                             bytesOf(cloud.bodies.of_surfel)};
  static_assert(arrays.size() == kArrays + 1);
  FociHeader header;
  header.flags = flagsOf(scene);
  if ((header.flags & kBodies) != 0) header.version = kVersionOfBodies;
  header.surfels = cloud.size();
  header.file_bytes = sizeof(FociHeader) + cloud.size() * bytesASurfel(header.flags);
  Checksum content;
  for (std::size_t i = 0; i < kArrays; ++i) content.add(checksumOf(arrays.at(i)));
  if (!arrays[kArrays].empty()) content.add(checksumOf(arrays[kArrays]));
  header.content_checksum = content.value();
  header.header_checksum = checksumOf(header);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "wb"));
  bool good = file && std::fwrite(&header, sizeof(header), 1, file.get()) == 1;
  for (const auto& array : arrays) {
    good = good && (array.empty() ||
                    std::fwrite(array.data(), 1, array.size(), file.get()) == array.size());
  }
  good = good && std::fflush(file.get()) == 0;
  if (!good) throw std::runtime_error(path.string() + ": cannot be written");
}

PreparedScene readSceneFile(const std::filesystem::path& path) {
  const Map map(path);
  const std::span<const unsigned char> bytes = map.bytes();
  const auto refuse = [&](const std::string& why) -> void { throw InputError(path.string(), why); };
  const std::size_t start = std::min(bytes.size(), kMagic.size());
  if (start == 0 ||
      std::memcmp(bytes.data(), kMagic.data(), std::min<std::size_t>(start, 4)) != 0) {
    refuse("is not a .foci scene");
  }
  if (bytes.size() < sizeof(FociHeader)) {
    refuse("is cut short: " + std::to_string(bytes.size()) + " bytes, a header has 64");
  }
  FociHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.magic != kMagic) refuse("was altered, as by a transfer as text");
  if (header.version > kVersion) {
    refuse("is of version " + std::to_string(header.version) + ": this program reads version " +
           std::to_string(kVersion));
  }
  if (kChecksums && header.header_checksum != checksumOf(header))
    refuse("was altered: its header does not match");
  const std::uint32_t version = (header.flags & kBodies) != 0 ? kVersionOfBodies : 1;
  if (header.version != version || (header.flags & ~kFlags) != 0) {
    refuse("is not a .foci scene");
  }
  const std::uint64_t surfel_bytes = bytesASurfel(header.flags);
  if (header.surfels == 0) refuse("has no surfels");
  if (header.surfels > std::numeric_limits<std::uint32_t>::max() - 1 ||
      header.file_bytes != sizeof(FociHeader) + header.surfels * surfel_bytes) {
    refuse("is not a .foci scene: its sizes contradict each other");
  }
  if (bytes.size() != header.file_bytes) {
    refuse(std::string(bytes.size() < header.file_bytes ? "is cut short" : "is too long") + ": " +
           std::to_string(bytes.size()) + " bytes of " + std::to_string(header.file_bytes));
  }

  std::size_t at = sizeof(FociHeader);
  Checksum content;
  const std::size_t count = header.surfels;
  const auto take = [&](std::size_t entry_bytes) {
    const std::span<const unsigned char> array = bytes.subspan(at, count * entry_bytes);
    at += array.size();
    content.add(checksumOf(array));
    return array;
  };
  const auto position = take(12), axis_u = take(12), axis_v = take(12), color = take(12);
  const auto area = take(4), opacity = (header.flags & kWithOpacity) != 0
                                           ? take(4)
                                           : std::span<const unsigned char>();
  if (opacity.empty()) content.add(checksumOf(opacity));
  const auto body = (header.flags & kBodies) != 0 ? take(2) : std::span<const unsigned char>();
  if (kChecksums && content.value() != header.content_checksum)
    refuse("was altered: its checksum does not match");

  SurfelCloud cloud;
  const auto fill = [](auto& values, std::span<const unsigned char> array) {
    values.resize(array.size() / sizeof(values[0]));
    if (!array.empty()) std::memcpy(static_cast<void*>(values.data()), array.data(), array.size());
  };
  fill(cloud.position_m, position);
  fill(cloud.axis_u_m, axis_u);
  fill(cloud.axis_v_m, axis_v);
  fill(cloud.color, color);
  fill(cloud.area_m2, area);
  fill(cloud.opacity, opacity);
  fill(cloud.bodies.of_surfel, body);
  cloud.oriented = (header.flags & kOriented) != 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!sound(cloud, i)) refuse("surfel " + std::to_string(i) + " is not sound");
  }
  completeBodies(cloud);
  return {std::move(cloud), originOf(header.flags)};
}

}  // namespace foci
