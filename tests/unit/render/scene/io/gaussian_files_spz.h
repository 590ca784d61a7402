// .spz of versions 1 to 4, and .ksplat.
#pragma once

#include <zlib.h>
#include <zstd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "render/scene/harmonics.h"
#include "tests/unit/render/scene/io/gaussian_files.h"

namespace foci {

/// The arrays of an SPZ file.
inline std::vector<std::string> spzArrays(unsigned version, int degree) {
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

inline std::string spzHeader(unsigned version, int degree, int last) {
  std::string header = "NGSP";
  put(header, version, 2u);
  for (const int byte : {degree, 12, 0, last}) putByte(header, byte);
  return header;
}

inline std::string spzFile(unsigned version, int degree) {
  std::string file = spzHeader(version, degree, 0);
  for (const std::string& array : spzArrays(version, degree)) file += array;
  return file;
}

inline std::string gzipped(const std::string& plain) {
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

/// @param axes  of the record 0xADBE0003; 0: no record
inline std::string spz4File(int degree, unsigned axes = 0) {
  std::vector<std::string> arrays = spzArrays(4, degree);
  if (degree == 0) arrays.pop_back();
  std::string file = spzHeader(4, degree, static_cast<int>(arrays.size()));
  std::string records;
  if (axes > 0) {
    put(records, 0xdead0001u, 2u, std::uint16_t{7}, 0xadbe0003u, 4u, axes);
    file[14] = '\2';
  }
  put(file, static_cast<unsigned>(32 + records.size()), 0u, std::uint64_t{0});
  file += records;
  std::string packed;
  for (const std::string& array : arrays) {
    std::string one(ZSTD_compressBound(array.size()), '\0');
    one.resize(ZSTD_compress(one.data(), one.size(), array.data(), array.size(), 1));
    put(file, std::uint64_t{one.size()}, std::uint64_t{array.size()});
    packed += one;
  }
  return file + packed;
}

inline std::string ksplatFile(unsigned mode, int degree) {
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

}  // namespace foci
