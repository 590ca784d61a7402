// The readers of Gaussians on files that the test writes, and on damaged ones.
#include "render/scene/io/gaussian_formats.h"

#include <gtest/gtest.h>
#include <webp/encode.h>
#include <webp/types.h>
#include <zlib.h>
#include <zstd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace {

template <typename... Values>
void put(std::string& bytes, const Values&... values) {
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
}

void putByte(std::string& bytes, int value) { bytes.push_back(static_cast<char>(value)); }

std::string harmonicsHeader(const char* type, int count) {
  std::string header;
  for (int i = 0; i < count; ++i) {
    header += std::string("property ") + type + " f_rest_" + std::to_string(i) + "\n";
  }
  return header;
}

/// The file that each test reads: two Gaussians, the first at (1, -2, 3) with the deviations 0.1,
/// 0.2, 0.4, opacity 0.8, colour (0.75, 0.5, 0.25), turned by 90 degrees about z.
const glm::vec3 kPosition(1.0f, -2.0f, 3.0f), kSigma(0.1f, 0.2f, 0.4f), kColor(0.75f, 0.5f, 0.25f);
constexpr float kOpacity = 0.8f;
const float kHalf = std::sqrt(0.5f);
const glm::vec4 kRotation(0.0f, 0.0f, kHalf, kHalf);

/// Coefficient `k` of a channel, for files with harmonics.
float coefficient(int channel, int k) {
  return 0.03125f * static_cast<float>((k % 5) - 2) + 0.25f * static_cast<float>(channel - 1);
}

std::string gaussianPly(int degree) {
  const int rest = harmonicsOf(degree);
  std::string file =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float f_dc_0\nproperty float f_dc_1\n"
      "property float f_dc_2\n" +
      harmonicsHeader("float", 3 * rest) +
      "property float opacity\nproperty float scale_0\nproperty float scale_1\n"
      "property float scale_2\nproperty float rot_0\nproperty float rot_1\nproperty float rot_2\n"
      "property float rot_3\nend_header\n";
  for (int i = 0; i < 2; ++i) {
    put(file, kPosition.x, kPosition.y, kPosition.z + static_cast<float>(i), 0.0f);
    for (int channel = 0; channel < 3; ++channel) put(file, (kColor[channel] - 0.5f) / kHarmonic0);
    for (int channel = 0; channel < 3; ++channel) {
      for (int k = 0; k < rest; ++k) put(file, coefficient(channel, k));
    }
    put(file, std::log(kOpacity / (1.0f - kOpacity)));
    for (int axis = 0; axis < 3; ++axis) put(file, std::log(kSigma[axis]));
    put(file, 2.0f * kHalf, 0.0f, 0.0f, 2.0f * kHalf);  // w x y z, of any length
  }
  return file;
}

std::string compressedPly(int degree, bool colored) {
  std::string file = "ply\nformat binary_little_endian 1.0\nelement chunk 1\n";
  for (const char* name :
       {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y",
        "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z"}) {
    file += std::string("property float ") + name + "\n";
  }
  for (const char* name : {"min_r", "min_g", "min_b", "max_r", "max_g", "max_b"}) {
    if (colored) file += std::string("property float ") + name + "\n";
  }
  file +=
      "element vertex 2\nproperty uint packed_position\nproperty uint packed_rotation\n"
      "property uint packed_scale\nproperty uint packed_color\n";
  const int rest = 3 * harmonicsOf(degree);
  if (rest > 0) file += "element sh 2\n" + harmonicsHeader("uchar", rest);
  file += "end_header\n";
  put(file, kPosition.x, kPosition.y, kPosition.z, 2.0f, -1.0f, 4.0f);
  for (int axis = 0; axis < 3; ++axis) put(file, std::log(kSigma[axis]));
  put(file, 0.0f, 0.0f, 0.0f);
  if (colored) put(file, kColor.r, kColor.g, kColor.b, 1.0f, 1.0f, 1.0f);
  const auto quarter = [](unsigned channel) {  // without ranges: the colour itself
    return static_cast<unsigned>(std::lround(kColor[static_cast<int>(channel)] * 255.0f));
  };
  const std::uint32_t color =
      (colored ? 0u : quarter(0) << 24u | quarter(1) << 16u | quarter(2) << 8u) | 204u;  // 0.8
  // w is the largest; z = 0.7071 is 1023 of its 10 bits, x and y are in the middle.
  const std::uint32_t rotation = 0u << 30u | 512u << 20u | 512u << 10u | 1023u;
  put(file, std::uint32_t{0}, rotation, std::uint32_t{0}, color);
  put(file, std::uint32_t{0x7ff}, rotation, std::uint32_t{0}, color);  // z at its greatest
  for (int i = 0; i < 2; ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      for (int k = 0; k < rest / 3; ++k) {
        putByte(file, static_cast<int>((coefficient(channel, k) / 8.0f + 0.5f) * 256.0f));
      }
    }
  }
  return file;
}

