#include "render/scene/io/las.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "render/image/srgb.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<unsigned char, 4> kLasMagic = {'L', 'A', 'S', 'F'};
constexpr std::size_t kHeader = 227;        // bytes that all versions have
constexpr std::size_t kHeader14 = 255;      // up to the 64-bit number of points of version 1.4
constexpr std::uint8_t kCompressed = 0xc0;  // bits of the point format that LASzip sets
constexpr std::size_t kIntensityAt = 12;

struct PointFormat {
  std::size_t bytes;     // at least
  std::size_t color_at;  // 0: none
};
constexpr std::array<PointFormat, 11> kFormats = {{{20, 0},
                                                   {28, 0},
                                                   {26, 20},
                                                   {34, 28},
                                                   {57, 0},
                                                   {63, 28},
                                                   {30, 0},
                                                   {36, 30},
                                                   {38, 30},
                                                   {59, 0},
                                                   {67, 30}}};

template <typename T>
T load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

struct LasHeader {
  std::uint64_t data_at = 0, points = 0;
  PointFormat format{};
  std::size_t record_bytes = 0;
  glm::dvec3 scale{1.0}, offset{0.0};
};

glm::dvec3 loadVector(const unsigned char* bytes) {
  return {load<double>(bytes), load<double>(bytes + 8), load<double>(bytes + 16)};
}

LasHeader readLasHeader(ply::Input& input) {
  const auto refuse = [&](const std::string& what) -> InputError { return {input.name(), what}; };
  if (input.remaining() < kHeader) throw refuse("is no LAS file: shorter than its header");
  std::array<unsigned char, kHeader14> raw{};
  std::copy_n(input.take(kHeader), kHeader, raw.begin());
  if (!std::equal(kLasMagic.begin(), kLasMagic.end(), raw.begin())) {
    throw refuse("is no LAS file: expected LASF in its first bytes");
  }
  const unsigned major = raw[24], minor = raw[25];
  if (major != 1 || minor > 4) {
    throw refuse("is LAS " + std::to_string(major) + "." + std::to_string(minor) +
                 ": expected version 1.0 to 1.4");
  }
  LasHeader header;
  header.data_at = load<std::uint32_t>(&raw[96]);
  header.points = load<std::uint32_t>(&raw[107]);
  const unsigned format = raw[104];
  if ((format & kCompressed) != 0) {
    throw refuse(
        "is compressed (LAZ), which foci does not read: laszip -i scan.laz -o scan.las, or pdal "
        "translate scan.laz scan.las, makes a LAS file of it");
  }
  if (format >= kFormats.size()) {
    throw refuse("has point format " + std::to_string(format) + ": expected 0 to 10");
  }
  header.format = kFormats[format];
  header.record_bytes = load<std::uint16_t>(&raw[105]);
  if (header.record_bytes < header.format.bytes) {
    throw refuse("has points of " + std::to_string(header.record_bytes) + " bytes: point format " +
                 std::to_string(format) + " needs " + std::to_string(header.format.bytes));
  }
  header.scale = loadVector(&raw[131]);
  header.offset = loadVector(&raw[155]);
  if (minor == 4) {
    if (input.remaining() < kHeader14 - kHeader) throw refuse("ends in its header");
    std::copy_n(input.take(kHeader14 - kHeader), kHeader14 - kHeader, raw.begin() + kHeader);
    header.points = std::max(header.points, load<std::uint64_t>(&raw[247]));
  }
  if (header.data_at < input.offset() || header.data_at - input.offset() > input.remaining()) {
    throw refuse("says that its points begin at byte " + std::to_string(header.data_at) +
                 ", which is not behind its header");
  }
  input.skip(header.data_at - input.offset());
  const std::uint64_t room = input.remaining() / header.record_bytes;
  if (header.points > room) {
    throw refuse("says that it has " + std::to_string(header.points) +
                 " points: the file has room for at most " + std::to_string(room));
  }
  return header;
}

glm::vec3 linearOfCodes(const std::array<std::uint16_t, 3>& codes, float white) {
  const auto linear = [&](std::uint16_t code) {
    return linearFromSrgb(static_cast<float>(code) / white);
  };
  return {linear(codes[0]), linear(codes[1]), linear(codes[2])};
}

}  // namespace

bool isLasFile(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  std::array<unsigned char, kLasMagic.size()> start{};
  return file && std::fread(start.data(), 1, start.size(), file.get()) == start.size() &&
         start == kLasMagic;
}

PointCloud readLas(const std::filesystem::path& path) {
  ply::Input input(path);
  const LasHeader header = readLasHeader(input);
  PointCloud points;
  points.position_m.reserve(header.points);
  std::vector<std::array<std::uint16_t, 3>> codes;
  std::vector<float> intensity;
  const bool has_color = header.format.color_at != 0;
  if (has_color) codes.reserve(header.points);
  if (!has_color) intensity.reserve(header.points);
  ScanPositions positions(points);
  std::uint16_t brightest = 0;
  for (std::uint64_t i = 0; i < header.points; ++i) {
    const unsigned char* record = input.take(header.record_bytes);
    const glm::dvec3 steps(load<std::int32_t>(record), load<std::int32_t>(record + 4),
                           load<std::int32_t>(record + 8));
    if (!positions.append(steps * header.scale + header.offset)) continue;
    if (has_color) {
      const unsigned char* at = record + header.format.color_at;
      codes.push_back(
          {load<std::uint16_t>(at), load<std::uint16_t>(at + 2), load<std::uint16_t>(at + 4)});
      brightest = std::max({brightest, codes.back()[0], codes.back()[1], codes.back()[2]});
    } else {
      intensity.push_back(load<std::uint16_t>(record + kIntensityAt));
    }
  }
  if (points.size() == 0) {
    throw InputError(input.name(), points.dropped == 0
                                       ? "has no points"
                                       : "none of its points has a finite position");
  }
  positions.finish();
  if (has_color && brightest > 0) {
    const float white = brightest > 255 ? 65535.0f : 255.0f;
    points.color.reserve(codes.size());
    for (const auto& code : codes) points.color.push_back(linearOfCodes(code, white));
    remarkDark(points);
  } else if (has_color) {
    points.color.assign(points.size(), glm::vec3(kUncolouredLight));
    points.remarks.emplace_back("all colours are 0: shown in grey");
  } else {
    points.color = greyOf(intensity);
  }
  return points;
}

}  // namespace foci
