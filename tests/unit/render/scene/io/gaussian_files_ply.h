// PLY, compressed PLY and .splat.
#pragma once

#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "render/scene/harmonics.h"
#include "tests/unit/render/scene/io/gaussian_files.h"

namespace foci {

inline std::string harmonicsHeader(const char* type, int count) {
  std::string header;
  for (int i = 0; i < count; ++i) {
    header += std::string("property ") + type + " f_rest_" + std::to_string(i) + "\n";
  }
  return header;
}

inline std::string gaussianPly(int degree) {
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

inline std::string compressedPly(int degree, bool colored) {
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

inline std::string splatFile() {
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

inline std::uint16_t halfOf(float value) {  // of normal numbers
  if (value == 0.0f) return 0;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t exponent = (bits >> 23u & 0xffu) - 112u;
  return static_cast<std::uint16_t>((bits >> 16u & 0x8000u) | exponent << 10u |
                                    (bits >> 13u & 0x3ffu));
}

}  // namespace foci