std::string splatFile() {
  std::string file;
  for (int i = 0; i < 2; ++i) {
    put(file, kPosition.x, kPosition.y, kPosition.z + static_cast<float>(i), kSigma.x, kSigma.y,
        kSigma.z);
    for (const float channel : {kColor.r, kColor.g, kColor.b, kOpacity}) {
      putByte(file, static_cast<int>(std::lround(channel * 255.0f)));
    }
    for (const float q : {kHalf, 0.0f, 0.0f, kHalf}) {
      putByte(file, static_cast<int>(std::lround(128.0f + 128.0f * q)));
    }
  }
  return file;
}

std::uint16_t halfOf(float value) {  // of normal numbers
  if (value == 0.0f) return 0;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t exponent = (bits >> 23u & 0xffu) - 112u;
  return static_cast<std::uint16_t>((bits >> 16u & 0x8000u) | exponent << 10u |
                                    (bits >> 13u & 0x3ffu));
}

/// The arrays of an SPZ file.
std::vector<std::string> spzArrays(unsigned version, int degree) {
  std::vector<std::string> arrays(6);
  for (int i = 0; i < 2; ++i) {
    for (const float x : {kPosition.x, kPosition.y, kPosition.z + static_cast<float>(i)}) {
      if (version == 1) {
        put(arrays[0], halfOf(x));
      } else {
        const auto fixed = static_cast<std::int32_t>(x * 4096.0f);
        for (int shift : {0, 8, 16}) putByte(arrays[0], fixed >> shift);
      }
    }
    putByte(arrays[1], 204);
    for (int channel = 0; channel < 3; ++channel) {
      putByte(arrays[2], static_cast<int>(std::lround(
                             ((kColor[channel] - 0.5f) / kHarmonic0 * 0.15f + 0.5f) * 255.0f)));
      putByte(arrays[3],
              static_cast<int>(std::lround((std::log(kSigma[channel]) + 10.0f) * 16.0f)));
    }
    if (version <= 2) {
      for (const float q : {0.0f, 0.0f, kHalf}) {
        putByte(arrays[4], static_cast<int>(std::lround((q + 1.0f) * 127.5f)));
      }
    } else {
      put(arrays[4], 3u << 30u | 511u);  // w is the largest, z is 511 / 511 of 0.7071
    }
    for (int k = 0; k < harmonicsOf(degree); ++k) {
      for (int channel = 0; channel < 3; ++channel) {
        putByte(arrays[5],
                static_cast<int>(std::lround(coefficient(channel, k) * 128.0f + 128.0f)));
      }
    }
  }
  return arrays;
}

std::string spzHeader(unsigned version, int degree, int last) {
  std::string header = "NGSP";
  put(header, version, 2u);
  for (const int byte : {degree, 12, 0, last}) putByte(header, byte);
  return header;
}

std::string spzFile(unsigned version, int degree) {
  std::string file = spzHeader(version, degree, 0);
  for (const std::string& array : spzArrays(version, degree)) file += array;
  return file;
}

