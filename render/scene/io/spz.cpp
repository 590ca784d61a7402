// Niantic's `.spz` (github.com/nianticlabs/spz). Versions 1 to 3 are one stream, plain or by gzip:
// a header of 16 bytes, then positions, opacities, colours, scales, rotations and harmonics, an
// array each. Version 4 has a header of 32 bytes, a table of the arrays' lengths, and the arrays,
// each compressed by Zstandard. Records of extensions follow the header of version 4, or the arrays
// of older versions: type, length and content.

#include <algorithm>
#include <array>
#include <glm/gtc/packing.hpp>
#include <numbers>
#include <string>

#include "base/input_error.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/compression.h"
#include "render/scene/io/gaussian_formats.h"

namespace foci {
namespace {

constexpr std::uint32_t kMagic = 0x5053474e;  // NGSP
constexpr std::size_t kHeader = 16, kHeader4 = 32, kTableEntry = 16;
constexpr unsigned kFlagPreservesLight = 1, kFlagExtensions = 2;
constexpr std::uint32_t kAxesRecord = 0xadbe0003;  // SPZ_ADOBE_coordinate_system
constexpr std::uint32_t kMaxAxes = 16;
constexpr int kMaxDegree = 4;  // foci shows kMaxHarmonicsDegree of them
constexpr std::size_t kMaxRecords = std::size_t{1} << 20u;  // bytes of extensions

/// A colour byte spans the coefficients of degree 0 from -0.5 to 0.5, over this.
constexpr float kColorScale = 0.15f;

enum Array { kPositions, kOpacities, kColors, kScales, kRotations, kHarmonics, kArrays };

struct SpzHeader {
  std::uint32_t version = 0, count = 0;
  int degree = 0;
  unsigned fraction_bits = 0, flags = 0, arrays = 0;