std::string gzipped(const std::string& plain) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
  std::string packed(plain.size() + 1000, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
  stream.avail_in = static_cast<uInt>(plain.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string spz4File(int degree) {
  std::vector<std::string> arrays = spzArrays(4, degree);
  if (degree == 0) arrays.pop_back();
  std::string file = spzHeader(4, degree, static_cast<int>(arrays.size()));
  put(file, 32u, 0u, std::uint64_t{0});
  std::string packed;
  for (const std::string& array : arrays) {
    std::string one(ZSTD_compressBound(array.size()), '\0');
    one.resize(ZSTD_compress(one.data(), one.size(), array.data(), array.size(), 1));
    put(file, std::uint64_t{one.size()}, std::uint64_t{array.size()});
    packed += one;
  }
  return file + packed;
}

std::string ksplatFile(unsigned mode, int degree) {
  std::string file(4096 + 1024, '\0');
  const auto set = [&](std::size_t at, const auto& value) {
    std::memcpy(file.data() + at, &value, sizeof(value));
  };
  set(1, std::uint8_t{1});
  set(4, 1u);
  set(16, 2u);
  set(20, static_cast<std::uint16_t>(mode));
  set(36, -1.0f);
  set(40, 1.0f);
  const std::size_t section = 4096;
  set(section, 2u);
  set(section + 4, 2u);
  set(section + 8, 256u);  // a bucket has room for 256
  set(section + 12, mode == 0 ? 0u : 1u);
  set(section + 16, 8.0f);  // width of a block
  set(section + 20, static_cast<std::uint16_t>(12));
  set(section + 24, 32767u);
  set(section + 36, mode == 0 ? 0u : 1u);  // one bucket, not full
  set(section + 40, static_cast<std::uint16_t>(degree));
  if (mode > 0) put(file, 2u, 0.0f, 0.0f, 0.0f);
  for (int i = 0; i < 2; ++i) {
    for (const float x : {kPosition.x, kPosition.y, kPosition.z + static_cast<float>(i)}) {
      if (mode == 0) {
        put(file, x);
      } else {
        put(file, static_cast<std::uint16_t>(std::lround(x / 4.0f * 32767.0f + 32767.0f)));
      }
    }
    for (const float x : {kSigma.x, kSigma.y, kSigma.z, kHalf, 0.0f, 0.0f, kHalf}) {
      if (mode == 0) {
        put(file, x);
      } else {
        put(file, halfOf(x));
      }
    }
    for (const float channel : {kColor.r, kColor.g, kColor.b, kOpacity}) {
      putByte(file, static_cast<int>(std::lround(channel * 255.0f)));
    }
    for (int l = 1, before = 0; l <= degree; before += 2 * l++ + 1) {
      for (int channel = 0; channel < 3; ++channel) {
        for (int k = before; k < before + 2 * l + 1; ++k) {
          const float value = coefficient(channel, k);
          if (mode == 0) put(file, value);
          if (mode == 1) put(file, halfOf(value));
          if (mode == 2) putByte(file, static_cast<int>(std::lround((value + 1.0f) * 127.5f)));
        }
      }
    }
  }
  return file;
}

/// A lossless WebP image of one row for each of `rows`.
std::string webp(const std::vector<std::string>& rows) {
  std::string pixels;
  for (const std::string& row : rows) pixels += row;
  const int width = static_cast<int>(rows.front().size() / 4), stride = 4 * width;
  std::uint8_t* packed = nullptr;
  const std::size_t size =
      WebPEncodeLosslessRGBA(reinterpret_cast<const std::uint8_t*>(pixels.data()), width,
                             static_cast<int>(rows.size()), stride, &packed);
  std::string file(reinterpret_cast<const char*>(packed), size);
  WebPFree(packed);
  return file;
}

std::string rgba(int r, int g, int b, int a = 255) {
  std::string pixel;
  for (const int value : {r, g, b, a}) putByte(pixel, value);
  return pixel;
}

std::string deflated(const std::string& bytes) {
  std::string packed(compressBound(bytes.size()), '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

/// A ZIP archive; its first member is deflated, the others are stored.
std::string zip(const std::vector<std::pair<std::string, std::string>>& members) {
  std::string file, directory;
  std::uint16_t method = 8;
  for (const auto& [name, bytes] : members) {
    const std::string packed = method == 8 ? deflated(bytes) : bytes;
    std::string facts;
    put(facts, std::uint16_t{20}, std::uint16_t{0}, method, std::uint32_t{0},
        static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(bytes.data()),
                                         static_cast<uInt>(bytes.size()))),
        static_cast<std::uint32_t>(packed.size()), static_cast<std::uint32_t>(bytes.size()),
        static_cast<std::uint16_t>(name.size()), std::uint16_t{0});
    directory += "PK\x01\x02";
    put(directory, std::uint16_t{20});
    directory += facts;
    put(directory, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0}, std::uint32_t{0},
        static_cast<std::uint32_t>(file.size()));
    directory += name;
    file.append("PK\x03\x04").append(facts).append(name).append(packed);
    method = 0;
  }
  const auto at = static_cast<std::uint32_t>(file.size());
  const auto count = static_cast<std::uint16_t>(members.size());
  file += directory + "PK\x05\x06";
  put(file, std::uint32_t{0}, count, count, static_cast<std::uint32_t>(directory.size()), at,
      std::uint16_t{0});
  return file;
}

std::string listOf(const std::vector<float>& numbers) {
  std::string list;
  for (const float number : numbers) list += (list.empty() ? "[" : ",") + std::to_string(number);
  return list + "]";
}

std::string codebook(std::vector<float> numbers) {
  numbers.resize(256);
  return "\"codebook\":" + listOf(numbers);
}

std::string sogFile(int degree, int version = 2) {
  const float high = std::log(1.0f + kPosition.z + 1.0f);
  std::string meta =
      "{\"version\":" + std::to_string(version) + ",\"count\":2,\"means\":{\"mins\":" +
      listOf({0.0f, -std::log(1.0f - kPosition.y), std::log(1.0f + kPosition.z)}) +
      ",\"maxs\":" + listOf({std::log(1.0f + kPosition.x), 0.0f, high}) +
      ",\"files\":[\"l.webp\",\"u.webp\"]},\"scales\":{" +
      codebook({std::log(kSigma.x), std::log(kSigma.y), std::log(kSigma.z)}) +
      ",\"files\":[\"s.webp\"]},\"quats\":{\"files\":[\"q.webp\"]},\"sh0\":{" +
      codebook({(kColor.r - 0.5f) / kHarmonic0, 0.0f, (kColor.b - 0.5f) / kHarmonic0}) +
      ",\"files\":[\"c.webp\"]}";
  // The component that is left out is w, or z: the others are 0 and 0.7071.
  const std::string rotation =
      degree % 2 == 0 ? rgba(128, 128, 255, 252) : rgba(255, 128, 128, 255);
  const std::string means = rgba(255, 0, 0) + rgba(255, 0, 255), codes = rgba(0, 1, 2);
  const std::string color = rgba(0, 1, 2, 204);
  std::vector<std::pair<std::string, std::string>> members = {
      {"l.webp", webp({means})},
      {"u.webp", webp({means})},
      {"s.webp", webp({codes + codes})},
      {"q.webp", webp({rotation + rotation})},
      {"c.webp", webp({color + color})}};
  if (degree > 0) {
    std::vector<float> steps(256);
    for (int i = 0; i < 256; ++i)
      steps[static_cast<std::size_t>(i)] = 0.03125f * static_cast<float>(i - 128);
    meta += ",\"shN\":{\"count\":128,\"bands\":" + std::to_string(degree) + "," + codebook(steps) +
            ",\"files\":[\"p.webp\",\"i.webp\"]}";
    // The second Gaussian has entry 65: the second one in the second row.
    std::vector<std::string> palette(2);
    for (int entry = 0; entry < 128; ++entry) {
      for (int k = 0; k < harmonicsOf(degree); ++k) {
        const auto code = [&](int channel) {
          return entry == 65 ? static_cast<int>(32.0f * coefficient(channel, k)) + 128 : 0;
        };
        palette[static_cast<std::size_t>(entry / 64)] += rgba(code(0), code(1), code(2));
      }
    }
    members.emplace_back("p.webp", webp(palette));
    members.emplace_back("i.webp", webp({rgba(0, 0, 0) + rgba(65, 0, 0)}));
  }
  members.insert(members.begin(), {"meta.json", meta + "}"});
  return zip(members);
}

struct Format {
  const char* name;
  int degree;
  std::string bytes;
  /// Steps of the format: of position, relative of deviations, of rotation, of colour, of
  /// harmonics.
  float position, sigma, rotation, color, harmonics;
};

std::vector<Format> formats() {
  constexpr float kByte = 1.0f / 255.0f, kFine = 1e-5f, kStep = kHarmonicsStep;
  std::vector<Format> all;
  for (int degree = 0; degree <= 3; ++degree) {
    all.push_back({"PLY", degree, gaussianPly(degree), kFine, kFine, kFine, kFine, kStep});
    all.push_back({"compressed PLY", degree, compressedPly(degree, true), kFine, kFine, 2e-3f,
                   kByte, 8.0f / 256.0f});
    for (const unsigned version : {1u, 2u, 3u}) {
      all.push_back(
          {"SPZ", degree, spzFile(version, degree), 2e-3f, 0.04f, 0.01f, 0.01f, 1.0f / 128.0f});
    }
    all.push_back(
        {"SPZ", degree, gzipped(spzFile(3, degree)), 3e-4f, 0.04f, 2e-3f, 0.01f, 1.0f / 128.0f});
    all.push_back({"SPZ", degree, spz4File(degree), 3e-4f, 0.04f, 2e-3f, 0.01f, 1.0f / 128.0f});
    all.push_back({"KSPLAT", degree, ksplatFile(0, degree), kFine, kFine, kFine, kByte, kStep});
    all.push_back({"SOG", degree, sogFile(degree), 2e-4f, kFine, 0.01f, kFine, kStep});
    for (const unsigned mode : {1u, 2u}) {
      all.push_back({"KSPLAT", degree, ksplatFile(mode, degree), 2e-4f, 1e-3f, 1e-3f, kByte,
                     mode == 1 ? 2.0f * kStep : 1.0f / 127.0f});
    }
  }
  all.push_back({"compressed PLY", 0, compressedPly(0, false), kFine, kFine, 2e-3f, kByte, 0.0f});
  all.push_back({"splat", 0, splatFile(), kFine, kFine, 0.01f, kByte, 0.0f});
  return all;
}

TEST(GaussianFormats, AreReadByTheirContent) {
  const TemporaryFolder folder;
  for (const Format& format : formats()) {
    SCOPED_TRACE(std::string(format.name) + " of degree " + std::to_string(format.degree));
    const auto file = readGaussians(folder.write("scene.bin", format.bytes));
    ASSERT_TRUE(file);
    EXPECT_EQ(file->format, format.name);
    const GaussianCloud& cloud = file->cloud;
    ASSERT_EQ(cloud.size(), 2u);
    ASSERT_EQ(cloud.degree, format.degree);
    EXPECT_EQ(file->dropped, 0u);
    EXPECT_NEAR(cloud.position_m[1].z, kPosition.z + 1.0f, 2.0f * format.position);
    EXPECT_NEAR(cloud.opacity[0], kOpacity, 2e-3f);
    const Covariance3 expected = covarianceOf(kSigma, kRotation), v = cloud.covariance_m2[0];
    // Axes of 0.1 and 0.4 at most: errors of sigma and rotation, both doubled by the square.
    const float slack = 0.16f * 2.0f * (format.sigma + format.rotation);
    EXPECT_NEAR(v.xx, expected.xx, slack);
    EXPECT_NEAR(v.xy, expected.xy, slack);
    EXPECT_NEAR(v.xz, expected.xz, slack);
    EXPECT_NEAR(v.yy, expected.yy, slack);
    EXPECT_NEAR(v.yz, expected.yz, slack);
    EXPECT_NEAR(v.zz, expected.zz, slack);
    EXPECT_GT(v.xx, 2.0f * v.yy);  // the turn by 90 degrees
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(cloud.position_m[0][channel], kPosition[channel], format.position);
      EXPECT_NEAR(cloud.color[0][channel], kColor[channel], format.color);
    }
    for (int k = 0; k < harmonicsOf(format.degree); ++k) {
      for (int channel = 0; channel < 3; ++channel) {
        const std::size_t second = cloud.harmonicsPerGaussian();
        const auto at =
            second + 3 * static_cast<std::size_t>(k) + static_cast<std::size_t>(channel);
        EXPECT_NEAR(kHarmonicsStep * cloud.harmonics[at], coefficient(channel, k),
                    format.harmonics);
      }
    }
  }
}

TEST(GaussianFormats, RefuseEveryShorterFileInOneLine) {
  const TemporaryFolder folder;
  for (const Format& format : formats()) {
    SCOPED_TRACE(std::string(format.name) + " of degree " + std::to_string(format.degree));
    const std::size_t size = format.bytes.size();
    // The headers of .ksplat are long: not every length.
    for (std::size_t length = 0; length<size; length += size> 4096 ? 61 : 7) {
      const auto path = folder.write("short.bin", format.bytes.substr(0, length));
      try {
        const auto file = readGaussians(path);
        EXPECT_LT(file ? file->cloud.size() : 0u, 2u) << length;
      } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        EXPECT_EQ(std::string(error.what()).find(path.string()), 0u);
      }
    }
  }
}

/// The message of the reader, without the file's name.
std::string refusalOf(const std::string& bytes) {
  const TemporaryFolder folder;
  const auto path = folder.write("bad.bin", bytes);
  try {
    return readGaussians(path) ? "read" : "another format";
  } catch (const InputError& error) {
    return std::string(error.what()).substr(path.string().size() + 2);
  }
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST(GaussianFormats, SayWhatIsWrong) {
  EXPECT_EQ(refusalOf(replaced(gaussianPly(0), "property float scale_2", "property float scale_9")),
            "element vertex: expected the property scale_2 of a Gaussian");
  EXPECT_EQ(refusalOf(replaced(gaussianPly(1), "f_rest_8", "f_other8")),
            "element vertex: has 8 properties f_rest: expected 0, 9, 24 or 45, for degree 0 to 3");
  EXPECT_EQ(refusalOf(replaced(gaussianPly(0), "binary_little_endian", "ascii")),
            "Gaussians: expected format binary_little_endian");
  EXPECT_EQ(
      refusalOf(replaced(compressedPly(0, true), "property float max_b", "property float max_c")),
      "compressed PLY of Gaussians: expected an element chunk of float min_x, min_y, ... (12 "
      "or 18 properties)");
  EXPECT_EQ(refusalOf("NGSP" + std::string("\x05\0\0\0", 4) + std::string(60, '\0')),
            "is SPZ of version 5: expected version 1 to 4");
  EXPECT_EQ(refusalOf(sogFile(0, 3)), "is SOG of version 3: expected version 2");
  EXPECT_EQ(refusalOf(zip({{"meta.json", "{\"version\":2,\"count\":1e30}"}})),
            "meta.json: expected a whole number");
  EXPECT_EQ(refusalOf(zip({{"meta.json", "{\"version\":2,\"count\":9}"}})),
            "meta.json: expected that of a SOG of version 2");
  EXPECT_EQ(refusalOf(zip({{"model.usd", "another scene"}})), "another format");
  std::string flipped = sogFile(0);
  const std::size_t pixels = flipped.find("WEBPVP8L") + 24;
  flipped[pixels] = static_cast<char>(flipped[pixels] ^ 0x55);
  EXPECT_EQ(refusalOf(flipped), "is damaged: l.webp");
  std::string many = spzFile(2, 0);
  many[11] = '\x7f';
  EXPECT_NE(refusalOf(many).find("Gaussians in"), std::string::npos);
  std::string damaged = spz4File(0);
  damaged.back() = static_cast<char>(damaged.back() ^ 0x55);
  damaged[damaged.size() - 8] = static_cast<char>(damaged[damaged.size() - 8] ^ 0x55);
  EXPECT_NE(refusalOf(damaged), "another format");
  std::string packed = gzipped(spzFile(3, 1));
  EXPECT_NE(refusalOf(packed.substr(0, packed.size() - 20)).find("is damaged"), std::string::npos);
}

TEST(GaussianFormats, LeaveOutGaussiansThatAreNotFinite) {
  std::string file = gaussianPly(0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(file.data() + file.find("end_header\n") + 11, &nan, sizeof(nan));
  const TemporaryFolder folder;
  const auto read = readGaussians(folder.write("nan.ply", file));
  EXPECT_EQ(read->cloud.size(), 1u);
  EXPECT_EQ(read->dropped, 1u);
}

TEST(GaussianFormats, OtherFilesAreNotTakenForThem) {
  const TemporaryFolder folder;
  EXPECT_FALSE(readGaussians(folder.write("a.txt", std::string(64, 'x'))));
  EXPECT_FALSE(readGaussians(folder.write("b", "")));
  // Small floats, and bytes that would be a quaternion of length 1.
  EXPECT_FALSE(readGaussians(folder.write("e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1HHH")));
  EXPECT_FALSE(readGaussians(folder.write("c", std::string(320, '\0'))));
  EXPECT_FALSE(readGaussians(
      folder.write("d.ply",
                   "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                   "property float z\nend_header\n0 0 0\n")));
}

TEST(GaussianFormats, OpenAsAScene) {
  const TemporaryFolder folder;
  const OpenedScene scene = openScene(folder.write("s.ply", gaussianPly(1)), 0.5, {});
  ASSERT_TRUE(scene.cloud.gaussians);
  EXPECT_TRUE(scene.cloud.empty());
  EXPECT_EQ(positionsOf(scene.cloud)[0], 0.5f * kPosition);
  EXPECT_NEAR(scene.cloud.gaussians->covariance_m2[0].zz, 0.25f * 0.16f, 1e-5f);
  EXPECT_THROW(openPoints(readScene(folder.path() / "s.ply"), 1.0), InputError);
}

}  // namespace
}  // namespace foci