  std::array<std::uint64_t, kArrays> bytes() const {
    const std::uint64_t n = count;
    return {n * (version == 1 ? 6u : 9u),
            n,
            3 * n,
            3 * n,
            n * (version <= 2 ? 3u : 4u),
            n * 3u * static_cast<unsigned>(harmonicsOf(degree))};
  }
};

/// The arrays, unpacked.
struct SpzArrays {
  SpzHeader header;
  std::vector<unsigned char> records;  // of extensions
  std::array<std::vector<unsigned char>, kArrays> array;
};

SpzHeader headerOf(std::span<const unsigned char> bytes, const std::string& file,
                   std::size_t file_bytes) {
  if (u32At(bytes, 0) != kMagic) throw InputError(file, "is no SPZ file: expected NGSP");
  SpzHeader header{.version = u32At(bytes, 4), .count = u32At(bytes, 8)};
  if (header.version < 1 || header.version > 4) {
    throw InputError(file, "is SPZ of version ", header.version, ": expected version 1 to 4");
  }
  header.degree = bytes[12];
  header.fraction_bits = bytes[13];
  header.flags = bytes[14];
  header.arrays = bytes[15];
  if (header.degree > kMaxDegree) {
    throw InputError(file, "has harmonics of degree ", header.degree, ": expected 0 to 4");
  }
  if (header.fraction_bits > 23) {
    throw InputError(file, "has positions with ", header.fraction_bits,
                     " bits after the point: expected 0 to 23");
  }
  // Less than a byte for a Gaussian is no capture, but a bomb of zeros.
  if (header.count > file_bytes) {
    throw InputError(file, "has ", header.count, " Gaussians in ", file_bytes, " bytes: damaged");
  }
  return header;
}

SpzArrays unpackOld(const FileBytes& file) {
  SpzArrays all;
  if (isGzip(file.all())) {
    Gunzip stream(file.name(), file.all());
    all.header = headerOf(stream.take(kHeader), file.name(), file.size());
    const auto sizes = all.header.bytes();
    for (std::size_t i = 0; i < kArrays; ++i) all.array[i] = stream.take(sizes[i]);
    all.records = stream.next(kMaxRecords);
    if (!stream.next(1).empty()) {  // up to the end, where the checksum is
      throw InputError(file.name(), "is damaged: more than its header says");
    }
  } else {
    all.header = headerOf(file.part(0, kHeader), file.name(), file.size());
    const auto sizes = all.header.bytes();
    std::uint64_t at = kHeader;
    for (std::size_t i = 0; i < kArrays; at += sizes[i++]) {
      const auto part = file.part(at, sizes[i]);
      all.array[i].assign(part.begin(), part.end());
    }
    const auto rest = file.part(at, std::min<std::uint64_t>(file.size() - at, kMaxRecords));
    all.records.assign(rest.begin(), rest.end());
  }
  if (all.header.version == 4) {
    throw InputError(file.name(), "is SPZ of version 4 inside gzip: expected version 1 to 3");
  }
  return all;
}

SpzArrays unpackNew(const FileBytes& file) {
  SpzArrays all{.header = headerOf(file.part(0, kHeader4), file.name(), file.size()),
                .records = {},
                .array = {}};
  const auto sizes = all.header.bytes();
  const unsigned expected = all.header.degree > 0 ? kArrays : kArrays - 1;
  if (!readsCompressed()) {
    throw InputError(file.name(), "is SPZ of version 4: foci was built without Zstandard");
  }
  if (all.header.arrays != expected) {
    throw InputError(file.name(), "has ", all.header.arrays, " arrays: expected ", expected);
  }
  const std::uint64_t table_at = u32At(file.all(), 16);
  const auto table = file.part(table_at, expected * kTableEntry);
  if (table_at > kHeader4) {
    const auto zone =
        file.part(kHeader4, std::min(table_at - kHeader4, std::uint64_t{kMaxRecords}));
    all.records.assign(zone.begin(), zone.end());
  }
  std::uint64_t at = table_at + table.size();
  for (std::size_t i = 0; i < expected; ++i) {
    const std::uint64_t packed = u64At(table, i * kTableEntry);
    const std::uint64_t plain = u64At(table, i * kTableEntry + 8);
    if (plain != sizes[i]) {
      throw InputError(file.name(), "array ", i + 1, " has ", plain, " bytes: expected ", sizes[i]);
    }
    const auto part = file.part(at, packed);
    at += packed;
    all.array[i].resize(plain);
    if (!decodeZstd(part, all.array[i])) {
      throw InputError(file.name(), "array ", i + 1,
                       " is damaged: no Zstandard stream of its length");
    }
  }
  return all;
}

float fixed24(const unsigned char* bytes, float scale) {
  std::int32_t value = bytes[0] | bytes[1] << 8 | bytes[2] << 16;
  if (value >= 1 << 23) value -= 1 << 24;
  return static_cast<float>(value) * scale;
}

glm::vec3 positionOf(const SpzArrays& all, std::size_t i) {
  const std::vector<unsigned char>& bytes = all.array[kPositions];
  if (all.header.version == 1) {
    const auto half = [&](std::size_t k) {
      return glm::unpackHalf1x16(u16At(bytes, 6 * i + 2 * k));
    };
    return {half(0), half(1), half(2)};
  }
  const float scale = 1.0f / static_cast<float>(1u << all.header.fraction_bits);
  const unsigned char* at = bytes.data() + 9 * i;
  return {fixed24(at, scale), fixed24(at + 3, scale), fixed24(at + 6, scale)};
}

glm::vec4 rotationOf(const SpzArrays& all, std::size_t i) {
  const std::vector<unsigned char>& bytes = all.array[kRotations];
  std::array<float, 3> three{};
  std::size_t derived = 3;
  if (all.header.version <= 2) {
    for (std::size_t k = 0; k < 3; ++k) {
      three[k] = static_cast<float>(bytes[3 * i + k]) / 127.5f - 1.0f;
    }
  } else {
    // The index of the largest component, and of the others sign and 9 bits, the last one lowest.
    constexpr std::uint32_t kMost = (1u << 9u) - 1u;
    std::uint32_t packed = u32At(bytes, 4 * i);
    derived = packed >> 30u;
    for (std::size_t k = 3; k-- > 0; packed >>= 10u) {
      const float size = static_cast<float>(packed & kMost) / static_cast<float>(kMost) /
                         std::numbers::sqrt2_v<float>;
      three[k] = (packed >> 9u & 1u) != 0 ? -size : size;
    }
  }
  const auto xyzw = quaternionOf(three, derived);
  return {xyzw[0], xyzw[1], xyzw[2], xyzw[3]};
}

RawGaussian gaussianOf(const SpzArrays& all, std::size_t i) {
  const auto bytesOf = [&](Array array) {
    const unsigned char* at = all.array[array].data() + 3 * i;
    return glm::vec3(at[0], at[1], at[2]);
  };
  return {.position = positionOf(all, i),
          .sigma = glm::exp(bytesOf(kScales) / 16.0f - 10.0f),
          .rotation = rotationOf(all, i),
          .opacity = static_cast<float>(all.array[kOpacities][i]) / 255.0f,
          .color = 0.5f + kHarmonic0 / kColorScale * (bytesOf(kColors) / 255.0f - 0.5f)};
}

/// What turns the axes of the file to those of SPZ by default: right, up, back (RUB). Of the
/// numbers 1 to 8, bits say whether x points right, y up, and z to the front; of 9 to 16, whether
/// x points right, y to the front, and z up (nianticlabs/spz, CoordinateSystem).
glm::mat3 axesOf(const SpzArrays& all) {
  if ((all.header.flags & kFlagExtensions) == 0) return glm::mat3(1.0f);
  std::uint32_t axes = 0;
  for (std::size_t at = 0; all.records.size() - at >= 8;) {
    const std::size_t length = u32At(all.records, at + 4), left = all.records.size() - at - 8;
    if (length > left) break;
    if (u32At(all.records, at) == kAxesRecord && length >= 4) axes = u32At(all.records, at + 8);
    at += 8 + length;
  }
  if (axes == 0 || axes > kMaxAxes) return glm::mat3(1.0f);
  const auto sign = [&](unsigned bit) { return ((axes - 1) >> bit & 1u) != 0 ? 1.0f : -1.0f; };
  const glm::vec3 right(sign(0), 0.0f, 0.0f);
  const bool z_is_up = axes > 8;
  const glm::vec3 up = z_is_up ? glm::vec3(0.0f, 0.0f, sign(1)) : glm::vec3(0.0f, sign(1), 0.0f);
  const glm::vec3 back =
      z_is_up ? glm::vec3(0.0f, -sign(2), 0.0f) : glm::vec3(0.0f, 0.0f, -sign(2));
  return glm::transpose(glm::mat3(right, up, back));
}

}  // namespace

bool isSpz(std::span<const unsigned char> first) {
  return first.size() >= 4 && u32At(first, 0) == kMagic;
}

GaussianFile readSpz(const FileBytes& bytes) {
  const bool is_new = !isGzip(bytes.all()) && u32At(bytes.part(0, 8), 4) == 4;
  const SpzArrays all = is_new ? unpackNew(bytes) : unpackOld(bytes);
  GaussianFile file{.format = "SPZ", .y_is_up = true};
  file.cloud.preserves_light = (all.header.flags & kFlagPreservesLight) != 0;
  if (all.header.degree > kMaxHarmonicsDegree) file.remarks.emplace_back(kDegree4);
  GaussianCollector collector(file, all.header.count,
                              std::min(all.header.degree, kMaxHarmonicsDegree));
  const std::size_t stored = 3 * static_cast<std::size_t>(harmonicsOf(all.header.degree));
  std::vector<float> harmonics(file.cloud.harmonicsPerGaussian());
  for (std::size_t i = 0; i < all.header.count; ++i) {
    for (std::size_t k = 0; k < harmonics.size(); ++k) {
      const unsigned char byte = all.array[kHarmonics][i * stored + k];
      harmonics[k] = (static_cast<float>(byte) - 128.0f) / 128.0f;
    }
    collector.append(gaussianOf(all, i), harmonics);
  }
  finishGaussians(file, bytes.name());
  if (const glm::mat3 axes = axesOf(all); axes != glm::mat3(1.0f)) {
    transform(file.cloud, axes, glm::vec3(0.0f));
  }
  return file;
}

}  // namespace foci
